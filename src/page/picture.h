/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scan as a small gray picture, and pictures as PNG. */
#ifndef FG_PAGE_PICTURE_H
#define FG_PAGE_PICTURE_H

#include <stdint.h>
#include <stdio.h>

#include "foilgauge/foil.h"

typedef struct fg_picture {
  uint8_t *gray; /* width × height; owned */
  int32_t width, height;
  double reduction[2];  /* picture px per scan px, x and y, at most 1 */
  int64_t origin_px[2]; /* of the scan: its pixel at the picture's top left */
} fg_picture;

/* Reads the part `box_px` (x, y, width, height) of the measured scan again, row by row, and
 * reduces it by averaging over boxes to at most `width_max` columns and `pixels_max` pixels.
 * FG_ERR_DATA when the file is no longer the one that was measured. Free with fg_picture_free. */
fg_status fg_picture_load(fg_context *ctx, const fg_measurement *measurement,
                          const int64_t box_px[4], int32_t width_max, double pixels_max,
                          fg_picture *picture);

void fg_picture_free(fg_picture *picture);

/* Encodes a whole PNG in memory: gray (channels 1) or RGB (channels 3). The caller frees *png. */
fg_status fg_png_encode(fg_context *ctx, const uint8_t *pixels, int32_t width, int32_t height,
                        int channels, uint8_t **png, size_t *size);

#endif
