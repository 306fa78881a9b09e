/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Noise of the rows: white, and the edge's own scatter, which neighbours share.
 *
 * The correlation of two rows at distance d along one arc is share rho(d) (1 of a row with itself),
 * rho(d) = exp(-(d / range)²) or exp(-d / range); a row's variance is that of a whole block times
 * FG_EDGE_FIT_BLOCK / weight. Rows of different arcs are independent. The range is bounded by what
 * edges do (0.01 to 0.12 mm): what is correlated over more is an effect. */
#ifndef FG_ROWS_SCATTER_H
#define FG_ROWS_SCATTER_H

#include <math.h>

#include "rows/edge_fit.h"

/* Behind the last row of the arc that starts at a row: neighbours on one view of one bump, land or
 * disc. What lies farther apart than 4 mm shares no noise, and polynomials could not follow it. */
size_t fg_edge_fit_arc_end(const fg_edge_fit *edge_fit, size_t from);

/* Fills points->scatter by restricted likelihood (Patterson and Thompson 1971) from what the
 * residual of every arc holds beside polynomials along it, which take what is smooth. */
fg_status fg_edge_fit_find_scatter(fg_context *ctx, fg_edge_fit *edge_fit,
                                   const double *residual_um);

/* Takes out of weighted residuals what the bumps share along their arcs, with `numbers` numbers: an
 * effect of the part that is not found yet is no noise. `left_out`: rows of arcs that hold
 * something of their own; of the others it would become a part. */
fg_status fg_edge_fit_take_shared(fg_context *ctx, const fg_edge_fit *edge_fit,
                                  const bool *left_out, double *weighted, size_t *numbers);

/* Makes rows independent. Values of smooth things keep their size: a sum of squares over what it
 * returns is that of generalised least squares, in units of fg_scatter.integral times the variance
 * of a row. */
typedef struct fg_whitening {
  size_t rows, band;
  bool *used;     /* owned; rows without weight are not there */
  double *before; /* owned; Gaussian: `band` coefficients of the rows before, nearest
                     first; exponential: what the state keeps, and its gain */
  double *scale;  /* owned; of what is left of the row itself */
  bool exponential;
  double unit;            /* of a whitened value that stands for one of unit variance */
  bool *first;            /* owned; rows that start an arc */
  double log_determinant; /* of the correlation, over all rows in use */
} fg_whitening;

/* Root of a row's weight: 1 for a whole block. */
static inline double fg_edge_fit_root_weight(const fg_edge_fit_row *row) {
  return sqrt(row->weight / FG_EDGE_FIT_BLOCK);
}

/* All rows as they are (band 0) where points->scatter.share is 0. */
fg_status fg_whitening_open(fg_context *ctx, const fg_edge_fit *edge_fit, fg_whitening *whitening);
void fg_whitening_close(fg_whitening *whitening);
/* `values`, one per row, times the root of their weight already. */
void fg_whitening_apply(const fg_whitening *whitening, double *values);

#endif
