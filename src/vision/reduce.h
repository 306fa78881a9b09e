/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A reduced copy of a scan: one byte per cell, whole in memory. */
#ifndef FG_VISION_REDUCE_H
#define FG_VISION_REDUCE_H

#include "vision/tiles.h"

typedef struct fg_reduced {
  uint8_t *cells; /* width × height; owned */
  int32_t width, height;
  int32_t cell_px; /* a cell is the mean of cell_px × cell_px pixels */
} fg_reduced;

/* Makes the finest reduction (2, 4, 8, ... px) of at most `cells_max` cells. Block means stand for
 * the pixels of tiles that were not kept. The caller frees `cells`. */
fg_status fg_reduce(fg_context *ctx, const fg_tiles *tiles, int64_t cells_max, fg_reduced *out);

#endif
