/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan/jpeg_tables.h"

#include <math.h>

static const uint8_t natural_order[64] = {
    0,  1,  8,  16, 9,  2,  3,  10, 17, 24, 32, 25, 18, 11, 4,  5,  12, 19, 26, 33, 40, 48,
    41, 34, 27, 20, 13, 6,  7,  14, 21, 28, 35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23,
    30, 37, 44, 51, 58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54, 47, 55, 62, 63};

/* ITU-T T.81, table K.1, in zigzag order, up to FG_JPEG_STEPS. */
static const uint8_t luminance[FG_JPEG_STEPS] = {16, 11, 12, 14, 12, 10, 16, 14, 13, 14,
                                                 18, 17, 16, 19, 24, 40, 26, 24, 22, 22,
                                                 24, 49, 35, 37, 29, 40, 58, 51};

void fg_jpeg_to_zigzag(const uint16_t natural[64], uint16_t zigzag[64]) {
  for (int i = 0; i < 64; i++)
    zigzag[i] = natural[natural_order[i]];
}

/* A step of the table for a quality, as the IJG scales it. */
int fg_jpeg_step_at(int quality, int i) {
  int percent = quality < 50 ? 5000 / quality : 200 - 2 * quality;
  int step = (luminance[i] * percent + 50) / 100;
  return step < 1 ? 1 : step > 255 ? 255 : step;
}

int fg_jpeg_place_of(int i) {
  return natural_order[i];
}

static double square_of_quality(int quality) {
  double sum = 0;
  for (int i = 0; i < FG_JPEG_STEPS; i++)
    sum += fg_jpeg_step_at(quality, i) * fg_jpeg_step_at(quality, i);
  return sum;
}

double fg_jpeg_step_of(int quality) {
  return sqrt(square_of_quality(quality) / FG_JPEG_STEPS);
}

int fg_jpeg_quality_of(const uint16_t zigzag[64]) {
  double sum = 0, nearest = INFINITY;
  int quality = 0;
  for (int i = 0; i < FG_JPEG_STEPS; i++)
    sum += (double)zigzag[i] * zigzag[i];
  for (int q = 100; q >= 1; q--) {
    double distance = fabs(log(square_of_quality(q) / fmax(sum, 1)));
    if (distance <= nearest) quality = q; /* 99 and 100 differ only in higher frequencies: 99 */
    nearest = fmin(nearest, distance);
  }
  return quality;
}

enum { MARKER_SOI = 0xd8, MARKER_SOS = 0xda, MARKER_DQT = 0xdb };

/* A DQT: precision and number in one byte, then 64 steps of one or two bytes. */
static bool read_table(const uint8_t *bytes, size_t length, uint16_t zigzag[64]) {
  size_t width = length > 0 && bytes[0] >> 4 ? 2 : 1;
  if (length < 1 + 64 * width) return false;
  for (size_t i = 0; i < 64; i++) {
    const uint8_t *at = bytes + 1 + i * width;
    zigzag[i] = (uint16_t)(width == 2 ? at[0] << 8 | at[1] : at[0]);
  }
  return true;
}

bool fg_jpeg_find_table(const uint8_t *bytes, size_t length, uint16_t zigzag[64]) {
  size_t at = 0;
  while (at + 4 <= length && bytes[at] == 0xff) {
    uint8_t marker = bytes[at + 1];
    if (marker == MARKER_SOI || marker == 0xff) {
      at += marker == 0xff ? 1 : 2;
      continue;
    }
    size_t size = (size_t)(bytes[at + 2] << 8 | bytes[at + 3]);
    if (marker == MARKER_SOS || size < 2 || size > length - at - 2) return false;
    if (marker == MARKER_DQT) return read_table(bytes + at + 4, size - 2, zigzag);
    at += 2 + size;
  }
  return false;
}
