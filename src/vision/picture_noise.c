/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Noise of a pixel and its correlation to its neighbours, from flat tiles. */
#include <math.h>

#include "core/select.h"
#include "vision/picture.h"

enum { LAG_FAR = 6, ROW_STEP = 2 };
/* Max correlation of neighbours: flatbeds at their best resolution reach 0.7. */
#define CORRELATION_MAX 0.85
/* Min noise; rounding to whole counts is no property of the scanner. */
#define NOISE_MIN 0.2

/* Mean squared differences of pixels one and six apart. */
typedef struct tile_noise {
  double far, near[2];
} tile_noise;

static double tile_count_at(const fg_tile *tile, int bytes_per_pixel, size_t at) {
  if (bytes_per_pixel == 1) return tile->pixels[at];
  return ((const uint16_t *)(const void *)tile->pixels)[at] * (1.0 / 257);
}

static tile_noise measure_tile(const fg_tile *tile, int bytes_per_pixel) {
  double far = 0, near[2] = {0, 0}, n = 0;
  for (size_t y = 0; y + LAG_FAR < FG_TILE_PX; y += ROW_STEP)
    for (size_t x = 0; x + LAG_FAR < FG_TILE_PX; x++) {
      size_t at = y * FG_TILE_PX + x;
      double value = tile_count_at(tile, bytes_per_pixel, at);
      double right = value - tile_count_at(tile, bytes_per_pixel, at + 1);
      double down = value - tile_count_at(tile, bytes_per_pixel, at + FG_TILE_PX);
      double off = value - tile_count_at(tile, bytes_per_pixel, at + LAG_FAR);
      double below = value - tile_count_at(tile, bytes_per_pixel, at + LAG_FAR * FG_TILE_PX);
      near[0] += right * right;
      near[1] += down * down;
      far += 0.5 * (off * off + below * below);
      n++;
    }
  return (tile_noise){far / n, {near[0] / n, near[1] / n}};
}

void fg_picture_inspect_noise(const fg_tile_choice *flat, int bytes_per_pixel,
                              fg_picture_state *state) {
  double far[16], near[2][16];
  if (!flat->count) return;
  for (size_t i = 0; i < flat->count; i++) {
    tile_noise noise = measure_tile(flat->tiles[i], bytes_per_pixel);
    far[i] = noise.far;
    for (int axis = 0; axis < 2; axis++)
      near[axis][i] = noise.far > 0 ? noise.near[axis] / noise.far : 1;
  }
  state->noise = sqrt(0.5 * fg_select(far, flat->count, flat->count / 2));
  if (state->noise < NOISE_MIN) return;
  for (int axis = 0; axis < 2; axis++) {
    state->noise_correlation[axis] = 1 - fg_select(near[axis], flat->count, flat->count / 2);
    if (state->noise_correlation[axis] > CORRELATION_MAX)
      state->findings |= FG_PICTURE_CORRELATED_NOISE;
  }
}
