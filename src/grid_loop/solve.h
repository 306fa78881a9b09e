/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mixed model solved: estimates with their covariance, and the sizes of noise and maps by
 * restricted likelihood (Patterson and Thompson 1971). */
#ifndef FG_GRID_LOOP_SOLVE_H
#define FG_GRID_LOOP_SOLVE_H

#include <gsl/gsl_matrix.h>

#include "grid_loop/problem.h"

/* A solution: estimates of all columns, in mm and ratios. */
typedef struct grid_solution {
  grid_columns columns;
  gsl_matrix *covariance;      /* owned */
  gsl_vector *estimate;        /* owned */
  double *residual;            /* owned; of every row, without the board's own mark */
  double minus_log_likelihood; /* restricted, without constants */
} grid_solution;

/* Rows that a solution learns from. */
typedef enum grid_rows_used { GRID_ALL_ROWS, GRID_NOT_HELD_OUT } grid_rows_used;

fg_status fg_grid_solve(fg_context *ctx, const grid_problem *problem, grid_rows_used rows,
                        grid_solution *solution);
void fg_grid_solution_free(grid_solution *solution);

/* The carriage's random part along its way, um, from scan to scan; NaN: no scan repeats the pose of
 * another. */
double fg_grid_find_carriage(const grid_problem *problem, const grid_solution *solution);

/* Finds the sizes of noise and maps, and drops outliers; the problem gets them. */
fg_status fg_grid_find_sizes(fg_context *ctx, grid_problem *problem);

#endif
