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

/* Pixels of stations [first, first + stations), those of one station after those of the station
 * before it: its are [begin[k], begin[k + 1]) with k counted from `first`. */
typedef struct fg_pixel_band {
  size_t first, stations;
  size_t *begin;    /* stations + 1; owned */
  float *across_px; /* signed distance from the reference line, along its normal; owned */
  float *value;     /* 8-bit counts; in the block of across_px */
  size_t count;     /* number of pixels */
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
