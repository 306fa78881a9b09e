/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pixels of every chunk of stations, and from them the middle of each station. */
#include <math.h>

#include "core/parallel.h"
#include "vision/edge_work.h"

enum { MIDDLE_STATIONS = 4 }; /* stations to either side over which the middle is smoothed */

void fg_edges_chunk(const fg_edge_work *work, size_t chunk, size_t *first, size_t *last) {
  *first = chunk * FG_CHUNK_STATIONS;
  *last = *first + FG_CHUNK_STATIONS - 1;
  if (*last >= work->reference->count) *last = work->reference->count - 1;
}

float fg_edges_background(const fg_edge_work *work, const fg_reference_station *station) {
  const fg_segmentation *seg = work->segmentation;
  double bx = fmin(fmax(station->x / FG_BLOCK_PX, 0), seg->tiles->block_columns - 1);
  double by = fmin(fmax(station->y / FG_BLOCK_PX, 0), seg->tiles->block_rows - 1);
  return fg_segmentation_background(seg, (int32_t)bx, (int32_t)by);
}

/* Weighs the stations' middles in one chunk: counts between 30 and 70 % of the contrast rise from 0
 * to 1, so that neither halo nor band pulls. */
static void weigh_pixels(const fg_edge_work *work, size_t chunk) {
  const fg_pixel_band *band = &work->bands[chunk];
  float scale = 2.5f / (float)work->trace->contrast, reach = (float)(work->width_px / 2 + 6);
  float sign = work->segmentation->light_on_dark ? scale : -scale;
  for (size_t k = 0; k < band->stations; k++) {
    fg_edge_station *s = &work->stations[band->first + k];
    /* until the plateau is known */
    s->plateau = fg_edges_background(work, &work->reference->stations[band->first + k]);
    for (size_t i = band->begin[k]; i < band->begin[k + 1]; i++) {
      if (fabsf(band->across_px[i]) > reach) continue;
      float weight = sign * (band->value[i] - s->plateau) - 0.75f;
      weight = weight < 0 ? 0 : weight > 1 ? 1 : weight;
      s->g1 += weight * band->across_px[i];
      s->m11 += weight;
    }
  }
}

static fg_status collect_task(fg_context *ctx, void *shared, size_t chunk) {
  fg_edge_work *work = shared;
  size_t first, last;
  fg_edges_chunk(work, chunk, &first, &last);
  if (!work->borrowed)
    FG_TRY(fg_pixel_band_collect(ctx, work->tiles, work->reference, first, last,
                                 work->width_px / 2 + work->reach_px, &work->bands[chunk]));
  weigh_pixels(work, chunk);
  return FG_OK;
}

fg_status fg_edges_collect(fg_context *ctx, fg_edge_work *work) {
  size_t count = work->reference->count;
  FG_TRY(fg_parallel_run(ctx, work->threads, work->chunk_count, collect_task, work));
  for (size_t i = 0; i < count; i++) {
    float sum = 0, weight = 0;
    size_t from = i > MIDDLE_STATIONS ? i - MIDDLE_STATIONS : 0;
    for (size_t j = from; j <= i + MIDDLE_STATIONS && j < count; j++) {
      sum += work->stations[j].g1;
      weight += work->stations[j].m11;
    }
    work->stations[i].middle_px = weight > 0 ? sum / weight : 0;
  }
  return FG_OK;
}
