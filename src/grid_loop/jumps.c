/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Places of jumps. Marks tell a jump's place to the gap between the marks on both its sides; a
 * place of the bed in that gap lies before the jump as likely as behind it. */
#include <math.h>

#include "grid_loop/grid_loop.h"

#define BESIDE_MM 1e-6

/* Distance of the jump from the nearest mark on one side of it; of one that it cuts, the mark's
 * reach. */
static double gap_beside(const grid_problem *problem, int axis, double jump, double side) {
  double gap = INFINITY;
  for (size_t i = 0; i < problem->row_count; i++) {
    double off = side * (fg_point_along(problem->rows[i].at, axis) - jump);
    if (problem->rows[i].used && off >= 0) gap = fmin(gap, fmax(off, problem->rows[i].reach_mm));
  }
  return gap;
}

/* Displacement at a jump, behind it less before. */
static fg_point jump_of(const fg_grid_loop *loop, const grid_effect *effect, size_t column,
                        fg_point at, double jump) {
  const fg_field_frame *frame = &loop->problem.model.frame;
  double a = gsl_vector_get(loop->solution.estimate, column);
  fg_point before = at, behind = at, low[FG_FIELD_COLUMNS], high[FG_FIELD_COLUMNS];
  *(effect->kind->axis ? &before.y : &before.x) = jump - BESIDE_MM;
  *(effect->kind->axis ? &behind.y : &behind.x) = jump + BESIDE_MM;
  effect->kind->glass(frame, effect->shape, before, low);
  effect->kind->glass(frame, effect->shape, behind, high);
  return (fg_point){a * (high[0].x - low[0].x), a * (high[0].y - low[0].y)};
}

fg_point fg_grid_jump_variance(const fg_grid_loop *loop, fg_point at) {
  const grid_problem *problem = &loop->problem;
  fg_point variance = {0, 0};
  size_t column = loop->solution.columns.effect;
  for (size_t e = 0; e < problem->model.effects; e++) {
    const grid_effect *effect = &problem->model.effect[e];
    int axis = effect->kind->axis;
    if (effect->kind->jumps) {
      double along = fg_point_along(at, axis), jump = fg_grid_nearest_jump(effect, along);
      double gap = gap_beside(problem, axis, jump, along < jump ? -1 : 1);
      fg_point size = jump_of(loop, effect, column, at, jump);
      if (fabs(along - jump) < gap) {
        variance.x += size.x * size.x / 4;
        variance.y += size.y * size.y / 4;
      }
    }
    column += fg_grid_effect_columns(effect);
  }
  return variance;
}

double fg_grid_jump_u_mm(const grid_problem *problem, const grid_effect *effect) {
  int axis = effect->kind->axis;
  double jump = fg_grid_nearest_jump(effect, problem->model.frame.centre_mm[axis]), gap = 0;
  if (!effect->kind->jumps) return 0;
  for (double side = -1; side <= 1; side += 2)
    gap += gap_beside(problem, axis, jump, side);
  return isfinite(gap) ? gap / sqrt(12) : 0;
}
