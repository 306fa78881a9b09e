/* A scan kept as sparse tiles: only what differs from the background stays in memory.
 *
 * Rows arrive in strips of FG_TILE_PX rows. Every strip is reduced to block means (FG_BLOCK_PX a
 * side); a tile whose block means differ by more than the background's own scatter is kept with
 * its eight neighbours, all others are forgotten. Memory follows the area of the foils, not of the
 * bed. Keeping a tile depends on the rows alone, not on threads or on how the strips arrive.
 */
#ifndef FG_VISION_TILES_H
#define FG_VISION_TILES_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { FG_TILE_PX = 64, FG_BLOCK_PX = 8, FG_BLOCKS_PER_TILE = FG_TILE_PX / FG_BLOCK_PX };

typedef struct fg_tiles {
  int64_t width_px, height_px;
  int bytes_per_pixel;                 /* 1 or 2 */
  int32_t columns, rows;               /* of tiles */
  int32_t block_columns, block_rows;   /* FG_BLOCKS_PER_TILE × as many; the last may lie outside */
  void **pixels;                       /* columns × rows; NULL: background */
  float *blocks;                       /* block means, in 8-bit counts; outside: the edge's value */
  float *medians;                      /* columns × rows: median of each tile's block means */
  /* the window of strips that are still undecided */
  void *strips[3];                     /* rows of width_px pixels each */
  uint8_t *wanted;                     /* columns × rows: contrast above the background's scatter */
  int32_t received;                    /* strips so far */
} fg_tiles;

fg_status fg_tiles_create(fg_context *ctx, int64_t width_px, int64_t height_px,
                          int bytes_per_pixel, fg_tiles *tiles);

/* The next strip: FG_TILE_PX rows (the last may have fewer), `stride_bytes` apart. */
fg_status fg_tiles_add_strip(fg_context *ctx, fg_tiles *tiles, const void *rows,
                             int64_t stride_bytes);

/* After the last strip. */
fg_status fg_tiles_finish(fg_context *ctx, fg_tiles *tiles);

void fg_tiles_free(fg_tiles *tiles);

/* The pixel's value in 8-bit counts (16-bit data are divided by 257), NaN where it is not kept or
 * outside the scan. */
static inline float fg_tiles_pixel(const fg_tiles *tiles, int64_t x, int64_t y) {
  if (x < 0 || y < 0 || x >= tiles->width_px || y >= tiles->height_px) return NAN;
  const void *tile = tiles->pixels[(size_t)(y / FG_TILE_PX) * (size_t)tiles->columns +
                                   (size_t)(x / FG_TILE_PX)];
  if (!tile) return NAN;
  size_t at = (size_t)(y % FG_TILE_PX) * FG_TILE_PX + (size_t)(x % FG_TILE_PX);
  if (tiles->bytes_per_pixel == 1) return (float)((const uint8_t *)tile)[at];
  return (float)((const uint16_t *)tile)[at] * (1.0f / 257.0f);
}

#ifdef __cplusplus
}
#endif
#endif
