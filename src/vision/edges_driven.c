/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stations' pixels under a driver's model: profiles as tables, of a few stations each. */
#include <math.h>

#include "vision/driver_table.h"
#include "vision/edge_work.h"

enum { BLOCK_STATIONS = 8, MARGIN_STEPS = 6 };

/* Mean shape of neighbouring stations, as of fg_driven_profile. */
typedef struct driven_block {
  double values[FG_DRIVEN_VALUES], half_px;
} driven_block;

static driven_block mean_block(const fg_edge_work *work, size_t first, size_t last) {
  driven_block block;
  double *values = block.values;
  double sum[FG_EDGE_SHAPE_VALUES] = {0}, width = 0, n = (double)(last - first + 1), rate;
  for (size_t i = first; i <= last; i++) {
    const fg_edge_station *s = &work->stations[i];
    const double of[FG_EDGE_SHAPE_VALUES] = {s->plateau,  s->step[0],    s->step[1],   s->slope[0],
                                             s->slope[1], s->blur_px[0], s->blur_px[1]};
    for (int k = 0; k < FG_EDGE_SHAPE_VALUES; k++)
      sum[k] += of[k] / n;
    width += (s->edge_px[1] - s->edge_px[0]) / n;
  }
  block.half_px = 0.5 * width;
  values[FG_DRIVEN_LEFT] = -block.half_px;
  values[FG_DRIVEN_RIGHT] = block.half_px;
  values[FG_DRIVEN_PLATEAU] = fg_edges_count(work, sum[0], &rate);
  for (int side = 0; side < 2; side++) {
    double count = fg_edges_count(work, sum[0] + sum[1 + side], &rate);
    double over = sum[1 + side] != 0 ? (count - values[FG_DRIVEN_PLATEAU]) / sum[1 + side] : 1;
    values[FG_DRIVEN_LEVEL_L + side] = count;
    values[FG_DRIVEN_SLOPE_L + side] = sum[3 + side] * over;
    values[FG_DRIVEN_BLUR_L + side] = sum[5 + side];
  }
  return block;
}

/* Pixels that wait for their counts. */
enum { BATCH = 64 };
typedef struct pixel_batch {
  size_t count;
  fg_edge_station *station[BATCH];
  bool right[BATCH]; /* of the two edges */
  int32_t start[BATCH];
  float value[BATCH], steps[BATCH];
} pixel_batch;

/* Takes a pixel, whose place is counted from the nearer edge. */
static void take_pixel(const fg_driven_tables *tables, size_t table, double half_px,
                       const float reach_px[2], fg_edge_station *s, float across_px, float value,
                       pixel_batch *batch) {
  const fg_driven_table *own = &tables->list[table];
  float left = s->edge_px[0] - across_px, right = across_px - s->edge_px[1];
  bool side = right > left;
  float d = side ? right : left;
  if (d > reach_px[side]) return;
  float from_middle = (float)half_px + d;
  float steps = fg_driven_table_steps(own, side ? from_middle : -from_middle);
  if (!fg_driven_table_holds(own, steps)) return;
  size_t k = batch->count++;
  batch->station[k] = s;
  batch->right[k] = side;
  batch->start[k] = fg_driven_tables_start(tables, table);
  batch->value[k] = value;
  batch->steps[k] = steps;
}

static void add_pixel(fg_edge_station *s, bool right, float value, float model, float rate,
                      float limit) {
  if ((model >= 254.5f && value >= 254.5f) || (model <= 0.5f && value <= 0.5f)) return;
  s->seen++; /* a pixel cut off at an end of the scale is neither evidence nor an outlier */
  float residual = value - model;
  if (fabsf(residual) > limit) return;
  float f1 = right ? 0 : -rate, f2 = right ? -rate : 0;
  s->m11 += f1 * f1;
  s->m22 += f2 * f2;
  s->g1 += f1 * residual;
  s->g2 += f2 * residual;
  s->misfit += residual * residual;
  s->used++;
}

