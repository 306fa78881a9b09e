/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effect_search/policy.h"

#include <math.h>

/* ---- foils ---- */

static bool scanned_again(const fg_edge_fit *edge_fit) {
  return edge_fit->view_count > edge_fit->part_count;
}

static size_t max_effects_of_foils(const fg_edge_fit *edge_fit) {
  return edge_fit->coarse ? 1 : scanned_again(edge_fit) ? 3 : 2;
}

static bool has_lower_score(const fg_search *s, const fg_explanation *explanation,
                            const fg_explanation *best) {
  if (!isfinite(explanation->excess)) return false;
  return !isfinite(best->excess) || fg_search_schwarz(s, explanation) < fg_search_schwarz(s, best);
}

/* ---- discs ---- */

/* Returns the number of effects that the rows can tell apart. */
static size_t max_effects_of_discs(const fg_edge_fit *edge_fit) {
  return edge_fit->coarse ? 1 : edge_fit->part_count > 2 ? 5 : 2;
}

/* Gain of one more effect by chance: a set that comes later, and is larger, must gain more. */
#define ONE_MORE_CHI2 12.0

static bool leaves_less(const fg_search *s, const fg_explanation *explanation,
                        const fg_explanation *best) {
  (void)s;
  return explanation->excess < best->excess - ONE_MORE_CHI2;
}

static bool has_new_shape(const fg_search *s, const fg_search_baseline *y,
                          const fg_explanation *best, const fg_explanation *curve) {
  (void)y;
  (void)best;
  (void)curve;
  return s->new_shapes > 0;
}

static const fg_search_policy foils = {
    .middles_with_sets = true,
    .smoother_curves = true,
    .other_steps = true,
    .find_placed = fg_search_find_on_foils,
    .effects_max = max_effects_of_foils,
    .placed_beside = true,
    .edge_error_um = 0.003, /* upper limit on clean renders (reports/loop_scans.md) */
    /* Edges of a stretched picture are measured a little wrong (reports/loop_scans.md). */
    .effect_error = 0.0055,
    .more_error = 0.01,
    .bend_error = 0.005,
    /* By chance 1 in 45 000 of one effect; of some dozen that are sought, 1 in 5 000. */
    .one_more_chi2 = 18.0,
    .counts_columns = true,
    .placed_chi2 = 30.0, /* of 300 places 1 in 10 000 by chance */
    .has_rivals = true,
    .worse_chi2 = 18.0, /* equal to the gain that one more effect needs */
    .is_better = has_lower_score,
    .beside_curve = 2,
    .curve_share = 0.03, /* reports/loop_scans.md, tier curves */
    .is_worth_fitting = fg_search_hopes_for_shape,
    .scatters = true,
    .strategies = {{true, false}, {false, false}, {true, true}},
    .strategy_count = 3,
    .converged_share = 0.05,
    .drops_nothings = true,
    .drops_ends = true,
    .step_half_mm = 0.08,
};

/* Policy for discs. Each disc's form error enters the noise and the free curves alike, so the sum
 * over all effects is weak evidence about one effect. So a set must not omit an effect that
 * explains more than chance, and its effects must predict discs that they were not fitted to. Rows
 * of discs are few and spread over the picture: neither the noise along one edge nor the middle of
 * a polynomial needs special treatment. */
static const fg_search_policy discs = {
    .find_placed = fg_search_find_on_discs,
    .effects_max = max_effects_of_discs,
    .keeps_collinear = true,
    .edge_error_um = 0.01, /* tuned on plates (reports/loop_plate.md) */
    .one_more_chi2 = ONE_MORE_CHI2,
    .quadratic_chi2 = FG_SEARCH_GAIN_MIN,
    .placed_chi2 = 45.0,    /* tuned on plates (reports/loop_plate.md) */
    .worse_chi2 = INFINITY, /* none that is much worse is right */
    .is_better = leaves_less,
    .beside_curve = 1,
    .curves_alone_last = true, /* confirmation drops the effect that does not belong there */
    .is_worth_fitting = has_new_shape,
    .smallest_beside_own = true,
    .strategies = {{true, false}},
    .strategy_count = 1,
    .converged_share =
        1, /* one round without a new effect has converged: the confirmation decides */
    .falls_back = true,
    .converges_in_force = true, /* with one strategy only, no other start follows */
    .own_noise = true,
    .step_half_mm = 0.03,
    .confirms = true,
};

const fg_search_policy *fg_search_policy_of(const fg_edge_fit *edge_fit) {
  return edge_fit->discs ? &discs : &foils;
}
