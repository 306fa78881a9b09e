/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/rims.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "vision/levels.h"

enum {
  ROW_STEP = 4, /* rims that no such row crosses are specks */
  COUNTS = FG_LEVEL_COUNTS,
  CONTRAST_MIN = 12, /* counts */
};
/* Min difference of the levels, in spreads of the counts on either side. */
#define CONTRAST_SPREADS 3.0

/* Directions of a rim: right, down, left, up as the scan is seen. */
static const int32_t step_x[4] = {1, 0, -1, 0}, step_y[4] = {0, 1, 0, -1};

typedef struct tracer {
  const fg_tiles *tiles;
  double limit;
  bool light;
  uint8_t *mine; /* true for tiles of the island */
  uint8_t *seen; /* a bit per upright side of a pixel, in every ROW_STEP-th row */
  size_t row_bytes;
  fg_point *points; /* of the rim in work */
  size_t count, capacity;
} tracer;

static bool is_hot(const tracer *t, int32_t x, int32_t y) {
  const fg_tiles *tiles = t->tiles;
  if (x < 0 || y < 0 || x >= tiles->width_px || y >= tiles->height_px) return false;
  float value = fg_tiles_pixel(tiles, x, y);
  if (isnan(value))
    value =
        tiles
            ->medians[(size_t)(y / FG_TILE_PX) * (size_t)tiles->columns + (size_t)(x / FG_TILE_PX)];
  return (value > (float)t->limit) == t->light;
}

static bool is_seen(const tracer *t, int32_t x, int32_t y) {
  return t->seen[(size_t)(y / ROW_STEP) * t->row_bytes + (size_t)x / 8] >> (x % 8) & 1;
}

static void mark_seen(const tracer *t, int32_t x, int32_t y) {
  if (y % ROW_STEP == 0)
    t->seen[(size_t)(y / ROW_STEP) * t->row_bytes + (size_t)x / 8] |= (uint8_t)(1u << (x % 8));
}

/* Returns the direction after the corner (x, y): diagonal neighbours are connected. Pixel (i, j)
 * has its corners at (i, j) to (i + 1, j + 1). */
static int turn_at(const tracer *t, int32_t x, int32_t y, int way) {
  static const int32_t right_x[4] = {0, -1, -1, 0}, right_y[4] = {0, 0, -1, -1};
  int cold =
      (way + 3) % 4; /* the pixel ahead on the other side is to the right of this direction */
  if (is_hot(t, x + right_x[cold], y + right_y[cold])) return cold;
  return is_hot(t, x + right_x[way], y + right_y[way]) ? way : (way + 1) % 4;
}

static fg_status follow_rim(fg_context *ctx, tracer *t, int32_t x0, int32_t y0, int way0) {
  int32_t x = x0, y = y0;
  int way = way0;
  t->count = 0;
  do {
    FG_TRY(
        fg_memory_reserve(ctx, t->count + 1, sizeof *t->points, &t->capacity, (void **)&t->points));
    t->points[t->count++] = (fg_point){x + 0.5 * step_x[way] - 0.5, y + 0.5 * step_y[way] - 0.5};
    if (way == 1) mark_seen(t, x, y);
    if (way == 3) mark_seen(t, x, y - 1);
    x += step_x[way];
    y += step_y[way];
    way = turn_at(t, x, y, way);
  } while (x != x0 || y != y0 || way != way0);
  return FG_OK;
}

static void describe_rim(const tracer *t, fg_rim *rim) {
  double area = 0, low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (size_t i = 0; i < t->count; i++) {
    const fg_point *p = &t->points[i], *q = &t->points[i + 1 < t->count ? i + 1 : 0];
    area += p->x * q->y - p->y * q->x;
    low[0] = fmin(low[0], p->x);
    low[1] = fmin(low[1], p->y);
    high[0] = fmax(high[0], p->x);
    high[1] = fmax(high[1], p->y);
  }
  for (int k = 0; k < 2; k++) {
    rim->box_px[k] = (int32_t)floor(low[k]);
    rim->box_px[2 + k] = (int32_t)ceil(high[k] - low[k]) + 1;
  }
  rim->hole = area < 0;
  rim->touches_border = low[0] < 1 || low[1] < 1 || high[0] > (double)t->tiles->width_px - 2 ||
                        high[1] > (double)t->tiles->height_px - 2;
}

static fg_status keep_rim(fg_context *ctx, const tracer *t, double min_px, fg_rims *rims) {
  fg_rim rim = {.count = t->count};
  describe_rim(t, &rim);
  if (hypot(rim.box_px[2], rim.box_px[3]) < min_px) {
    rims->specks++;
    return FG_OK;
  }
  FG_TRY(fg_memory_reserve(ctx, rims->count + 1, sizeof *rims->list, &rims->capacity,
                           (void **)&rims->list));
  FG_TRY(fg_memory_allocate(ctx, t->count, sizeof *rim.points, (void **)&rim.points));
  memcpy(rim.points, t->points, t->count * sizeof *rim.points);
  rims->list[rims->count++] = rim;
  return FG_OK;
}

