/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ring: every pixel near a circle, once, with its place along and across it.
 *
 * Pixels are never interpolated; the distance from a circle is exact. Lengths are square pixels
 * (vision/disc_find.h).
 */
#ifndef FG_VISION_RING_H
#define FG_VISION_RING_H

#include "vision/disc_find.h"
#include "vision/edge_model.h"

typedef struct fg_ring_pixel {
  float across_px; /* outwards from the circle */
  float value;     /* 8-bit counts */
  int32_t station; /* station whose share of the turn contains it */
} fg_ring_pixel;

/* A turn is divided into sectors, a sector into stations; station 0 starts in the direction +x and
 * they follow each other towards +y. */
typedef struct fg_ring {
  fg_circle circle;
  double reach_px;
  size_t sector_count, station_count;
  fg_ring_pixel *pixels; /* row by row; owned */
  size_t count, capacity;
} fg_ring;

/* Direction of a station's middle. */
static inline double fg_ring_angle(const fg_ring *ring, size_t station) {
  return ((double)station + 0.5) * 2 * M_PI / (double)ring->station_count;
}

/* Collects all kept pixels within ring->reach_px of ring->circle. The caller sets circle and counts
 * of sectors and stations. Pixels of an earlier call are replaced. */
fg_status fg_ring_collect(fg_context *ctx, const fg_tiles *tiles, const fg_pixel_shape *shape,
                          fg_ring *ring);
void fg_ring_free(fg_ring *ring); /* frees the pixels only */

/* Mean profiles: bins[sector × bin_count + i], FG_RING_BIN_PX wide, from -reach_px. */
#define FG_RING_BIN_PX 0.25
size_t fg_ring_bin_count(double reach_px);
void fg_ring_stack(const fg_ring *ring, fg_profile_bin *bins, size_t bin_count);

#endif
