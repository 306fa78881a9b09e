/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan_loop/verdict.h"

#include <math.h>
#include <string.h>

#include "core/text.h"
#include "scan_loop/channel_check.h"
#include "scan_loop/result.h"
#include "scan_loop/scanner_model.h"
#include "scan_loop/state.h"

/* Below this share of an effect beside the geometry no data of this kind could show it. */
#define ABSORBED_SHARE 1e-4

_Static_assert((int)FG_SCAN_RESULT_CLAIMS == (int)FG_EFFECT_SET_MAX + (int)FG_WIDTH_EFFECTS_MAX,
               "every effect has its place");
_Static_assert((int)FG_SCAN_RESULT_EXPLANATIONS == (int)FG_EXPLANATIONS_MAX,
               "every explanation has its place");
_Static_assert((int)FG_SCAN_RESULT_UNCLAIMED >=
                   FG_CANDIDATES_MAX + (int)FG_SEARCH_BARRED_MAX + (int)FG_WIDTH_EFFECTS_MAX,
               "every candidate has its place");
_Static_assert((int)FG_SCAN_X == (int)FG_EFFECT_X && (int)FG_SCAN_Y == (int)FG_EFFECT_Y &&
                   (int)FG_SCAN_FOIL == (int)FG_EFFECT_FOIL &&
                   (int)FG_SCAN_PHI == (int)FG_EFFECT_PHI &&
                   (int)FG_SCAN_INDEX == (int)FG_EFFECT_INDEX &&
                   (int)FG_SCAN_NORMAL == (int)FG_EFFECT_NORMAL &&
                   (int)FG_SCAN_COORDINATES == (int)FG_EFFECT_COORDINATES,
               "coordinates are numbered alike");

/* ---- explanations ---- */

static bool member_holds(const fg_explanations *explanations, size_t explanation,
                         const fg_effect *kind) {
  for (size_t e = 0; e < explanations->candidate_count; e++)
    if ((explanations->each[explanation].mask >> e & 1) &&
        fg_effect_same(explanations->candidates[e].kind, kind))
      return true;
  return false;
}

/* Returns true when every explanation that the data allow includes the effect, in any basis. */
static bool is_sure(const fg_explanations *explanations, const fg_effect *kind) {
  for (size_t m = 0; m < explanations->count; m++)
    if (!member_holds(explanations, m, kind)) return false;
  return true;
}

static bool any_member_holds(const fg_explanations *explanations, const fg_effect *kind) {
  for (size_t m = 0; m < explanations->count; m++)
    if (member_holds(explanations, m, kind)) return true;
  return false;
}

/* Returns true when an explanation includes all effects of another, in any basis. */
static bool covers(const fg_explanations *explanations, size_t explanation, size_t other) {
  for (size_t e = 0; e < explanations->candidate_count; e++)
    if ((explanations->each[other].mask >> e & 1) &&
        !member_holds(explanations, explanation, explanations->candidates[e].kind))
      return false;
  return true;
}

/* The effects of an explanation as a sum of ids. */
static void fill_explanation_name(const fg_explanations *explanations, size_t explanation,
                                  char name[FG_SCAN_RESULT_WORDS]) {
  size_t used = 0;
  name[0] = 0;
  for (size_t e = 0; e < explanations->candidate_count && used + 1 < FG_SCAN_RESULT_WORDS; e++) {
    if (!(explanations->each[explanation].mask >> e & 1)) continue;
    fg_text_clip(name + used, FG_SCAN_RESULT_WORDS - used, "%s%s", used ? " + " : "",
                 explanations->candidates[e].kind->id);
    used = strlen(name);
  }
}

/* Writes the effects that an explanation shares with all others (`common`), or those that it has
 * alone: "a together with b". */
static void put_words(const fg_explanations *explanations, size_t explanation, bool common,
                      char words[FG_SCAN_RESULT_WORDS]) {
  size_t used = 0;
  fg_text_clip(words, FG_SCAN_RESULT_WORDS, "%s", common ? "" : "nothing more");
  for (size_t e = 0; e < explanations->candidate_count && used + 1 < FG_SCAN_RESULT_WORDS; e++) {
    const fg_effect *kind = explanations->candidates[e].kind;
    if (!(explanations->each[explanation].mask >> e & 1) || is_sure(explanations, kind) != common)
      continue;
    fg_text_clip(words + used, FG_SCAN_RESULT_WORDS - used, "%s%s", used ? " together with " : "",
                 kind->words);
    used = strlen(words);
  }
}

