/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scan kept as sparse tiles: only areas that differ from the background stay in memory.
 *
 * Rows arrive in strips of FG_TILE_PX rows. Every strip is reduced to block means (FG_BLOCK_PX a
 * side). A tile whose block means differ by more than its own scatter is wanted, and kept with its
 * eight neighbours; of all others only the median stays. Memory follows the area of the foils, not
 * of the bed. The choice of kept tiles depends on the surrounding pixels alone: not on threads, not
 * on the arrival of the strips, not on other objects on the bed.
 */
#ifndef FG_VISION_TILES_H
#define FG_VISION_TILES_H

#include <math.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/memory.h"
#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
  FG_TILE_PX = 64,
  FG_BLOCK_PX = 8,
  FG_BLOCKS_PER_TILE = FG_TILE_PX / FG_BLOCK_PX,
  FG_TILE_STRIPS = 8, /* strips held until their tiles are decided */
};

/* A tile that was kept. Pixels outside the scan are 0, blocks outside repeat the last one. */
typedef struct fg_tile {
  float blocks[FG_BLOCKS_PER_TILE * FG_BLOCKS_PER_TILE]; /* means, in 8-bit counts */
  atomic_int holders;                                    /* fg_tiles that show it */
  uint8_t pixels[];                                      /* FG_TILE_PX² of 1 or 2 bytes */
} fg_tile;

typedef struct fg_tiles {
  fg_budget *budget; /* of kept tiles and held strips; NULL: no limit */
  int64_t width_px, height_px;
  int bytes_per_pixel;               /* 1 or 2 */
  int32_t columns, rows;             /* of tiles */
  int32_t block_columns, block_rows; /* of blocks inside the scan */
  fg_tile **tiles;                   /* columns × rows; NULL: background */
  float *medians;                    /* columns × rows: median of each tile's block means */
  uint8_t *wanted;                   /* columns × rows: contrast above the background's scatter */
  float brightest;                   /* of all block means, in 8-bit counts */
  int32_t received;                  /* number of received strips */
  /* of the undecided strips: */
  uint8_t *strips[FG_TILE_STRIPS];     /* rows of width_px pixels */
  float *strip_blocks[FG_TILE_STRIPS]; /* FG_BLOCKS_PER_TILE rows of columns × FG_BLOCKS_PER_TILE */
  size_t strip_budget;                 /* bytes that they reserve of the budget */
} fg_tiles;

/* `budget` (NULL: none) must outlive the tiles. */
fg_status fg_tiles_create(fg_context *ctx, int64_t width_px, int64_t height_px, int bytes_per_pixel,
                          fg_budget *budget, fg_tiles *tiles);

/* Address for the rows of a strip, one after the other without padding. It may be filled while
 * strips before it are processed, as long as strip < received + FG_TILE_STRIPS - 1. */
static inline void *fg_tiles_strip(const fg_tiles *tiles, int32_t strip) {
  return tiles->strips[strip % FG_TILE_STRIPS];
}

/* Number of rows of a strip: FG_TILE_PX, fewer in the last. */
int64_t fg_tiles_strip_rows(const fg_tiles *tiles, int32_t strip);

/* Accepts the next strip, whose rows are in place: decides the tiles of the strip before it. */
fg_status fg_tiles_accept_strip(fg_context *ctx, fg_tiles *tiles);

/* Copies rows from elsewhere, `stride_bytes` apart, and accepts them as the next strip. */
fg_status fg_tiles_add_strip(fg_context *ctx, fg_tiles *tiles, const void *rows,
                             int64_t stride_bytes);

/* Decides the last tiles; call it after the last strip. */
fg_status fg_tiles_finish(fg_context *ctx, fg_tiles *tiles);

/* Bits of a tile's blocks that lie inside the scan with all their pixels. */
uint64_t fg_tiles_whole_blocks(const fg_tiles *tiles, int32_t column, int32_t row);

/* Makes a tile of zeros where there is none. FG_ERR_MEMORY; FG_ERR_DATA: beyond the budget. */
fg_status fg_tiles_add(fg_context *ctx, fg_tiles *tiles, int32_t column, int32_t row,
                       fg_tile **tile);

/* Releases one tile. Its memory is freed with its last holder. */
void fg_tiles_drop(fg_tiles *tiles, int32_t column, int32_t row);

/* Lets `to` hold a tile of `from` as well, where both exist and `to` has none there yet. */
void fg_tiles_share(const fg_tiles *from, int32_t column, int32_t row, fg_tiles *to,
                    int32_t to_column, int32_t to_row);

/* Allocates the tables of an area whose width, height and bytes_per_pixel are set. */
fg_status fg_tiles_allocate(fg_context *ctx, fg_tiles *tiles);

void fg_tiles_free(fg_tiles *tiles);

static inline const fg_tile *fg_tiles_at(const fg_tiles *tiles, int32_t column, int32_t row) {
  return tiles->tiles[(size_t)row * (size_t)tiles->columns + (size_t)column];
}

/* Mean of a block inside the scan, in 8-bit counts; of a tile that was not kept, its median. */
static inline float fg_tiles_block(const fg_tiles *tiles, int32_t x, int32_t y) {
  int32_t column = x / FG_BLOCKS_PER_TILE, row = y / FG_BLOCKS_PER_TILE;
  size_t at = (size_t)row * (size_t)tiles->columns + (size_t)column;
  const fg_tile *tile = tiles->tiles[at];
  if (!tile) return tiles->medians[at];
  return tile->blocks[y % FG_BLOCKS_PER_TILE * FG_BLOCKS_PER_TILE + x % FG_BLOCKS_PER_TILE];
}

/* A tile's pixel, counted row by row, in 8-bit counts (16-bit data are divided by 257). */
static inline float fg_tile_value(const fg_tiles *tiles, const fg_tile *tile, size_t at) {
  if (tiles->bytes_per_pixel == 1) return (float)tile->pixels[at];
  return (float)((const uint16_t *)(const void *)tile->pixels)[at] * (1.0f / 257.0f);
}

/* The pixel's value in 8-bit counts, NaN where it is not kept or outside the scan. */
static inline float fg_tiles_pixel(const fg_tiles *tiles, int64_t x, int64_t y) {
  if (x < 0 || y < 0 || x >= tiles->width_px || y >= tiles->height_px) return NAN;
  size_t ux = (size_t)x, uy = (size_t)y;
  const fg_tile *tile = tiles->tiles[uy / FG_TILE_PX * (size_t)tiles->columns + ux / FG_TILE_PX];
  if (!tile) return NAN;
  return fg_tile_value(tiles, tile, uy % FG_TILE_PX * FG_TILE_PX + ux % FG_TILE_PX);
}

#ifdef __cplusplus
}
#endif
#endif
