/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/grid_loop.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "grid_loop/grid_loop.h"

enum { DOF_MIN = 3 };
/* Of a map beside which effects are sought, and of the last one. */
#define MARKS_PER_SPLINE      3.0
#define FINE_MARKS_PER_SPLINE 1.5
/* A model whose marks scatter by so much less than another's shows that one to be wrong. */
#define ADEQUATE_RATIO 0.8
/* A map must be more likely than none by this much. */
#define MAP_LIKELIHOOD 4.0

/* Checks a scan against those before it. */
static fg_status check_scan_of_grid(fg_context *ctx, const fg_measurement *all, size_t i) {
  const fg_measurement *first = &all[0], *m = &all[i];
  for (size_t k = 0; k < i; k++)
    if (!strcmp(all[k].sha256, m->sha256))
      return fg_fail(ctx, FG_ERR_DATA, "%s and %s are the same scan: give each once", all[k].scan,
                     m->scan);
  for (int axis = 0; axis < 2; axis++)
    if (fabs(m->dpi[axis] / first->dpi[axis] - 1) > 1e-4)
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s has %g dpi and %s has %g dpi: scans of one loop must have one resolution",
                     first->scan, first->dpi[axis], m->scan, m->dpi[axis]);
  return FG_OK;
}

/* Measures the scans that the loop learns from, then those that only confirm; the turns follow. */
static fg_status measure_grids(fg_context *ctx, const char *const *paths, size_t count,
                               const fg_design *design, fg_grid_loop *loop) {
  fg_measure_options options = {.dpi = loop->options.dpi,
                                .allow_lossy = loop->options.allow_lossy,
                                .threads = loop->options.threads};
  const fg_grid_loop_options given = loop->options;
  size_t at = 0;
  for (int held_out = 0; held_out < 2; held_out++)
    for (size_t i = 0; i < count; i++) {
      if (given.hold_out[i] != (held_out != 0)) continue;
      FG_TRY(fg_measure_scan(ctx, paths[i], design, &options, &loop->measurements[at]));
      FG_TRY(check_scan_of_grid(ctx, loop->measurements, at));
      loop->options.turns[at++] = given.turns[i];
    }
  return FG_OK;
}

/* Minus the logarithm of the likelihood under the present sizes. The amplitudes are integrated
 * over; their shapes, which were sought, cost as in Schwarz's criterion. */
static fg_status find_likelihood(fg_context *ctx, const grid_problem *problem, double *value) {
  grid_solution solution;
  double shapes = 0;
  FG_TRY(fg_grid_solve(ctx, problem, GRID_ALL_ROWS, &solution));
  for (size_t e = fg_grid_own_effects(problem); e < problem->model.effects; e++)
    shapes += (double)problem->model.effect[e].kind->shapes;
  *value = solution.minus_log_likelihood + 0.5 * shapes * log((double)problem->row_count);
  fg_grid_solution_free(&solution);
  return FG_OK;
}

/* Lays maps over the marks in place of those in force, if any, drops effects that are none beside
 * them, and keeps all that where it is more likely. The sizes follow. */
static fg_status try_maps(fg_context *ctx, grid_problem *problem, double marks_per_spline) {
  double before, with;
  FG_TRY(fg_grid_find_sizes(ctx, problem));
  FG_TRY(find_likelihood(ctx, problem, &before));
  const grid_model kept = problem->model;
  fg_grid_lay_maps(problem, marks_per_spline);
  if (!problem->model.has_map) return FG_OK;
  FG_TRY(fg_grid_find_sizes(ctx, problem));
  FG_TRY(fg_grid_prune_effects(ctx, problem));
  if (problem->model.effects < kept.effects) FG_TRY(fg_grid_find_sizes(ctx, problem));
  FG_TRY(find_likelihood(ctx, problem, &with));
  if (!kept.has_map && before - with < MAP_LIKELIHOOD) problem->model = kept;
  return FG_OK;
}

/* Moves the effects to their best places beside all else, and drops those that are none there. */
static fg_status place_effects(fg_context *ctx, grid_problem *problem) {
  FG_TRY(fg_grid_refine_effects(ctx, problem));
  return fg_grid_prune_effects(ctx, problem);
}

/* Listed effects first, beside the boards alone; then coarse maps, and listed effects again beside
 * them; fine maps last, beside which chips would hide. */
static fg_status build_from_effects(fg_context *ctx, grid_problem *problem) {
  FG_TRY(fg_grid_find_sizes(ctx, problem));
  FG_TRY(fg_grid_add_effects(ctx, problem));
  FG_TRY(try_maps(ctx, problem, MARKS_PER_SPLINE));
  FG_TRY(place_effects(ctx, problem));
  FG_TRY(fg_grid_add_effects(ctx, problem));
  FG_TRY(place_effects(ctx, problem));
  return try_maps(ctx, problem, FINE_MARKS_PER_SPLINE);
}

