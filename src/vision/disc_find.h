/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Round things in a scan, coarsely: circles that outlines at many levels agree upon.
 *
 * Works on a reduced picture. An edge with a clean, strong step gives the same outline at every
 * level between its two sides; a texture, a shadow or a chamfer gives another one at each. So the
 * circle that most levels agree upon is the edge, and how many do is its strength.
 *
 * Lengths are in square pixels: x and y scaled so that a pixel has the same width and height
 * (and the same area), for a scan of unequal resolution shows circles as ellipses.
 */
#ifndef FG_VISION_DISC_FIND_H
#define FG_VISION_DISC_FIND_H

#include "foilgauge/circle.h"
#include "vision/tiles.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_disc_candidate {
  fg_circle circle; /* square px */
  double u_px;      /* how far the edge may lie from it */
  int levels;       /* outlines that agree */
} fg_disc_candidate;

typedef struct fg_disc_candidates {
  fg_disc_candidate *list; /* owned; in reading order of their centres */
  size_t count;
  size_t other_shapes; /* outlines at the middle level that are not round */
} fg_disc_candidates;

/* How a scan's pixels become square ones. */
typedef struct fg_pixel_shape {
  double scale[2]; /* square px per pixel, x and y; their product is 1 */
  double um;       /* per square px */
} fg_pixel_shape;

fg_pixel_shape fg_pixel_shape_of(const double dpi[2]);

/* Circles of at least `min_px` radius that show at least 200 degrees of their circumference. None
 * is no error. */
fg_status fg_discs_find(fg_context *ctx, const fg_tiles *tiles, const fg_pixel_shape *shape,
                        double min_px, unsigned threads, fg_disc_candidates *found);
void fg_disc_candidates_free(fg_disc_candidates *found);

#ifdef __cplusplus
}
#endif
#endif
