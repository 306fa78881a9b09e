/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/tile.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

enum { MARGIN_MAX_PX = 64 }; /* for the widest blur: 10 px and a motion of 20 px */

static int64_t round_up(double value, int64_t step) {
  return step * (int64_t)ceil(value / (double)step);
}

/* Integral of the normal distribution function of sd `sigma`. */
static double ramp_integral(double u, double sigma) {
  double z = u / sigma;
  return 0.5 * u * erfc(-z / sqrt(2.0)) +
         sigma * exp(-0.5 * z * z) / sqrt(2 * 3.14159265358979323846);
}

/* Gaussian of sd `sigma` through the pixel's box, and through that of the motion during its
 * reading. A box is a difference of the integral, two boxes a difference of the integral's
 * integral. */
static double kernel_weight(double u, double sigma, double motion_px) {
  const double still_px = 0.01; /* below this the difference of ramps loses digits */
  double half = 0.5 * motion_px;
  if (motion_px < still_px)
    return 0.5 * (erf((u + 0.5) / (sigma * sqrt(2.0))) - erf((u - 0.5) / (sigma * sqrt(2.0))));
  return (ramp_integral(u + 0.5 + half, sigma) - ramp_integral(u + 0.5 - half, sigma) -
          ramp_integral(u - 0.5 + half, sigma) + ramp_integral(u - 0.5 - half, sigma)) /
         motion_px;
}

/* Kernel for samples: the smoothing by the sampling is subtracted first. The sum is 1, so plateaus
 * keep their value. */
static fg_status make_kernel(fg_context *ctx, double blur_px, double motion_px, double sampled_px,
                             int *taps, float **kernel) {
  double sigma = sqrt(blur_px * blur_px - sampled_px * sampled_px);
  *taps = (int)ceil(FG_SAMPLES * (0.5 + 0.5 * motion_px + 4.5 * sigma));
  size_t count = 2 * (size_t)*taps + 1;
  double sum = 0;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof **kernel, (void **)kernel));
  for (int pass = 0; pass < 2; pass++)
    for (int k = -*taps; k <= *taps; k++) {
      double u = (double)k / FG_SAMPLES;
      double weight = kernel_weight(u, sigma, motion_px);
      if (pass == 0)
        sum += weight;
      else
        (*kernel)[k + *taps] = (float)(weight / sum);
    }
  return FG_OK;
}

/* Cells of the halo: light scattered within the scanner, as two Gaussians of sd 0.6 L and 1.6 L
 * with equal shares. Its foot falls to 1/e about L from an edge. Rows: pixel offset within a cell;
 * columns: cells. */
static int halo_cells(const fg_tiler *tiler) {
  return (int)((FG_TILE_PX + 2 * tiler->halo_px) / FG_COARSE_PX);
}

static void make_halo_kernel(fg_tiler *tiler, double length_px) {
  int cells = halo_cells(tiler);
  for (int part = 0; part < 2; part++)
    for (int pixel = 0; pixel < FG_TILE_PX; pixel++) {
      double sd = (part ? 1.6 : 0.6) * length_px, sum = 0;
      float *row = tiler->halo_kernel + (size_t)(part * FG_TILE_PX + pixel) * (size_t)cells;
      for (int cell = 0; cell < cells; cell++) {
        double centre = FG_COARSE_PX * cell + 0.5 * (FG_COARSE_PX - 1) - (double)tiler->halo_px;
        double u = (pixel - centre) / sd;
        row[cell] = (float)exp(-0.5 * u * u);
        sum += (double)row[cell];
      }
      for (int cell = 0; cell < cells; cell++)
        row[cell] = (float)((double)row[cell] / sum);
    }
}

static fg_status create_halo(fg_context *ctx, const fg_scanner *scanner, fg_tiler *tiler) {
  if (scanner->halo_fraction <= 0) return FG_OK;
  tiler->halo_px = round_up(4.5 * scanner->halo_length_px, FG_BLOCK_PX);
  size_t cells = (size_t)halo_cells(tiler);
  FG_TRY(fg_memory_allocate(ctx, cells * cells, sizeof(float), (void **)&tiler->cells));
  FG_TRY(fg_memory_allocate(ctx, cells * FG_TILE_PX, sizeof(float), (void **)&tiler->cell_rows));
  FG_TRY(fg_memory_allocate(ctx, FG_TILE_PX * FG_TILE_PX, sizeof(float), (void **)&tiler->halo));
  FG_TRY(
      fg_memory_allocate(ctx, 2 * FG_TILE_PX * cells, sizeof(float), (void **)&tiler->halo_kernel));
  make_halo_kernel(tiler, scanner->halo_length_px);
  return FG_OK;
}

