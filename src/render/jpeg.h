/* What JPEG does to gray pixels: every 8 × 8 block through the discrete cosine transform, its
 * coefficients rounded to multiples of the luminance table of ITU-T T.81 annex K. */
#ifndef FG_RENDER_JPEG_H
#define FG_RENDER_JPEG_H

#include <stdint.h>

typedef struct fg_jpeg {
  float cosines[8][8]; /* orthonormal: [frequency][place] */
  float steps[64];
} fg_jpeg;

/* quality from 1 to 100, scaled as the Independent JPEG Group does. */
void fg_jpeg_init(int quality, fg_jpeg *jpeg);

/* In place, for rows from a multiple of 8; incomplete blocks repeat their last row or column. */
void fg_jpeg_squeeze(const fg_jpeg *jpeg, uint8_t *pixels, int64_t width, int64_t rows,
                     int64_t stride);

#endif
