/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/ring.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

/* One row of the scan in the ring's coordinates. */
typedef struct ring_row {
  const fg_tiles *tiles;
  const fg_pixel_shape *shape;
  int64_t y;
  double dv; /* distance of the row from the centre */
} ring_row;

/* Pixels of a row between two distances du from the centre, both included. */
static fg_status collect_run(fg_context *ctx, const ring_row *row, double from, double to,
                             fg_ring *ring) {
  double scale = row->shape->scale[0], turn = (double)ring->station_count / (2 * M_PI);
  int64_t first = (int64_t)ceil((ring->circle.x + from) / scale);
  int64_t last = (int64_t)floor((ring->circle.x + to) / scale);
  if (first < 0) first = 0;
  if (last >= row->tiles->width_px) last = row->tiles->width_px - 1;
  if (first > last) return FG_OK;
  FG_TRY(fg_memory_reserve(ctx, ring->count + (size_t)(last - first + 1), sizeof *ring->pixels,
                           &ring->capacity, (void **)&ring->pixels));
  for (int64_t x = first; x <= last; x++) {
    float value = fg_tiles_pixel(row->tiles, x, row->y);
    if (isnan(value)) continue;
    double du = (double)x * scale - ring->circle.x;
    double across = hypot(du, row->dv) - ring->circle.radius;
    if (fabs(across) > ring->reach_px) continue;
    double angle = atan2(row->dv, du);
    size_t station = (size_t)((angle < 0 ? angle + 2 * M_PI : angle) * turn);
    if (station >= ring->station_count) station = 0;
    ring->pixels[ring->count++] = (fg_ring_pixel){(float)across, value, (int32_t)station};
  }
  return FG_OK;
}

fg_status fg_ring_collect(fg_context *ctx, const fg_tiles *tiles, const fg_pixel_shape *shape,
                          fg_ring *ring) {
  double outer = ring->circle.radius + ring->reach_px, inner = ring->circle.radius - ring->reach_px;
  double scale = shape->scale[1];
  int64_t first = (int64_t)ceil(fmax(0, (ring->circle.y - outer) / scale));
  int64_t last = (int64_t)floor((ring->circle.y + outer) / scale);
  if (last >= tiles->height_px) last = tiles->height_px - 1;
  ring->count = 0;
  for (int64_t y = first; y <= last; y++) {
    ring_row row = {tiles, shape, y, (double)y * scale - ring->circle.y};
    double far = sqrt(fmax(0, outer * outer - row.dv * row.dv));
    if (inner <= fabs(row.dv)) {
      FG_TRY(collect_run(ctx, &row, -far, far, ring));
      continue;
    }
    double near = sqrt(inner * inner - row.dv * row.dv);
    FG_TRY(collect_run(ctx, &row, -far, -near, ring));
    FG_TRY(collect_run(ctx, &row, near, far, ring));
  }
  return FG_OK;
}

void fg_ring_free(fg_ring *ring) {
  free(ring->pixels);
  ring->pixels = NULL;
  ring->count = ring->capacity = 0;
}

size_t fg_ring_bin_count(double reach_px) {
  return (size_t)(2 * reach_px / FG_RING_BIN_PX) + 1;
}

void fg_ring_stack(const fg_ring *ring, fg_profile_bin *bins, size_t bin_count) {
  size_t per_sector = ring->station_count / ring->sector_count;
  memset(bins, 0, ring->sector_count * bin_count * sizeof *bins);
  for (size_t i = 0; i < ring->count; i++) {
    const fg_ring_pixel *p = &ring->pixels[i];
    size_t at = (size_t)((p->across_px + ring->reach_px) / FG_RING_BIN_PX);
    if (at >= bin_count) continue;
    fg_profile_bin *bin = &bins[(size_t)p->station / per_sector * bin_count + at];
    bin->across_px += p->across_px;
    bin->value += p->value;
    bin->count += 1;
  }
  for (size_t i = 0; i < ring->sector_count * bin_count; i++) {
    if (bins[i].count <= 0) continue;
    bins[i].across_px /= bins[i].count;
    bins[i].value /= bins[i].count;
  }
}