static int64_t sample_side(const fg_tiler *tiler) {
  return FG_SAMPLES * (FG_TILE_PX + 2 * tiler->margin_px);
}

static fg_status create_blur(fg_context *ctx, const fg_sampler *sampler, fg_tiler *tiler) {
  const fg_scanner *scanner = &sampler->spec->scanner;
  fg_blur_ellipse ellipse = {.angle_deg = scanner->blur_angle_deg,
                             .motion = scanner->motion_blur_px};
  for (int axis = 0; axis < 2; axis++) {
    ellipse.sd[axis] = scanner->blur_px[axis];
    ellipse.sampled[axis] = sampler->sd_mm / sampler->pixel_mm[axis];
  }
  if (fg_blur_is_turned(&ellipse)) {
    FG_TRY(fg_turned_blur_create(ctx, &ellipse, FG_SAMPLES, &tiler->turned));
    memcpy(tiler->taps, tiler->turned.taps, sizeof tiler->taps);
    return FG_OK;
  }
  for (int axis = 0; axis < 2; axis++)
    FG_TRY(make_kernel(ctx, ellipse.sd[axis], axis ? ellipse.motion : 0, ellipse.sampled[axis],
                       &tiler->taps[axis], &tiler->kernel[axis]));
  return FG_OK;
}

fg_status fg_tiler_create(fg_context *ctx, fg_sampler *sampler, fg_tiler *tiler) {
  const fg_scanner *scanner = &sampler->spec->scanner;
  *tiler = (fg_tiler){.sampler = sampler};
  FG_TRY(create_blur(ctx, sampler, tiler));
  int taps = tiler->taps[0] > tiler->taps[1] ? tiler->taps[0] : tiler->taps[1];
  tiler->margin_px = round_up((double)(taps + 1) / FG_SAMPLES, FG_BLOCK_PX);
  size_t side = (size_t)sample_side(tiler);
  FG_TRY(fg_memory_allocate(ctx, side * side, sizeof(float), (void **)&tiler->samples));
  FG_TRY(fg_memory_allocate(ctx, FG_TILE_PX * FG_TILE_PX, sizeof(float), (void **)&tiler->jump));
  return create_halo(ctx, scanner, tiler);
}

void fg_tiler_free(fg_tiler *tiler) {
  float *blocks[] = {tiler->kernel[0], tiler->kernel[1], tiler->samples, tiler->jump,
                     tiler->cells,     tiler->cell_rows, tiler->halo,    tiler->halo_kernel};
  for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++)
    free(blocks[i]);
  fg_turned_blur_free(&tiler->turned);
  *tiler = (fg_tiler){0};
}

int64_t fg_tiler_reach_px(const fg_tiler *tiler) {
  return tiler->margin_px > tiler->halo_px ? tiler->margin_px : tiler->halo_px;
}

/* Fills one block's samples into the tile's sample buffer. */
static void sample_block(const fg_tiler *tiler, const fg_near *near, int64_t x_px, int64_t y_px,
                         float *out, int64_t stride) {
  const fg_sampler *sampler = tiler->sampler;
  const int count = FG_BLOCK_PX * FG_SAMPLES;
  const float plain = near->filled ? 1.0F : 0.0F;
  for (int j = 0; j < count; j++) {
    double y = ((double)y_px + (double)(j - 1) / FG_SAMPLES) * sampler->pixel_mm[1];
    for (int i = 0; i < count; i++) {
      double x = ((double)x_px + (double)(i - 1) / FG_SAMPLES) * sampler->pixel_mm[0];
      out[j * stride + i] =
          near->count ? (float)fg_sample(sampler, near, x, y, sampler->sd_mm) : plain;
    }
  }
}

static void sample_tile(const fg_tiler *tiler, const fg_band *band, int64_t x0, int64_t y0) {
  int64_t stride = sample_side(tiler), margin = tiler->margin_px;
  fg_near near;
  for (int64_t y = -margin; y < FG_TILE_PX + margin; y += FG_BLOCK_PX)
    for (int64_t x = -margin; x < FG_TILE_PX + margin; x += FG_BLOCK_PX) {
      fg_band_gather(band, (x0 + x) / FG_BLOCK_PX, (y0 + y) / FG_BLOCK_PX, &near);
      float *out = tiler->samples + FG_SAMPLES * ((y + margin) * stride + (x + margin));
      sample_block(tiler, &near, x0 + x, y0 + y, out, stride);
    }
}

