/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The straight sides of a closed line. */
#ifndef FG_VISION_POLYGON_H
#define FG_VISION_POLYGON_H

#include <stdbool.h>

#include "foilgauge/circle.h"

/* A side from one point of the line to another, in its order; `last` may lie before `first`, beyond
 * the line's end. */
typedef struct fg_polygon_side {
  size_t first, last;
  double angle; /* of its direction, rad */
  double length;
} fg_polygon_side;

typedef struct fg_polygon {
  const fg_point *points; /* the line; not owned */
  size_t point_count;
  fg_polygon_side *sides; /* in order; owned */
  size_t count;
} fg_polygon;

/* Douglas and Peucker's polygon: no point lies further than `tolerance` from its side. Sides parted
 * by dust or a burr are joined again. FG_ERR_MEMORY. */
fg_status fg_polygon_make(fg_context *ctx, const fg_point *points, size_t count, double tolerance,
                          fg_polygon *polygon);
void fg_polygon_free(fg_polygon *polygon);

/* Number of points from one index to another along the line, both included. */
static inline size_t fg_polygon_span(const fg_polygon *polygon, size_t first, size_t last) {
  return (last + polygon->point_count - first) % polygon->point_count + 1;
}

/* Returns the turn from one direction to another, -pi to pi; above 0 to the left where y points up.
 */
double fg_polygon_turn(double from, double to);

/* A straight line by least squares. */
typedef struct fg_straight {
  fg_point at; /* the mean of the points */
  fg_point along;
} fg_straight;

/* Fits a straight line to a stretch of the line, without the share `trim` at either end; its
 * direction is that of the stretch. */
fg_straight fg_polygon_straight(const fg_polygon *polygon, size_t first, size_t last, double trim);

/* Intersection of two lines; NaN where they are parallel. */
fg_point fg_straight_meet(const fg_straight *a, const fg_straight *b);

/* Distance of a point from a line, positive to its left where y points up. */
double fg_straight_left(const fg_straight *line, fg_point p);

#endif
