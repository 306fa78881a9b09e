/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Findings about the driver and the light, from the pixels around a picture's edges and from a few
 * tiles beside them.
 *
 * Fills the members of a state that pixels tell without a model; the others stay unchanged. */
#ifndef FG_VISION_PICTURE_H
#define FG_VISION_PICTURE_H

#include "foilgauge/picture.h"
#include "vision/disc_work.h"
#include "vision/edge_work.h"
#include "vision/picture_profile.h"

/* State of a strip whose edges are found. picture_strip.c */
fg_status fg_picture_of_strip(fg_context *ctx, const fg_edge_work *work, fg_picture_state *state);

/* State of one round or straight edge. picture_ring.c */
fg_status fg_picture_of_ring(fg_context *ctx, const fg_disc_work *work, const fg_disc_edge *edge,
                             fg_picture_state *state);

/* Counts of the pixels near edges. picture_levels.c */
typedef struct fg_value_counts {
  size_t of[256], total; /* by 8-bit count */
  uint64_t low[256][4];  /* by 8-bit count: a bit for each low byte of its 16-bit values */
} fg_value_counts;

void fg_value_counts_clear(fg_value_counts *counts);

static inline void fg_value_counts_add(fg_value_counts *counts, float value) {
  int raw = (int)(value * 257 + 0.5f), high = raw >> 8, low = raw & 255;
  if (raw < 0 || high > 255) return;
  counts->of[high]++;
  counts->total++;
  counts->low[high][low >> 6] |= (uint64_t)1 << (low & 63);
}

/* Gray levels in use, gaps between them, clipping at either end. `levels`: counts inside and
 * outside of the material; state->noise is used. */
void fg_picture_inspect_levels(const fg_value_counts *counts, const double levels[2],
                               fg_picture_state *state);

/* Min blur that a scanner's optics give an edge; a picture of few levels, or a clipped one, may
 * hide it. */
#define FG_HIDDEN_BLUR_PX 1.2

/* Estimates the blur that the ends of the scale may have cut off: state->u_cut where the finding is
 * there, and state->seen_blur. `blur_px`: that of the edge's model. picture_cut.c */
void fg_picture_inspect_cut(const fg_edge_profile *profiles, size_t count, double blur_px,
                            fg_picture_state *state);

/* Tiles to inspect, all of which are kept. */
typedef struct fg_tile_choice {
  const fg_tile *tiles[16];
  size_t count;
} fg_tile_choice;

/* Noise and its correlation, from tiles that hold nothing but background. picture_noise.c */
void fg_picture_inspect_noise(const fg_tile_choice *flat, int bytes_per_pixel,
                              fg_picture_state *state);

/* Steps across multiples of 8 px, from tiles along the edges. picture_blocks.c */
void fg_picture_inspect_blocks(const fg_tile_choice *choice, int bytes_per_pixel, double contrast,
                               fg_picture_state *state);

/* A pixel in 8-bit counts. */
static inline double fg_tile_count(const fg_tile *tile, int bytes_per_pixel, size_t at) {
  if (bytes_per_pixel == 1) return tile->pixels[at];
  return ((const uint16_t *)(const void *)tile->pixels)[at] * (1.0 / 257);
}

/* Returns the quality of the Independent JPEG Group by which the coefficients of 8 x 8 blocks were
 * quantised; 0: none fits, as where the picture was changed afterwards. `first`: begin of a tile's
 * first block along x and y. picture_jpeg.c */
int fg_picture_jpeg_quality(const fg_tile_choice *choice, int bytes_per_pixel,
                            const size_t first[2]);

/* Finds rows at which both edges of the strip jump along y. picture_rows.c */
fg_status fg_picture_inspect_rows(fg_context *ctx, const fg_edge_work *work,
                                  fg_picture_state *state);

/* Finds rows at which both limbs of a round edge jump, along y or x. picture_ring_rows.c */
fg_status fg_picture_inspect_ring_rows(fg_context *ctx, const fg_disc_work *work,
                                       const fg_disc_edge *edge, fg_picture_state *state);

#endif
