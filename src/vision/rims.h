/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rims: the closed lines between a flat part's material and its surroundings, pixel by pixel.
 *
 * A rim runs along the sides of pixels, with the material to its left in coordinates whose y axis
 * points up (to its right as the scan is seen, where y runs down). So the shoelace formula in x and
 * y of the scan gives a positive area for an outer rim and a negative one for a hole. Rims locate
 * edges to within a pixel; vision/line_edge.h locates them exactly.
 */
#ifndef FG_VISION_RIMS_H
#define FG_VISION_RIMS_H

#include <stdbool.h>

#include "foilgauge/circle.h"
#include "vision/islands.h"

typedef struct fg_rim {
  fg_point *points; /* middles of the pixels' sides, px; owned */
  size_t count;
  int32_t box_px[4];   /* x, y, width, height */
  bool hole;           /* it surrounds no material */
  bool touches_border; /* touches the border of the inspected area */
} fg_rim;

typedef struct fg_rims {
  fg_rim *list; /* owned */
  size_t count, capacity;
  size_t specks; /* number of rims that are too small */
} fg_rims;

/* The two sides of the edges of an island, in 8-bit counts. */
typedef struct fg_two_levels {
  double low, high;
  bool found; /* they differ by more than noise */
} fg_two_levels;

/* Finds the threshold that best parts an island's counts into two classes (Otsu 1979), and returns
 * the medians of both. */
fg_two_levels fg_two_levels_find(const fg_tiles *tiles, const fg_island *island);

typedef struct fg_rim_options {
  double level;  /* between the two sides, 8-bit counts */
  bool light;    /* the material is the brighter side */
  double min_px; /* diagonal of the smallest box that counts */
} fg_rim_options;

/* Traces every rim of an island, in the order of their uppermost points. FG_ERR_MEMORY. */
fg_status fg_rims_trace(fg_context *ctx, const fg_tiles *tiles, const fg_island *island,
                        const fg_rim_options *options, fg_rims *rims);
void fg_rims_free(fg_rims *rims);

#endif
