/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A driver that promises more dots per inch than its sensor reads: the sensor's rows, interpolated
 * to the stated resolution. The middles of the first pixels coincide. */
#ifndef FG_RENDER_RESAMPLE_H
#define FG_RENDER_RESAMPLE_H

#include <stdbool.h>
#include <stdint.h>

#include "foilgauge/status.h"

/* Mapping from the sensor's grid to that of the finished picture. */
typedef struct fg_resampling {
  int64_t from_px[2], to_px[2]; /* width, height */
  double step[2];               /* sensor pixels per finished one; at most 1 */
  bool bicubic;                 /* Catmull-Rom's; else bilinear */
  int64_t channels;
} fg_resampling;

/* Receives a finished row, channel after channel; it may change it. */
typedef fg_status fg_resampled_row(fg_context *ctx, void *user, float *values);

typedef struct fg_resampler {
  fg_resampling way;
  fg_resampled_row *row;
  void *user;
  int64_t taken, given; /* rows */
  float *rows;          /* the last four of the sensor, as wide as the finished picture */
  float *out;
} fg_resampler;

fg_status fg_resampler_create(fg_context *ctx, const fg_resampling *way, fg_resampled_row *row,
                              void *user, fg_resampler *resampler);
void fg_resampler_free(fg_resampler *resampler);

/* Accepts the sensor's next row, whose channels lie `stride` values apart, and hands out the
 * finished rows that need no later one. */
fg_status fg_resampler_add_row(fg_context *ctx, fg_resampler *resampler, const float *values,
                               int64_t stride);

/* Returns the number of the sensor's pixels that `to_px` finished ones need. */
int64_t fg_resampling_need(int64_t to_px, double step);

#endif
