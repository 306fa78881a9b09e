/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Best feasible setting: a multiple of each factor's step. */
#include <math.h>
#include <string.h>

#include "process/experiment_parts.h"

/* Steps that are tried on each side of the optimum: next to a border the nearest may be outside. */
enum { REACH = 2, SIDES = 2 * REACH, TRIED_MAX = 1 << 16 };

/* Combinations beside each of which the factors without a step are optimised again. */
enum { OPTIMISED_MAX = 64 };

static const fg_factor *rounded_factor(const fg_experiment *e, size_t k) {
  for (size_t f = 0; f < e->factors; f++)
    if (e->factor[f].variable == e->surface.variable[k]) return &e->factor[f];
  return NULL;
}

static fg_status find_steps(fg_context *ctx, const fg_experiment_options *options,
                            fg_experiment *e) {
  for (size_t r = 0; r < options->rounds; r++) {
    bool found = false;
    for (size_t k = 0; k < e->surface.factors; k++) {
      if (strcmp(rounded_factor(e, k)->name, options->round[r].name) != 0) continue;
      e->best.step[k] = options->round[r].step;
      found = e->best.has_rounded = true;
    }
    if (!found)
      return fg_fail(ctx, FG_ERR_USAGE, "--round %s: this is no numeric factor of the model",
                     options->round[r].name);
  }
  return FG_OK;
}

/* The i-th multiple of the step about x, of SIDES; in the model's units. */
static double multiple(const fg_factor *factor, double step, double x, size_t i) {
  double real = fg_factor_real(factor, x), low = fg_factor_real(factor, -1),
         per_unit = (fg_factor_real(factor, 1) - low) / 2;
  double set = fg_round_to(step * (floor(real / step) + (double)i - (REACH - 1)), step);
  return x + (set - real) / per_unit;
}

/* Combination `number` of the multiples of all factors that have a step. */
static void combine(const fg_experiment *e, size_t number, double *x) {
  memcpy(x, e->best.optimum.x, sizeof e->best.optimum.x);
  for (size_t k = 0; k < e->surface.factors; k++) {
    if (!(e->best.step[k] > 0)) continue;
    x[k] = multiple(rounded_factor(e, k), e->best.step[k], x[k], number % SIDES);
    number /= SIDES;
  }
}

static bool has_free(const fg_experiment *e) {
  for (size_t k = 0; k < e->surface.factors; k++)
    if (!(e->best.step[k] > 0)) return true;
  return false;
}

/* Moves the factors without a step to their best values beside the others; false: none is in the
 * region. */
static bool move_free(const fg_experiment *e, double *x) {
  fg_context quiet = {0};
  fg_region held = e->region;
  for (size_t k = 0; k < e->surface.factors; k++)
    if (e->best.step[k] > 0) held.low[k] = held.high[k] = x[k];
  return fg_surface_optimum_region(&quiet, &e->surface, e->best.goal, e->best.target, &held, x) ==
         FG_OK;
}

static bool find_best(const fg_experiment *e, size_t tried, double *best) {
  double min = INFINITY, x[FG_SURFACE_FACTORS];
  bool move = has_free(e) && tried <= OPTIMISED_MAX;
  for (size_t i = 0; i < tried; i++) {
    combine(e, i, x);
    if (move && !move_free(e, x)) continue;
    double cost = fg_experiment_cost(e, fg_surface_value(&e->surface, x));
    if (!(cost < min) || !fg_region_contains(&e->region, x, 1e-9)) continue;
    min = cost;
    memcpy(best, x, sizeof x);
  }
  return isfinite(min);
}

fg_status fg_experiment_round(fg_context *ctx, const fg_experiment_options *options,
                              fg_experiment *e) {
  size_t tried = 1;
  FG_TRY(find_steps(ctx, options, e));
  if (!e->best.has_rounded) return FG_OK;
  for (size_t k = 0; k < e->surface.factors; k++)
    if (e->best.step[k] > 0) tried = tried > TRIED_MAX / SIDES ? TRIED_MAX : tried * SIDES;
  e->best.has_rounded = find_best(e, tried, e->best.rounded.x);
  if (!e->best.has_rounded && e->reduced) return FG_OK;
  if (!e->best.has_rounded)
    return fg_experiment_note(ctx, e,
                              "no setting that can be made (--round) lies in the region near the "
                              "best one: take finer steps");
  FG_TRY(fg_experiment_predict_at(ctx, e, e->best.rounded.x, &e->best.rounded.prediction));
  e->best.rounded.on_border = fg_experiment_on_border(&e->region, e->best.rounded.x);
  return FG_OK;
}
