/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Round features of a scan, coarsely: circles that outlines at many levels agree upon.
 *
 * Works on a reduced picture. An edge with a clean, strong step gives the same outline at every
 * level between its two sides; a texture, a shadow or a chamfer gives another one at each. So the
 * edge is the circle that most levels agree upon, and its strength is their number.
 *
 * Lengths are in square pixels: x and y scaled so that a pixel has the same width and height (and
 * the same area), for a scan of unequal resolution shows circles as ellipses.
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
  double u_px;      /* max distance of the edge from the circle */
  int levels;       /* outlines that agree */
} fg_disc_candidate;

typedef struct fg_disc_candidates {
  fg_disc_candidate *list; /* owned; in reading order of their centres */
  size_t count;
  size_t other_shapes; /* outlines at the middle level that are not round */
} fg_disc_candidates;

/* Scale from a scan's pixels to square ones. */
typedef struct fg_pixel_shape {
  double scale[2]; /* square px per pixel, x and y; their product is 1 */
  double um;       /* per square px */
} fg_pixel_shape;

fg_pixel_shape fg_pixel_shape_of(const double dpi[2]);

/* Finds circles of at least `min_px` radius that show at least 200 degrees of their circumference.
 * None is no error. */
fg_status fg_discs_find(fg_context *ctx, const fg_tiles *tiles, const fg_pixel_shape *shape,
                        double min_px, unsigned threads, fg_disc_candidates *found);
void fg_disc_candidates_free(fg_disc_candidates *found);

#ifdef __cplusplus
}
#endif
#endif
