/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Corners of a chessboard: places whose ring changes between dark and light four times, at
 * opposite places alike. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"
#include "vision/mark_find.h"

/* The detector's ring: 16 cells at a radius of 5 (after Bennett and Lasenby 2014: sums of opposite
 * cells against those a quarter away, less differences of opposite cells). */
enum { RING = 16, RING_RADIUS = 5, NEAR = 4 };
static const int ring_x[RING] = {5, 5, 4, 2, 0, -2, -4, -5, -5, -5, -4, -2, 0, 2, 4, 5};
static const int ring_y[RING] = {0, 2, 4, 5, 5, 5, 4, 2, 0, -2, -4, -5, -5, -5, -4, -2};
/* Response of a place that can be a corner, as a share of the strongest ones'. */
#define RESPONSE_SHARE 0.3
enum { STRONG_OF = 50, RESPONSE_MIN = 160 };
/* Half the window of a fit, in cells: the ring and the edges beside it. */
#define REACH_CELLS 7.0
/* The ring that the edges' directions are read from. */
enum { SECTORS = 64 };
#define SECTOR_RADIUS 5.5

static int response_at(const fg_reduced *r, int32_t x, int32_t y) {
  const uint8_t *cell = r->cells + (size_t)y * (size_t)r->width + (size_t)x;
  int value[RING], sum = 0, differences = 0, ring = 0;
  for (int k = 0; k < RING; k++) {
    value[k] = cell[ring_y[k] * r->width + ring_x[k]];
    ring += value[k];
  }
  for (int k = 0; k < RING / 4; k++)
    sum += abs(value[k] + value[k + 8] - value[k + 4] - value[k + 12]);
  for (int k = 0; k < RING / 2; k++)
    differences += abs(value[k] - value[k + 8]);
  int local = cell[0] + cell[1] + cell[-1] + cell[r->width] + cell[-r->width];
  return sum - differences - abs(ring - local * RING / 5);
}

typedef struct corner_map {
  const fg_reduced *picture;
  int16_t *response; /* owned */
} corner_map;

static int at_cell(const corner_map *map, int32_t x, int32_t y) {
  return map->response[(size_t)y * (size_t)map->picture->width + (size_t)x];
}

static bool is_local_maximum(const corner_map *map, int32_t x, int32_t y) {
  int own = at_cell(map, x, y);
  for (int32_t j = -NEAR; j <= NEAR; j++)
    for (int32_t i = -NEAR; i <= NEAR; i++) {
      int other = at_cell(map, x + i, y + j);
      if (other > own || (other == own && (j < 0 || (j == 0 && i < 0)))) return false;
    }
  return true;
}

static double sample_cells(const fg_reduced *r, double x, double y) {
  int32_t i = (int32_t)floor(x), j = (int32_t)floor(y);
  double fx = x - i, fy = y - j;
  const uint8_t *cell = r->cells + (size_t)j * (size_t)r->width + (size_t)i;
  return (1 - fy) * ((1 - fx) * cell[0] + fx * cell[1]) +
         fy * ((1 - fx) * cell[r->width] + fx * cell[r->width + 1]);
}

/* Directions of the edges: the changes of the ring, folded by half a turn. Returns false where the
 * ring has not two changes up and down in half a turn. */
static bool read_ring(const fg_reduced *r, int32_t x, int32_t y, double change[2], double *low,
                      double *high) {
  double value[SECTORS], middle;
  *low = INFINITY;
  *high = -INFINITY;
  for (int k = 0; k < SECTORS / 2; k++) {
    double angle = 2 * M_PI * k / SECTORS;
    double dx = SECTOR_RADIUS * cos(angle), dy = SECTOR_RADIUS * sin(angle);
    value[k] = 0.5 * (sample_cells(r, x + dx, y + dy) + sample_cells(r, x - dx, y - dy));
    *low = fmin(*low, value[k]);
    *high = fmax(*high, value[k]);
  }
  middle = 0.5 * (*low + *high);
  int changes = 0;
  for (int k = 0; k < SECTORS / 2; k++) {
    double a = value[k] - middle, b = value[(k + 1) % (SECTORS / 2)] - middle;
    if ((a < 0) == (b < 0)) continue;
    if (changes == 2) return false;
    change[changes++] = 2 * M_PI * (k + a / (a - b)) / SECTORS;
  }
  return changes == 2;
}

