/* Pixels of tiles on other tiles: the same picture, cut from another corner. */
#ifndef FG_VISION_SHEET_H
#define FG_VISION_SHEET_H

#include "vision/tiles.h"

/* Tiles whose corner lies at corner_px of those they were cut from. A block is whole when all its
 * pixels were there; the mean of any other is NaN, and its pixels say nothing. */
typedef struct fg_sheet {
  fg_tiles tiles;
  uint64_t *whole; /* of each tile: a bit per block, row by row */
} fg_sheet;

/* Cuts columns × rows of tiles. FG_ERR_MEMORY; FG_ERR_DATA when they go beyond the budget. The
 * caller frees the sheet, also after an error. */
fg_status fg_sheet_cut(fg_context *ctx, const fg_tiles *from, const int64_t corner_px[2],
                       int32_t columns, int32_t rows, fg_sheet *sheet);
void fg_sheet_free(fg_sheet *sheet);

static inline bool fg_sheet_is_whole(const fg_sheet *sheet, int32_t x, int32_t y) {
  int32_t column = x / FG_BLOCKS_PER_TILE, row = y / FG_BLOCKS_PER_TILE;
  size_t at = (size_t)row * (size_t)sheet->tiles.columns + (size_t)column;
  int bit = y % FG_BLOCKS_PER_TILE * FG_BLOCKS_PER_TILE + x % FG_BLOCKS_PER_TILE;
  return sheet->whole[at] >> bit & 1;
}

#endif
