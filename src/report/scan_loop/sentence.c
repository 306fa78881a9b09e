/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The page's one sentence. */
#include <math.h>
#include <string.h>

#include "core/text.h"
#include "report/correction_words.h"
#include "report/scan_loop/parts.h"

static fg_status say_parameters(fg_context *ctx, const fg_scan_result_claim *claim, char **text) {
  char value[64];
  for (size_t i = 0; i < claim->parameters; i++) {
    const fg_scan_result_parameter *p = &claim->parameter[i];
    fg_scan_loop_value_words(p->told, p->u_told, value, sizeof value);
    FG_TRY(fg_text_append(ctx, text, "%s%s = %s%s%s", i ? ", " : " (", p->symbol, value,
                          strcmp(p->unit, "°") ? " " : "", p->unit));
  }
  return claim->parameters ? fg_text_append(ctx, text, ")") : FG_OK;
}

/* Appends the effects that every explanation includes: listed ones, or free curves. */
static fg_status append_claims(fg_context *ctx, const fg_scan_result *result, bool free_curves,
                               char **text) {
  const char *before = !free_curves ? "Found: "
                       : *text      ? "; no listed effect explains "
                                    : "No listed effect explains ";
  bool first = true;
  for (size_t i = 0; i < result->claims; i++) {
    const fg_scan_result_claim *claim = &result->claim[i];
    if (claim->free != free_curves || !claim->sure || claim->of_width) continue;
    const char *between = free_curves ? ", nor " : "; ";
    FG_TRY(fg_text_append(ctx, text, "%s%s", first ? before : between, claim->words));
    FG_TRY(say_parameters(ctx, claim, text));
    first = false;
  }
  return FG_OK;
}

/* Appends the effects of each explanation besides the common ones. */
static fg_status append_explanations(fg_context *ctx, const fg_scan_result *result, char **text) {
  enum { NAMED = 3 };
  size_t count = result->explanations, total = count + result->unlisted;
  size_t named = total <= NAMED ? count : NAMED - 1;
  if (result->named) return FG_OK;
  FG_TRY(fg_text_append(ctx, text, "%s",
                        *text           ? "; beside it the data cannot tell which it is: "
                        : result->curve ? "No one listed effect explains what is there, and the "
                                          "data cannot tell which it is: "
                                        : "Found, but the data cannot tell which it is: "));
  for (size_t m = 0; m < named; m++)
    FG_TRY(fg_text_append(ctx, text, "%s%s",
                          m == 0           ? ""
                          : m + 1 == total ? " or "
                                           : ", ",
                          result->explanation[m].words));
  if (total == named + 1) FG_TRY(fg_text_append(ctx, text, " or one other explanation"));
  if (total > named + 1)
    FG_TRY(fg_text_append(ctx, text, " or one of %zu other explanations", total - named));
  return FG_OK;
}

/* Writes "falls from 2 µm to 1 µm", or "stays at 2 µm" where the digits shown do not tell. */
static void change_words(double before_um, double after_um, char *words, size_t size) {
  char before[32], after[32];
  fg_scan_loop_length_words(before_um, before, sizeof before);
  fg_scan_loop_length_words(after_um, after, sizeof after);
  if (strcmp(before, after) == 0)
    fg_text_clip(words, size, "stays at %s", after);
  else
    fg_text_clip(words, size, "%s from %s to %s", after_um < before_um ? "falls" : "rises", before,
                 after);
}

static fg_status write_error_sentence(fg_context *ctx, const fg_scan_result *result, char **text) {
  char change[96], floor_words[32];
  change_words(result->before.rms, result->after.rms, change, sizeof change);
  fg_scan_loop_length_words(result->noise_floor_um, floor_words, sizeof floor_words);
  FG_TRY(fg_text_append(ctx, text, " The edge residual %s rms; the noise alone makes %s.", change,
                        floor_words));
  char held_out[FG_HELD_OUT_WORDS];
  fg_scan_loop_held_out_words(result, held_out);
  if (!held_out[0] || !isfinite(result->before.held_out_rms)) return FG_OK;
  change_words(result->before.held_out_rms, result->after.held_out_rms, change, sizeof change);
  return fg_text_append(ctx, text, " On %s it %s.", held_out, change);
}

