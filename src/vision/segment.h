/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Segmentation of an island: the blocks that belong to objects which differ from the background.
 *
 * Works on the block means of fg_tiles. The background is the median of each tile, smoothed over
 * neighbours, so that uneven illumination does not count. The sign of the larger part of the
 * contrast decides the polarity. Nothing outside the island and its neighbours plays a part: a foil
 * on a full bed is segmented as if it were alone.
 */
#ifndef FG_VISION_SEGMENT_H
#define FG_VISION_SEGMENT_H

#include <stdbool.h>

#include "vision/islands.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_object {
  int32_t label;               /* its value in `labels` */
  int32_t x, y, width, height; /* bounding box in blocks of the scan */
  int32_t blocks;              /* number of blocks */
  bool touches_border;         /* within one block of the scan's border */
} fg_object;

typedef struct fg_segmentation {
  const fg_tiles *tiles;                           /* the scan's; must outlive this */
  int32_t x, y, width, height;                     /* the island's box in blocks of the scan */
  int32_t grid_x, grid_y, grid_columns, grid_rows; /* tiles that `grid` covers */
  float *grid;                                     /* background at tile centres, 8-bit counts */
  int32_t *labels; /* width × height: 0 background, else 1 + object of the mask */
  bool light_on_dark;
  float contrast;     /* typical excess of the objects, 8-bit counts */
  float noise;        /* sd of background block means, 8-bit counts */
  fg_object *objects; /* objects of at least min_px, in reading order of their boxes; owned */
  size_t object_count;
  size_t speck_count; /* number of smaller objects, which are ignored */
} fg_segmentation;

/* Background at the centre of a block of the scan, bilinear between tile centres. */
static inline float fg_segmentation_background(const fg_segmentation *s, int32_t x, int32_t y) {
  float u = ((float)x + 0.5f) / FG_BLOCKS_PER_TILE - 0.5f - (float)s->grid_x;
  float v = ((float)y + 0.5f) / FG_BLOCKS_PER_TILE - 0.5f - (float)s->grid_y;
  float right = (float)(s->grid_columns - 1), low = (float)(s->grid_rows - 1);
  u = u < 0 ? 0 : u > right ? right : u;
  v = v < 0 ? 0 : v > low ? low : v;
  int32_t i = (int32_t)u, j = (int32_t)v;
  int32_t i1 = i + 1 < s->grid_columns ? i + 1 : i, j1 = j + 1 < s->grid_rows ? j + 1 : j;
  float fu = u - (float)i, fv = v - (float)j;
  const float *a = s->grid + (size_t)j * (size_t)s->grid_columns;
  const float *b = s->grid + (size_t)j1 * (size_t)s->grid_columns;
  return (1 - fv) * ((1 - fu) * a[i] + fu * a[i1]) + fv * ((1 - fu) * b[i] + fu * b[i1]);
}

/* Block mean minus background, positive inside objects; x, y are of the scan. */
static inline float fg_segmentation_excess(const fg_segmentation *s, int32_t x, int32_t y) {
  float excess = fg_tiles_block(s->tiles, x, y) - fg_segmentation_background(s, x, y);
  return s->light_on_dark ? excess : -excess;
}

/* Label of a block of the scan; 0 outside the island's box. */
static inline int32_t fg_segmentation_label(const fg_segmentation *s, int32_t x, int32_t y) {
  int32_t u = x - s->x, v = y - s->y;
  if (u < 0 || v < 0 || u >= s->width || v >= s->height) return 0;
  return s->labels[(size_t)v * (size_t)s->width + (size_t)u];
}

/* Finds the objects whose box has a diagonal of at least `min_px`. None is no error here. */
fg_status fg_segment(fg_context *ctx, const fg_tiles *tiles, const fg_island *island, double min_px,
                     fg_segmentation *segmentation);

void fg_segmentation_free(fg_segmentation *segmentation);

#ifdef __cplusplus
}
#endif
#endif
