/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Circles through points: an algebraic estimate, then the orthogonal-distance fit.
 *
 * The algebraic estimate is the hyper-accurate fit (Al-Sharadqah and Chernov 2009, Electronic
 * Journal of Statistics 3, 886): no essential bias on short arcs, unlike Kåsa's. The geometric fit
 * minimises sum w_i (|p_i - c| - R)² with Nelder-Mead (GSL nmsimplex2) on centred, scaled
 * coordinates, and is polished by damped Newton to the last digits. Both work on the arc
 * (curvature, direction, crown), so that a radius of thousands of times the arc is no special case.
 */
#ifndef FOILGAUGE_CIRCLE_H
#define FOILGAUGE_CIRCLE_H

#include <stddef.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_point {
  double x, y;
} fg_point;

typedef struct fg_circle {
  double x, y;   /* centre, in the unit of the points */
  double radius; /* in the unit of the points */
} fg_circle;

/* Result of a geometric fit. */
typedef struct fg_circle_fit {
  fg_circle circle;
  double rms;              /* weighted root mean square of the orthogonal residuals */
  double covariance[3][3]; /* of (x, y, R) for residuals of unit variance and weight 1, without
                              correlation: (J'WJ)^-1; multiply by the variance */
  size_t iterations;       /* of Nelder-Mead */
} fg_circle_fit;

/* Hyper fit. `weights` may be NULL (all 1) and are 0 or more. FG_ERR_NUMERIC for fewer than 3
 * points of weight above 0, for points
 * that are not finite, all in one place or exactly on a line. */
fg_status fg_circle_estimate(fg_context *ctx, const fg_point *points, const double *weights,
                             size_t count, fg_circle *circle);

/* Orthogonal-distance fit. `start` may be NULL: the algebraic estimate is used. A given start may
 * be bad: it is tried first only where it is better than the algebraic one. Errors as
 * fg_circle_estimate's. */
fg_status fg_circle_fit_geometric(fg_context *ctx, const fg_point *points, const double *weights,
                                  size_t count, const fg_circle *start, fg_circle_fit *fit);

/* Finds the same minimum by Levenberg-Marquardt (GSL), for differential tests. */
fg_status fg_circle_fit_levenberg(fg_context *ctx, const fg_point *points, const double *weights,
                                  size_t count, const fg_circle *start, fg_circle_fit *fit);

#ifdef __cplusplus
}
#endif
#endif
