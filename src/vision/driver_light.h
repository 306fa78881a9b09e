/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The light across one edge or both, before a driver's tone curve. */
#ifndef FG_VISION_DRIVER_LIGHT_H
#define FG_VISION_DRIVER_LIGHT_H

#include "vision/driver_model.h"

/* One profile in light. */
typedef struct fg_lit {
  double plateau, step[2], slope[2], blur[2], edge[2], inner_slope;
  double halo, halo_px;
  bool single;
} fg_lit;

fg_lit fg_lit_profile(const fg_driver *driver, const fg_driver_tone *tone, const double *values,
                      bool single);

/* A step of 1 at one edge, at many places. It depends on the edge's place, its blur and the
 * halo's length alone; levels and slopes enter in proportion. */
typedef struct fg_lit_side {
  double edge, blur, halo_px;
  double *outwards;   /* distance from the edge, px */
  double *cumulative; /* share of the step */
  double *density;    /* what a slope of 1 adds by the blur, px */
  double *loss;       /* share of the step that a halo of 1 takes */
} fg_lit_side;

/* Fills a side for the given edge. `side` 0 is the left one; `lossy`: there may be a halo. */
void fg_lit_side_fill(const fg_lit *lit, int side, bool lossy, const double *across, size_t count,
                      fg_lit_side *out);

/* Adds up the light of both sides (of one edge alone: of sides[1]). */
void fg_lit_add(const fg_lit *lit, const fg_lit_side *const sides[2], size_t count, double *light);

#endif
