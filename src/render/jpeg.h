/* SPDX-License-Identifier: GPL-3.0-or-later */
/* JPEG's loss: every 8 × 8 block through the discrete cosine transform, its coefficients rounded to
 * multiples of the tables of ITU-T T.81 annex K.
 *
 * Colours become luminance and two colour differences of half the resolution (JFIF, 4:2:0), as in
 * most encoders. */
#ifndef FG_RENDER_JPEG_H
#define FG_RENDER_JPEG_H

#include <stdint.h>

typedef struct fg_jpeg {
  float cosines[8][8];                  /* orthonormal: [frequency][place] */
  float luminance[64], chrominance[64]; /* steps of the coefficients */
} fg_jpeg;

/* quality from 1 to 100, scaled as the Independent JPEG Group does. */
void fg_jpeg_init(int quality, fg_jpeg *jpeg);

/* Compresses gray rows in place, from a multiple of 8; incomplete blocks repeat their last row or
 * column. */
void fg_jpeg_squeeze(const fg_jpeg *jpeg, uint8_t *pixels, int64_t width, int64_t rows,
                     int64_t stride);

/* Compresses rows of red, green and blue in place, from a multiple of 16; `stride` is in bytes. */
void fg_jpeg_squeeze_colours(const fg_jpeg *jpeg, uint8_t *pixels, int64_t width, int64_t rows,
                             int64_t stride);

#endif
