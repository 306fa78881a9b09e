/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Up needs no order and is left to the compiler. Sub is a running sum: within sixteen bytes by
 * doubling steps, so that only one addition waits for the sixteen before. Average and Paeth go from
 * pixel to pixel: with three bytes or more, all of a pixel at once; with one or two, a byte at a
 * time without branches. */
#include "scan/png_unfilter.h"

#include <string.h>

enum { FILTER_NONE, FILTER_SUB, FILTER_UP, FILTER_AVERAGE, FILTER_PAETH };

typedef uint8_t bytes_16 __attribute__((vector_size(16)));
typedef uint8_t bytes_8 __attribute__((vector_size(8)));
typedef int16_t words_8 __attribute__((vector_size(16)));

#define INLINE static inline __attribute__((always_inline))

__attribute__((target_clones("avx2", "default"))) static void undo_up(const uint8_t *above,
                                                                      uint8_t *row, size_t size) {
  for (size_t i = 0; i < size; i++)
    row[i] = (uint8_t)(row[i] + above[i]);
}

INLINE void undo_sub_bytewise(uint8_t *row, size_t from, size_t size, size_t pixel_bytes) {
  for (size_t i = from < pixel_bytes ? pixel_bytes : from; i < size; i++)
    row[i] = (uint8_t)(row[i] + row[i - pixel_bytes]);
}

/* Lanes of the first vector moved up by a step, zeros below. */
#define MOVED(v, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p)                                   \
  __builtin_shufflevector(v, (bytes_16){0}, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p)

INLINE bytes_16 sum_within(bytes_16 v, size_t pixel_bytes) {
  if (pixel_bytes <= 1) v += MOVED(v, 16, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14);
  if (pixel_bytes <= 2) v += MOVED(v, 16, 16, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13);
  if (pixel_bytes <= 4) v += MOVED(v, 16, 16, 16, 16, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11);
  return v + MOVED(v, 16, 16, 16, 16, 16, 16, 16, 16, 0, 1, 2, 3, 4, 5, 6, 7);
}

/* The last pixel of the vector, in the place of every pixel. */
INLINE bytes_16 last_pixel(bytes_16 v, size_t pixel_bytes) {
  if (pixel_bytes == 1)
    return MOVED(v, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15, 15);
  if (pixel_bytes == 2)
    return MOVED(v, 14, 15, 14, 15, 14, 15, 14, 15, 14, 15, 14, 15, 14, 15, 14, 15);
  if (pixel_bytes == 4)
    return MOVED(v, 12, 13, 14, 15, 12, 13, 14, 15, 12, 13, 14, 15, 12, 13, 14, 15);
  return MOVED(v, 8, 9, 10, 11, 12, 13, 14, 15, 8, 9, 10, 11, 12, 13, 14, 15);
}

INLINE void undo_sub(uint8_t *row, size_t size, size_t pixel_bytes) {
  size_t i = 0;
  bytes_16 carry = {0};
  for (; i + 16 <= size; i += 16) {
    bytes_16 v;
    memcpy(&v, row + i, 16);
    v = sum_within(v, pixel_bytes) + carry;
    carry = last_pixel(v, pixel_bytes);
    memcpy(row + i, &v, 16);
  }
  undo_sub_bytewise(row, i, size, pixel_bytes);
}

/* Loads bytes beyond the pixel, too: FG_PNG_ROW_SLACK. */
INLINE words_8 load_pixel(const uint8_t *from, size_t pixel_bytes) {
  uint64_t wide = 0;
  bytes_8 bytes;
  memcpy(&wide, from, pixel_bytes <= 4 ? 4 : 8);
  memcpy(&bytes, &wide, 8);
  return __builtin_convertvector(bytes, words_8);
}

/* Stores modulo 256, as the filters count, in the sizes that a processor stores; returns the stored
 * bytes. */
INLINE words_8 store_pixel(uint8_t *to, words_8 value, size_t pixel_bytes) {
  bytes_8 bytes = __builtin_convertvector(value, bytes_8);
  uint64_t wide;
  memcpy(&wide, &bytes, 8);
  size_t whole = pixel_bytes == 3 ? 2 : pixel_bytes == 6 ? 4 : pixel_bytes;
  memcpy(to, &wide, whole);
  for (size_t i = whole; i < pixel_bytes; i++)
    to[i] = bytes[i];
  return __builtin_convertvector(bytes, words_8);
}

INLINE words_8 magnitude(words_8 v) {
  words_8 negative = v < 0;
  return (v ^ negative) - negative;
}

INLINE words_8 choose(words_8 mask, words_8 yes, words_8 no) {
  return (mask & yes) | (~mask & no);
}

/* Of left, above and above left the one nearest to left + above - above left, in this order. */
INLINE words_8 predict_pixel(words_8 left, words_8 above, words_8 corner) {
  words_8 to_left = above - corner, to_above = left - corner;
  words_8 far_corner = magnitude(to_left + to_above), far_left = magnitude(to_left),
          far_above = magnitude(to_above);
  words_8 right = choose(far_above <= far_corner, above, corner);
  return choose((far_left <= far_above) & (far_left <= far_corner), left, right);
}

