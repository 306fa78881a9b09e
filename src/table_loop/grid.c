/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/grid.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

/* Coordinates that are no axis share one array of zeros: that of an additional coordinate after the
 * problem's. */
static double *zeros(const fg_loop_problem *grid) {
  return grid->coordinate[grid->coordinates].value;
}

fg_status fg_engine_grid_open(fg_context *ctx, const fg_loop_problem *problem, size_t rows,
                              fg_loop_problem *grid) {
  size_t count = problem->coordinates;
  double *shared = NULL;
  *grid = (fg_loop_problem){.level = problem->level,
                            .rows = rows,
                            .self = problem->self,
                            .declared = problem->declared,
                            .declared_model = problem->declared_model};
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *shared, (void **)&shared));
  fg_status status =
      fg_memory_allocate(ctx, count + 1, sizeof *grid->coordinate, (void **)&grid->coordinate);
  if (status != FG_OK) {
    free(shared);
    return status;
  }
  memcpy(grid->coordinate, problem->coordinate, count * sizeof *grid->coordinate);
  grid->coordinates = count;
  for (size_t i = 0; i <= count; i++)
    grid->coordinate[i].value = shared;
  return FG_OK;
}

fg_status fg_engine_grid_axis(fg_context *ctx, fg_loop_problem *grid, size_t coordinate,
                              double **value) {
  fg_loop_coordinate *at = &grid->coordinate[coordinate];
  if (at->value == zeros(grid)) {
    double *own = NULL;
    FG_TRY(fg_memory_allocate(ctx, grid->rows, sizeof *own, (void **)&own));
    at->value = own;
  }
  *value = at->value;
  return FG_OK;
}

void fg_engine_grid_close(fg_loop_problem *grid) {
  if (!grid->coordinate) return;
  double *shared = zeros(grid);
  for (size_t i = 0; i < grid->coordinates; i++)
    if (grid->coordinate[i].value != shared) free(grid->coordinate[i].value);
  free(shared);
  free(grid->coordinate);
  *grid = (fg_loop_problem){0};
}

fg_status fg_loop_claim_curve(fg_context *ctx, const fg_loop_problem *problem,
                              const fg_loop_claim *claim, const double *value, size_t count,
                              double *effect) {
  fg_loop_problem grid = {0};
  double *axis = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_engine_grid_open(ctx, problem, count, &grid));
  FG_TRY_EXIT(fg_engine_grid_axis(ctx, &grid, claim->candidate.a, &axis));
  memcpy(axis, value, count * sizeof *axis);
  FG_TRY_EXIT(fg_loop_claim_evaluate(ctx, &grid, claim, effect));
exit:
  fg_engine_grid_close(&grid);
  return status;
}