/* Numbers of foils, or of scans of discs, that keep a dimension as measured. */
typedef struct kept {
  size_t left[FG_CORRECTED], tied[FG_CORRECTED], all;
} kept;

static void count_kept(const fg_correction_choice *choice, kept *k) {
  if (choice[FG_CORRECTED_RADIUS].reason == FG_CORRECTION_NONE) return;
  k->all++;
  for (int d = 0; d < FG_CORRECTED; d++) {
    k->left[d] += fg_correction_is_left_out(&choice[d]);
    k->tied[d] += fg_correction_is_left_out(&choice[d]) && choice[d].reason == FG_CORRECTION_TIED;
  }
}

static kept count_all_kept(const fg_scan_result *result) {
  kept k = {.all = 0};
  for (size_t i = 0; i < result->scans; i++)
    for (size_t f = 0; f < result->scan[i].after->foil_count; f++)
      count_kept(result->scan[i].after->foils[f].choice, &k);
  return k;
}

/* Appends the dimensions without a benefit, which stay as measured. */
static fg_status append_kept(fg_context *ctx, const fg_scan_result *result, char **text) {
  const kept k = count_all_kept(result);
  size_t kinds = 0, whole = 0, tied = 0, at = 0;
  for (int d = 0; d < FG_CORRECTED; d++) {
    kinds += k.left[d] > 0;
    whole += k.all && k.left[d] == k.all;
    tied += k.tied[d];
  }
  if (!kinds) return FG_OK;
  if (whole == FG_CORRECTED) {
    FG_TRY(fg_text_append(ctx, text, " All dimensions stay as measured"));
  } else {
    for (int d = 0; d < FG_CORRECTED; d++) {
      if (!k.left[d]) continue;
      const char *between = !at ? " " : at + 1 == kinds ? " and " : ", ";
      FG_TRY(fg_text_append(ctx, text, "%s%s", between, fg_corrected_symbol((fg_corrected)d)));
      if (k.left[d] < k.all)
        FG_TRY(fg_text_append(ctx, text, " of %zu of %zu foils", k.left[d], k.all));
      at++;
    }
    FG_TRY(fg_text_append(ctx, text, kinds > 1 ? " stay as measured" : " stays as measured"));
  }
  const char *move = result->named ? "the forms that the effect can have would move"
                                   : "these explanations would move";
  if (!tied)
    return fg_text_append(ctx, text, ": a correction would add more error than it removes.");
  return fg_text_append(ctx, text, ": %s %s by different amounts.", move,
                        kinds > 1 ? "them" : "it");
}

static fg_status write_chance_sentence(fg_context *ctx, double p, char **text) {
  if (p < 1e-12)
    return fg_text_append(ctx, text, "Probability that noise alone looks like this: p < 10⁻¹².");
  return fg_text_append(ctx, text, "Probability that noise alone looks like this: p = %.2g.", p);
}

static fg_status say_clean(fg_context *ctx, const fg_scan_result *result, char **text) {
  char rms[32];
  fg_scan_loop_length_words(result->before.rms, rms, sizeof rms);
  if (result->uneven_discs)
    return fg_text_print(ctx, text,
                         "Nothing is claimed of the scanner: the discs deviate from circles (%s "
                         "rms) by more than noise, and not as one cause on all of them would have "
                         "it. The dimensions stand as measured.",
                         rms);
  return fg_text_print(ctx, text,
                       "Nothing is claimed: what the circles leave of the edges (%s rms) is noise "
                       "as far as %s can tell. The dimensions stand as measured.",
                       rms, result->scans > 1 ? "these scans" : "this scan");
}

