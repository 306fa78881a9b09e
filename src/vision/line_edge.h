/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The edge of a straight stretch, or of a flat arc: stations along it, each with its place across.
 *
 * The same model of one step as of round features (vision/disc_edge.h), fitted to every pixel of a
 * band about the stretch; its shape (levels, slopes, blur) runs straight along the stretch.
 * Lengths are square pixels (vision/disc_find.h).
 */
#ifndef FG_VISION_LINE_EDGE_H
#define FG_VISION_LINE_EDGE_H

#include "vision/disc_edge.h"

/* From one place to another, the material to the left of the way where y points up (see
 * vision/rims.h). `radius` is that of an arc from place to place, whose centre lies in what
 * surrounds the material; INFINITY: a straight line. */
typedef struct fg_stretch {
  fg_point from, to;
  double radius;
} fg_stretch;

double fg_stretch_length(const fg_stretch *stretch);

/* The place at a share of its length, so far towards what surrounds the material. */
fg_point fg_stretch_point(const fg_stretch *stretch, double share, double outwards);

/* Where the stretches lie. */
typedef struct fg_line_view {
  const fg_tiles *tiles;
  fg_pixel_shape shape;
  double middle; /* the count between the two sides of an edge */
} fg_line_view;

/* What the stretch says of the tone curve, as fg_disc_edge_tone. */
fg_status fg_line_edge_tone(fg_context *ctx, const fg_line_view *view, const fg_stretch *stretch,
                            fg_tone *tone);

/* What is known before of what the scanner and its driver do to an edge. */
typedef struct fg_line_tone {
  fg_tone tone;
  const fg_found_driver *driver; /* as a longer edge beside it shows it; NULL: this edge is asked */
} fg_line_tone;

typedef struct fg_line_found {
  fg_disc_edge edge; /* its circle is not used, and edge_px counts towards what surrounds the
                        material */
  double next_px;    /* how far the next edge is, on either side: INFINITY, none is near */
  fg_found_driver driver;
} fg_line_found;

/* FG_ERR_NUMERIC when there is no edge. */
fg_status fg_line_edge_measure(fg_context *ctx, const fg_line_view *view, const fg_stretch *stretch,
                               const fg_line_tone *tone, fg_line_found *found);

/* What all edge_px may be wrong by together because the next edge's blur reaches into the band. */
double fg_line_edge_overlap(double next_px, double blur_px);

#endif
