/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "grid_loop/score.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"

static double variance_of_rows(const grid_problem *problem, const grid_solution *solution) {
  double square = 0, n = 0;
  for (size_t i = 0; i < problem->row_count; i++) {
    if (!problem->rows[i].used) continue;
    square += solution->residual[i] * solution->residual[i];
    n++;
  }
  return square / fmax(1, n - (double)solution->columns.board_map);
}

static void keep_sparse_rows(grid_score_work *work) {
  const grid_problem *problem = work->problem;
  size_t at = 0;
  for (size_t i = 0; i < problem->row_count; i++) {
    size_t n = fg_grid_row_columns(problem, &work->solution->columns, &problem->rows[i],
                                   work->index + at, work->value + at);
    work->rows[i] = (grid_sparse_row){at, n};
    at += n;
  }
}

fg_status fg_grid_score_open(fg_context *ctx, const grid_problem *problem,
                             const grid_solution *solution, grid_score_work *work) {
  size_t numbers = (problem->row_count + 1) * GRID_ROW_MAX, columns = solution->columns.count;
  fg_status status = FG_OK;
  *work = (grid_score_work){.problem = problem, .solution = solution};
  work->variance = variance_of_rows(problem, solution);
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, problem->row_count, sizeof *work->rows, (void **)&work->rows));
  FG_TRY_EXIT(fg_memory_allocate(ctx, numbers, sizeof *work->index, (void **)&work->index));
  FG_TRY_EXIT(fg_memory_allocate(ctx, numbers, sizeof *work->value, (void **)&work->value));
  FG_TRY_EXIT(fg_memory_allocate(ctx, 4 * columns, sizeof *work->cross, (void **)&work->cross));
  keep_sparse_rows(work);
exit:
  if (status != FG_OK) fg_grid_score_close(work);
  return status;
}

void fg_grid_score_close(grid_score_work *work) {
  free(work->rows);
  free(work->index);
  free(work->value);
  free(work->cross);
  *work = (grid_score_work){0};
}

/* Products of a candidate's columns with each other and with the residual. */
typedef struct candidate_products {
  double own[GRID_EFFECT_COLUMNS][GRID_EFFECT_COLUMNS], right[GRID_EFFECT_COLUMNS];
} candidate_products;

/* Fills the products, and those with the model's columns into `cross`. */
static candidate_products project_candidate(grid_score_work *work, const grid_effect *candidate) {
  const grid_problem *problem = work->problem;
  size_t count = work->solution->columns.count, columns = candidate->kind->columns;
  candidate_products products = {0};
  grid_effect fixed = *candidate;
  fixed.loose = false;
  memset(work->cross, 0, columns * count * sizeof *work->cross);
  for (size_t i = 0; i < problem->row_count; i++) {
    const grid_row *row = &problem->rows[i];
    const grid_sparse_row *sparse = &work->rows[i];
    double c[FG_FIELD_COLUMNS];
    if (!row->used) continue;
    fg_grid_effect_of_row(&fixed, &problem->model.frame, row, c);
    for (size_t k = 0; k < columns; k++) {
      if (c[k] == 0) continue;
      products.right[k] += c[k] * work->solution->residual[i];
      products.own[k][0] += c[k] * c[0];
      products.own[k][1] += c[k] * c[1];
      for (size_t j = sparse->first; j < sparse->first + sparse->count; j++)
        work->cross[k * count + work->index[j]] += c[k] * work->value[j];
    }
  }
  return products;
}

/* Takes what the model's columns explain of the candidate's out of their products. */
static void take_model_out(grid_score_work *work, size_t columns, candidate_products *products) {
  size_t count = work->solution->columns.count;
  double mark2 = work->problem->model.mark_sd * work->problem->model.mark_sd;
  double *solved = work->cross + GRID_EFFECT_COLUMNS * count;
  for (size_t a = 0; a < columns; a++)
    for (size_t i = 0; i < count; i++)
      solved[a * count + i] = fg_dot_in_lanes(
          gsl_matrix_const_ptr(work->solution->covariance, i, 0), work->cross + a * count, count);
  for (size_t a = 0; a < columns; a++)
    for (size_t b = 0; b < columns; b++)
      products->own[a][b] -=
          fg_dot_in_lanes(work->cross + b * count, solved + a * count, count) / mark2;
}

double fg_grid_score(grid_score_work *work, const grid_effect *candidate) {
  size_t columns = candidate->kind->columns;
  candidate_products p = project_candidate(work, candidate);
  const double *right = p.right, before[2] = {p.own[0][0], p.own[1][1]};
  take_model_out(work, columns, &p);
  if (columns == 1)
    return p.own[0][0] > 1e-9 * before[0] ? right[0] * right[0] / (p.own[0][0] * work->variance)
                                          : 0;
  double det = p.own[0][0] * p.own[1][1] - p.own[0][1] * p.own[1][0];
  if (!(det > 1e-9 * before[0] * before[1])) return 0;
  return (p.own[1][1] * right[0] * right[0] - 2 * p.own[0][1] * right[0] * right[1] +
          p.own[0][0] * right[1] * right[1]) /
         (det * work->variance);
}