INLINE void undo_sub_pixels(uint8_t *row, size_t size, size_t pixel_bytes) {
  words_8 left = {0};
  for (size_t i = 0; i + pixel_bytes <= size; i += pixel_bytes)
    left = store_pixel(row + i, load_pixel(row + i, pixel_bytes) + left, pixel_bytes);
}

INLINE void undo_average_pixels(const uint8_t *above, uint8_t *row, size_t size,
                                size_t pixel_bytes) {
  words_8 left = {0};
  for (size_t i = 0; i + pixel_bytes <= size; i += pixel_bytes) {
    words_8 mean = (left + load_pixel(above + i, pixel_bytes)) >> 1;
    left = store_pixel(row + i, load_pixel(row + i, pixel_bytes) + mean, pixel_bytes);
  }
}

INLINE void undo_paeth_pixels(const uint8_t *above, uint8_t *row, size_t size, size_t pixel_bytes) {
  words_8 left = {0}, corner = {0};
  for (size_t i = 0; i + pixel_bytes <= size; i += pixel_bytes) {
    words_8 up = load_pixel(above + i, pixel_bytes);
    words_8 predicted = predict_pixel(left, up, corner);
    left = store_pixel(row + i, load_pixel(row + i, pixel_bytes) + predicted, pixel_bytes);
    corner = up;
  }
}

INLINE void undo_average_bytes(const uint8_t *above, uint8_t *row, size_t size,
                               size_t pixel_bytes) {
  unsigned left[2] = {0};
  for (size_t i = 0; i + pixel_bytes <= size; i += pixel_bytes)
    for (size_t k = 0; k < pixel_bytes; k++) {
      left[k] = (row[i + k] + ((left[k] + above[i + k]) >> 1)) & 0xff;
      row[i + k] = (uint8_t)left[k];
    }
}

INLINE int magnitude_1(int v) {
  return v < 0 ? -v : v;
}

/* Written so that the compiler has nothing to branch on. */
INLINE int predict_byte(int left, int above, int corner) {
  int far_left = magnitude_1(above - corner), far_above = magnitude_1(left - corner),
      far_corner = magnitude_1(left + above - 2 * corner);
  int right = far_above <= far_corner ? above : corner;
  int nearer = far_above <= far_corner ? far_above : far_corner;
  return far_left <= nearer ? left : right;
}

INLINE void undo_paeth_bytes(const uint8_t *above, uint8_t *row, size_t size, size_t pixel_bytes) {
  int left[2] = {0}, corner[2] = {0};
  for (size_t i = 0; i + pixel_bytes <= size; i += pixel_bytes)
    for (size_t k = 0; k < pixel_bytes; k++) {
      int up = above[i + k];
      left[k] = (row[i + k] + predict_byte(left[k], up, corner[k])) & 0xff;
      corner[k] = up;
      row[i + k] = (uint8_t)left[k];
    }
}

/* One for each size of a pixel, so that the compiler knows it. */
#define FOR_PIXELS(bytes, sub, average, paeth)                                                     \
  static void undo_##bytes(unsigned filter, const uint8_t *above, uint8_t *row, size_t size) {     \
    if (filter == FILTER_SUB)                                                                      \
      sub;                                                                                         \
    else if (filter == FILTER_AVERAGE)                                                             \
      average(above, row, size, bytes);                                                            \
    else                                                                                           \
      paeth(above, row, size, bytes);                                                              \
  }

FOR_PIXELS(1, undo_sub(row, size, 1), undo_average_bytes, undo_paeth_bytes)
FOR_PIXELS(2, undo_sub(row, size, 2), undo_average_bytes, undo_paeth_bytes)
FOR_PIXELS(3, undo_sub_pixels(row, size, 3), undo_average_pixels, undo_paeth_pixels)
FOR_PIXELS(4, undo_sub(row, size, 4), undo_average_pixels, undo_paeth_pixels)
FOR_PIXELS(6, undo_sub_pixels(row, size, 6), undo_average_pixels, undo_paeth_pixels)
FOR_PIXELS(8, undo_sub(row, size, 8), undo_average_pixels, undo_paeth_pixels)

bool fg_png_unfilter(unsigned filter, size_t pixel_bytes, const uint8_t *above, uint8_t *row,
                     size_t row_bytes) {
  static void (*const undo[9])(unsigned, const uint8_t *, uint8_t *, size_t) = {
      [1] = undo_1, [2] = undo_2, [3] = undo_3, [4] = undo_4, [6] = undo_6, [8] = undo_8};
  if (filter > FILTER_PAETH) return false;
  if (filter == FILTER_UP)
    undo_up(above, row, row_bytes);
  else if (filter != FILTER_NONE)
    undo[pixel_bytes](filter, above, row, row_bytes);
  return true;
}
