/* The stations' pixels under a driver's model: profiles as tables, of a few stations each. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "vision/edges.h"

enum { BLOCK_STATIONS = 8 };

/* Profiles of one block of stations about edges at -half and half, and how they change with the
 * place: without slopes, which are the least certain part of the shape. */
typedef struct block {
  float *counts, *rates;
  double from_px, half_px;
  size_t size;
} block;

static void mean_shape(const fg_edge_work *work, size_t first, size_t last, double *values,
                       double *half_px) {
  double sum[FG_EDGE_SHAPE_VALUES] = {0}, width = 0, n = (double)(last - first + 1), rate;
  for (size_t i = first; i <= last; i++) {
    const fg_edge_station *s = &work->stations[i];
    const double of[FG_EDGE_SHAPE_VALUES] = {s->plateau,  s->step[0],    s->step[1],   s->slope[0],
                                             s->slope[1], s->blur_px[0], s->blur_px[1]};
    for (int k = 0; k < FG_EDGE_SHAPE_VALUES; k++)
      sum[k] += of[k] / n;
    width += (s->edge_px[1] - s->edge_px[0]) / n;
  }
  *half_px = 0.5 * width;
  values[FG_DRIVEN_LEFT] = -*half_px;
  values[FG_DRIVEN_RIGHT] = *half_px;
  values[FG_DRIVEN_PLATEAU] = fg_edges_count(work, sum[0], &rate);
  for (int side = 0; side < 2; side++) {
    double count = fg_edges_count(work, sum[0] + sum[1 + side], &rate);
    double over = sum[1 + side] != 0 ? (count - values[FG_DRIVEN_PLATEAU]) / sum[1 + side] : 1;
    values[FG_DRIVEN_LEVEL_L + side] = count;
    values[FG_DRIVEN_SLOPE_L + side] = sum[3 + side] * over;
    values[FG_DRIVEN_BLUR_L + side] = sum[5 + side];
  }
}

static void fill_block(const fg_edge_work *work, size_t first, size_t last, double *scratch,
                       block *b) {
  double values[FG_DRIVEN_VALUES];
  mean_shape(work, first, last, values, &b->half_px);
  b->from_px = -b->half_px - work->reach_px - 2;
  b->size = (size_t)(2 * (-b->from_px) / FG_DRIVEN_STEP_PX) + 1;
  if (b->size > FG_DRIVEN_MOST) b->size = FG_DRIVEN_MOST;
  fg_driven_grid(work->driver, work->driver_tone, values, false, b->from_px, b->size, scratch);
  for (size_t i = 0; i < b->size; i++)
    b->counts[i] = (float)scratch[i];
  values[FG_DRIVEN_SLOPE_L] = values[FG_DRIVEN_SLOPE_R] = 0;
  fg_driven_grid(work->driver, work->driver_tone, values, false, b->from_px, b->size, scratch);
  for (size_t i = 0; i < b->size; i++) {
    size_t before = i > 0 ? i - 1 : i, after = i + 1 < b->size ? i + 1 : i;
    b->rates[i] = (float)((scratch[after] - scratch[before]) /
                          ((double)(after - before) * FG_DRIVEN_STEP_PX));
  }
}

/* A cubic through four neighbours. */
static float cubic(const float *grid, size_t i, float f) {
  return grid[i - 1] * (-f * (f - 1) * (f - 2) / 6) + grid[i] * ((f + 1) * (f - 1) * (f - 2) / 2) +
         grid[i + 1] * (-(f + 1) * f * (f - 2) / 2) + grid[i + 2] * ((f + 1) * f * (f - 1) / 6);
}

/* The nearer edge tells where a pixel is. */
static void add_pixel(const block *b, double radius_px, fg_edge_station *s, const fg_band_pixel *p,
                      float limit) {
  float left = s->edge_px[0] - p->across_px, right = p->across_px - s->edge_px[1];
  int side = right > left;
  float d = side ? right : left;
  if (d > (float)FG_REACH_BLURS * hypotf(s->blur_px[side], (float)radius_px)) return;
  float at =
      (float)((side ? 1 : -1) * (b->half_px + (double)d) - b->from_px) / (float)FG_DRIVEN_STEP_PX;
  if (!(at >= 1) || at >= (float)(b->size - 3)) return;
  size_t i = (size_t)at;
  float share = at - (float)i, model = cubic(b->counts, i, share);
  float rate = b->rates[i] + share * (b->rates[i + 1] - b->rates[i]);
  s->seen++;
  if ((model >= 254.5f && p->value >= 254.5f) || (model <= 0.5f && p->value <= 0.5f)) return;
  float residual = p->value - model, by_edge = -rate;
  if (fabsf(residual) > limit) return;
  float f1 = side ? 0 : by_edge, f2 = side ? by_edge : 0;
  s->m11 += f1 * f1;
  s->m22 += f2 * f2;
  s->g1 += f1 * residual;
  s->g2 += f2 * residual;
  s->misfit += residual * residual;
  s->used++;
}

static fg_status fill_blocks(fg_context *ctx, const fg_edge_work *work, size_t first, size_t last,
                             block *blocks, float *memory) {
  double *scratch;
  FG_TRY(fg_memory_allocate(ctx, FG_DRIVEN_MOST, sizeof *scratch, (void **)&scratch));
  for (size_t i = first, k = 0; i <= last; i += BLOCK_STATIONS, k++) {
    size_t end = i + BLOCK_STATIONS - 1 < last ? i + BLOCK_STATIONS - 1 : last;
    blocks[k].counts = memory + 2 * k * FG_DRIVEN_MOST;
    blocks[k].rates = blocks[k].counts + FG_DRIVEN_MOST;
    fill_block(work, i, end, scratch, &blocks[k]);
  }
  free(scratch);
  return FG_OK;
}

fg_status fg_edges_add_driven(fg_context *ctx, const fg_edge_work *work, size_t chunk,
                              float limit) {
  enum { BLOCKS = FG_CHUNK_STATIONS / BLOCK_STATIONS + 1 };
  block blocks[BLOCKS];
  float *memory;
  size_t first, last;
  fg_edges_chunk(work, chunk, &first, &last);
  FG_TRY(fg_memory_allocate(ctx, BLOCKS * 2 * FG_DRIVEN_MOST, sizeof *memory, (void **)&memory));
  fg_status status = fill_blocks(ctx, work, first, last, blocks, memory);
  double radius = work->driver->values[FG_DRIVER_RADIUS];
  if (work->driver->values[FG_DRIVER_AMOUNT] == 0) radius = 0;
  const fg_pixel_band *band = &work->bands[chunk];
  for (size_t i = 0; status == FG_OK && i < band->count; i++) {
    const fg_band_pixel *p = &band->pixels[i];
    size_t station = (size_t)p->station;
    add_pixel(&blocks[(station - first) / BLOCK_STATIONS], radius, &work->stations[station], p,
              limit);
  }
  free(memory);
  return status;
}