/* Blurs down the columns first, to one value per pixel row: the inner loop runs along memory. */
static void blur_tile(const fg_tiler *tiler, float *out, int64_t stride) {
  int64_t side = sample_side(tiler);
  float line[FG_SAMPLES * (FG_TILE_PX + 2 * MARGIN_MAX_PX)];
  for (int64_t y = 0; y < FG_TILE_PX; y++) {
    int64_t centre = FG_SAMPLES * (y + tiler->margin_px) + 1;
    memset(line, 0, (size_t)side * sizeof *line);
    for (int k = -tiler->taps[1]; k <= tiler->taps[1]; k++) {
      const float *row = tiler->samples + (centre + k) * side;
      const float weight = tiler->kernel[1][k + tiler->taps[1]];
      for (int64_t x = 0; x < side; x++)
        line[x] += weight * row[x];
    }
    for (int64_t x = 0; x < FG_TILE_PX; x++) {
      const float *at = line + FG_SAMPLES * (x + tiler->margin_px) + 1 - tiler->taps[0];
      float sum = 0;
      for (int k = 0; k <= 2 * tiler->taps[0]; k++)
        sum += tiler->kernel[0][k] * at[k];
      out[y * stride + x] = sum;
    }
  }
}

static void blur_tile_turned(const fg_tiler *tiler, float *out, int64_t stride) {
  float line[FG_SAMPLES * (FG_TILE_PX + 2 * MARGIN_MAX_PX)];
  const fg_sample_square square = {.values = tiler->samples,
                                   .side = sample_side(tiler),
                                   .margin = tiler->margin_px,
                                   .width_px = FG_TILE_PX};
  fg_turned_blur_sort(&tiler->turned, &square, line);
  for (int64_t y = 0; y < FG_TILE_PX; y++)
    fg_turned_blur_row(&tiler->turned, &square, y, out + y * stride);
}

/* Mean of a cell, by 2 × 2 samples smoothed with 1.2 px: enough under a blur of 6 px. */
static float sample_cell(const fg_tiler *tiler, const fg_near *near, double x_px, double y_px) {
  const fg_sampler *sampler = tiler->sampler;
  double sum = 0;
  for (int k = 0; k < 4; k++) {
    double x = (x_px + ((k & 1) ? 2.5 : 0.5)) * sampler->pixel_mm[0];
    double y = (y_px + ((k & 2) ? 2.5 : 0.5)) * sampler->pixel_mm[1];
    sum += fg_sample(sampler, near, x, y, 4 * sampler->sd_mm);
  }
  return (float)(0.25 * sum);
}

static void sample_cells(const fg_tiler *tiler, const fg_band *band, int64_t x0, int64_t y0) {
  int64_t cells = halo_cells(tiler), per_block = FG_BLOCK_PX / FG_COARSE_PX;
  fg_near near;
  for (int64_t y = 0; y < cells; y += per_block)
    for (int64_t x = 0; x < cells; x += per_block) {
      int64_t px = x0 - tiler->halo_px + FG_COARSE_PX * x;
      int64_t py = y0 - tiler->halo_px + FG_COARSE_PX * y;
      fg_band_gather(band, px / FG_BLOCK_PX, py / FG_BLOCK_PX, &near);
      for (int64_t k = 0; k < per_block * per_block; k++) {
        int64_t i = k % per_block, j = k / per_block;
        tiler->cells[(y + j) * cells + x + i] =
            near.count    ? sample_cell(tiler, &near, (double)(px + FG_COARSE_PX * i),
                                        (double)(py + FG_COARSE_PX * j))
            : near.filled ? 1.0F
                          : 0.0F;
      }
    }
}

static void blur_cells(const fg_tiler *tiler, int part) {
  int64_t cells = halo_cells(tiler);
  const float *kernel = tiler->halo_kernel + part * FG_TILE_PX * cells;
  for (int64_t y = 0; y < FG_TILE_PX; y++) {
    float *line = tiler->cell_rows;
    memset(line, 0, (size_t)cells * sizeof *line);
    for (int64_t j = 0; j < cells; j++)
      for (int64_t x = 0; x < cells; x++)
        line[x] += kernel[y * cells + j] * tiler->cells[j * cells + x];
    for (int64_t x = 0; x < FG_TILE_PX; x++) {
      float sum = 0;
      for (int64_t i = 0; i < cells; i++)
        sum += kernel[x * cells + i] * line[i];
      tiler->halo[y * FG_TILE_PX + x] += 0.5F * sum;
    }
  }
}

