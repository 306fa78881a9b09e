/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A jump of the scan beside the moves of a circle: all beyond a row or column is displaced. */
#ifndef FG_GEOMETRY_JUMP_H
#define FG_GEOMETRY_JUMP_H

#include <stdbool.h>

#include "core/small_solve.h"

enum { FG_JUMP_CIRCLE_TERMS = 3 }; /* moves along x and y, and of the radius */

/* Least squares of distances from a circle: its moves alone, and products of the jump's column
 * with the residuals of that fit, with itself and with the moves' columns. */
typedef struct fg_jump_sums {
  double inverse[FG_SMALL_MAX][FG_SMALL_MAX], moves[FG_SMALL_MAX];
  double with_residual, with_itself, with_row[FG_JUMP_CIRCLE_TERMS];
} fg_jump_sums;

/* Fills the jump along an axis and the circle's change by it. The jump's column is that of a
 * displacement where it lies beyond, so half of it everywhere is half a displacement of the whole:
 * the changed centre lies halfway between both parts. False where the moves leave no more than
 * `min_share` of the column's square. */
bool fg_jump_solve(const fg_jump_sums *sums, int axis, double min_share, double *jump_mm,
                   double change[FG_JUMP_CIRCLE_TERMS]);

#endif
