/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Distances of a part from its circle, explained by moves of the circle, by an oval, or by a jump
 * of the scan: all beyond a row or column is displaced. */
#ifndef FG_GEOMETRY_JUMP_H
#define FG_GEOMETRY_JUMP_H

#include <stdbool.h>

#include "core/small_solve.h"

enum { FG_CIRCLE_TERMS = 3, FG_OVAL_TERMS = 5 };

/* Distance of a place from the circle, outwards, and its terms by the direction from the centre:
 * moves of the circle along x and y, its radius, and the two of an oval. */
typedef struct fg_distance {
  double row[FG_OVAL_TERMS], mm;
} fg_distance;

/* `cosine` and `sine` are those of the direction from the centre. */
fg_distance fg_distance_at(double cosine, double sine, double mm);

/* Fits the first `terms` of the rows by least squares. `inverse`, of the normal equations, may be
 * NULL. Returns the sum of squares left, mm²; infinite without a solution. */
double fg_distances_fit(const fg_distance *distances, size_t count, size_t terms,
                        double x[FG_SMALL_MAX], double inverse[FG_SMALL_MAX][FG_SMALL_MAX]);

/* The fit of a circle's moves alone, and products of the jump's column with the residuals of that
 * fit, with itself and with the moves' columns. */
typedef struct fg_jump_sums {
  double inverse[FG_SMALL_MAX][FG_SMALL_MAX], moves[FG_SMALL_MAX];
  double with_residual, with_itself, with_row[FG_CIRCLE_TERMS];
} fg_jump_sums;

/* Residual of a distance after the circle's moves alone, mm. */
double fg_jump_residual(const fg_jump_sums *sums, const fg_distance *distance);

/* Clears the products with the jump's column. */
void fg_jump_clear(fg_jump_sums *sums);

/* Fills the jump along an axis and the circle's change by it. The jump's column is that of a
 * displacement where it lies beyond, so half of it everywhere is half a displacement of the whole:
 * the changed centre lies halfway between both parts. False where the moves leave no more than
 * `min_share` of the column's square. */
bool fg_jump_solve(const fg_jump_sums *sums, int axis, double min_share, double *jump_mm,
                   double change[FG_CIRCLE_TERMS]);

#endif