/* Start of a fit: an edge's normal is a quarter from its direction; the dark sector is the one in
 * which both distances have one sign. */
static bool start_corner(const fg_reduced *r, int32_t x, int32_t y, fg_mark_fit *start) {
  double change[2], low, high;
  if (!read_ring(r, x, y, change, &low, &high)) return false;
  double between = change[1] - change[0];
  if (between < M_PI / 4 || between > 3 * M_PI / 4) return false;
  *start = (fg_mark_fit){.reach_px = REACH_CELLS * r->cell_px};
  start->p[FG_MARK_X] = (x + 0.5) * r->cell_px - 0.5;
  start->p[FG_MARK_Y] = (y + 0.5) * r->cell_px - 0.5;
  start->p[FG_MARK_LEVEL] = high;
  start->p[FG_MARK_CONTRAST] = low - high;
  start->p[FG_MARK_SHAPE] = change[0] + M_PI / 2;
  start->p[FG_MARK_SHAPE + 1] = change[1] - M_PI / 2;
  double middle = 0.5 * (change[0] + change[1]);
  double value = sample_cells(r, x + SECTOR_RADIUS * cos(middle), y + SECTOR_RADIUS * sin(middle));
  bool dark = value < 0.5 * (low + high);
  if (!dark) start->p[FG_MARK_SHAPE + 1] += M_PI;
  return true;
}

/* A response that a few corners have: the strongest local maxima's. */
static fg_status find_response_limit(fg_context *ctx, const corner_map *map, double *limit) {
  double *values = NULL;
  size_t count = 0, capacity = 0;
  const fg_reduced *r = map->picture;
  for (int32_t y = 2 * NEAR; y < r->height - 2 * NEAR; y++)
    for (int32_t x = 2 * NEAR; x < r->width - 2 * NEAR; x++) {
      if (at_cell(map, x, y) < RESPONSE_MIN || !is_local_maximum(map, x, y)) continue;
      fg_status status =
          fg_memory_reserve(ctx, count + 1, sizeof *values, &capacity, (void **)&values);
      if (status != FG_OK) {
        free(values);
        return status;
      }
      values[count++] = at_cell(map, x, y);
    }
  *limit = INFINITY;
  if (count) {
    size_t top = count > STRONG_OF ? count / STRONG_OF : 1;
    *limit = fmax(RESPONSE_SHARE * fg_select(values, count, count - top), RESPONSE_MIN);
  }
  free(values);
  return FG_OK;
}

static fg_status collect_corners(fg_context *ctx, const corner_map *map, fg_mark_starts *found) {
  double limit;
  const fg_reduced *r = map->picture;
  FG_TRY(find_response_limit(ctx, map, &limit));
  for (int32_t y = 2 * NEAR; y < r->height - 2 * NEAR; y++)
    for (int32_t x = 2 * NEAR; x < r->width - 2 * NEAR; x++) {
      fg_mark_fit start;
      if (at_cell(map, x, y) < limit || !is_local_maximum(map, x, y)) continue;
      if (!start_corner(r, x, y, &start)) continue;
      FG_TRY(fg_memory_reserve(ctx, found->count + 1, sizeof *found->list, &found->capacity,
                               (void **)&found->list));
      found->list[found->count++] = start;
    }
  return FG_OK;
}

fg_status fg_mark_find_corners(fg_context *ctx, const fg_reduced *picture, fg_mark_starts *found) {
  corner_map map = {.picture = picture};
  int32_t w = picture->width, h = picture->height;
  *found = (fg_mark_starts){0};
  if (w <= 4 * RING_RADIUS || h <= 4 * RING_RADIUS) return FG_OK;
  FG_TRY(
      fg_memory_allocate(ctx, (size_t)w * (size_t)h, sizeof *map.response, (void **)&map.response));
  for (int32_t y = RING_RADIUS; y < h - RING_RADIUS; y++)
    for (int32_t x = RING_RADIUS; x < w - RING_RADIUS; x++)
      map.response[(size_t)y * (size_t)w + (size_t)x] = (int16_t)response_at(picture, x, y);
  fg_status status = collect_corners(ctx, &map, found);
  free(map.response);
  return status;
}
