/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/segment.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "vision/grid.h"

/* A block belongs to an object when its excess is above this share of the typical contrast and
 * this many standard deviations of the background. */
#define MASK_SHARE  0.3f
#define MASK_SIGMAS 6.0f
/* Min contrast of an object, 8-bit counts. */
#define CONTRAST_MIN 8.0f

static int compare_floats(const void *a, const void *b) {
  float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

enum { BACKGROUND_REACH = 3 }; /* tiles beyond the island that contribute to its background */

static int32_t clamp_index(int32_t value, int32_t low, int32_t high) {
  return value < low ? low : value > high ? high : value;
}

/* Fills the smoothed medians of the island's box and its surroundings. */
static fg_status find_background(fg_context *ctx, const fg_island *island, fg_segmentation *out) {
  const fg_tiles *tiles = out->tiles;
  out->grid_x = clamp_index(island->x - BACKGROUND_REACH, 0, tiles->columns - 1);
  out->grid_y = clamp_index(island->y - BACKGROUND_REACH, 0, tiles->rows - 1);
  int32_t right = clamp_index(island->x + island->width + BACKGROUND_REACH, 1, tiles->columns);
  int32_t low = clamp_index(island->y + island->height + BACKGROUND_REACH, 1, tiles->rows);
  out->grid_columns = right - out->grid_x;
  out->grid_rows = low - out->grid_y;
  size_t width = (size_t)out->grid_columns;
  FG_TRY(fg_memory_allocate(ctx, width * (size_t)out->grid_rows, sizeof *out->grid,
                            (void **)&out->grid));
  for (int32_t y = 0; y < out->grid_rows; y++)
    memcpy(out->grid + (size_t)y * width,
           tiles->medians + (size_t)(y + out->grid_y) * (size_t)tiles->columns +
               (size_t)out->grid_x,
           width * sizeof *out->grid);
  return fg_grid_median(ctx, out->grid, out->grid_columns, out->grid_rows);
}

/* Visitor of every block of one tile inside the scan; the excess is NaN where it is not known. */
typedef void visit_block(fg_segmentation *out, int32_t x, int32_t y, float excess, void *data);

static void visit_tile(fg_segmentation *out, int32_t column, int32_t row, visit_block *visit,
                       void *data) {
  for (int32_t y = row * FG_BLOCKS_PER_TILE; y < (row + 1) * FG_BLOCKS_PER_TILE; y++)
    for (int32_t x = column * FG_BLOCKS_PER_TILE; x < (column + 1) * FG_BLOCKS_PER_TILE; x++)
      if (x < out->tiles->block_columns && y < out->tiles->block_rows)
        visit(out, x, y, fg_segmentation_excess(out, x, y), data);
}

static void visit_island(fg_segmentation *out, const fg_island *island, visit_block *visit,
                         void *data) {
  for (size_t i = 0; i < island->count; i++)
    visit_tile(out, island->tiles[i] % out->tiles->columns, island->tiles[i] / out->tiles->columns,
               visit, data);
}

typedef struct sample {
  float *values;
  size_t count;
} sample;

static void add_sample(fg_segmentation *out, int32_t x, int32_t y, float excess, void *data) {
  (void)out;
  sample *s = data;
  if ((x + y) % 3 == 0 && !isnan(excess)) s->values[s->count++] = fabsf(excess);
}

/* Robust sd of the background: the median of |excess| over the tiles around the island that are not
 * wanted, where the excess is mostly noise. */
static fg_status estimate_noise(fg_context *ctx, const fg_island *island, fg_segmentation *out) {
  enum { TILES_MAX = 64, BLOCKS = FG_BLOCKS_PER_TILE * FG_BLOCKS_PER_TILE };
  const fg_tiles *tiles = out->tiles;
  sample s = {0};
  size_t taken = 0, stride = island->count / TILES_MAX + 1;
  FG_TRY(fg_memory_allocate(ctx, (size_t)TILES_MAX * 9 * BLOCKS, sizeof *s.values,
                            (void **)&s.values));
  for (size_t i = 0; i < island->count && taken < TILES_MAX; i += stride, taken++) {
    int32_t column = island->tiles[i] % tiles->columns, row = island->tiles[i] / tiles->columns;
    for (int32_t y = row - 1; y <= row + 1; y++)
      for (int32_t x = column - 1; x <= column + 1; x++)
        if (x >= 0 && y >= 0 && x < tiles->columns && y < tiles->rows && fg_tiles_at(tiles, x, y) &&
            !tiles->wanted[(size_t)y * (size_t)tiles->columns + (size_t)x])
          visit_tile(out, x, y, add_sample, &s);
  }
  fg_sort_items(s.values, s.count, sizeof *s.values, compare_floats);
  out->noise = (s.count ? 1.4826f * s.values[s.count / 2] : 0) + 0.02f;
  free(s.values);
  return FG_OK;
}

/* Blocks beyond the noise: sums of both signs and a histogram of either's excess in counts. */
typedef struct tally {
  float limit;
  double light, dark;
  size_t light_counts[256], dark_counts[256];
} tally;

static void tally_block(fg_segmentation *out, int32_t x, int32_t y, float excess, void *data) {
  (void)out;
  (void)x;
  (void)y;
  tally *t = data;
  int bin = (int)fminf(fabsf(excess), 255);
  if (excess > t->limit) {
    t->light += excess;
    t->light_counts[bin]++;
  } else if (excess < -t->limit) {
    t->dark -= excess;
    t->dark_counts[bin]++;
  }
}

/* Polarity by the larger sum beyond the noise; the typical contrast is the 80th percentile of
 * those blocks. */
static void find_polarity(const fg_island *island, fg_segmentation *out) {
  tally t = {.limit = fmaxf(MASK_SIGMAS * out->noise, 0.5f * CONTRAST_MIN)};
  out->light_on_dark = true;
  visit_island(out, island, tally_block, &t);
  out->light_on_dark = t.light >= t.dark;
  const size_t *counts = out->light_on_dark ? t.light_counts : t.dark_counts;
  size_t total = 0, below = 0;
  int bin = 0;
  for (int i = 0; i < 256; i++)
    total += counts[i];
  while (bin < 255 && below + counts[bin] <= total * 4 / 5)
    below += counts[bin++];
  out->contrast = total ? (float)bin + 0.5f : 0;
}

static int compare_objects(const void *a, const void *b) {
  const fg_object *x = a, *y = b;
  if (x->y != y->y) return (x->y > y->y) - (x->y < y->y);
  return (x->x > y->x) - (x->x < y->x);
}

static fg_status collect_objects(fg_context *ctx, const fg_blob *blobs, int32_t blob_count,
                                 double min_px, fg_segmentation *out) {
  FG_TRY(fg_memory_allocate(ctx, (size_t)blob_count, sizeof *out->objects, (void **)&out->objects));
  for (int32_t i = 0; i < blob_count; i++) {
    const fg_blob *b = &blobs[i];
    if (hypot((double)b->width, (double)b->height) * FG_BLOCK_PX < min_px) {
      out->speck_count++;
      continue;
    }
    int32_t x = b->x + out->x, y = b->y + out->y;
    out->objects[out->object_count++] = (fg_object){
        .label = i + 1,
        .x = x,
        .y = y,
        .width = b->width,
        .height = b->height,
        .blocks = b->area,
        .touches_border = x <= 0 || y <= 0 || x + b->width >= out->tiles->block_columns ||
                          y + b->height >= out->tiles->block_rows};
  }
  if (out->object_count)
    fg_sort_items(out->objects, out->object_count, sizeof *out->objects, compare_objects);
  return FG_OK;
}

typedef struct mask {
  uint8_t *cells;
  float limit;
} mask;

static void mark_block(fg_segmentation *out, int32_t x, int32_t y, float excess, void *data) {
  mask *m = data;
  m->cells[(size_t)(y - out->y) * (size_t)out->width + (size_t)(x - out->x)] = excess > m->limit;
}

static fg_status label_objects(fg_context *ctx, const fg_island *island, double min_px,
                               fg_segmentation *out) {
  size_t count = (size_t)out->width * (size_t)out->height;
  mask m = {.limit = fmaxf(MASK_SIGMAS * out->noise, MASK_SHARE * out->contrast)};
  fg_blob *blobs = NULL;
  int32_t blob_count = 0;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, 1, (void **)&m.cells));
  if (out->contrast >= CONTRAST_MIN) visit_island(out, island, mark_block, &m);
  FG_TRY_EXIT(
      fg_grid_label(ctx, m.cells, out->width, out->height, out->labels, &blobs, &blob_count));
  FG_TRY_EXIT(collect_objects(ctx, blobs, blob_count, min_px, out));
