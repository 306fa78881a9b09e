/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The band: every pixel near a strip, once, with its place along and across the reference line.
 *
 * Pixels are never interpolated: each enters with its exact distance from the line, so that noise
 * stays white and the edge position carries no bias of a resampler.
 */
#ifndef FG_VISION_PIXEL_BAND_H
#define FG_VISION_PIXEL_BAND_H

#include "vision/reference.h"
#include "vision/tiles.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_band_pixel {
  float across_px; /* signed distance from the reference line, along its normal */
  float value;     /* 8-bit counts */
  int32_t station; /* station whose step contains it */
} fg_band_pixel;

typedef struct fg_pixel_band {
  fg_band_pixel *pixels; /* in the order of their stations; owned */
  size_t count, capacity;
} fg_pixel_band;

/* All pixels within reach_px of the line that belong to stations [first, last]. Pixels that were
 * not kept are left out. */
fg_status fg_pixel_band_collect(fg_context *ctx, const fg_tiles *tiles,
                                const fg_reference *reference, size_t first, size_t last,
                                double reach_px, fg_pixel_band *band);

void fg_pixel_band_free(fg_pixel_band *band);

#ifdef __cplusplus
}
#endif
#endif
