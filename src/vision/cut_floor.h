/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The floor of a cut beside a beam: it marks the beam's root on that side. */
#ifndef FG_VISION_CUT_FLOOR_H
#define FG_VISION_CUT_FLOOR_H

#include "vision/line_edge.h"
#include "vision/polygon.h"

/* Margin between corner and straight side, for the corner's blur and the error of its radius. */
#define FG_CORNER_MARGIN_PX 6.0
/* Min length of a stretch whose edge can be fitted. */
#define FG_STRETCH_MIN_PX 6.0

#define FG_NO_SIDE ((size_t)-1)

typedef struct fg_cut_floor {
  bool found;
  fg_stretch stretch; /* its straight part, or the arc about the apex of a round end */
  fg_point place;     /* middle of the stretch, or the apex */
  double corner;      /* radius of the corner between it and the beam */
  size_t side;        /* longest side of the rim along the floor; FG_NO_SIDE: none */
} fg_cut_floor;

/* Finds the floor before the side `side` of a rim, which leads to the tip, or `after` a side that
 * leads back. `line` is the line of that side. */
void fg_cut_floor_find(const fg_polygon *rim, size_t side, bool after, const fg_straight *line,
                       double width_px, fg_cut_floor *floor);

/* Returns the radius of a corner of about 90 degrees between two lines that meet at `corner`. It
 * follows from the distance that the rim keeps from `corner` between its points `first` and `last`.
 */
double fg_corner_radius(const fg_polygon *rim, size_t first, size_t last, fg_point corner);

#endif
