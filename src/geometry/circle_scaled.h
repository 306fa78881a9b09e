/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Points prepared for a circle fit: centred on their weighted mean, turned to their principal axes
 * (x is the long one), scaled to a mean square distance of 1, weights summing to 1.
 *
 * In these coordinates nothing depends on the points' place or unit, sums do not cancel, and the
 * mean square distance from the best line is the mean of y².
 */
#ifndef FG_GEOMETRY_CIRCLE_SCALED_H
#define FG_GEOMETRY_CIRCLE_SCALED_H

#include "foilgauge/circle.h"

/* A circle this flat (curvature in units of 1 / rms size of the point set) cannot be told from a
 * line: its sagitta is below the rounding of the coordinates. */
#define FG_CIRCLE_FLAT 1e-11

typedef struct fg_circle_scaled {
  size_t count;
  double *x, *y, *weight; /* owned, one block */
  double *scratch;        /* `count` doubles for the caller's use */
  double weight_sum;      /* of the weights as given */
  double line_ms;         /* weighted mean square distance from the best line */
  fg_point origin;        /* of the scaled points, in the unit of those given */
  double scale;           /* points' units per unit of the scaled ones */
  double axis_x, axis_y;  /* unit vector of the long axis */
} fg_circle_scaled;

/* FG_ERR_NUMERIC for fewer than 3 points of weight above 0, values that are not finite, negative
 * weights, points all in one place or all on a line. */
fg_status fg_circle_scale_points(fg_context *ctx, const fg_point *points, const double *weights,
                                 size_t count, fg_circle_scaled *scaled);
void fg_circle_scaled_free(fg_circle_scaled *scaled);

fg_circle fg_circle_into_scaled(const fg_circle_scaled *scaled, const fg_circle *circle);
fg_circle fg_circle_out_of_scaled(const fg_circle_scaled *scaled, const fg_circle *circle);

/* Hyper fit of the scaled points. FG_ERR_NUMERIC when a line fits better than any circle. */
fg_status fg_circle_estimate_scaled(fg_context *ctx, const fg_circle_scaled *scaled,
                                    fg_circle *circle);

#endif
