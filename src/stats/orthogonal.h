/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gram-Schmidt in extended precision, without aliased columns. */
#ifndef FG_STATS_ORTHOGONAL_H
#define FG_STATS_ORTHOGONAL_H

#include "foilgauge/table.h"

/* X = Q R over the kept columns. Everything in R, z and the inverse is in the units of X and y. */
typedef struct fg_orthogonal {
  size_t rows, columns, rank;
  size_t *kept;   /* rank: column of X that made column i of Q */
  bool *aliased;  /* columns */
  fg_extended *q; /* columns × rows; column j of X became q + j × rows; aliased ones are 0 */
  fg_extended *r; /* columns × columns, row by row: r[i][j] = q_i' x_j, 0 where i aliased */
  fg_extended *z; /* columns: q_i' y */
  fg_extended *residual; /* rows */
  fg_extended *inverse;  /* columns × columns, row by row: R^-1 over the kept columns */
} fg_orthogonal;

/* `matrix` (column by column) and `response` are copied, with row i times scale[i] when `scale` is
 * given. */
typedef struct fg_least_squares {
  const fg_extended *matrix, *response, *scale;
  size_t rows, columns;
  double tolerance;
} fg_least_squares;

fg_status fg_orthogonal_solve(fg_context *ctx, const fg_least_squares *problem,
                              fg_orthogonal *solution);
void fg_orthogonal_free(fg_orthogonal *solution);

#endif
