/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Binned coordinate: equal steps with sums over the rows of each. Products with a basis over that
 * coordinate use the sums instead of the rows, for tables of many rows. */
#ifndef FG_TABLE_LOOP_BINS_H
#define FG_TABLE_LOOP_BINS_H

#include "table_loop/gram.h"

typedef struct fg_engine_bins {
  size_t count, rank, coordinate;
  double *weight;       /* count: sums of the rows' inverse variances */
  double *vectors;      /* (rank + 1) × count: sums of the null's columns and the residual */
  fg_loop_problem grid; /* problem of the coordinate's values at the middle of every step */
} fg_engine_bins;

/* `vectors`: rank + 1 whitened vectors over the training set's rows; the last is the residual. */
fg_status fg_engine_bins_open(fg_context *ctx, const fg_engine_training *training,
                              size_t coordinate, size_t count, const double *vectors, size_t rank,
                              fg_engine_bins *bins);
void fg_engine_bins_close(fg_engine_bins *bins);
/* Computes the gram of an effect over that coordinate; `columns` has room for its columns × count.
 */
void fg_engine_bins_gram(const fg_engine_bins *bins, const fg_loop_candidate *candidate,
                         const double *shape, double *columns, fg_engine_gram *gram);

#endif