/* Two bases of one effect are one explanation. */
static void put_explanations(const fg_explanations *from, fg_scan_result *result) {
  size_t shown[FG_EXPLANATIONS_MAX];
  for (size_t m = 0; m < from->count; m++) {
    bool known = false;
    for (size_t k = 0; k < result->explanations && !known; k++)
      known = covers(from, m, shown[k]) && covers(from, shown[k], m);
    if (known) continue;
    fg_scan_result_explanation *one = &result->explanation[result->explanations];
    shown[result->explanations++] = m;
    fill_explanation_name(from, m, one->name);
    put_words(from, m, false, one->words);
  }
  if (from->count) put_words(from, 0, true, result->common);
  if (from->count == FG_EXPLANATIONS_MAX && from->total > FG_EXPLANATIONS_MAX)
    result->unlisted = from->total - FG_EXPLANATIONS_MAX;
  result->tied = from->count > 1;
  result->named = result->explanations < 2;
}

/* ---- claims ---- */

static void put_shares(const fg_explanations *explanations, const fg_effect *kind,
                       fg_scan_result_claim *claim) {
  claim->would_explain = claim->retained_share = NAN;
  for (size_t e = 0; e < explanations->candidate_count; e++)
    if (explanations->candidates[e].kind == kind) {
      claim->would_explain = explanations->alone[e];
      claim->retained_share = explanations->share[e];
      return;
    }
}

static fg_status fill_claim(fg_context *ctx, const fg_scan_loop *loop,
                            const fg_effect_found *effect, fg_scan_result_claim *claim) {
  const fg_effect *kind = effect->kind;
  *claim = (fg_scan_result_claim){
      .id = kind->id,
      .direction = kind->direction,
      .words = kind->words,
      .equation = kind->equation,
      .free = fg_effect_is_free(kind),
      .sure = is_sure(&loop->explanations, kind),
      .coordinate = (fg_scan_coordinate)kind->coordinate,
      .coordinate_name = fg_effect_coordinate_name(kind->coordinate),
      .moves = kind->moves,
      .basis = kind->bends && !fg_effect_is_free(kind)
                   ? "deviation of every bump from its best-fit circle"
                   : NULL,
      .amplitude_um = fg_effect_found_amplitude(effect),
      .p_value = loop->explanations.p_value,
  };
  claim->verdict = claim->sure ? FG_LOOP_FOUND : FG_LOOP_TIED;
  claim->parameters = fg_scan_result_put_parameters(effect, claim->parameter);
  put_shares(&loop->explanations, kind, claim);
  if (!claim->free && !claim->basis) return FG_OK;
  return fg_scan_result_put_shape(ctx, loop, effect, claim);
}

/* Returns true where the scanner does what nobody has named: it stretches the strip as well. */
static bool holds_nameless_scanner(const fg_effect_set *set) {
  for (size_t i = 0; i < set->count; i++)
    if (fg_effect_is_free(set->effects[i].kind) && set->effects[i].kind->glass) return true;
  return false;
}

static void put_width_claim(const fg_width_effect *from, bool sure, fg_scan_result_claim *claim) {
  const fg_effect *kind = from->effect.kind;
  *claim = (fg_scan_result_claim){
      .id = kind->id,
      .words = kind->words,
      .equation = kind->equation,
      .says = kind->says[fg_effect_found_amplitude(&from->effect) < 0],
      .of_width = true,
      .sure = sure,
      .verdict = sure ? FG_LOOP_FOUND : FG_LOOP_TIED,
      .coordinate = (fg_scan_coordinate)kind->coordinate,
      .coordinate_name = fg_effect_coordinate_name(kind->coordinate),
      .amplitude_um = fg_effect_found_amplitude(&from->effect),
      .p_value = from->p_value,
      .retained_share = from->share,
      .would_explain = from->would_explain,
  };
  claim->parameters = fg_scan_result_put_parameters(&from->effect, claim->parameter);
}

