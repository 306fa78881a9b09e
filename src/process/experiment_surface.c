/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Optimum of the fitted surface, and its uncertainty. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "process/experiment_parts.h"

enum { COMBINATIONS = 4096 };

/* Distance from the border, as a share of the region's size, within which a point counts as on it.
 */
static const double BORDER = 1e-6;

static const fg_factor *surface_factor(const fg_experiment *e, size_t k) {
  for (size_t f = 0; f < e->factors; f++)
    if (e->factor[f].variable == e->surface.variable[k]) return &e->factor[f];
  return NULL;
}

/* The smallest box about the runs, and the ball about its centre that reaches the farthest run. */
static void region_of_data(const fg_experiment *e, fg_region *r) {
  size_t variables = e->model.formula.variables;
  *r = (fg_region){.factors = e->surface.factors};
  for (size_t k = 0; k < r->factors; k++) {
    const fg_factor *factor = surface_factor(e, k);
    r->low[k] = factor->lowest;
    r->high[k] = factor->highest;
    r->centre[k] = (r->low[k] + r->high[k]) / 2;
  }
  for (size_t i = 0; i < e->model.rows; i++) {
    double square = 0;
    for (size_t k = 0; k < r->factors; k++) {
      double away = e->setting[i * variables + e->surface.variable[k]] - r->centre[k];
      square += away * away;
    }
    r->radius = fmax(r->radius, sqrt(square));
  }
}

/* Without a common scale a ball means nothing: factors in real units have the box only. */
static void drop_ball_of_mixed_units(const fg_experiment *e, fg_region *r) {
  for (size_t k = 0; k < r->factors; k++)
    if (!surface_factor(e, k)->coded) r->radius = INFINITY;
}

/* Of an experiment without some factors, the constraints are those of the whole one. */
static fg_status make_region(fg_context *ctx, const fg_experiment_options *options,
                             const fg_experiment *whole, fg_experiment *e) {
  double centre[FG_SURFACE_FACTORS];
  region_of_data(e, &e->region);
  drop_ball_of_mixed_units(e, &e->region);
  if (options->constraints)
    FG_TRY(fg_memory_allocate(ctx, options->constraints, sizeof *e->constraint,
                              (void **)&e->constraint));
  for (size_t i = 0; i < options->constraints; i++) {
    FG_TRY(fg_text_print(ctx, &e->constraint[i], "%s", options->constraint[i]));
    e->constraints++;
    if (!whole) FG_TRY(fg_experiment_constrain(ctx, e, options->constraint[i], &e->region));
  }
  if (whole) fg_experiment_add_constraints(whole, e);
  memcpy(centre, e->region.centre, sizeof centre);
  if (fg_region_project(ctx, &e->region, centre) == FG_OK) return FG_OK;
  return fg_fail(ctx, FG_ERR_USAGE,
                 "the constraints leave nothing of the region of the data: loosen one");
}

fg_status fg_experiment_predict_at(fg_context *ctx, const fg_experiment *e, const double *x,
                                   fg_prediction *prediction) {
  double setting[FG_FORMULA_VARIABLES];
  memcpy(setting, e->best.levels, sizeof setting);
  for (size_t k = 0; k < e->surface.factors; k++)
    setting[e->surface.variable[k]] = x[k];
  FG_TRY(fg_experiment_predict(ctx, e, setting, prediction));
  fg_experiment_widen(e, x, prediction);
  return FG_OK;
}

/* Returns true on its sphere, a side of its box or a half-space: a step outwards leaves the region.
 */
bool fg_experiment_on_border(const fg_region *region, const double *x) {
  double size = 0, scale[FG_SURFACE_FACTORS], at[FG_SURFACE_FACTORS];
  fg_region r;
  fg_region_scale(region, &r, scale);
  for (size_t i = 0; i < r.factors; i++) {
    size = fmax(size, r.high[i] - r.low[i]);
    at[i] = (x[i] - region->centre[i]) / scale[i];
  }
  for (size_t i = 0; i < r.factors; i++)
    for (int side = -1; side <= 1; side += 2) {
      double moved[FG_SURFACE_FACTORS];
      memcpy(moved, at, r.factors * sizeof *at);
      moved[i] += side * BORDER * size;
      if (!fg_region_contains(&r, moved, BORDER * size / 10)) return true;
    }
  return false;
}

bool fg_experiment_next_levels(const fg_experiment *e, double *setting) {
  for (size_t v = 0; v < e->model.formula.variables; v++) {
    if (e->model.levels[v].count == 0 || v == e->block_variable) continue;
    setting[v] += 1;
    if (setting[v] < (double)e->model.levels[v].count) return true;
    setting[v] = 0;
  }
  return false;
}

/* Without numeric factors the surface is level. */
static fg_status make_surface(fg_context *ctx, const fg_experiment *e, const double *levels,
                              fg_surface *surface) {
  *surface = (fg_surface){.kind = FG_SURFACE_PLANE};
  return e->factors ? fg_surface_make(ctx, &e->model, &e->regression, levels, surface) : FG_OK;
}