static fg_status say_edges(fg_context *ctx, const fg_scan_result *result, char **text) {
  char rms[32];
  fg_scan_loop_length_words(result->before.rms, rms, sizeof rms);
  return fg_text_print(ctx, text, "The edges lie on their circles within the noise (%s rms).", rms);
}

static fg_status say_points(fg_context *ctx, const fg_scan_result *result, char **text) {
  if (result->verdict == FG_LOOP_CLEAN) return say_clean(ctx, result, text);
  if (!result->corrected) return say_edges(ctx, result, text);
  FG_TRY(append_claims(ctx, result, false, text));
  FG_TRY(append_claims(ctx, result, true, text));
  if (result->tied) FG_TRY(append_explanations(ctx, result, text));
  FG_TRY(fg_text_append(ctx, text, ". "));
  FG_TRY(write_chance_sentence(ctx, result->p_value, text));
  FG_TRY(write_error_sentence(ctx, result, text));
  return append_kept(ctx, result, text);
}

/* Appends the effects of the width separately: the residual does not include them. */
static fg_status append_width(fg_context *ctx, const fg_scan_result *result, char **text) {
  char value[64], before[32], after[32];
  for (size_t i = 0; i < result->claims; i++) {
    const fg_scan_result_claim *claim = &result->claim[i];
    const fg_scan_result_parameter *p = &claim->parameter[0];
    if (!claim->of_width) continue;
    fg_scan_loop_value_words(p->told, p->u_told, value, sizeof value);
    FG_TRY(fg_text_append(ctx, text, " In the strip's width: %s (%s = %s %s)%s. ",
                          claim->says ? claim->says : claim->words, p->symbol, value, p->unit,
                          claim->sure ? "" : ", or the scanner's shift stretches it so"));
    FG_TRY(write_chance_sentence(ctx, claim->p_value, text));
  }
  fg_scan_loop_length_words(result->width_before_um, before, sizeof before);
  fg_scan_loop_length_words(result->width_after_um, after, sizeof after);
  return fg_text_append(ctx, text, " Half the width deviates by %s rms before and %s after.",
                        before, after);
}

/* ---- the bumps ---- */

static fg_status say_bump_claim(fg_context *ctx, const fg_scan_result_response *response,
                                const fg_scan_result_bump_claim *claim, const char *lead,
                                char **text) {
  char value[64];
  fg_scan_loop_value_words(claim->amplitude, claim->u_amplitude, value, sizeof value);
  FG_TRY(fg_text_append(ctx, text, "%s%s in the %s (half range %s %s)", lead, claim->words,
                        response->words, value, fg_scan_loop_unit_words(response->unit)));
  if (!claim->ties) return FG_OK;
  return fg_text_append(ctx, text, ", or %s%s", claim->tied[0].name,
                        claim->ties > 1 ? " or others" : "");
}

/* Appends the effects over the bumps. */
static fg_status append_bumps(fg_context *ctx, const fg_scan_result_bumps *bumps, char **text) {
  const char *first =
      bumps->declared_path ? " Over the bumps, beside the declared forming: " : " Over the bumps: ";
  const char *lead = first;
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++)
    for (size_t m = 0; m < bumps->response[r].claims; m++, lead = "; ")
      FG_TRY(say_bump_claim(ctx, &bumps->response[r], &bumps->response[r].claim[m], lead, text));
  if (bumps->curve) {
    FG_TRY(fg_text_append(ctx, text, "%sno listed effect explains how the %s varies", lead,
                          bumps->curve->words));
    lead = "; ";
  }
  return lead == first ? FG_OK : fg_text_append(ctx, text, ".");
}

fg_status fg_scan_loop_sentence(fg_context *ctx, const fg_scan_result *result, char **text) {
  *text = NULL;
  FG_TRY(say_points(ctx, result, text));
  if (result->of_width) FG_TRY(append_width(ctx, result, text));
  return append_bumps(ctx, &result->bumps, text);
}
