/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/turned_blur.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

static const double pi = 3.14159265358979323846;
static const double KERNEL_REACH = 4.5; /* sd */
static const double NEGLIGIBLE = 1e-9;  /* of the largest weight */
enum { STEPS_PER_PX = 24 };             /* of the integral along y; a multiple of any sampling */

/* Covariance of the Gaussian that remains after the samples' smoothing. */
typedef struct covariance {
  double xx, xy, yy;
} covariance;

static covariance find_covariance(const fg_blur_ellipse *ellipse) {
  double turn = ellipse->angle_deg * pi / 180, c = cos(turn), s = sin(turn);
  double first = ellipse->sd[0] * ellipse->sd[0], second = ellipse->sd[1] * ellipse->sd[1];
  return (covariance){
      .xx = first * c * c + second * s * s - ellipse->sampled[0] * ellipse->sampled[0],
      .xy = (first - second) * c * s,
      .yy = first * s * s + second * c * c - ellipse->sampled[1] * ellipse->sampled[1]};
}

bool fg_blur_is_turned(const fg_blur_ellipse *ellipse) {
  return ellipse->sd[0] != ellipse->sd[1] && fmod(ellipse->angle_deg, 180) != 0;
}

/* The pixel's box and that of the motion, convolved, at a distance along y. */
static double box_height(double distance, double motion) {
  const double still_px = 0.01;
  if (motion < still_px) return fabs(distance) < 0.5 ? 1 : 0;
  double overlap = fmin(distance + 0.5, 0.5 * motion) - fmax(distance - 0.5, -0.5 * motion);
  return fmax(0, overlap) / motion;
}

/* Weight of a sample. At t along y the Gaussian along x has its middle at t xy / yy and the
 * variance xx - xy² / yy. Through the pixel's box along x that is a difference of error functions;
 * through the boxes along y a sum of midpoints, between which the pixel's box ends. */
static double sample_weight(const covariance *v, double motion, double x, double y) {
  double slope = v->xy / v->yy, scale = 1 / sqrt(2 * (v->xx - v->xy * slope));
  int half = (int)ceil((0.5 + 0.5 * motion) * STEPS_PER_PX);
  double sum = 0;
  for (int k = -half; k < half; k++) {
    double distance = (k + 0.5) / STEPS_PER_PX, t = y - distance;
    double height = box_height(distance, motion) * exp(-0.5 * t * t / v->yy);
    if (height < NEGLIGIBLE * NEGLIGIBLE) continue;
    double u = x - slope * t;
    sum += height * (erf((u + 0.5) * scale) - erf((u - 0.5) * scale));
  }
  return sum;
}

/* Weights below the negligible are 0, the others sum to 1. */
static void fill_weights(fg_turned_blur *blur, const covariance *v, double motion) {
  int columns = 2 * blur->taps[0] + 1, rows = 2 * blur->taps[1] + 1;
  double min = NEGLIGIBLE * sample_weight(v, motion, 0, 0), sum = 0;
  for (int pass = 0; pass < 2; pass++)
    for (int j = 0; j < rows; j++)
      for (int i = 0; i < columns; i++) {
        float *weight = &blur->weights[j * columns + i];
        if (pass == 1) {
          *weight = (float)((double)*weight / sum);
          continue;
        }
        double value = sample_weight(v, motion, (double)(i - blur->taps[0]) / blur->samples,
                                     (double)(j - blur->taps[1]) / blur->samples);
        *weight = value > min ? (float)value : 0;
        sum += (double)*weight;
      }
}

static void find_ranges(fg_turned_blur *blur) {
  int columns = 2 * blur->taps[0] + 1, rows = 2 * blur->taps[1] + 1;
  for (int j = 0; j < rows; j++) {
    const float *row = blur->weights + j * columns;
    int first = 0, end = columns;
    while (first < end && row[first] <= 0)
      first++;
    while (end > first && row[end - 1] <= 0)
      end--;
    blur->first[j] = first;
    blur->end[j] = end;
  }
}

fg_status fg_turned_blur_create(fg_context *ctx, const fg_blur_ellipse *ellipse, int samples,
                                fg_turned_blur *blur) {
  covariance v = find_covariance(ellipse);
  double reach[2] = {0.5 + KERNEL_REACH * sqrt(v.xx),
                     0.5 + 0.5 * ellipse->motion + KERNEL_REACH * sqrt(v.yy)};
  *blur = (fg_turned_blur){.samples = samples};
  for (int axis = 0; axis < 2; axis++)
    blur->taps[axis] = (int)ceil(samples * reach[axis]);
  size_t columns = 2 * (size_t)blur->taps[0] + 1, rows = 2 * (size_t)blur->taps[1] + 1;
  FG_TRY(fg_memory_allocate(ctx, rows * columns, sizeof *blur->weights, (void **)&blur->weights));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *blur->first, (void **)&blur->first));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *blur->end, (void **)&blur->end));
  fill_weights(blur, &v, ellipse->motion);
  find_ranges(blur);
  return FG_OK;
}

void fg_turned_blur_free(fg_turned_blur *blur) {
  free(blur->weights);
  free(blur->first);
  free(blur->end);
  *blur = (fg_turned_blur){0};
}

void fg_turned_blur_sort(const fg_turned_blur *blur, const fg_sample_square *square, float *line) {
  int64_t pixels = square->side / blur->samples;
  for (int64_t y = 0; y < square->side; y++) {
    float *row = square->values + y * square->side;
    for (int64_t x = 0; x < square->side; x++)
      line[x % blur->samples * pixels + x / blur->samples] = row[x];
    memcpy(row, line, (size_t)square->side * sizeof *row);
  }
}

/* A pixel's middle is its middle sample. */
void fg_turned_blur_row(const fg_turned_blur *blur, const fg_sample_square *square, int64_t y_px,
                        float *out) {
  int64_t pixels = square->side / blur->samples, columns = 2 * blur->taps[0] + 1;
  int64_t middle = blur->samples / 2;
  memset(out, 0, (size_t)square->width_px * sizeof *out);
  for (int64_t j = 0; j <= 2 * blur->taps[1]; j++) {
    int64_t y = blur->samples * (y_px + square->margin) + middle + j - blur->taps[1];
    const float *weights = blur->weights + j * columns, *row = square->values + y * square->side;
    for (int64_t i = blur->first[j]; i < blur->end[j]; i++) {
      int64_t at = blur->samples * square->margin + middle + i - blur->taps[0];
      const float *from = row + at % blur->samples * pixels + at / blur->samples;
      const float weight = weights[i];
      for (int64_t x = 0; x < square->width_px; x++)
        out[x] += weight * from[x];
    }
  }
}
