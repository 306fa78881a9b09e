/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scores of candidate effects: the squares that they take from the residual of a grids' model,
 * beside everything that the model has. */
#ifndef FG_GRID_LOOP_SCORE_H
#define FG_GRID_LOOP_SCORE_H

#include "grid_loop/solve.h"

typedef struct grid_sparse_row {
  size_t first, count; /* of its columns that are not 0 */
} grid_sparse_row;

/* Shared by all candidates; `problem` and `solution` are not owned. */
typedef struct grid_score_work {
  const grid_problem *problem;
  const grid_solution *solution;
  double variance;       /* of a row */
  grid_sparse_row *rows; /* owned */
  size_t *index;         /* owned */
  double *value;         /* owned */
  double *cross;         /* owned; two columns of products with the model, and two of solutions */
} grid_score_work;

fg_status fg_grid_score_open(fg_context *ctx, const grid_problem *problem,
                             const grid_solution *solution, grid_score_work *work);
void fg_grid_score_close(grid_score_work *work);

/* The sum of squares that a candidate takes from the residual, in variances of a row. */
double fg_grid_score(grid_score_work *work, const grid_effect *candidate);

#endif
