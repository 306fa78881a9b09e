/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A coordinate in equal steps with sums over the rows of each: a form over that coordinate is
 * multiplied with sums instead of rows. For many rows. */
#ifndef FG_TABLE_LOOP_BINS_H
#define FG_TABLE_LOOP_BINS_H

#include "table_loop/gram.h"

typedef struct fg_engine_bins {
  size_t count, rank, coordinate;
  double *weight;       /* count: sum of the rows' inverse variances */
  double *vectors;      /* (rank + 1) × count: sums of the null's columns and of the residual */
  fg_loop_problem grid; /* the coordinate at the middle of every step */
} fg_engine_bins;

/* `vectors`: rank + 1 whitened ones of the training's rows, the last is the residual. */
fg_status fg_engine_bins_open(fg_context *ctx, const fg_engine_training *training,
                              size_t coordinate, size_t count, const double *vectors, size_t rank,
                              fg_engine_bins *bins);
void fg_engine_bins_close(fg_engine_bins *bins);
/* The gram of an effect over that coordinate; `columns` has room for its columns × count. */
void fg_engine_bins_gram(const fg_engine_bins *bins, const fg_loop_candidate *candidate,
                         const double *shape, double *columns, fg_engine_gram *gram);

#endif
