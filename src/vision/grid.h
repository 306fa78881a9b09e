/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Small grids of cells: connected parts of a mask, and medians over neighbours. */
#ifndef FG_VISION_GRID_H
#define FG_VISION_GRID_H

#include <stdint.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One connected component of a mask. */
typedef struct fg_blob {
  int32_t x, y, width, height; /* bounding box */
  int32_t area;                /* cells */
} fg_blob;

/* Labels the 8-connected components of a mask (0 is background): labels[y * width + x] is 0 for
 * background, else 1 + the index into *blobs, which come in reading order of their first cells. The
 * caller frees *blobs. FG_ERR_MEMORY. */
fg_status fg_grid_label(fg_context *ctx, const uint8_t *mask, int32_t width, int32_t height,
                        int32_t *labels, fg_blob **blobs, int32_t *blob_count);

/* Median over 5 × 5 of a grid, in place, borders repeated. NaN cells are unknown: they do not
 * count. They become the median of their known neighbours, or of the whole grid where none is known
 * (0 in an unknown grid). FG_ERR_MEMORY. */
fg_status fg_grid_median(fg_context *ctx, float *grid, int32_t width, int32_t height);

#ifdef __cplusplus
}
#endif
#endif
