/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/tiles.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"

/* Range of a tile's block means, in 8-bit counts, above which it is kept: this multiple of the
 * median step between neighbouring blocks, which a strip through the tile hardly changes. For white
 * noise the range over 64 blocks is 5 of these steps. Never below MIN (noise) nor above MAX
 * (texture must not hide a part). A tile is judged by itself alone, so that a foil is kept in the
 * same way whatever else lies on the bed. */
enum { CONTRAST_MIN = 3, CONTRAST_MAX = 12, CONTRAST_OVER_STEP = 27 };

static size_t row_bytes(const fg_tiles *tiles) {
  return (size_t)tiles->width_px * (size_t)tiles->bytes_per_pixel;
}

/* Block means in one row of blocks, those outside the scan too. */
static size_t blocks_across(const fg_tiles *tiles) {
  return (size_t)tiles->columns * FG_BLOCKS_PER_TILE;
}

fg_status fg_tiles_allocate(fg_context *ctx, fg_tiles *tiles) {
  tiles->columns = (int32_t)((tiles->width_px + FG_TILE_PX - 1) / FG_TILE_PX);
  tiles->rows = (int32_t)((tiles->height_px + FG_TILE_PX - 1) / FG_TILE_PX);
  tiles->block_columns = (int32_t)((tiles->width_px + FG_BLOCK_PX - 1) / FG_BLOCK_PX);
  tiles->block_rows = (int32_t)((tiles->height_px + FG_BLOCK_PX - 1) / FG_BLOCK_PX);
  size_t count = (size_t)tiles->columns * (size_t)tiles->rows;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof(fg_tile *), (void **)&tiles->tiles));
  FG_TRY(fg_memory_allocate(ctx, count, 1, (void **)&tiles->wanted));
  return fg_memory_allocate(ctx, count, sizeof(float), (void **)&tiles->medians);
}

static size_t strip_bytes(const fg_tiles *tiles) {
  return row_bytes(tiles) * FG_TILE_PX + blocks_across(tiles) * FG_BLOCKS_PER_TILE * sizeof(float);
}

static fg_status allocate_strip(fg_context *ctx, fg_tiles *tiles, int i) {
  FG_TRY(fg_budget_reserve(ctx, tiles->budget, strip_bytes(tiles)));
  tiles->strip_budget += strip_bytes(tiles);
  FG_TRY(fg_memory_allocate(ctx, row_bytes(tiles), FG_TILE_PX, (void **)&tiles->strips[i]));
  return fg_memory_allocate(ctx, blocks_across(tiles), FG_BLOCKS_PER_TILE * sizeof(float),
                            (void **)&tiles->strip_blocks[i]);
}

fg_status fg_tiles_create(fg_context *ctx, int64_t width_px, int64_t height_px, int bytes_per_pixel,
                          fg_budget *budget, fg_tiles *tiles) {
  *tiles = (fg_tiles){.budget = budget,
                      .width_px = width_px,
                      .height_px = height_px,
                      .bytes_per_pixel = bytes_per_pixel};
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_tiles_allocate(ctx, tiles));
  for (int i = 0; i < FG_TILE_STRIPS && i < tiles->rows; i++)
    FG_TRY_EXIT(allocate_strip(ctx, tiles, i));
exit:
  if (status != FG_OK) fg_tiles_free(tiles);
  return status;
}

int64_t fg_tiles_strip_rows(const fg_tiles *tiles, int32_t strip) {
  int64_t left = tiles->height_px - (int64_t)strip * FG_TILE_PX;
  return left < FG_TILE_PX ? left : FG_TILE_PX;
}

/* Sums of FG_BLOCK_PX rows, column by column: all rows of a column at once, so that only the sum is
 * stored. */
#define SUM_ROWS(type, narrow, name)                                                               \
  __attribute__((target_clones("avx2", "default"))) static void name(                              \
      const type *restrict r, size_t width, uint32_t *restrict sums) {                             \
    const type *r1 = r + width, *r2 = r1 + width, *r3 = r2 + width, *r4 = r3 + width,              \
               *r5 = r4 + width, *r6 = r5 + width, *r7 = r6 + width;                               \
    for (size_t x = 0; x < width; x++) {                                                           \
      narrow upper = (narrow)(r[x] + r1[x] + r2[x] + r3[x]);                                       \
      narrow lower = (narrow)(r4[x] + r5[x] + r6[x] + r7[x]);                                      \
      sums[x] = (narrow)(upper + lower);                                                           \
    }                                                                                              \
  }

