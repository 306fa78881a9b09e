/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/colour_read.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/parallel.h"

enum {
  BATCH_ROWS = 128,
  PIXELS_MAX = 1024, /* of one cross-section; a larger one is skipped */
};

/* Rows of the scan, the newest in the place of the oldest. */
typedef struct ring {
  fg_colour_stations *stations;
  int64_t width_px, rows, read; /* rows in the ring; rows read */
  int bytes_per_pixel;
  uint8_t *planes[3];
  fg_edge_tables *tables;
  size_t first; /* of the stations in order: of the batch */
  atomic_bool differ[3];
} ring;

static uint8_t *row_of(const ring *r, int channel, int64_t y) {
  return r->planes[channel] +
         (size_t)(y % r->rows) * (size_t)r->width_px * (size_t)r->bytes_per_pixel;
}

static float ring_value(const ring *r, int channel, int64_t x, int64_t y) {
  const uint8_t *row = row_of(r, channel, y);
  if (r->bytes_per_pixel == 1) return (float)row[x];
  return (float)((const uint16_t *)(const void *)row)[x] * (1.0F / 257.0F);
}

static fg_colour_pixel pixel_at(const ring *r, int64_t x, int64_t y, double across) {
  return (fg_colour_pixel){
      .across_px = (float)across,
      .value = {ring_value(r, 0, x, y), ring_value(r, 1, x, y), ring_value(r, 2, x, y)}};
}

/* Collects the pixels of one cross-section: a rectangle along the normal. */
static size_t collect_pixels(const ring *r, const fg_colour_station *s, fg_colour_pixel *pixels) {
  size_t count = 0;
  double wide = fabs(s->nx) * s->half_across_px + fabs(s->ny) * s->half_along_px;
  for (int64_t y = s->top; y <= s->bottom; y++)
    for (int64_t x = (int64_t)ceil(s->x - wide); x <= (int64_t)floor(s->x + wide); x++) {
      double dx = (double)x - s->x, dy = (double)y - s->y;
      double across = dx * s->nx + dy * s->ny, along = dy * s->nx - dx * s->ny;
      if (fabs(across) > s->half_across_px || fabs(along) > s->half_along_px) continue;
      if (count == PIXELS_MAX) return 0;
      pixels[count++] = pixel_at(r, x, y, across);
    }
  return count;
}

static void compare_channels(ring *r, const fg_colour_pixel *pixels, size_t count) {
  for (int k = 0; k < 3; k++) {
    if (atomic_load(&r->differ[k])) continue;
    for (size_t i = 0; i < count; i++)
      if (pixels[i].value[k] != pixels[i].value[(k + 1) % 3]) atomic_store(&r->differ[k], true);
  }
}

static fg_status fit_station(fg_context *ctx, void *shared, size_t item) {
  (void)ctx;
  ring *r = shared;
  fg_colour_station *s = &r->stations->list[r->stations->order[r->first + item]];
  fg_colour_pixel pixels[PIXELS_MAX];
  size_t count = collect_pixels(r, s, pixels);
  compare_channels(r, pixels, count);
  for (int channel = 0; channel < 3; channel++)
    fg_colour_profile_fit(r->tables, &s->known, pixels, count, channel, &s->place[channel]);
  return FG_OK;
}

/* Fits the cross-sections whose last row has been read. */
static fg_status fit_batch(fg_context *ctx, ring *r, unsigned threads) {
  const fg_colour_stations *stations = r->stations;
  size_t next = r->first;
  while (next < stations->count && stations->list[stations->order[next]].bottom < r->read)
    next++;
  FG_TRY(fg_parallel_run(ctx, threads, next - r->first, fit_station, r));
  r->first = next;
  return FG_OK;
}

static fg_status read_batch(fg_context *ctx, fg_scan *scan, ring *r, int64_t height_px) {
  for (int i = 0; i < BATCH_ROWS && r->read < height_px; i++, r->read++) {
    void *planes[3];
    for (int k = 0; k < 3; k++)
      planes[k] = row_of(r, k, r->read);
    FG_TRY(fg_scan_read_colours(ctx, scan, planes));
  }
  return FG_OK;
}

static fg_status read_all_rows(fg_context *ctx, fg_scan *scan, unsigned threads, ring *r) {
  size_t bytes = (size_t)r->rows * (size_t)r->width_px * (size_t)r->bytes_per_pixel;
  for (int k = 0; k < 3; k++)
    FG_TRY(fg_memory_allocate(ctx, bytes, 1, (void **)&r->planes[k]));
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *r->tables, (void **)&r->tables));
  fg_edge_tables_init(r->tables, 1);
  FG_TRY(fg_scan_begin_colours(ctx, scan));
  while (r->first < r->stations->count) {
    FG_TRY(read_batch(ctx, scan, r, fg_scan_get_info(scan)->height_px));
    FG_TRY(fit_batch(ctx, r, threads));
  }
  return FG_OK;
}

fg_status fg_colour_read(fg_context *ctx, fg_scan *scan, fg_budget *budget, unsigned threads,
                         fg_colour_stations *stations, bool same[3]) {
  const fg_scan_info *info = fg_scan_get_info(scan);
  ring r = {.stations = stations,
            .width_px = info->width_px,
            .rows = stations->rows_max + BATCH_ROWS,
            .bytes_per_pixel = info->bytes_per_pixel};
  size_t bytes = 3 * (size_t)r.rows * (size_t)r.width_px * (size_t)r.bytes_per_pixel;
  FG_TRY(fg_budget_reserve(ctx, budget, bytes));
  fg_status status = read_all_rows(ctx, scan, threads, &r);
  fg_budget_release(budget, bytes);
  free(r.tables);
  for (int k = 0; k < 3; k++) {
    same[k] = !atomic_load(&r.differ[k]);
    free(r.planes[k]);
  }
  return status;
}
