/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scan in little: one byte per cell, whole in memory. */
#ifndef FG_VISION_REDUCE_H
#define FG_VISION_REDUCE_H

#include "vision/tiles.h"

typedef struct fg_reduced {
  uint8_t *cells; /* width × height; owned */
  int32_t width, height;
  int32_t cell_px; /* a cell is the mean of cell_px × cell_px pixels */
} fg_reduced;

/* The finest reduction (2, 4, 8, ... px) that has at most `cells_max` cells. Where a tile was not
 * kept its block means stand for the pixels. The caller frees `cells`. */
fg_status fg_reduce(fg_context *ctx, const fg_tiles *tiles, int64_t cells_max, fg_reduced *out);

#endif