SUM_ROWS(uint8_t, uint16_t, sum_rows_8)
SUM_ROWS(uint16_t, uint32_t, sum_rows_16)

/* Sums fewer rows, at the end of the scan. */
static void sum_last_rows(const fg_tiles *tiles, const uint8_t *rows, int64_t count,
                          uint32_t *sums) {
  size_t width = (size_t)tiles->width_px;
  memset(sums, 0, width * sizeof *sums);
  for (int64_t y = 0; y < count; y++) {
    const uint8_t *row = rows + (size_t)y * row_bytes(tiles);
    const uint16_t *wide = (const uint16_t *)(const void *)row;
    for (size_t x = 0; x < width; x++)
      sums[x] += tiles->bytes_per_pixel == 1 ? row[x] : wide[x];
  }
}

static void sum_rows(const fg_tiles *tiles, const uint8_t *rows, int64_t count, uint32_t *sums) {
  if (count < FG_BLOCK_PX)
    sum_last_rows(tiles, rows, count, sums);
  else if (tiles->bytes_per_pixel == 1)
    sum_rows_8(rows, (size_t)tiles->width_px, sums);
  else
    sum_rows_16((const uint16_t *)(const void *)rows, (size_t)tiles->width_px, sums);
}

/* Means of blocks that lie inside the scan with all their columns, of sums of so many rows. */
__attribute__((target_clones("avx2", "default"))) static void
average_whole_blocks(const uint32_t *restrict sums, size_t count, float unit, int64_t rows,
                     float *restrict out) {
  float pixels = (float)(FG_BLOCK_PX * rows);
  for (size_t b = 0; b < count; b++) {
    const uint32_t *s = sums + b * FG_BLOCK_PX;
    int32_t sum = (int32_t)(s[0] + s[1] + s[2] + s[3] + s[4] + s[5] + s[6] + s[7]);
    out[b] = (float)sum * unit / pixels;
  }
}

/* Block means of one row of blocks; blocks outside the scan repeat the last one inside. */
static void average_blocks(const fg_tiles *tiles, const uint32_t *sums, int64_t rows, float *out) {
  float unit = tiles->bytes_per_pixel == 1 ? 1.0f : 1.0f / 257.0f;
  size_t width = (size_t)tiles->width_px, whole = width / FG_BLOCK_PX;
  average_whole_blocks(sums, whole, unit, rows, out);
  for (size_t b = whole; b < blocks_across(tiles); b++) {
    size_t from = b * FG_BLOCK_PX;
    uint32_t sum = 0;
    for (size_t x = from; x < width; x++)
      sum += sums[x];
    out[b] =
        from < width ? (float)sum * unit / (float)((int64_t)(width - from) * rows) : out[b - 1];
  }
}

static fg_status reduce_strip(fg_context *ctx, fg_tiles *tiles, int32_t strip) {
  const uint8_t *pixels = fg_tiles_strip(tiles, strip);
  float *out = tiles->strip_blocks[strip % FG_TILE_STRIPS];
  int64_t rows = fg_tiles_strip_rows(tiles, strip);
  uint32_t *sums = NULL;
  FG_TRY(fg_memory_allocate(ctx, (size_t)tiles->width_px, sizeof *sums, (void **)&sums));
  for (int b = 0; b < FG_BLOCKS_PER_TILE; b++, out += blocks_across(tiles)) {
    int64_t from = (int64_t)b * FG_BLOCK_PX;
    if (from >= rows) {
      memcpy(out, out - blocks_across(tiles), blocks_across(tiles) * sizeof *out);
      continue;
    }
    int64_t count = rows - from < FG_BLOCK_PX ? rows - from : FG_BLOCK_PX;
    sum_rows(tiles, pixels + (size_t)from * row_bytes(tiles), count, sums);
    average_blocks(tiles, sums, count, out);
  }
  free(sums);
  return FG_OK;
}

/* Block means of one tile of a strip that is still held. */
static void copy_blocks(const fg_tiles *tiles, int32_t column, int32_t strip, float *out) {
  const float *row =
      tiles->strip_blocks[strip % FG_TILE_STRIPS] + (size_t)column * FG_BLOCKS_PER_TILE;
  for (int y = 0; y < FG_BLOCKS_PER_TILE; y++)
    memcpy(out + y * FG_BLOCKS_PER_TILE, row + (size_t)y * blocks_across(tiles),
           FG_BLOCKS_PER_TILE * sizeof *out);
}

