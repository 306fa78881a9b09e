/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"

/* Provisional labels: parents[i] <= i is a label of the same component, itself at a root. */
typedef struct forest {
  int32_t *parents; /* [0] is the background */
  size_t count, capacity;
} forest;

static int32_t find_root(const forest *f, int32_t label) {
  while (f->parents[label] != label)
    label = f->parents[label];
  return label;
}

/* Joins two components under the smaller root, and points every label on the path to it. */
static int32_t join_components(forest *f, int32_t a, int32_t b) {
  int32_t ra = find_root(f, a), rb = find_root(f, b), root = ra < rb ? ra : rb;
  f->parents[ra] = f->parents[rb] = root;
  f->parents[a] = f->parents[b] = root;
  return root;
}

static fg_status add_label(fg_context *ctx, forest *f, int32_t *label) {
  FG_TRY(
      fg_memory_reserve(ctx, f->count + 1, sizeof *f->parents, &f->capacity, (void **)&f->parents));
  *label = (int32_t)f->count;
  f->parents[f->count++] = *label;
  return FG_OK;
}

/* Labels one row: a cell gets the label of its neighbours before it, which then become one. */
static fg_status label_row(fg_context *ctx, forest *f, const uint8_t *mask, int32_t width,
                           const int32_t *above, int32_t *here) {
  for (int32_t x = 0; x < width; x++) {
    int32_t label = 0;
    here[x] = 0;
    if (!mask[x]) continue;
    if (x > 0) label = here[x - 1];
    for (int32_t c = x > 0 ? x - 1 : 0; above && c <= x + 1 && c < width; c++)
      if (above[c])
        label = label && label != above[c] ? join_components(f, label, above[c]) : above[c];
    if (!label) FG_TRY(add_label(ctx, f, &label));
    here[x] = label;
  }
  return FG_OK;
}

/* Numbers the roots 1, 2, ...; parents[i] is then the number of i's component. */
static int32_t number_roots(forest *f) {
  int32_t count = 0;
  for (size_t i = 1; i < f->count; i++) {
    int32_t parent = f->parents[i]; /* below i: numbered already */
    f->parents[i] = parent == (int32_t)i ? ++count : f->parents[parent];
  }
  return count;
}

static void add_cell(fg_blob *b, int32_t x, int32_t y) {
  if (b->area++ == 0) {
    b->x = x;
    b->y = y;
  }
  if (x < b->x) {
    b->width += b->x - x;
    b->x = x;
  }
  if (x - b->x >= b->width) b->width = x - b->x + 1;
  b->height = y - b->y + 1;
}

static void measure_blobs(const forest *f, int32_t width, int32_t height, int32_t *labels,
                          fg_blob *blobs) {
  for (int32_t y = 0; y < height; y++)
    for (int32_t x = 0; x < width; x++) {
      int32_t *label = &labels[(size_t)y * (size_t)width + (size_t)x];
      if (!*label) continue;
      *label = f->parents[*label];
      add_cell(&blobs[*label - 1], x, y);
    }
}

fg_status fg_grid_label(fg_context *ctx, const uint8_t *mask, int32_t width, int32_t height,
                        int32_t *labels, fg_blob **blobs, int32_t *blob_count) {
  forest f = {0};
  int32_t background;
  fg_status status = FG_OK;
  *blobs = NULL;
  *blob_count = 0;
  FG_TRY_EXIT(add_label(ctx, &f, &background));
  for (int32_t y = 0; y < height; y++) {
    int32_t *here = labels + (size_t)y * (size_t)width;
    FG_TRY_EXIT(label_row(ctx, &f, mask + (size_t)y * (size_t)width, width,
                          y > 0 ? here - width : NULL, here));
  }
  int32_t count = number_roots(&f);
  FG_TRY_EXIT(fg_memory_allocate(ctx, (size_t)count, sizeof **blobs, (void **)blobs));
  measure_blobs(&f, width, height, labels, *blobs);
  *blob_count = count;
exit:
  free(f.parents);
  return status;
}

enum { MEDIAN_REACH = 2, MEDIAN_CELLS = (2 * MEDIAN_REACH + 1) * (2 * MEDIAN_REACH + 1) };

static int32_t clamp_index(int32_t value, int32_t high) {
  return value < 0 ? 0 : value > high ? high : value;
}

/* Moves the known values to the front and returns their median; NaN: none is known. */
static float median_of_known(float *values, size_t count) {
  size_t known = 0;
  for (size_t i = 0; i < count; i++)
    if (!isnan(values[i])) values[known++] = values[i];
  return known ? fg_select_float(values, known, known / 2) : NAN;
}

static float median_at(const float *grid, int32_t width, int32_t height, int32_t x, int32_t y) {
  float values[MEDIAN_CELLS];
  size_t count = 0;
  for (int32_t v = y - MEDIAN_REACH; v <= y + MEDIAN_REACH; v++)
    for (int32_t u = x - MEDIAN_REACH; u <= x + MEDIAN_REACH; u++)
      values[count++] = grid[(size_t)clamp_index(v, height - 1) * (size_t)width +
                             (size_t)clamp_index(u, width - 1)];
  return median_of_known(values, count);
}

/* Fills cells without a known neighbour; `copy` is the grid as it was, and scratch. */
static void fill_unknown(float *grid, float *copy, size_t count) {
  float whole = NAN;
  for (size_t i = 0; i < count; i++) {
    if (!isnan(grid[i])) continue;
    if (isnan(whole)) whole = median_of_known(copy, count);
    if (isnan(whole)) whole = 0;
    grid[i] = whole;
  }
}

fg_status fg_grid_median(fg_context *ctx, float *grid, int32_t width, int32_t height) {
  size_t count = (size_t)width * (size_t)height;
  float *copy = NULL;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *copy, (void **)&copy));
  memcpy(copy, grid, count * sizeof *copy);
  for (int32_t y = 0; y < height; y++)
    for (int32_t x = 0; x < width; x++)
      grid[(size_t)y * (size_t)width + (size_t)x] = median_at(copy, width, height, x, y);
  fill_unknown(grid, copy, count);
  free(copy);
  return FG_OK;
}
