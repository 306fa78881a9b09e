/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/resample.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"

enum { TAPS = 4 }; /* from one before the pixel at or below the place; bilinear uses two of them */

typedef struct taps {
  int64_t first; /* may lie outside the picture */
  float weight[TAPS];
} taps;

static taps taps_at(const fg_resampling *way, int axis, int64_t to) {
  double place = (double)to * way->step[axis], below = floor(place);
  float t = (float)(place - below);
  taps result = {.first = (int64_t)below - 1, .weight = {0, 1 - t, t, 0}};
  if (way->bicubic) {
    float t2 = t * t, t3 = t2 * t;
    result.weight[0] = 0.5F * (-t3 + 2 * t2 - t);
    result.weight[1] = 0.5F * (3 * t3 - 5 * t2 + 2);
    result.weight[2] = 0.5F * (-3 * t3 + 4 * t2 + t);
    result.weight[3] = 0.5F * (t3 - t2);
  }
  return result;
}

/* Index within the picture; the outermost pixels repeat beyond it. */
static int64_t clamp_index(int64_t at, int64_t count) {
  return at < 0 ? 0 : at >= count ? count - 1 : at;
}

int64_t fg_resampling_need(int64_t to_px, double step) {
  return (int64_t)ceil((double)(to_px - 1) * step - 1e-9) + 1;
}

static size_t row_values(const fg_resampler *resampler) {
  return (size_t)resampler->way.to_px[0] * (size_t)resampler->way.channels;
}

fg_status fg_resampler_create(fg_context *ctx, const fg_resampling *way, fg_resampled_row *row,
                              void *user, fg_resampler *resampler) {
  *resampler = (fg_resampler){.way = *way, .row = row, .user = user};
  size_t values = row_values(resampler);
  FG_TRY(fg_memory_allocate(ctx, TAPS * values, sizeof(float), (void **)&resampler->rows));
  return fg_memory_allocate(ctx, values, sizeof(float), (void **)&resampler->out);
}

void fg_resampler_free(fg_resampler *resampler) {
  free(resampler->rows);
  free(resampler->out);
  *resampler = (fg_resampler){0};
}

static void keep_row(fg_resampler *resampler, const float *values, int64_t stride) {
  const fg_resampling *way = &resampler->way;
  float *kept = resampler->rows + (size_t)(resampler->taken % TAPS) * row_values(resampler);
  for (int64_t x = 0; x < way->to_px[0]; x++) {
    taps at = taps_at(way, 0, x);
    for (int64_t c = 0; c < way->channels; c++) {
      float sum = 0;
      for (int k = 0; k < TAPS; k++)
        sum += at.weight[k] * values[c * stride + clamp_index(at.first + k, way->from_px[0])];
      kept[c * way->to_px[0] + x] = sum;
    }
  }
  resampler->taken++;
}

/* Interpolates a row. A cubic overshoots; numbers are clipped to the scale. */
static void interpolate_row(const fg_resampler *resampler, const taps *at) {
  size_t values = row_values(resampler);
  const float *rows[TAPS];
  for (int k = 0; k < TAPS; k++) {
    int64_t row = clamp_index(at->first + k, resampler->way.from_px[1]);
    rows[k] = resampler->rows + (size_t)(row % TAPS) * values;
  }
  for (size_t i = 0; i < values; i++) {
    float sum = 0;
    for (int k = 0; k < TAPS; k++)
      sum += at->weight[k] * rows[k][i];
    resampler->out[i] = sum < 0 ? 0 : sum > 255 ? 255 : sum;
  }
}

fg_status fg_resampler_add_row(fg_context *ctx, fg_resampler *resampler, const float *values,
                               int64_t stride) {
  const fg_resampling *way = &resampler->way;
  keep_row(resampler, values, stride);
  while (resampler->given < way->to_px[1]) {
    taps at = taps_at(way, 1, resampler->given);
    if (clamp_index(at.first + TAPS - 1, way->from_px[1]) >= resampler->taken) return FG_OK;
    interpolate_row(resampler, &at);
    resampler->given++;
    FG_TRY(resampler->row(ctx, resampler->user, resampler->out));
  }
  return FG_OK;
}