/* Returns true when a range is many times the median step between blocks that lie side by side:
 * when it is for more than half of the steps. */
static bool is_beyond_steps(const float *blocks, float range) {
  enum { STEPS = FG_BLOCKS_PER_TILE * (FG_BLOCKS_PER_TILE - 1) };
  int small = 0;
  for (int y = 0; y < FG_BLOCKS_PER_TILE; y++)
    for (int x = 1; x < FG_BLOCKS_PER_TILE; x++) {
      const float *b = blocks + y * FG_BLOCKS_PER_TILE + x;
      small += range > CONTRAST_OVER_STEP * fabsf(b[0] - b[-1]);
    }
  return small > STEPS / 2;
}

static float brightest_of(const float *blocks, float brightest) {
  for (int i = 0; i < FG_BLOCKS_PER_TILE * FG_BLOCKS_PER_TILE; i++)
    brightest = blocks[i] > brightest ? blocks[i] : brightest;
  return brightest;
}

static bool has_contrast(const float *blocks) {
  float low = INFINITY, high = -INFINITY;
  for (int i = 0; i < FG_BLOCKS_PER_TILE * FG_BLOCKS_PER_TILE; i++) {
    low = blocks[i] < low ? blocks[i] : low;
    high = blocks[i] > high ? blocks[i] : high;
  }
  if (high - low <= CONTRAST_MIN) return false;
  return high - low > CONTRAST_MAX || is_beyond_steps(blocks, high - low);
}

static void mark_wanted(fg_tiles *tiles, int32_t strip) {
  size_t first = (size_t)strip * (size_t)tiles->columns;
  float blocks[FG_BLOCKS_PER_TILE * FG_BLOCKS_PER_TILE];
  for (int32_t c = 0; c < tiles->columns; c++) {
    copy_blocks(tiles, c, strip, blocks);
    tiles->wanted[first + (size_t)c] = has_contrast(blocks);
    tiles->brightest = brightest_of(blocks, tiles->brightest);
    tiles->medians[first + (size_t)c] = fg_select_of_few(blocks, sizeof blocks / sizeof *blocks,
                                                         sizeof blocks / sizeof *blocks / 2);
  }
}

/* Returns true when a tile is wanted, or beside a wanted one. */
static int is_kept(const fg_tiles *tiles, int32_t column, int32_t strip) {
  for (int32_t y = strip - 1; y <= strip + 1; y++)
    for (int32_t x = column - 1; x <= column + 1; x++)
      if (x >= 0 && y >= 0 && x < tiles->columns && y < tiles->rows &&
          tiles->wanted[(size_t)y * (size_t)tiles->columns + (size_t)x])
        return 1;
  return 0;
}

uint64_t fg_tiles_whole_blocks(const fg_tiles *tiles, int32_t column, int32_t row) {
  int64_t across = tiles->width_px / FG_BLOCK_PX - (int64_t)column * FG_BLOCKS_PER_TILE;
  int64_t down = tiles->height_px / FG_BLOCK_PX - (int64_t)row * FG_BLOCKS_PER_TILE;
  uint64_t bits = 0;
  for (int y = 0; y < FG_BLOCKS_PER_TILE && y < down; y++)
    for (int x = 0; x < FG_BLOCKS_PER_TILE && x < across; x++)
      bits |= (uint64_t)1 << (y * FG_BLOCKS_PER_TILE + x);
  return bits;
}

static size_t tile_bytes(const fg_tiles *tiles) {
  return sizeof(fg_tile) + FG_TILE_PX * FG_TILE_PX * (size_t)tiles->bytes_per_pixel;
}

fg_status fg_tiles_add(fg_context *ctx, fg_tiles *tiles, int32_t column, int32_t row,
                       fg_tile **tile) {
  size_t size = tile_bytes(tiles);
  FG_TRY(fg_budget_reserve(ctx, tiles->budget, size));
  fg_status status = fg_memory_allocate(ctx, 1, size, (void **)tile);
  if (status != FG_OK) {
    fg_budget_release(tiles->budget, size);
    return status;
  }
  atomic_init(&(*tile)->holders, 1);
  tiles->tiles[(size_t)row * (size_t)tiles->columns + (size_t)column] = *tile;
  return FG_OK;
}