/* Traces the rims that cross a row of one tile. */
static fg_status trace_row(fg_context *ctx, tracer *t, int32_t x0, int32_t y, double min_px,
                           fg_rims *rims) {
  int32_t end = x0 + FG_TILE_PX;
  if (end > t->tiles->width_px) end = (int32_t)t->tiles->width_px + 1;
  bool left = is_hot(t, x0 - 1, y);
  for (int32_t x = x0; x < end; x++) {
    bool right = is_hot(t, x, y);
    if (left != right && !is_seen(t, x, y)) {
      FG_TRY(left ? follow_rim(ctx, t, x, y, 1) : follow_rim(ctx, t, x, y + 1, 3));
      FG_TRY(keep_rim(ctx, t, min_px, rims));
    }
    left = right;
  }
  return FG_OK;
}

static fg_status trace_tiles(fg_context *ctx, tracer *t, double min_px, fg_rims *rims) {
  for (int32_t row = 0; row < t->tiles->rows; row++)
    for (int32_t y = row * FG_TILE_PX; y < (row + 1) * FG_TILE_PX; y += ROW_STEP)
      for (int32_t column = 0; column < t->tiles->columns && y < t->tiles->height_px; column++)
        if (t->mine[(size_t)row * (size_t)t->tiles->columns + (size_t)column])
          FG_TRY(trace_row(ctx, t, column * FG_TILE_PX, y, min_px, rims));
  return FG_OK;
}

fg_status fg_rims_trace(fg_context *ctx, const fg_tiles *tiles, const fg_island *island,
                        const fg_rim_options *options, fg_rims *rims) {
  tracer t = {.tiles = tiles, .limit = options->level, .light = options->light};
  fg_status status = FG_OK;
  memset(rims, 0, sizeof *rims);
  t.row_bytes = (size_t)tiles->width_px / 8 + 1;
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, (size_t)tiles->columns, (size_t)tiles->rows, (void **)&t.mine));
  FG_TRY_EXIT(fg_memory_allocate(ctx, (size_t)tiles->height_px / ROW_STEP + 1, t.row_bytes,
                                 (void **)&t.seen));
  for (size_t i = 0; i < island->count; i++)
    t.mine[island->tiles[i]] = 1;
  FG_TRY_EXIT(trace_tiles(ctx, &t, options->min_px, rims));
exit:
  free(t.mine);
  free(t.seen);
  free(t.points);
  if (status != FG_OK) fg_rims_free(rims);
  return status;
}

void fg_rims_free(fg_rims *rims) {
  for (size_t i = 0; i < rims->count; i++)
    free(rims->list[i].points);
  free(rims->list);
  memset(rims, 0, sizeof *rims);
}

/* Returns the count that parts the two classes: the one with the largest distance of their means.
 */
static int part_counts(const size_t counts[COUNTS]) {
  double total = 0, moment = 0, below = 0, below_moment = 0, best = -1;
  int at = 0;
  for (int i = 0; i < COUNTS; i++) {
    total += (double)counts[i];
    moment += (double)counts[i] * i;
  }
  for (int i = 0; i < COUNTS - 1; i++) {
    below += (double)counts[i];
    below_moment += (double)counts[i] * i;
    if (below <= 0 || below >= total) continue;
    double apart = below_moment / below - (moment - below_moment) / (total - below);
    double between = below * (total - below) * apart * apart;
    if (between > best) {
      best = between;
      at = i;
    }
  }
  return at;
}

/* Returns the count below which that share of those from `first` to `last` lies, with its fraction.
 */
static double class_quantile(const size_t counts[COUNTS], int first, int last, double share) {
  double total = 0, below = 0;
  for (int i = first; i <= last; i++)
    total += (double)counts[i];
  for (int i = first; i <= last; i++) {
    double here = (double)counts[i];
    if (below + here > share * total) return i + (share * total - below) / here;
    below += here;
  }
  return last + 0.5;
}

/* Counts every fourth row of a tile's pixels inside the scan. */
static void count_tile(const fg_tiles *tiles, size_t at, size_t counts[COUNTS]) {
  const fg_tile *tile = tiles->tiles[at];
  int64_t x0 = (int64_t)(at % (size_t)tiles->columns) * FG_TILE_PX;
  int64_t y0 = (int64_t)(at / (size_t)tiles->columns) * FG_TILE_PX;
  for (size_t y = 0; tile && y < FG_TILE_PX && y0 + (int64_t)y < tiles->height_px; y += ROW_STEP)
    for (size_t x = 0; x < FG_TILE_PX && x0 + (int64_t)x < tiles->width_px; x++)
      counts[fg_tile_count(tile, tiles->bytes_per_pixel, y * FG_TILE_PX + x)]++;
}

fg_two_levels fg_two_levels_find(const fg_tiles *tiles, const fg_island *island) {
  size_t counts[COUNTS] = {0};
  for (size_t i = 0; i < island->count; i++)
    count_tile(tiles, (size_t)island->tiles[i], counts);
  int middle = part_counts(counts);
  fg_two_levels levels = {.low = class_quantile(counts, 0, middle, 0.5),
                          .high = class_quantile(counts, middle + 1, COUNTS - 1, 0.5)};
  /* The upper quartile of the lower class and the lower one of the upper are its spreads without
   * the pixels of the edges between them. */
  double spread = fmax(levels.low - class_quantile(counts, 0, middle, 0.16),
                       class_quantile(counts, middle + 1, COUNTS - 1, 0.84) - levels.high);
  double contrast = levels.high - levels.low;
  levels.found = contrast > CONTRAST_MIN && contrast > CONTRAST_SPREADS * spread;
  return levels;
}
