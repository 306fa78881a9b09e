/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/sheet.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"

/* A tile of the sheet lies on up to four tiles of the scan: two spans along each axis. */
typedef struct span {
  int32_t source; /* column or row of the scan's tile */
  int from, to;   /* pixels of the sheet's tile, from ≤ i < to */
  int at;         /* place of the first of them in the scan's tile */
} span;

/* Finds the spans; pixels outside the scan belong to none. */
static int find_spans(int64_t first_px, int64_t limit_px, span spans[2]) {
  int count = 0;
  for (int from = 0; from < FG_TILE_PX;) {
    int64_t px = first_px + from;
    if (px >= limit_px) break;
    if (px < 0) {
      from = px > -FG_TILE_PX ? (int)(from - px) : FG_TILE_PX;
      continue;
    }
    int at = (int)(px % FG_TILE_PX), length = FG_TILE_PX - at;
    if (length > FG_TILE_PX - from) length = FG_TILE_PX - from;
    if (length > limit_px - px) length = (int)(limit_px - px);
    spans[count++] = (span){(int32_t)(px / FG_TILE_PX), from, from + length, at};
    from += length;
  }
  return count;
}

/* Bits of the blocks of one row or column that lie in the spans; spans[i] counts only if bit i of
 * `there` is set. */
static unsigned whole_blocks(const span *spans, int count, unsigned there) {
  unsigned bits = 0;
  for (int b = 0; b < FG_BLOCKS_PER_TILE; b++) {
    int covered = 0;
    for (int i = 0; i < count; i++) {
      int from = b * FG_BLOCK_PX, to = from + FG_BLOCK_PX;
      if (spans[i].from > from) from = spans[i].from;
      if (spans[i].to < to) to = spans[i].to;
      if (there >> i & 1 && to > from) covered += to - from;
    }
    if (covered == FG_BLOCK_PX) bits |= 1u << b;
  }
  return bits;
}

/* Finds whole blocks: every span of columns under the block exists in every span of rows. */
static uint64_t find_whole(const span *across, int columns, const span *down, int rows,
                           const unsigned there[2]) {
  uint64_t whole = 0;
  for (int b = 0; b < FG_BLOCKS_PER_TILE; b++) {
    int covered = 0;
    unsigned bits = 0xff;
    for (int i = 0; i < rows; i++) {
      int from = b * FG_BLOCK_PX, to = from + FG_BLOCK_PX;
      if (down[i].from > from) from = down[i].from;
      if (down[i].to < to) to = down[i].to;
      if (to <= from) continue;
      covered += to - from;
      bits &= whole_blocks(across, columns, there[i]);
    }
    if (covered == FG_BLOCK_PX) whole |= (uint64_t)bits << (b * FG_BLOCKS_PER_TILE);
  }
  return whole;
}

static void copy_part(const fg_tile *from, const span *x, const span *y, size_t pixel_bytes,
                      fg_tile *to) {
  size_t bytes = (size_t)(x->to - x->from) * pixel_bytes;
  for (int i = y->from; i < y->to; i++) {
    size_t source = (size_t)(y->at + i - y->from) * FG_TILE_PX + (size_t)x->at;
    size_t target = (size_t)i * FG_TILE_PX + (size_t)x->from;
    memcpy(to->pixels + target * pixel_bytes, from->pixels + source * pixel_bytes, bytes);
  }
}

/* Sum, min and max of the eight rows of a row of blocks, column by column: loops that the compiler
 * turns into a few wide instructions. */
#define REDUCE_ROWS(type)                                                                          \
  const type *rows = (const type *)(const void *)tile->pixels + first_row * FG_TILE_PX;            \
  for (int x = 0; x < FG_TILE_PX; x++) {                                                           \
    uint32_t sum = 0;                                                                              \
    type low = rows[x], high = rows[x];                                                            \
    for (int y = 0; y < FG_BLOCK_PX; y++) {                                                        \
      type value = rows[y * FG_TILE_PX + x];                                                       \
      sum += value;                                                                                \
      low = value < low ? value : low;                                                             \
      high = value > high ? value : high;                                                          \
    }                                                                                              \
    columns->sum[x] = sum;                                                                         \
    columns->low[x] = low;                                                                         \
    columns->high[x] = high;                                                                       \
  }

typedef struct column_sums {
  uint32_t sum[FG_TILE_PX];
  uint16_t low[FG_TILE_PX], high[FG_TILE_PX];
} column_sums;

static void reduce_bytes(const fg_tile *tile, int first_row, column_sums *columns) {
  REDUCE_ROWS(uint8_t)
}

static void reduce_words(const fg_tile *tile, int first_row, column_sums *columns) {
  REDUCE_ROWS(uint16_t)
}