static void put_width(const fg_width_findings *width, const fg_effect_set *set,
                      fg_scan_result *result) {
  bool sure = !holds_nameless_scanner(set);
  for (size_t e = 0; e < width->count; e++)
    if (width->each[e].found)
      put_width_claim(&width->each[e], sure, &result->claim[result->claims++]);
  result->of_width = width->found > 0;
  result->width_before_um = width->rms_before_um;
  result->width_after_um = width->rms_after_um;
}

static fg_status put_claims(fg_context *ctx, const fg_scan_loop *loop, fg_scan_result *result) {
  for (size_t i = 0; i < loop->set.count; i++) {
    fg_scan_result_claim *claim = &result->claim[result->claims++];
    FG_TRY(fill_claim(ctx, loop, &loop->set.effects[i], claim));
    if (claim->free && (!result->curve || claim->amplitude_um > result->curve->amplitude_um))
      result->curve = claim;
  }
  const fg_explanations *explanations = &loop->explanations;
  for (size_t e = 0; e < explanations->candidate_count; e++) {
    const fg_effect *kind = explanations->candidates[e].kind;
    if (!fg_effect_is_free(kind) && explanations->alone[e] > FG_SCAN_LOOP_NEAR_SHARE &&
        !kind->second)
      result->nearest[result->nearests++] = kind->id;
  }
  return FG_OK;
}

/* ---- effects that are not claimed ---- */

static bool is_claimed(const fg_effect_set *set, const fg_effect *kind) {
  for (size_t i = 0; i < set->count; i++)
    if (fg_effect_same(set->effects[i].kind, kind)) return true;
  return false;
}

static bool is_listed(const fg_scan_result *result, const fg_effect *kind) {
  for (size_t i = 0; i < result->unclaimeds; i++)
    if (fg_effect_same(fg_effect_find(result->unclaimed[i].id), kind)) return true;
  return false;
}

static fg_loop_verdict verdict_on(double smallest_um, double share) {
  if (fg_scan_loop_would_show(smallest_um)) return FG_LOOP_ABSENT;
  return share < ABSORBED_SHARE ? FG_LOOP_ABSORBED : FG_LOOP_INCONCLUSIVE;
}

static void put_width_unclaimed(const fg_width_findings *width, fg_scan_result *result) {
  for (size_t e = 0; e < width->count; e++) {
    const fg_width_effect *one = &width->each[e];
    if (one->found) continue;
    result->unclaimed[result->unclaimeds++] =
        (fg_scan_result_unclaimed){.id = one->effect.kind->id,
                                   .words = one->effect.kind->words,
                                   .of_width = true,
                                   .verdict = verdict_on(one->smallest_um, one->share),
                                   .would_explain = one->would_explain,
                                   .retained_share = one->share,
                                   .smallest_um = one->smallest_um};
  }
}

/* Of two bases of one effect the first stands for both. */
static void fill_unclaimed(const fg_scan_loop *loop, fg_scan_result *result) {
  const fg_explanations *explanations = &loop->explanations;
  for (size_t e = 0; e < explanations->candidate_count; e++) {
    const fg_effect *kind = explanations->candidates[e].kind;
    if (fg_effect_is_free(kind) || kind->second || is_claimed(&loop->set, kind)) continue;
    result->unclaimed[result->unclaimeds++] = (fg_scan_result_unclaimed){
        .id = kind->id,
        .words = kind->words,
        .verdict = any_member_holds(explanations, kind)
                       ? FG_LOOP_TIED
                       : verdict_on(explanations->smallest_um[e], explanations->share[e]),
        .would_explain = explanations->alone[e],
        .retained_share = explanations->share[e],
        .smallest_um = explanations->smallest_um[e]};
  }
  for (size_t b = 0; b < explanations->barred.count; b++) {
    const fg_search_barred *barred = &explanations->barred.each[b];
    const fg_effect *kind = barred->effect;
    if (fg_effect_is_free(kind) || is_claimed(&loop->set, kind) || is_listed(result, kind))
      continue;
    result->unclaimed[result->unclaimeds++] =
        (fg_scan_result_unclaimed){.id = kind->id,
                                   .words = kind->words,
                                   .verdict = FG_LOOP_INCONCLUSIVE,
                                   .would_explain = barred->would_explain,
                                   .retained_share = barred->share,
                                   .smallest_um = barred->smallest_um,
                                   .barred = true};
  }
}

