/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Noise of the rows: white, and correlated along the edge.
 *
 * The correlation of two rows at distance d along one arc is share rho(d) (1 of a row with itself),
 * rho(d) = exp(-(d / range)²) or exp(-d / range); a row's variance is that of a whole block times
 * FG_EDGE_FIT_BLOCK / weight. Rows of different arcs are independent. The range is limited to that
 * of edges (0.01 to 0.12 mm): correlation over more is an effect. */
#ifndef FG_ROWS_SCATTER_H
#define FG_ROWS_SCATTER_H

#include <math.h>

#include "rows/edge_fit.h"

/* Returns the index after the last row of the arc that starts at a row: neighbours on one view of
 * one bump, land or disc. Rows farther apart than 4 mm share no noise, and polynomials could not
 * follow the arc. */
size_t fg_edge_fit_arc_end(const fg_edge_fit *edge_fit, size_t from);

/* Fills edge_fit->scatter by restricted likelihood (Patterson and Thompson 1971) from the residual
 * of every arc beside polynomials along it, which remove its smooth part. */
fg_status fg_edge_fit_find_scatter(fg_context *ctx, fg_edge_fit *edge_fit,
                                   const double *residual_um);

/* Removes from weighted residuals the shape that the bumps share along their arcs, with `numbers`
 * parameters: an effect of the part that is not found yet is no noise. `left_out`: rows of arcs
 * with a deviation of their own, which would spread to the other arcs. */
fg_status fg_edge_fit_remove_shared_shape(fg_context *ctx, const fg_edge_fit *edge_fit,
                                          const bool *left_out, double *weighted, size_t *numbers);

enum { FG_WHITENING_QUARTERS = 4 };

/* Makes rows independent. Values of smooth functions keep their size: a sum of squares of whitened
 * values is that of generalised least squares, in units of fg_scatter.integral times the variance
 * of a row. */
typedef struct fg_whitening {
  size_t rows, band;
  bool *used;     /* owned; rows without weight are false */
  double *before; /* owned; Gaussian: `band` coefficients of the rows before, nearest first;
                     exponential: decay of the state, and its gain */
  double *scale;  /* owned; of the row's innovation */
  bool exponential;
  double unit; /* size of a whitened value that represents unit variance */
  bool *first; /* owned; rows that start an arc */
  size_t quarter[FG_WHITENING_QUARTERS + 1]; /* their bounds, at starts of arcs */
  double log_determinant;                    /* of the correlation, over all rows in use */
} fg_whitening;

/* Returns the root of a row's weight: 1 for a whole block. */
static inline double fg_edge_fit_root_weight(const fg_edge_fit_row *row) {
  return sqrt(row->weight / FG_EDGE_FIT_BLOCK);
}

/* Leaves all rows unchanged (band 0) where edge_fit->scatter.share is 0. */
fg_status fg_whitening_open(fg_context *ctx, const fg_edge_fit *edge_fit, fg_whitening *whitening);
void fg_whitening_close(fg_whitening *whitening);
/* Whitens `values`, one per row, already times the root of their weight. */
void fg_whitening_apply(const fg_whitening *whitening, double *values);

#endif
