/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The circles of an edge fit with their rows: of every part the lands, then each bump. Deviations
 * of the part count from the least-squares circle through them (ISO 12181). */
#ifndef FG_SCAN_LOOP_CIRCLES_H
#define FG_SCAN_LOOP_CIRCLES_H

#include "rows/edge_fit.h"

typedef struct fg_circles {
  const fg_edge_fit *edge_fit;
  size_t count, rows;
  size_t *first; /* owned; count + 1: of a part's circles, those of one of its views */
  size_t *row;   /* owned; rows of the edge fit, circle by circle */
  double *ring;  /* owned; 3 × rows: orthonormal, what a circle follows */
  /* owned; 2 × count: along the foil, the rows between which a deviation counts for sure. An arc
   * that deviates from its circle seems to end too early, in a fillet. */
  double *sure_mm;
  double *sure_ring; /* owned; as ring, of those rows alone */
  bool *cut;         /* owned; per circle: too much of its arc is missing */
} fg_circles;

fg_status fg_circles_open(fg_context *ctx, const fg_edge_fit *edge_fit, fg_circles *circles);
void fg_circles_close(fg_circles *circles);

/* Index of the circle of a part's lands; those of its bumps follow. */
size_t fg_circles_of_part(const fg_edge_fit *edge_fit, size_t part);

/* Removes from a deviation, one value per row of the circles, what their circles follow. */
void fg_circles_remove(const fg_circles *circles, double *values);

/* Peak to valley of a deviation on one circle; 0 without rows. */
double fg_circles_peak_to_valley(const fg_circles *circles, size_t circle, const double *values);

/* The same over its sure rows alone, from the circle through them: the arc without its ends, as
 * much shorter as it may be longer than measured. `values` is overwritten. */
double fg_circles_sure_peak_to_valley(const fg_circles *circles, size_t circle, double *values);

#endif
