/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curve of one value of the edges' shape along a strip or around a turn, shared by edges_smooth.c
 * and disc_shape.c. */
#ifndef FG_VISION_SHAPE_CURVE_H
#define FG_VISION_SHAPE_CURVE_H

#include <stdbool.h>

#include "core/small_solve.h"

typedef struct fg_shape_curve_sums {
  double squares, expected,
      count; /* sums of squared deviations, of the fits' own variances, and of values */
} fg_shape_curve_sums;

/* Solves for the curve's coefficients; false when the system is singular. `judged`: the sums are
 * about a curve already, and *real becomes the share of the scatter that the fits' own variances do
 * not explain. */
bool fg_shape_curve_solve(fg_normal_equations *system, const fg_shape_curve_sums *sums, bool judged,
                          double *coefficients, double *real);

/* Returns the deviation from the curve beyond which a value is left out; INFINITY without values.
 * Reorders `sizes`. */
double fg_shape_curve_limit(double *sizes, size_t count);

#endif