/* Means and ranges of one row of blocks. */
static void reduce_blocks(fg_tile *tile, int row, int bytes_per_pixel, uint64_t whole,
                          fg_range *ranges) {
  column_sums c;
  bool bytes = bytes_per_pixel == 1;
  (bytes ? reduce_bytes : reduce_words)(tile, row * FG_BLOCK_PX, &c);
  for (int b = 0; b < FG_BLOCKS_PER_TILE; b++) {
    int block = row * FG_BLOCKS_PER_TILE + b, low = UINT16_MAX, high = 0;
    uint32_t sum = 0;
    for (int x = b * FG_BLOCK_PX; x < (b + 1) * FG_BLOCK_PX; x++) {
      sum += c.sum[x];
      low = c.low[x] < low ? c.low[x] : low;
      high = c.high[x] > high ? c.high[x] : high;
    }
    float mean = (float)sum * (bytes ? 1.0f : 1.0f / 257.0f) / (FG_BLOCK_PX * FG_BLOCK_PX);
    tile->blocks[block] = whole >> block & 1 ? mean : NAN;
    ranges[block] =
        (fg_range){(uint8_t)(bytes ? low : low >> 8), (uint8_t)(bytes ? high : high >> 8)};
  }
}

/* A sheet while it is cut: a row of tiles is an item of parallel work. */
typedef struct cutting {
  const fg_tiles *from;
  const fg_sheet_place *place;
  fg_sheet *sheet;
} cutting;

static fg_status cut_tile(fg_context *ctx, const cutting *c, int32_t column, int32_t row) {
  const fg_tiles *from = c->from;
  const int64_t *corner_px = c->place->corner_px;
  fg_sheet *sheet = c->sheet;
  span across[2], down[2];
  int columns = find_spans(corner_px[0] + (int64_t)column * FG_TILE_PX, from->width_px, across);
  int rows = find_spans(corner_px[1] + (int64_t)row * FG_TILE_PX, from->height_px, down);
  unsigned there[2] = {0, 0};
  for (int i = 0; i < rows; i++)
    for (int k = 0; k < columns; k++)
      if (fg_tiles_at(from, across[k].source, down[i].source)) there[i] |= 1u << k;
  uint64_t whole = find_whole(across, columns, down, rows, there);
  if (!whole) return FG_OK;
  fg_tile *tile;
  FG_TRY(fg_tiles_add(ctx, &sheet->tiles, column, row, &tile));
  for (int i = 0; i < rows; i++)
    for (int k = 0; k < columns; k++)
      if (there[i] >> k & 1)
        copy_part(fg_tiles_at(from, across[k].source, down[i].source), &across[k], &down[i],
                  (size_t)from->bytes_per_pixel, tile);
  size_t at = (size_t)row * (size_t)sheet->tiles.columns + (size_t)column;
  for (int b = 0; b < FG_BLOCKS_PER_TILE; b++)
    reduce_blocks(tile, b, from->bytes_per_pixel, whole,
                  sheet->ranges + at * FG_BLOCKS_PER_TILE * FG_BLOCKS_PER_TILE);
  sheet->whole[at] = whole;
  return FG_OK;
}

static fg_status cut_row(fg_context *ctx, void *shared, size_t row) {
  const cutting *c = shared;
  for (int32_t column = 0; column < c->place->columns; column++)
    FG_TRY(cut_tile(ctx, c, column, (int32_t)row));
  return FG_OK;
}

fg_status fg_sheet_cut(fg_context *ctx, const fg_tiles *from, const fg_sheet_place *place,
                       unsigned threads, fg_sheet *sheet) {
  size_t columns = (size_t)place->columns, rows = (size_t)place->rows;
  cutting c = {from, place, sheet};
  *sheet = (fg_sheet){.tiles = {.budget = from->budget,
                                .width_px = (int64_t)place->columns * FG_TILE_PX,
                                .height_px = (int64_t)place->rows * FG_TILE_PX,
                                .bytes_per_pixel = from->bytes_per_pixel}};
  FG_TRY(fg_tiles_allocate(ctx, &sheet->tiles));
  FG_TRY(fg_memory_allocate(ctx, columns * rows, sizeof *sheet->whole, (void **)&sheet->whole));
  FG_TRY(fg_memory_allocate(ctx, columns * rows * FG_BLOCKS_PER_TILE * FG_BLOCKS_PER_TILE,
                            sizeof *sheet->ranges, (void **)&sheet->ranges));
  return fg_parallel_run(ctx, threads, rows, cut_row, &c);
}

void fg_sheet_free(fg_sheet *sheet) {
  fg_tiles_free(&sheet->tiles);
  free(sheet->whole);
  free(sheet->ranges);
  sheet->whole = NULL;
  sheet->ranges = NULL;
}