/* Blocks shift the surface by a constant, for which the predictions correct it. */
static fg_status find_optimum(fg_context *ctx, fg_experiment *e) {
  double levels[FG_FORMULA_VARIABLES] = {0}, best = INFINITY;
  size_t tried = 0;
  do {
    fg_surface surface;
    fg_optimum optimum = {0};
    double kept[FG_FORMULA_VARIABLES];
    FG_TRY(make_surface(ctx, e, levels, &surface));
    fg_prediction centre;
    memcpy(kept, e->best.levels, sizeof kept);
    memcpy(e->best.levels, levels, sizeof levels);
    FG_TRY(fg_experiment_predict_at(ctx, e, e->region.centre, &centre));
    surface.constant += centre.mean - fg_surface_value(&surface, e->region.centre);
    FG_TRY(fg_surface_optimum_region(ctx, &surface, e->best.goal, e->best.target, &e->region,
                                     optimum.x));
    FG_TRY(fg_experiment_predict_at(ctx, e, optimum.x, &optimum.prediction));
    if (fg_experiment_cost(e, optimum.prediction.mean) < best) {
      best = fg_experiment_cost(e, optimum.prediction.mean);
      e->surface = surface;
      e->best.optimum = optimum;
    } else {
      memcpy(e->best.levels, kept, sizeof kept);
    }
  } while (++tried < COMBINATIONS && fg_experiment_next_levels(e, levels));
  fg_region runs = e->region;
  runs.planes = 0;
  e->best.optimum.on_border = fg_experiment_on_border(&e->region, e->best.optimum.x);
  e->best.optimum.on_edge_of_runs = fg_experiment_on_border(&runs, e->best.optimum.x);
  e->best.found = true;
  return FG_OK;
}

/* From the centre of the coding to the farthest run, towards the goal. */
static fg_status make_ridge(fg_context *ctx, fg_experiment *e) {
  double radii[FG_RIDGE_POINTS], path[FG_RIDGE_POINTS * FG_SURFACE_FACTORS];
  double farthest = isfinite(e->region.radius) ? e->region.radius : 0, size = 0;
  size_t n = e->surface.factors;
  bool highest = e->best.goal == FG_GOAL_HIGHEST ||
                 (e->best.goal == FG_GOAL_TARGET &&
                  e->best.target > fg_surface_value(&e->surface, e->region.centre));
  for (size_t k = 0; k < n; k++)
    size = fmax(size, e->region.high[k] - e->region.low[k]);
  if (!(farthest > 0)) return FG_OK;
  for (size_t i = 0; i < FG_RIDGE_POINTS; i++)
    radii[i] = farthest * (double)i / (FG_RIDGE_POINTS - 1);
  FG_TRY(fg_surface_ridge_path(ctx, &e->surface, highest, radii, FG_RIDGE_POINTS, path));
  for (size_t i = 0; i < FG_RIDGE_POINTS; i++) {
    fg_ridge_point *point = &e->best.ridge[i];
    point->radius = radii[i];
    memcpy(point->x, path + i * n, n * sizeof *path);
    point->inside = fg_region_contains(&e->region, point->x, BORDER * size);
    FG_TRY(fg_experiment_predict_at(ctx, e, point->x, &point->prediction));
  }
  return FG_OK;
}

static fg_status judge_stationary(fg_context *ctx, fg_experiment *e) {
  if (!e->surface.has_stationary) return FG_OK;
  e->stationary_inside = fg_region_contains(&e->region, e->surface.stationary, 1e-9);
  FG_TRY(fg_experiment_predict_at(ctx, e, e->surface.stationary, &e->stationary));
  e->surface.stationary_value = e->stationary.mean;
  return FG_OK;
}

fg_status fg_experiment_check_subtracted(fg_context *ctx, const fg_experiment *e) {
  for (size_t i = 0; i < e->subtracted.count; i++)
    if (fg_experiment_is_of_factors(e, &e->subtracted.effects[i]))
      return fg_fail(ctx, FG_ERR_USAGE,
                     "%s was taken out, and the response at a setting has it: declare it in the "
                     "formula instead, as the loop's next step says",
                     e->subtracted.effects[i].words);
  return FG_OK;
}

fg_status fg_experiment_surface(fg_context *ctx, const fg_experiment_options *options,
                                const fg_experiment *whole, fg_experiment *e) {
  fg_context words = {0};
  e->best.goal = options->goal;
  e->best.target = options->target;
  fg_status status = fg_experiment_check_subtracted(&words, e);
  if (status == FG_OK)
    status = whole ? make_surface(&words, e, NULL, &e->surface)
                   : fg_surface_make(&words, &e->model, &e->regression, NULL, &e->surface);
  if (status == FG_ERR_USAGE) {
    if (options->constraints) return fg_fail(ctx, status, "no optimum: %.900s", words.message);
    return fg_experiment_note(ctx, e, "no optimum: %s", words.message);
  }
  if (status != FG_OK) return fg_fail(ctx, status, "%s", words.message);
  e->has_surface = true;
  return make_region(ctx, options, whole, e);
}

fg_status fg_experiment_optimise(fg_context *ctx, const fg_experiment_options *options,
                                 const fg_experiment *whole, fg_experiment *e) {
  if (!e->has_surface) return FG_OK;
  FG_TRY(fg_experiment_simultaneous(ctx, whole, e));
  FG_TRY(find_optimum(ctx, e));
  FG_TRY(fg_experiment_round(ctx, options, e));
  FG_TRY(judge_stationary(ctx, e));
  return make_ridge(ctx, e);
}
