/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scores of what `clean` rests on beside everything that was looked for by name. */
#ifndef FG_TABLE_LOOP_RESIDUAL_TESTS_H
#define FG_TABLE_LOOP_RESIDUAL_TESTS_H

#include "table_loop/engine.h"

/* Rows with the same settings. */
typedef struct fg_engine_cells {
  size_t count;
  size_t *cell;   /* n: 0 .. count - 1; NULL: nothing repeats */
  double *weight; /* count: sum of 1 / scale² */
  double *sum;    /* count: room */
  double dof[2];  /* of the settings beyond the model; of the repeats */
} fg_engine_cells;

/* Rows of a training that agree in every column of the null and, with `recorded`, in every column
 * of the table that is no order. */
fg_status fg_engine_cells_open(fg_context *ctx, const fg_engine_training *training, size_t rank,
                               bool recorded, fg_engine_cells *cells);
void fg_engine_cells_close(fg_engine_cells *cells);
/* F ratio of a whitened residual: what the means of repeated settings leave over what the repeats
 * differ by. NaN where repeats are copies of each other. */
double fg_engine_lack_of_fit(const fg_engine_training *training, fg_engine_cells *cells,
                             const double *white);

/* How alike rows `lag` apart are: the sum of products over the root of their squares' sum, near to
 * a normal deviate whatever the rows' tails and sizes. */
double fg_engine_lag_score(const fg_engine_training *training, const double *white, size_t lag);
double fg_engine_lag_correlation(const fg_engine_training *training, const double *white,
                                 size_t lag);

#endif
