/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether an outline is round, or holds a round part. */
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

/* An outline at work; points that are taken move behind `count`. */
typedef struct fg_outline {
  fg_point *points; /* in order along it */
  double *weights;  /* scratch, as many */
  size_t count;
  double cell; /* what a point is uncertain by */
  double min_radius;
} fg_outline;

/* Takes the largest circle out of what is left of the outline: its points are removed. False when
 * there is none. The whole outline is tried first, then stretches of it (two discs that touch). */
bool fg_outline_take_circle(fg_outline *outline, fg_round *round);

#endif
