/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/circle_arc.h"

#include <math.h>

fg_circle_arc fg_circle_arc_from(const fg_circle *circle) {
  double distance = hypot(circle->x, circle->y);
  fg_circle_arc arc = {.nx = 0, .ny = 1, .curvature = 1 / circle->radius};
  if (distance > 1e-12 * circle->radius) {
    arc.nx = circle->x / distance;
    arc.ny = circle->y / distance;
  }
  arc.qx = circle->x - circle->radius * arc.nx;
  arc.qy = circle->y - circle->radius * arc.ny;
  return arc;
}

fg_circle fg_circle_arc_circle(const fg_circle_arc *arc) {
  double radius = 1 / arc->curvature;
  return (fg_circle){arc->qx + radius * arc->nx, arc->qy + radius * arc->ny, fabs(radius)};
}

/* S² = |k v - n|² cannot be negative but for rounding. */
static inline double signed_distance(const fg_circle_arc *arc, double x, double y) {
  double vx = x - arc->qx, vy = y - arc->qy;
  double p = 0.5 * arc->curvature * (vx * vx + vy * vy) - arc->nx * vx - arc->ny * vy;
  double square = 1 + 2 * arc->curvature * p;
  return 2 * p / (1 + sqrt(square > 0 ? square : 0));
}

double fg_circle_arc_ms(const fg_circle_scaled *scaled, const fg_circle_arc *arc) {
  double sum = 0;
  for (size_t i = 0; i < scaled->count; i++) {
    double d = signed_distance(arc, scaled->x[i], scaled->y[i]);
    sum += scaled->weight[i] * d * d;
  }
  return sum;
}

double fg_circle_arc_profile_ms(const fg_circle_scaled *scaled, const fg_circle_arc *arc,
                                double *mean) {
  const double *restrict x = scaled->x, *restrict y = scaled->y, *restrict w = scaled->weight;
  double *restrict d = scaled->scratch;
  const fg_circle_arc local = *arc;
  size_t count = scaled->count;
  for (size_t i = 0; i < count; i++)
    d[i] = signed_distance(&local, x[i], y[i]);
  /* Two lanes each: one chain of additions would cost more than the square roots. */
  double sum[2] = {0, 0}, square[2] = {0, 0};
  for (size_t i = 0; i + 1 < count; i += 2)
    for (size_t lane = 0; lane < 2; lane++) {
      double weighted = w[i + lane] * d[i + lane];
      sum[lane] += weighted;
      square[lane] += weighted * d[i + lane];
    }
  if (count % 2) {
    sum[0] += w[count - 1] * d[count - 1];
    square[0] += w[count - 1] * d[count - 1] * d[count - 1];
  }
  *mean = sum[0] + sum[1];
  return square[0] + square[1] - *mean * *mean;
}

fg_circle_arc fg_circle_arc_step(const fg_circle_arc *arc, double bend, double turn_rad,
                                 double shift) {
  double c = cos(turn_rad), s = sin(turn_rad);
  return (fg_circle_arc){
      .qx = arc->qx + shift * arc->nx,
      .qy = arc->qy + shift * arc->ny,
      .nx = c * arc->nx + s * arc->ny,
      .ny = c * arc->ny - s * arc->nx,
      .curvature = arc->curvature + bend,
  };
}

fg_circle_arc fg_circle_arc_rebase(const fg_circle_arc *arc) {
  /* k v - n for v from q to the origin: from the centre to the origin, times k. */
  double x = -arc->curvature * arc->qx - arc->nx, y = -arc->curvature * arc->qy - arc->ny;
  double length = hypot(x, y);
  fg_circle_arc based = *arc;
  /* Near the centre any point of the circle serves, and the distance from there (S near 0) would
   * lose digits. */
  if (length > 0.25) {
    double d = signed_distance(arc, 0, 0);
    based =
        (fg_circle_arc){-d * x / length, -d * y / length, -x / length, -y / length, arc->curvature};
  }
  if (based.curvature < 0) {
    based.nx = -based.nx;
    based.ny = -based.ny;
    based.curvature = -based.curvature;
  }
  return based;
}
