/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The floor of a cut beside a beam: where its root lies on that side. */
#ifndef FG_VISION_CUT_FLOOR_H
#define FG_VISION_CUT_FLOOR_H

#include "vision/line_edge.h"
#include "vision/polygon.h"

/* A corner's blur and what its radius is wrong by keep so far away from the straight side. */
#define FG_CORNER_MARGIN_PX 6.0
/* Shorter stretches hold no edge to fit. */
#define FG_STRETCH_MIN_PX 6.0

#define FG_NO_SIDE ((size_t)-1)

typedef struct fg_cut_floor {
  bool found;
  fg_stretch stretch; /* its straight part, or the arc about the apex of a round end */
  fg_point place;     /* its middle, or the apex */
  double corner;      /* radius of the corner between it and the beam */
  size_t side;        /* the rim's longest side along it; FG_NO_SIDE: none */
} fg_cut_floor;

/* The floor before the side `side` of a rim, which leads to the tip, or `after` one that leads
 * back. `line` is the side's. */
void fg_cut_floor_find(const fg_polygon *rim, size_t side, bool after, const fg_straight *line,
                       double width_px, fg_cut_floor *floor);

/* Radius of a corner of about 90 degrees between two lines that meet at `corner`, from how far the
 * rim between two of its points stays away from there. */
double fg_corner_radius(const fg_polygon *rim, size_t first, size_t last, fg_point corner);

#endif
