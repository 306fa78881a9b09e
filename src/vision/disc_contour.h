/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Circles in outlines: a whole round outline, or the round part of one. */
#ifndef FG_VISION_DISC_CONTOUR_H
#define FG_VISION_DISC_CONTOUR_H

#include <stdbool.h>

#include "foilgauge/circle.h"

/* A circle fitted to an outline. */
typedef struct fg_round {
  fg_circle circle;
  double rms;
  size_t inliers;
} fg_round;

/* An outline in work; points of extracted circles move behind `count`. */
typedef struct fg_outline {
  fg_point *points; /* in order along it */
  double *weights;  /* scratch, one per point */
  size_t count;
  double cell; /* uncertainty of a point */
  double min_radius;
} fg_outline;

/* Extracts the largest circle from the outline and removes its points; false when there is none.
 * The whole outline is tried first, then stretches of it (two discs that touch). */
bool fg_outline_extract_circle(fg_outline *outline, fg_round *round);

#endif