/* ---- advice and errors ---- */

static void put_advice(const fg_scan_loop *loop, fg_scan_result *result) {
  if (!result->named)
    result->advice[result->advices++] =
        loop->edge_fit.discs
            ? "scan a plate of several gauges on the same scanner: what all of them show is the "
              "scanner, and an oval is each one's own"
        : !loop->options.same_foil
            ? "scan the same foil again, turned by about 90 degrees, and run the loop on both "
              "scans with --same-foil: what stays with the glass is the scanner, what turns is "
              "the part"
            : "scan another foil on the same scanner: what repeats is the scanner";
  if (loop->scale_tied)
    result->advice[result->advices++] =
        "scan a gauge of known diameter on the same scanner (--form discs): it tells the scale, "
        "which no foil of unknown size can";
}

static fg_scan_held_out held_out_of(const fg_scan_loop *loop) {
  for (size_t i = 0; i < loop->scan_count; i++)
    if (loop->hold_out[i]) return FG_SCAN_HELD_OUT_SCANS;
  return loop->cross_fit.folds ? FG_SCAN_HELD_OUT_FOLDS : FG_SCAN_HELD_OUT_NOTHING;
}

static void fill_numbers(const fg_scan_loop *loop, fg_scan_result *result) {
  result->verdict = loop->verdict;
  result->same_foil = loop->options.same_foil;
  result->without = loop->options.without;
  result->discs = loop->edge_fit.discs;
  result->uneven_discs = fg_scan_loop_has_uneven_discs(loop);
  result->scale_tied = loop->scale_tied;
  result->noise_floor_um = loop->noise_floor_um;
  result->edge_model_error_um = loop->explanations.edge_error_um;
  result->half_width_rms_um = loop->explanations.width_rms_um;
  result->half_width_smooth_um = loop->explanations.width_smooth_um;
  result->p_value = loop->explanations.p_value;
  result->matters_um = FG_SCAN_LOOP_MATTERS_UM;
  result->before = loop->error_before;
  result->after = loop->error_after;
  result->folds = loop->cross_fit.folds;
  result->fold_of = fg_scan_loop_fold_of(loop);
  result->left_out = loop->left_out;
  result->note = (const char *const *)loop->bumps.note;
  result->notes = loop->bumps.notes;
  /* Effects must also hold on scans that were not used to find them. */
  result->corrected = loop->set.count > 0;
  result->held_out = held_out_of(loop);
  result->contradicted = result->corrected && result->held_out == FG_SCAN_HELD_OUT_SCANS &&
                         loop->error_after.held_out_rms > loop->error_before.held_out_rms;
  for (int c = 0; c < FG_SCAN_COORDINATES; c++) {
    result->coordinate_name[c] = fg_effect_coordinate_name((fg_effect_coordinate)c);
    result->coordinate_title[c] = fg_effect_coordinate_title((fg_effect_coordinate)c);
  }
}

static fg_status put_model(fg_context *ctx, const fg_scan_loop *loop, fg_scan_result *result) {
  fg_scanner_model *model = NULL;
  fg_status status = fg_scanner_model_of(ctx, loop, &model);
  result->model = model;
  return status;
}

fg_status fg_scan_loop_decide(fg_context *ctx, fg_scan_loop *loop) {
  fg_scan_result *result = &loop->result;
  fg_scan_result_free(result);
  fill_numbers(loop, result);
  FG_TRY(fg_scan_result_put_noise(ctx, loop, result));
  put_explanations(&loop->explanations, result);
  FG_TRY(put_claims(ctx, loop, result));
  put_width(&loop->width, &loop->set, result);
  fill_unclaimed(loop, result);
  put_width_unclaimed(&loop->width, result);
  put_advice(loop, result);
  fg_scan_loop_check_channels(loop, result);
  FG_TRY(fg_scan_result_put_bumps(ctx, loop, result));
  FG_TRY(fg_scan_result_put_rows(ctx, loop, result));
  FG_TRY(fg_scan_result_put_lines(ctx, loop, result));
  FG_TRY(fg_scan_result_put_grid(ctx, loop, result));
  return put_model(ctx, loop, result);
}
