/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/jpeg.h"

#include <math.h>

static const uint8_t luminance[64] = {16,  11,  10,  16,  24, 40, 51,  61,  12,  12,  14,  19,  26,
                                      58,  60,  55,  14,  13, 16, 24,  40,  57,  69,  56,  14,  17,
                                      22,  29,  51,  87,  80, 62, 18,  22,  37,  56,  68,  109, 103,
                                      77,  24,  35,  55,  64, 81, 104, 113, 92,  49,  64,  78,  87,
                                      103, 121, 120, 101, 72, 92, 95,  98,  112, 100, 103, 99};

static const uint8_t chrominance[64] = {
    17, 18, 24, 47, 99, 99, 99, 99, 18, 21, 26, 66, 99, 99, 99, 99, 24, 26, 56, 99, 99, 99,
    99, 99, 47, 66, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99,
    99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99};

static void scale_steps(const uint8_t table[64], int quality, float steps[64]) {
  int scale = quality < 50 ? 5000 / quality : 200 - 2 * quality;
  for (int i = 0; i < 64; i++) {
    int step = (table[i] * scale + 50) / 100;
    steps[i] = (float)(step < 1 ? 1 : step > 255 ? 255 : step);
  }
}

void fg_jpeg_init(int quality, fg_jpeg *jpeg) {
  scale_steps(luminance, quality, jpeg->luminance);
  scale_steps(chrominance, quality, jpeg->chrominance);
  for (int k = 0; k < 8; k++)
    for (int n = 0; n < 8; n++)
      jpeg->cosines[k][n] =
          (float)(sqrt(k ? 0.25 : 0.125) * cos((2 * n + 1) * k * 3.14159265358979323846 / 16));
}

static void transform_cosine(const float cosines[8][8], int inverse, const float in[8][8],
                             float out[8][8]) {
  float half[8][8];
  for (int i = 0; i < 8; i++)
    for (int j = 0; j < 8; j++) {
      float sum = 0;
      for (int k = 0; k < 8; k++)
        sum += (inverse ? cosines[k][i] : cosines[i][k]) * in[k][j];
      half[i][j] = sum;
    }
  for (int i = 0; i < 8; i++)
    for (int j = 0; j < 8; j++) {
      float sum = 0;
      for (int k = 0; k < 8; k++)
        sum += half[i][k] * (inverse ? cosines[k][j] : cosines[j][k]);
      out[i][j] = sum;
    }
}

/* A block of numbers about 0, through its rounded coefficients. */
static void code_block(const fg_jpeg *jpeg, const float steps[64], float block[8][8]) {
  float spectrum[8][8];
  transform_cosine(jpeg->cosines, 0, (const float(*)[8])block, spectrum);
  for (int i = 0; i < 64; i++)
    spectrum[i / 8][i % 8] = steps[i] * roundf(spectrum[i / 8][i % 8] / steps[i]);
  transform_cosine(jpeg->cosines, 1, (const float(*)[8])spectrum, block);
}

static uint8_t to_byte(float value) {
  return (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
}

static void squeeze_block(const fg_jpeg *jpeg, uint8_t *pixels, int64_t columns, int64_t rows,
                          int64_t stride) {
  float block[8][8];
  for (int64_t y = 0; y < 8; y++)
    for (int64_t x = 0; x < 8; x++)
      block[y][x] =
          (float)pixels[(y < rows ? y : rows - 1) * stride + (x < columns ? x : columns - 1)] - 128;
  code_block(jpeg, jpeg->luminance, block);
  for (int64_t y = 0; y < rows && y < 8; y++)
    for (int64_t x = 0; x < columns && x < 8; x++)
      pixels[y * stride + x] = to_byte(block[y][x] + 128.5F);
}

/* Four blocks of luminance, and one of each colour difference, of 16 × 16 pixels. */
typedef struct colour_block {
  float y[16][16], cb[16][16], cr[16][16]; /* about 0 */
} colour_block;

static void load_colours(const uint8_t *pixels, int64_t columns, int64_t rows, int64_t stride,
                         colour_block *block) {
  for (int64_t y = 0; y < 16; y++)
    for (int64_t x = 0; x < 16; x++) {
      const uint8_t *at =
          pixels + (y < rows ? y : rows - 1) * stride + 3 * (x < columns ? x : columns - 1);
      float r = at[0], g = at[1], b = at[2];
      block->y[y][x] = roundf(0.299F * r + 0.587F * g + 0.114F * b) - 128;
      block->cb[y][x] = roundf(-0.168736F * r - 0.331264F * g + 0.5F * b);
      block->cr[y][x] = roundf(0.5F * r - 0.418688F * g - 0.081312F * b);
    }
}

static void code_luminance(const fg_jpeg *jpeg, float values[16][16]) {
  float block[8][8];
  for (int part = 0; part < 4; part++) {
    int top = part / 2 * 8, left = part % 2 * 8;
    for (int i = 0; i < 64; i++)
      block[i / 8][i % 8] = values[top + i / 8][left + i % 8];
    code_block(jpeg, jpeg->luminance, block);
    for (int i = 0; i < 64; i++)
      values[top + i / 8][left + i % 8] = roundf(block[i / 8][i % 8]);
  }
}

/* Replaces 2 × 2 pixels by their mean. */
static void code_difference(const fg_jpeg *jpeg, float values[16][16]) {
  float block[8][8];
  for (int i = 0; i < 64; i++) {
    int y = i / 8 * 2, x = i % 8 * 2;
    block[i / 8][i % 8] =
        roundf(0.25F * (values[y][x] + values[y][x + 1] + values[y + 1][x] + values[y + 1][x + 1]));
  }
  code_block(jpeg, jpeg->chrominance, block);
  for (int i = 0; i < 256; i++)
    values[i / 16][i % 16] = roundf(block[i / 32][i % 16 / 2]);
}

static void squeeze_colour_block(const fg_jpeg *jpeg, uint8_t *pixels, int64_t columns,
                                 int64_t rows, int64_t stride) {
  colour_block block;
  load_colours(pixels, columns, rows, stride, &block);
  code_luminance(jpeg, block.y);
  code_difference(jpeg, block.cb);
  code_difference(jpeg, block.cr);
  for (int64_t y = 0; y < rows && y < 16; y++)
    for (int64_t x = 0; x < columns && x < 16; x++) {
      uint8_t *at = pixels + y * stride + 3 * x;
      float gray = block.y[y][x] + 128.5F, cb = block.cb[y][x], cr = block.cr[y][x];
      at[0] = to_byte(gray + 1.402F * cr);
      at[1] = to_byte(gray - 0.344136F * cb - 0.714136F * cr);
      at[2] = to_byte(gray + 1.772F * cb);
    }
}

void fg_jpeg_squeeze_colours(const fg_jpeg *jpeg, uint8_t *pixels, int64_t width, int64_t rows,
                             int64_t stride) {
  for (int64_t y = 0; y < rows; y += 16)
    for (int64_t x = 0; x < width; x += 16)
      squeeze_colour_block(jpeg, pixels + y * stride + 3 * x, width - x, rows - y, stride);
}

void fg_jpeg_squeeze(const fg_jpeg *jpeg, uint8_t *pixels, int64_t width, int64_t rows,
                     int64_t stride) {
  for (int64_t y = 0; y < rows; y += 8)
    for (int64_t x = 0; x < width; x += 8)
      squeeze_block(jpeg, pixels + y * stride + x, width - x, rows - y, stride);
}
