/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/reduce.h"

#include <string.h>

#include "core/memory.h"

enum { SIDE_MAX = 32767 };

static uint8_t to_byte(double value) {
  return (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value + 0.5);
}

/* Mean of the blocks under a cell. */
static uint8_t from_blocks(const fg_tiles *tiles, const fg_reduced *r, int32_t i, int32_t j) {
  int64_t cell = r->cell_px, sum_of = 0;
  int64_t x0 = i * cell / FG_BLOCK_PX, y0 = j * cell / FG_BLOCK_PX;
  int64_t n = cell > FG_BLOCK_PX ? cell / FG_BLOCK_PX : 1;
  double sum = 0;
  for (int64_t y = y0; y < y0 + n && y < tiles->block_rows; y++)
    for (int64_t x = x0; x < x0 + n && x < tiles->block_columns; x++, sum_of++)
      sum += (double)fg_tiles_block(tiles, (int32_t)x, (int32_t)y);
  return to_byte(sum / (double)(sum_of ? sum_of : 1));
}

/* Mean of the pixels under a cell; the cell lies in one tile that was kept. */
static uint8_t from_pixels(const fg_tiles *tiles, const void *tile, int32_t cell_px, size_t first) {
  uint32_t sum = 0, n = (uint32_t)(cell_px * cell_px);
  for (int32_t y = 0; y < cell_px; y++)
    for (int32_t x = 0; x < cell_px; x++) {
      size_t at = first + (size_t)y * FG_TILE_PX + (size_t)x;
      sum +=
          tiles->bytes_per_pixel == 1 ? ((const uint8_t *)tile)[at] : ((const uint16_t *)tile)[at];
    }
  return to_byte((double)sum / n / (tiles->bytes_per_pixel == 1 ? 1 : 257));
}

static uint8_t cell_at(const fg_tiles *tiles, const fg_reduced *r, int32_t i, int32_t j) {
  if (r->cell_px >= FG_BLOCK_PX) return from_blocks(tiles, r, i, j);
  int64_t x = (int64_t)i * r->cell_px, y = (int64_t)j * r->cell_px;
  const fg_tile *tile = fg_tiles_at(tiles, (int32_t)(x / FG_TILE_PX), (int32_t)(y / FG_TILE_PX));
  if (!tile) return from_blocks(tiles, r, i, j);
  return from_pixels(tiles, tile->pixels, r->cell_px,
                     (size_t)(y % FG_TILE_PX) * FG_TILE_PX + (size_t)(x % FG_TILE_PX));
}

fg_status fg_reduce(fg_context *ctx, const fg_tiles *tiles, int64_t cells_max, fg_reduced *out) {
  int64_t cell = 2;
  memset(out, 0, sizeof *out);
  while ((tiles->width_px / cell) * (tiles->height_px / cell) > cells_max ||
         tiles->width_px / cell > SIDE_MAX || tiles->height_px / cell > SIDE_MAX)
    cell *= 2;
  out->cell_px = (int32_t)cell;
  out->width = (int32_t)(tiles->width_px / cell);
  out->height = (int32_t)(tiles->height_px / cell);
  FG_TRY(fg_memory_allocate(ctx, (size_t)out->width, (size_t)out->height, (void **)&out->cells));
  for (int32_t j = 0; j < out->height; j++)
    for (int32_t i = 0; i < out->width; i++)
      out->cells[(size_t)j * (size_t)out->width + (size_t)i] = cell_at(tiles, out, i, j);
  return FG_OK;
}
