/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Facts of each effect beside the best explanation, for the report. */
#include <math.h>

#include "effect_search/state.h"

/* Amplitude, in standard deviations, that is found in most cases: at chi² 10.8 (score.c) an
 * amplitude of 3.5 is found in 58 of 100. */
#define SMALLEST_ERRORS 3.5

/* P-value of no effect: by all effects at once, or where an effect is found by the best one of the
 * family, whichever is smaller. */
static double p_of_none(const fg_search *s, const fg_search_baseline *y, const double *left) {
  const fg_explanations *out = s->out;
  double none = s->columns.square, beyond = 1 + y->allowance / y->dof;
  double p = fg_search_chance(s, fmax(0, none - y->full) / y->unit / beyond, y->dof);
  for (size_t e = 0; out->each[0].mask && e < out->candidate_count; e++) {
    if (fg_effect_is_free(out->candidates[e].kind)) continue;
    double gain = fmax(0, (none - left[e]) / y->unit - y->allowance);
    p = fmin(p, (double)out->candidate_count *
                    fg_search_chance(s, gain, (double)out->candidates[e].terms));
  }
  return fmin(p, 1);
}

static void describe_effects(fg_search *s, const fg_search_baseline *y) {
  fg_explanations *out = s->out;
  double none = s->columns.square, left[FG_CANDIDATES_MAX];
  unsigned beside = out->each[0].mask & fg_search_mask_of(out, false);
  for (size_t e = 0; e < out->candidate_count; e++) {
    left[e] = fg_search_sum_of_one(s, y, e);
    out->alone[e] = none > 0 ? 1 - left[e] / none : 0;
    if (!fg_effect_is_free(out->candidates[e].kind))
      out->smallest_um[e] = SMALLEST_ERRORS * sqrt(y->unit) * fg_search_amplitude_u(s, beside, e);
  }
  out->p_value = p_of_none(s, y, left);
}

static void describe_width(fg_search *s, const fg_search_baseline *y) {
  fg_explanation first = fg_search_try(s, y, s->out->each[0].mask);
  s->out->width_rms_um = sqrt(fmax(first.width, 0) / (double)s->columns.rows);
  s->out->width_smooth_um = sqrt(s->columns.width_part);
}

void fg_search_describe(fg_search *s, const fg_search_baseline *y) {
  describe_effects(s, y);
  describe_width(s, y);
}
