/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The edge of a straight stretch, or of a flat arc: stations along it, each with its place across.
 *
 * The model is the one step of round features (vision/disc_edge.h), fitted to every pixel of a band
 * about the stretch. Its shape (levels, slopes, blur) is linear along the stretch. Lengths are
 * square pixels (vision/disc_find.h).
 */
#ifndef FG_VISION_LINE_EDGE_H
#define FG_VISION_LINE_EDGE_H

#include "vision/disc_edge.h"

/* A stretch runs from one place to another, the material to its left where y points up (see
 * vision/rims.h). `radius` is that of an arc between the places, whose centre lies outside of the
 * material; INFINITY: a straight line. An arc that ends a cut lies in its middle; `half_width` is
 * half of the cut's width, 0 where that is not known. */
typedef struct fg_stretch {
  fg_point from, to;
  double radius, half_width;
} fg_stretch;

double fg_stretch_length(const fg_stretch *stretch);

/* Returns the point at a share of the stretch's length, `outwards` px away from the material. */
fg_point fg_stretch_point(const fg_stretch *stretch, double share, double outwards);

/* Scan of the stretches. */
typedef struct fg_line_view {
  const fg_tiles *tiles;
  fg_pixel_shape shape;
  double middle; /* the count between the two sides of an edge */
} fg_line_view;

/* Estimates the tone curve from the stretch, as fg_disc_edge_tone. */
fg_status fg_line_edge_tone(fg_context *ctx, const fg_line_view *view, const fg_stretch *stretch,
                            fg_tone *tone);

/* Prior knowledge of scanner and driver. */
typedef struct fg_line_tone {
  fg_tone tone;
  const fg_found_driver
      *driver; /* as found at a longer edge beside it; NULL: it is sought at this edge */
  double blur_along, blur_across; /* of the edges across a cut's end and along it; 0: not known */
} fg_line_tone;

typedef struct fg_line_found {
  fg_disc_edge edge; /* its circle is not used, and edge_px counts away from the material */
  double next_px;    /* distance of the next edge on either side; INFINITY: none is near */
  fg_found_driver driver;
} fg_line_found;

/* Returns true when the end of a cut is measured by its own light (vision/round_end.h), so that
 * blur does not move it. An unsharp mask has no such light. */
bool fg_line_edge_has_end(const fg_stretch *stretch, const fg_line_tone *tone);

/* FG_ERR_NUMERIC when there is no edge. */
fg_status fg_line_edge_measure(fg_context *ctx, const fg_line_view *view, const fg_stretch *stretch,
                               const fg_line_tone *tone, fg_line_found *found);

/* Returns the error common to all edge_px from the next edge's blur inside the band. */
double fg_line_edge_overlap(double next_px, double blur_px);

#endif
