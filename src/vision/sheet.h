/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pixels of tiles on other tiles: the same picture, cut from another corner. */
#ifndef FG_VISION_SHEET_H
#define FG_VISION_SHEET_H

#include "vision/tiles.h"

/* Min and max count of a block, 8 bit, rounded down. */
typedef struct fg_range {
  uint8_t low, high;
} fg_range;

/* Tiles whose corner lies at corner_px of those they were cut from. A block is whole when all its
 * pixels were there. The mean of any other block is NaN, and its pixels are invalid. */
typedef struct fg_sheet {
  fg_tiles tiles;
  uint64_t *whole;  /* of each tile: a bit per block, row by row */
  fg_range *ranges; /* of each tile's blocks, as in fg_tile */
} fg_sheet;

/* Place of a sheet: its corner, on the tiles it is cut from, and its size in tiles. */
typedef struct fg_sheet_place {
  int64_t corner_px[2];
  int32_t columns, rows;
} fg_sheet_place;

/* Cuts a sheet on up to `threads` threads. FG_ERR_MEMORY; FG_ERR_DATA beyond the budget. The caller
 * frees the sheet, also after an error. */
fg_status fg_sheet_cut(fg_context *ctx, const fg_tiles *from, const fg_sheet_place *place,
                       unsigned threads, fg_sheet *sheet);
void fg_sheet_free(fg_sheet *sheet);

#endif
