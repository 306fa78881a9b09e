/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scores behind the verdict `clean`: lack of fit and correlation, beside all effects found. */
#ifndef FG_TABLE_LOOP_RESIDUAL_TESTS_H
#define FG_TABLE_LOOP_RESIDUAL_TESTS_H

#include "table_loop/engine.h"

/* Rows with the same settings. */
typedef struct fg_engine_cells {
  size_t count;
  size_t *cell;   /* n: 0 .. count - 1; NULL: no row is repeated */
  double *weight; /* count: sum of 1 / scale² */
  double *sum;    /* count: workspace */
  double dof[2];  /* of settings beyond the model; of repeats */
} fg_engine_cells;

/* Groups rows of a training set that agree in every column of the null and, with `recorded`, in
 * every column of the table that is no order. */
fg_status fg_engine_cells_open(fg_context *ctx, const fg_engine_training *training, size_t rank,
                               bool recorded, fg_engine_cells *cells);
void fg_engine_cells_close(fg_engine_cells *cells);
/* Computes the F ratio of a whitened residual: mean square of the means of repeated settings over
 * that of the repeats. NaN where repeats are copies of each other. */
double fg_engine_lack_of_fit(const fg_engine_training *training, fg_engine_cells *cells,
                             const double *white);

/* Computes the correlation score of rows `lag` apart: the sum of products over the root of their
 * squares' sum, close to a normal deviate for rows of any tails and sizes. */
double fg_engine_lag_score(const fg_engine_training *training, const double *white, size_t lag);
double fg_engine_lag_correlation(const fg_engine_training *training, const double *white,
                                 size_t lag);

#endif