/* Fine maps first, and listed effects beside them: a smooth field may look like jumps and ripples
 * where nothing smooth is in the model. */
static fg_status build_from_maps(fg_context *ctx, grid_problem *problem) {
  FG_TRY(fg_grid_find_sizes(ctx, problem));
  fg_grid_lay_maps(problem, FINE_MARKS_PER_SPLINE);
  FG_TRY(fg_grid_find_sizes(ctx, problem));
  FG_TRY(fg_grid_add_effects(ctx, problem));
  FG_TRY(place_effects(ctx, problem));
  return fg_grid_find_sizes(ctx, problem);
}

/* Jumps at some places follow any curve between the marks, but down to their noise only where they
 * are there. Where both do, the likelihood decides. */
static bool are_maps_better(const grid_model *by_effects, const grid_model *by_maps,
                            double more_likely) {
  double ratio = by_maps->mark_sd / by_effects->mark_sd;
  if (ratio < ADEQUATE_RATIO || ratio > 1 / ADEQUATE_RATIO) return ratio < 1;
  return more_likely > 0;
}

/* The better of both ways. */
static fg_status build_model(fg_context *ctx, grid_problem *problem) {
  double by_effects, by_maps;
  fg_grid_begin_effects(problem);
  const grid_model empty = problem->model;
  fg_grid_lay_maps(problem, MARKS_PER_SPLINE);
  bool map = problem->model.has_map;
  problem->model = empty;
  if (!map) return fg_grid_find_sizes(ctx, problem);
  FG_TRY(build_from_effects(ctx, problem));
  if (problem->model.effects > fg_grid_own_effects(problem)) {
    const grid_model kept = problem->model;
    FG_TRY(find_likelihood(ctx, problem, &by_effects));
    problem->model = empty;
    FG_TRY(build_from_maps(ctx, problem));
    FG_TRY(find_likelihood(ctx, problem, &by_maps));
    if (!are_maps_better(&kept, &problem->model, by_effects - by_maps)) problem->model = kept;
  }
  FG_TRY(fg_grid_find_sizes(ctx, problem));
  return fg_grid_loosen_shapes(ctx, problem);
}

/* Standard deviation of Student's t with `dof` degrees of freedom, over that of a normal law. */
static double find_widening(const grid_problem *problem) {
  double used = 0;
  grid_columns columns = fg_grid_columns(problem);
  for (size_t i = 0; i < problem->row_count; i++)
    used += problem->rows[i].used;
  double dof = fmax(DOF_MIN, used - (double)columns.map);
  return sqrt(dof / (dof - 2));
}

static fg_status close_grid_loop(fg_context *ctx, fg_grid_loop *loop) {
  FG_TRY(fg_grid_problem_build(ctx, loop->measurements, loop->scan_count, &loop->options,
                               &loop->problem));
  FG_TRY(build_model(ctx, &loop->problem));
  FG_TRY(fg_grid_solve(ctx, &loop->problem, GRID_ALL_ROWS, &loop->solution));
  loop->widening = find_widening(&loop->problem);
  FG_TRY(fg_grid_loop_fill_result(ctx, loop));
  FG_TRY(fg_grid_loop_hold_out(ctx, loop));
  fg_grid_loop_write_sentence(&loop->result);
  return fg_grid_loop_make_model(ctx, loop);
}

fg_status fg_grid_loop_run(fg_context *ctx, const char *const *paths, size_t count,
                           const fg_design *design, const fg_grid_loop_options *options,
                           fg_grid_loop **result) {
  fg_grid_loop *loop = NULL;
  fg_status status = FG_OK;
  *result = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *loop, (void **)&loop));
  loop->options = *options;
  for (size_t i = 0; i < count; i++)
    loop->held_out_count += options->hold_out[i];
  loop->scan_count = count - loop->held_out_count;
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, count, sizeof *loop->measurements, (void **)&loop->measurements));
  FG_TRY_EXIT(measure_grids(ctx, paths, count, design, loop));
  FG_TRY_EXIT(close_grid_loop(ctx, loop));
  *result = loop;
exit:
  if (status != FG_OK) fg_grid_loop_free(loop);
  return status;
}

const fg_grid_loop_result *fg_grid_loop_result_of(const fg_grid_loop *loop) {
  return &loop->result;
}

void fg_grid_loop_free(fg_grid_loop *loop) {
  if (!loop) return;
  for (size_t i = 0; loop->result.scan && i < loop->scan_count; i++)
    free(loop->result.scan[i].residual_mm);
  free(loop->result.scan);
  free(loop->result.map);
  free(loop->result.held_out);
  fg_scanner_model_free(loop->model);
  fg_grid_solution_free(&loop->solution);
  fg_grid_problem_free(&loop->problem);
  for (size_t i = 0; loop->measurements && i < loop->scan_count + loop->held_out_count; i++)
    fg_measurement_free(&loop->measurements[i]);
  free(loop->measurements);
  free(loop);
}