static void add_batch(const fg_driven_tables *tables, pixel_batch *batch, float limit) {
  float model[BATCH], rate[BATCH];
  fg_driven_tables_at(tables, batch->count, batch->start, batch->steps, model, rate);
  for (size_t k = 0; k < batch->count; k++)
    add_pixel(batch->station[k], batch->right[k], batch->value[k], model[k], rate[k], limit);
  batch->count = 0;
}

/* Reach of a station's edges, outwards. */
typedef struct station_reach {
  float px[2];
} station_reach;

static void find_station_reach(const fg_edge_work *work, size_t first, size_t last,
                               station_reach *reach) {
  double radius = work->driver->values[FG_DRIVER_RADIUS];
  if (work->driver->values[FG_DRIVER_AMOUNT] == 0) radius = 0;
  float outer = fg_edges_outer(work);
  for (size_t i = first; i <= last; i++)
    for (int side = 0; side < 2; side++)
      reach[i - first].px[side] = fminf(
          outer, (float)FG_REACH_BLURS * hypotf(work->stations[i].blur_px[side], (float)radius));
}

/* Reach of tables from the middle of the strip: of the farthest pixel that counts, and no more than
 * that of the band. The places of a table do not depend on it. */
static double table_reach(const fg_edge_work *work, const driven_block *blocks, size_t block_count,
                          const station_reach *reach, size_t station_count) {
  double band = work->width_px + work->reach_px, half = 0, beyond = 0;
  for (size_t k = 0; k < block_count; k++)
    half = fmax(half, blocks[k].half_px);
  for (size_t i = 0; i < station_count; i++)
    beyond = fmax(beyond, fmaxf(reach[i].px[0], reach[i].px[1]));
  double spare = floor((band - half - beyond) / FG_DRIVEN_STEP_PX) - MARGIN_STEPS;
  return spare > 0 ? band - spare * FG_DRIVEN_STEP_PX : band;
}

static void add_band(const fg_edge_work *work, size_t chunk, const driven_block *blocks,
                     const fg_driven_tables *tables, const station_reach *reach, float limit) {
  pixel_batch batch;
  batch.count = 0;
  const fg_pixel_band *band = &work->bands[chunk];
  for (size_t k = 0; k < band->stations; k++)
    for (size_t i = band->begin[k]; i < band->begin[k + 1]; i++) {
      take_pixel(tables, k / BLOCK_STATIONS, blocks[k / BLOCK_STATIONS].half_px, reach[k].px,
                 &work->stations[band->first + k], band->across_px[i], band->value[i], &batch);
      if (batch.count == BATCH) add_batch(tables, &batch, limit);
    }
  add_batch(tables, &batch, limit);
}

fg_status fg_edges_add_driven(fg_context *ctx, const fg_edge_work *work, size_t chunk,
                              float limit) {
  enum { BLOCKS = FG_CHUNK_STATIONS / BLOCK_STATIONS + 1 };
  driven_block blocks[BLOCKS];
  station_reach reach[FG_CHUNK_STATIONS];
  size_t first, last, count = 0;
  fg_driven_tables tables;
  fg_edges_chunk(work, chunk, &first, &last);
  find_station_reach(work, first, last, reach);
  for (size_t i = first; i <= last; i += BLOCK_STATIONS)
    blocks[count++] =
        mean_block(work, i, i + BLOCK_STATIONS - 1 < last ? i + BLOCK_STATIONS - 1 : last);
  double from_middle = table_reach(work, blocks, count, reach, last + 1 - first);
  FG_TRY(fg_driven_tables_create(ctx, count, from_middle, &tables));
  for (size_t k = 0; k < count; k++)
    fg_driven_tables_fill(work->driver, work->driver_tone, blocks[k].values, false, &tables, k);
  add_band(work, chunk, blocks, &tables, reach, limit);
  fg_driven_tables_free(&tables);
  return FG_OK;
}