static fg_status keep_tile(fg_context *ctx, fg_tiles *tiles, int32_t column, int32_t strip) {
  size_t width = FG_TILE_PX * (size_t)tiles->bytes_per_pixel, from = (size_t)column * width;
  const uint8_t *source = fg_tiles_strip(tiles, strip);
  fg_tile *tile = NULL;
  FG_TRY(fg_tiles_add(ctx, tiles, column, strip, &tile));
  size_t valid = from + width > row_bytes(tiles) ? row_bytes(tiles) - from : width;
  for (int64_t y = 0; y < fg_tiles_strip_rows(tiles, strip); y++)
    memcpy(tile->pixels + (size_t)y * width, source + (size_t)y * row_bytes(tiles) + from, valid);
  copy_blocks(tiles, column, strip, tile->blocks);
  return FG_OK;
}

static fg_status keep_tiles(fg_context *ctx, fg_tiles *tiles, int32_t strip) {
  for (int32_t c = 0; c < tiles->columns; c++)
    if (is_kept(tiles, c, strip)) FG_TRY(keep_tile(ctx, tiles, c, strip));
  return FG_OK;
}

fg_status fg_tiles_accept_strip(fg_context *ctx, fg_tiles *tiles) {
  int32_t strip = tiles->received;
  if (strip >= tiles->rows) return fg_fail(ctx, FG_ERR_USAGE, "more rows than the scan has");
  FG_TRY(reduce_strip(ctx, tiles, strip));
  mark_wanted(tiles, strip);
  if (strip > 0) FG_TRY(keep_tiles(ctx, tiles, strip - 1));
  tiles->received++;
  return FG_OK;
}

fg_status fg_tiles_add_strip(fg_context *ctx, fg_tiles *tiles, const void *rows,
                             int64_t stride_bytes) {
  int32_t strip = tiles->received;
  if (strip >= tiles->rows) return fg_fail(ctx, FG_ERR_USAGE, "more rows than the scan has");
  uint8_t *target = fg_tiles_strip(tiles, strip);
  for (int64_t y = 0; y < fg_tiles_strip_rows(tiles, strip); y++)
    memcpy(target + (size_t)y * row_bytes(tiles), (const uint8_t *)rows + y * stride_bytes,
           row_bytes(tiles));
  return fg_tiles_accept_strip(ctx, tiles);
}

static void free_strips(fg_tiles *tiles) {
  for (int i = 0; i < FG_TILE_STRIPS; i++) {
    free(tiles->strips[i]);
    free(tiles->strip_blocks[i]);
    tiles->strips[i] = NULL;
    tiles->strip_blocks[i] = NULL;
  }
  fg_budget_release(tiles->budget, tiles->strip_budget);
  tiles->strip_budget = 0;
}

fg_status fg_tiles_finish(fg_context *ctx, fg_tiles *tiles) {
  if (tiles->received != tiles->rows)
    return fg_fail(ctx, FG_ERR_USAGE, "fewer rows than the scan has");
  FG_TRY(keep_tiles(ctx, tiles, tiles->rows - 1));
  free_strips(tiles);
  return FG_OK;
}

static void let_go(fg_tiles *tiles, size_t at) {
  fg_tile *tile = tiles->tiles[at];
  tiles->tiles[at] = NULL;
  if (!tile || atomic_fetch_sub(&tile->holders, 1) != 1) return;
  free(tile);
  fg_budget_release(tiles->budget, tile_bytes(tiles));
}

void fg_tiles_drop(fg_tiles *tiles, int32_t column, int32_t row) {
  let_go(tiles, (size_t)row * (size_t)tiles->columns + (size_t)column);
}

void fg_tiles_share(const fg_tiles *from, int32_t column, int32_t row, fg_tiles *to,
                    int32_t to_column, int32_t to_row) {
  if (column < 0 || row < 0 || column >= from->columns || row >= from->rows) return;
  if (to_column < 0 || to_row < 0 || to_column >= to->columns || to_row >= to->rows) return;
  fg_tile *tile = from->tiles[(size_t)row * (size_t)from->columns + (size_t)column];
  fg_tile **place = &to->tiles[(size_t)to_row * (size_t)to->columns + (size_t)to_column];
  if (!tile || *place) return;
  atomic_fetch_add(&tile->holders, 1);
  *place = tile;
}

void fg_tiles_free(fg_tiles *tiles) {
  if (!tiles) return;
  if (tiles->tiles)
    for (size_t i = 0; i < (size_t)tiles->columns * (size_t)tiles->rows; i++)
      let_go(tiles, i);
  free(tiles->tiles);
  free(tiles->wanted);
  free(tiles->medians);
  free_strips(tiles);
  memset(tiles, 0, sizeof *tiles);
}