exit:
  free(m.cells);
  free(blobs);
  return status;
}

/* The island's box in blocks, cut at the scan's border. */
static void find_box(const fg_island *island, fg_segmentation *out) {
  out->x = island->x * FG_BLOCKS_PER_TILE;
  out->y = island->y * FG_BLOCKS_PER_TILE;
  int32_t right = (island->x + island->width) * FG_BLOCKS_PER_TILE;
  int32_t low = (island->y + island->height) * FG_BLOCKS_PER_TILE;
  out->width = (right < out->tiles->block_columns ? right : out->tiles->block_columns) - out->x;
  out->height = (low < out->tiles->block_rows ? low : out->tiles->block_rows) - out->y;
}

fg_status fg_segment(fg_context *ctx, const fg_tiles *tiles, const fg_island *island, double min_px,
                     fg_segmentation *out) {
  memset(out, 0, sizeof *out);
  out->tiles = tiles;
  out->light_on_dark = true;
  find_box(island, out);
  size_t count = (size_t)out->width * (size_t)out->height;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof(int32_t), (void **)&out->labels));
  FG_TRY_EXIT(find_background(ctx, island, out));
  FG_TRY_EXIT(estimate_noise(ctx, island, out));
  find_polarity(island, out);
  FG_TRY_EXIT(label_objects(ctx, island, min_px, out));
exit:
  if (status != FG_OK) fg_segmentation_free(out);
  return status;
}

void fg_segmentation_free(fg_segmentation *segmentation) {
  if (!segmentation) return;
  free(segmentation->grid);
  free(segmentation->labels);
  free(segmentation->objects);
  memset(segmentation, 0, sizeof *segmentation);
}
