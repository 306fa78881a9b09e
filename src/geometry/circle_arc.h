/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A circle in coordinates that may be as flat as a line: a point on it, the direction to its centre
 * and its curvature.
 *
 * With v = p - q, the signed distance of p from the circle (outside positive) is
 *
 *  P = k |v|² / 2 - n.v,     d = 2 P / (1 + S),     S = sqrt(1 + 2 k P) = 1 + k d
 *
 * (|v - n/k| = S/k and d = (S - 1)/k, without the difference of two large numbers.) It is smooth
 * through k = 0, where d = -n.v: a huge radius is no special case. Seen from q, moving the arc
 * along n, turning it and bending it hardly correlate, whereas the centre and R do at 0.999 and
 * more.
 */
#ifndef FG_GEOMETRY_CIRCLE_ARC_H
#define FG_GEOMETRY_CIRCLE_ARC_H

#include <stdbool.h>

#include "geometry/circle_scaled.h"

typedef struct fg_circle_arc {
  double qx, qy;    /* a point on the circle, scaled */
  double nx, ny;    /* unit vector towards the centre */
  double curvature; /* k = 1 / R; negative while a search passes through flat */
} fg_circle_arc;

/* The arc's point is the one nearest to the origin, that is, amid the points. */
fg_circle_arc fg_circle_arc_from(const fg_circle *circle);
fg_circle fg_circle_arc_circle(const fg_circle_arc *arc);

/* Mean square distance of the scaled points. */
double fg_circle_arc_ms(const fg_circle_scaled *scaled, const fg_circle_arc *arc);

/* Mean square distance with the best radius about the arc's centre, and the mean distance that
 * leads to it; uses scaled->scratch. */
double fg_circle_arc_profile_ms(const fg_circle_scaled *scaled, const fg_circle_arc *arc,
                                double *mean);

/* Returns the arc turned by an angle (towards n turned by -90 degrees), moved along n, bent. */
fg_circle_arc fg_circle_arc_step(const fg_circle_arc *arc, double bend, double turn_rad,
                                 double shift);

/* Returns the same circle with its point nearest to the origin and curvature not negative. */
fg_circle_arc fg_circle_arc_rebase(const fg_circle_arc *arc);

/* Damped Newton on the exact Hessian, to the last digits. Returns true when it converged; *arc is
 * the best found in any case. */
bool fg_circle_arc_polish(const fg_circle_scaled *scaled, fg_circle_arc *arc);

/* (J'WJ)^-1 of (x, y, R) in the points' units and weights; false where it is singular. */
bool fg_circle_arc_covariance(const fg_circle_scaled *scaled, const fg_circle_arc *arc,
                              double covariance[3][3]);

#endif
