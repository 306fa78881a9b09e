/* What the page of the loop on scans says in words. */
#include <math.h>
#include <string.h>

#include "core/text.h"
#include "report/scan_loop/scan_loop_parts.h"

void fg_scan_loop_explanation_name(const fg_explanations *explanations, size_t explanation,
                                   char *name, size_t size) {
  size_t used = 0;
  name[0] = 0;
  for (size_t e = 0; e < explanations->candidate_count && used + 1 < size; e++) {
    if (!(explanations->each[explanation].mask >> e & 1)) continue;
    fg_text_clip(name + used, size - used, "%s%s", used ? " + " : "",
                 explanations->candidates[e].kind->id);
    used = strlen(name);
  }
}

void fg_scan_loop_explanation_words(const fg_explanations *explanations, size_t explanation,
                                    bool common, char *words, size_t size) {
  size_t used = 0;
  fg_text_clip(words, size, "%s", common ? "" : "nothing more");
  for (size_t e = 0; e < explanations->candidate_count && used + 1 < size; e++) {
    const fg_effect *kind = explanations->candidates[e].kind;
    if (!(explanations->each[explanation].mask >> e & 1) ||
        fg_scan_loop_is_sure(explanations, kind) != common)
      continue;
    fg_text_clip(words + used, size - used, "%s%s", used ? " together with " : "", kind->words);
    used = strlen(words);
  }
}

/* ---- parameters ---- */

/* Names of fg_effect_found_number with their units for people; a ratio is told in ppm. */
static void put_unit(const fg_effect *kind, fg_scan_loop_parameter *p) {
  static const struct {
    const char *name, *people, *unit;
    double factor;
  } units[] = {
      {"value", "q", "ppm", 1e6}, {"amplitude_um", "a", "µm", 1}, {"phase_deg", "φ", "°", 1}};
  for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
    if (strcmp(p->name, units[i].name) != 0) continue;
    p->name = units[i].people;
    p->unit = units[i].unit;
    p->value *= units[i].factor;
    p->u *= units[i].factor;
    return;
  }
  for (size_t s = 0; s < kind->shapes; s++)
    if (p->name == kind->shape_name[s])
      *p = (fg_scan_loop_parameter){kind->shape_symbol[s], "mm", p->value, p->u};
}

bool fg_effect_found_parameter(const fg_effect_found *effect, size_t i, fg_scan_loop_parameter *p) {
  *p = (fg_scan_loop_parameter){"", "", 0, 0};
  if (!fg_effect_found_number(effect, i, &p->name, &p->value, &p->u)) return false;
  put_unit(effect->kind, p);
  if (effect->kind->numbers == FG_EFFECT_LED) p->value = effect->coefficient_um[0]; /* which way */
  if (effect->kind->numbers == FG_EFFECT_OVAL && i == 1) p->name = "ψ0";
  return true;
}

void fg_scan_loop_value_words(double value, double u, char *words, size_t size) {
  double expanded = FG_COVERAGE_FACTOR * u;
  if (!isfinite(value)) {
    fg_text_clip(words, size, "–");
  } else if (!(expanded > 0) || !isfinite(expanded)) {
    fg_text_clip(words, size, "%.5g", value);
  } else {
    int decimals = (int)fmin(9, fmax(0, 1 - floor(log10(expanded))));
    fg_text_clip(words, size, "%.*f ± %.*f", decimals, value, decimals, expanded);
  }
}

void fg_scan_loop_length_words(double um, char *words, size_t size) {
  if (!isfinite(um))
    fg_text_clip(words, size, "–");
  else if (fabs(um) < 1e-3 && um != 0)
    fg_text_clip(words, size, "%.3g nm", 1000 * um);
  else
    fg_text_clip(words, size, "%.3g µm", um);
}

double fg_scan_loop_nice_below(double most) {
  double power = pow(10, floor(log10(most))), share = most / power;
  return power * (share >= 5 ? 5 : share >= 2 ? 2 : 1);
}

/* ---- the sentence ---- */

static fg_status say_parameters(fg_context *ctx, const fg_effect_found *effect, char **text) {
  fg_scan_loop_parameter p;
  char value[64];
  for (size_t i = 0; fg_effect_found_parameter(effect, i, &p); i++) {
    fg_scan_loop_value_words(p.value, p.u, value, sizeof value);
    FG_TRY(fg_text_append(ctx, text, "%s%s = %s%s%s", i ? ", " : " (", p.name, value,
                          strcmp(p.unit, "°") ? " " : "", p.unit));
    if (!fg_effect_found_parameter(effect, i + 1, &p)) FG_TRY(fg_text_append(ctx, text, ")"));
  }
  return FG_OK;
}

