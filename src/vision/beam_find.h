/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the beams of a flat cantilever foil from its rims, to within a pixel.
 *
 * A rim has the material to its left (vision/rims.h). Along a beam it runs a long side towards the
 * tip, a convex turn of half a circle over the tip, and a long side back. Before and after the beam
 * it turns the other way, into the floor of the cut, where there is one. That holds for beams of a
 * comb and for beams cut out of a sheet. Lengths are square pixels.
 */
#ifndef FG_VISION_BEAM_FIND_H
#define FG_VISION_BEAM_FIND_H

#include "foilgauge/foil.h"
#include "vision/line_edge.h"
#include "vision/polygon.h"

/* Sizes that a beam may have. */
typedef struct fg_beam_limits {
  double length_px[2], width_px[2]; /* min, max */
  double tolerance_px;              /* straightness tolerance of a side */
} fg_beam_limits;

fg_beam_limits fg_beam_limits_of(const fg_design *design, const fg_pixel_shape *shape);

typedef struct fg_beam_place {
  fg_stretch sides[FG_BEAM_SIDES]; /* straight part of each side, without the rounding at corners */
  bool there[FG_BEAM_SIDES];
  unsigned flags;     /* fg_beam_flag */
  fg_point root, tip; /* middles of root and tip */
  double length_px, width_px;
  size_t edge_sides[2], floor_sides[2]; /* indices into the rim's polygon */
} fg_beam_place;

typedef struct fg_beam_places {
  fg_beam_place *list; /* owned */
  size_t count, capacity;
} fg_beam_places;

/* Adds the beams of one rim. FG_ERR_MEMORY. */
fg_status fg_beams_find(fg_context *ctx, const fg_polygon *rim, const fg_beam_limits *limits,
                        fg_beam_places *places);

#endif