static void add_halo(const fg_tiler *tiler, const fg_band *band, int64_t x0, int64_t y0, float *out,
                     int64_t stride) {
  float share = (float)tiler->sampler->spec->scanner.halo_fraction;
  sample_cells(tiler, band, x0, y0);
  memset(tiler->halo, 0, FG_TILE_PX * FG_TILE_PX * sizeof *tiler->halo);
  for (int part = 0; part < 2; part++)
    blur_cells(tiler, part);
  for (int64_t y = 0; y < FG_TILE_PX; y++)
    for (int64_t x = 0; x < FG_TILE_PX; x++)
      out[y * stride + x] += share * (tiler->halo[y * FG_TILE_PX + x] - out[y * stride + x]);
}

static bool anything_within(const fg_band *band, int64_t x0, int64_t y0, int64_t margin) {
  return fg_band_any(band, (x0 - margin) / FG_BLOCK_PX, (y0 - margin) / FG_BLOCK_PX,
                     (x0 + FG_TILE_PX + margin) / FG_BLOCK_PX - 1,
                     (y0 + FG_TILE_PX + margin) / FG_BLOCK_PX - 1);
}

static void draw_plain(fg_tiler *tiler, const fg_band *band, int64_t x0, int64_t y0, float *out,
                       int64_t stride) {
  if (anything_within(band, x0, y0, tiler->margin_px)) {
    sample_tile(tiler, band, x0, y0);
    (tiler->turned.weights ? blur_tile_turned : blur_tile)(tiler, out, stride);
  } else {
    for (int64_t y = 0; y < FG_TILE_PX; y++)
      memset(out + y * stride, 0, FG_TILE_PX * sizeof *out);
  }
  if (tiler->halo_px) add_halo(tiler, band, x0, y0, out, stride);
}

/* The next jump at the place where the drawn line meets it; NaN without. */
static double next_jump(const fg_tiler *tiler, int axis, double low_mm, double high_mm) {
  const fg_sampler *sampler = tiler->sampler;
  double lag = axis ? sampler->lag_mm : 0;
  return fg_render_effects_next_step(&sampler->spec->effects, axis, low_mm + lag, high_mm + lag) -
         lag;
}

/* First pixel after `from` that lies beyond the next jump along an axis, within the tile. */
static int64_t run_end(const fg_tiler *tiler, int axis, int64_t origin, int64_t from) {
  double pixel = tiler->sampler->pixel_mm[axis], at = (double)(origin + from) * pixel;
  double jump = next_jump(tiler, axis, at, INFINITY);
  int64_t end = from + 1;
  while (end < FG_TILE_PX && !((double)(origin + end) * pixel > jump))
    end++;
  return end;
}

/* Draws a tile with jumps: once for every run of rows and columns between jumps, as such pixels see
 * the whole neighbourhood from their own side of the jumps. */
static void draw_with_jumps(fg_tiler *tiler, const fg_band *band, int64_t x0, int64_t y0,
                            float *out, int64_t stride) {
  fg_sampler *sampler = tiler->sampler;
  for (int64_t top = 0, bottom; top < FG_TILE_PX; top = bottom) {
    bottom = run_end(tiler, 1, y0, top);
    sampler->side_mm[1] = (double)(y0 + top) * sampler->pixel_mm[1];
    for (int64_t left = 0, right; left < FG_TILE_PX; left = right) {
      right = run_end(tiler, 0, x0, left);
      sampler->side_mm[0] = (double)(x0 + left) * sampler->pixel_mm[0];
      draw_plain(tiler, band, x0, y0, tiler->jump, FG_TILE_PX);
      for (int64_t y = top; y < bottom; y++)
        memcpy(out + y * stride + left, tiler->jump + y * FG_TILE_PX + left,
               (size_t)(right - left) * sizeof *out);
    }
  }
  sampler->side_mm[0] = sampler->side_mm[1] = NAN;
}

/* Returns true when a jump lies within reach of the tile's pixels. */
static bool has_jump(const fg_tiler *tiler, int axis, int64_t origin_px) {
  int64_t reach = fg_tiler_reach_px(tiler);
  double pixel = tiler->sampler->pixel_mm[axis];
  return !isnan(next_jump(tiler, axis, (double)(origin_px - reach) * pixel,
                          (double)(origin_px + FG_TILE_PX + reach) * pixel));
}

bool fg_tiler_draw(fg_tiler *tiler, const fg_band *band, int64_t x0_px, int64_t y0_px, float *out,
                   int64_t stride) {
  int64_t reach = fg_tiler_reach_px(tiler);
  if (!anything_within(band, x0_px, y0_px, reach)) return false;
  if (!has_jump(tiler, 0, x0_px) && !has_jump(tiler, 1, y0_px))
    draw_plain(tiler, band, x0_px, y0_px, out, stride);
  else
    draw_with_jumps(tiler, band, x0_px, y0_px, out, stride);
  return true;
}
