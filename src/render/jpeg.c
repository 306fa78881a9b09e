#include "render/jpeg.h"

#include <math.h>

static const uint8_t luminance[64] = {16,  11,  10,  16,  24, 40, 51,  61,  12,  12,  14,  19,  26,
                                      58,  60,  55,  14,  13, 16, 24,  40,  57,  69,  56,  14,  17,
                                      22,  29,  51,  87,  80, 62, 18,  22,  37,  56,  68,  109, 103,
                                      77,  24,  35,  55,  64, 81, 104, 113, 92,  49,  64,  78,  87,
                                      103, 121, 120, 101, 72, 92, 95,  98,  112, 100, 103, 99};

void fg_jpeg_init(int quality, fg_jpeg *jpeg) {
  int scale = quality < 50 ? 5000 / quality : 200 - 2 * quality;
  for (int i = 0; i < 64; i++) {
    int step = (luminance[i] * scale + 50) / 100;
    jpeg->steps[i] = (float)(step < 1 ? 1 : step > 255 ? 255 : step);
  }
  for (int k = 0; k < 8; k++)
    for (int n = 0; n < 8; n++)
      jpeg->cosines[k][n] =
          (float)(sqrt(k ? 0.25 : 0.125) * cos((2 * n + 1) * k * 3.14159265358979323846 / 16));
}

static void transform(const float cosines[8][8], int inverse, const float in[8][8],
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

static void squeeze_block(const fg_jpeg *jpeg, uint8_t *pixels, int64_t columns, int64_t rows,
                          int64_t stride) {
  float block[8][8], spectrum[8][8];
  for (int64_t y = 0; y < 8; y++)
    for (int64_t x = 0; x < 8; x++)
      block[y][x] =
          (float)pixels[(y < rows ? y : rows - 1) * stride + (x < columns ? x : columns - 1)] - 128;
  transform(jpeg->cosines, 0, (const float(*)[8])block, spectrum);
  for (int i = 0; i < 64; i++)
    spectrum[i / 8][i % 8] = jpeg->steps[i] * roundf(spectrum[i / 8][i % 8] / jpeg->steps[i]);
  transform(jpeg->cosines, 1, (const float(*)[8])spectrum, block);
  for (int64_t y = 0; y < rows && y < 8; y++)
    for (int64_t x = 0; x < columns && x < 8; x++) {
      float value = block[y][x] + 128.5F;
      pixels[y * stride + x] = (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
    }
}

void fg_jpeg_squeeze(const fg_jpeg *jpeg, uint8_t *pixels, int64_t width, int64_t rows,
                     int64_t stride) {
  for (int64_t y = 0; y < rows; y += 8)
    for (int64_t x = 0; x < width; x += 8)
      squeeze_block(jpeg, pixels + y * stride + x, width - x, rows - y, stride);
}
