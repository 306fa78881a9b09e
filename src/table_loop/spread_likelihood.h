/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Restricted likelihood of an unequal spread in few rows, where a row of large scatter moves the
 * fit and with it the residuals of the others. */
#ifndef FG_TABLE_LOOP_SPREAD_LIKELIHOOD_H
#define FG_TABLE_LOOP_SPREAD_LIKELIHOOD_H

#include "table_loop/engine.h"

enum { FG_ENGINE_SPREAD_ROWS = 48 }; /* rows up to which it is computed */

/* Slopes that are tried of every response. */
enum { FG_ENGINE_SPREAD_SLOPES = 21 };

/* Fits at each of these slopes but for the response: the null's columns over the rows' scales,
 * which many responses share. */
typedef struct fg_engine_spread_grid {
  double *inverse;                       /* slopes × n: 1 over the scale */
  double *basis;                         /* slopes × rank × n, orthonormal */
  double terms[FG_ENGINE_SPREAD_SLOPES]; /* what the likelihood has of the columns alone */
} fg_engine_spread_grid;

/* A spread by level of every row (0 .. FG_LOOP_COLUMNS), or, without levels, by a column z. */
typedef struct fg_engine_spread_rows {
  const size_t *level; /* NULL: none */
  const double *z;
  const fg_engine_spread_grid *grid; /* of z */
} fg_engine_spread_rows;

fg_status fg_engine_spread_grid_open(fg_context *ctx, const fg_engine_span *null, const double *z,
                                     fg_engine_spread_grid *grid);
void fg_engine_spread_grid_close(fg_engine_spread_grid *grid);

/* Returns twice the gain in the logarithm of the restricted likelihood over equal spread, of
 * independent rows, at most FG_ENGINE_SPREAD_ROWS. */
double fg_engine_spread_gain(const fg_engine_span *null, fg_engine_spread_rows rows,
                             const double *y);

#endif