/* The effects that every explanation holds: listed ones, or free curves. */
static fg_status say_effects(fg_context *ctx, const fg_scan_loop *loop, bool free_curves,
                             char **text) {
  const char *before = !free_curves ? "Found: "
                       : *text      ? "; no listed effect explains "
                                    : "No listed effect explains ";
  bool first = true;
  for (size_t i = 0; i < loop->set.count; i++) {
    const fg_effect_found *effect = &loop->set.effects[i];
    if (fg_effect_is_free(effect->kind) != free_curves || !loop->decided.sure[i]) continue;
    const char *between = free_curves ? ", nor " : "; ";
    FG_TRY(fg_text_append(ctx, text, "%s%s", first ? before : between, effect->kind->words));
    FG_TRY(say_parameters(ctx, effect, text));
    first = false;
  }
  return FG_OK;
}

/* What stands beside the common effects in each explanation. */
static fg_status say_class(fg_context *ctx, const fg_scan_loop *loop, char **text) {
  enum { NAMED = 3 };
  const fg_explanations *explanations = &loop->explanations;
  const fg_scan_loop_decisions *decided = &loop->decided;
  size_t count = decided->shown_count, total = count + decided->unlisted;
  size_t named = total <= NAMED ? count : NAMED - 1;
  if (count < 2) return FG_OK;
  FG_TRY(fg_text_append(ctx, text, "%s",
                        *text ? "; beside it the data cannot tell which it is: "
                              : "Found, but the data cannot tell which it is: "));
  for (size_t m = 0; m < named; m++) {
    char words[FG_SCAN_LOOP_CLASS_WORDS];
    fg_scan_loop_explanation_words(explanations, decided->shown[m], false, words, sizeof words);
    FG_TRY(fg_text_append(ctx, text, "%s%s", m == 0 ? "" : m + 1 == total ? " or " : ", ", words));
  }
  if (total == named + 1) FG_TRY(fg_text_append(ctx, text, " or one other explanation"));
  if (total > named + 1)
    FG_TRY(fg_text_append(ctx, text, " or one of %zu other explanations", total - named));
  return FG_OK;
}

static fg_status say_errors(fg_context *ctx, const fg_scan_loop *loop, char **text) {
  char before[32], after[32], floor_words[32];
  fg_scan_loop_length_words(loop->error_before.rms, before, sizeof before);
  fg_scan_loop_length_words(loop->error_after.rms, after, sizeof after);
  fg_scan_loop_length_words(loop->noise_floor_um, floor_words, sizeof floor_words);
  FG_TRY(fg_text_append(ctx, text,
                        " The edge residual %s from %s to %s rms; the noise alone makes %s.",
                        loop->error_after.rms <= loop->error_before.rms ? "falls" : "rises", before,
                        after, floor_words));
  if (!isfinite(loop->error_before.held_out_rms)) return FG_OK;
  fg_scan_loop_length_words(loop->error_before.held_out_rms, before, sizeof before);
  fg_scan_loop_length_words(loop->error_after.held_out_rms, after, sizeof after);
  return fg_text_append(ctx, text, " On scans kept aside it %s from %s to %s.",
                        loop->error_after.held_out_rms <= loop->error_before.held_out_rms ? "falls"
                                                                                          : "rises",
                        before, after);
}

static fg_status say_chance(fg_context *ctx, double p, char **text) {
  if (p < 1e-12) return fg_text_append(ctx, text, "Noise alone would do this with p < 10⁻¹².");
  return fg_text_append(ctx, text, "Noise alone would do this with p = %.2g.", p);
}

static fg_status say_clean(fg_context *ctx, const fg_scan_loop *loop, char **text) {
  char rms[32];
  fg_scan_loop_length_words(loop->error_before.rms, rms, sizeof rms);
  return fg_text_print(ctx, text,
                       "Nothing is claimed: what the circles leave of the edges (%s rms) is noise "
                       "as far as %s can tell. The dimensions stand as measured.",
                       rms, loop->scan_count > 1 ? "these scans" : "this scan");
}

static fg_status say_edges(fg_context *ctx, const fg_scan_loop *loop, char **text) {
  char rms[32];
  fg_scan_loop_length_words(loop->error_before.rms, rms, sizeof rms);
  return fg_text_print(ctx, text, "The edges lie on their circles within the noise (%s rms).", rms);
}

static fg_status say_points(fg_context *ctx, const fg_scan_loop *loop, char **text) {
  if (loop->verdict == FG_LOOP_CLEAN) return say_clean(ctx, loop, text);
  if (!loop->set.count) return say_edges(ctx, loop, text);
  FG_TRY(say_effects(ctx, loop, false, text));
  FG_TRY(say_effects(ctx, loop, true, text));
  if (loop->tied) FG_TRY(say_class(ctx, loop, text));
  FG_TRY(fg_text_append(ctx, text, ". "));
  FG_TRY(say_chance(ctx, loop->explanations.p_value, text));
  return say_errors(ctx, loop, text);
}

fg_status fg_scan_loop_sentence(fg_context *ctx, const fg_scan_loop *loop, char **text) {
  *text = NULL;
  FG_TRY(say_points(ctx, loop, text));
  return fg_scan_loop_bumps_sentence(ctx, &loop->bumps, text);
}
