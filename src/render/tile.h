/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A tile of 64 × 64 pixels: samples, then the remaining optical blur and the pixel's square as a
 * two-dimensional, separable low-pass; halo.
 *
 * Tiles lie on a fixed grid and do not depend on each other. So the picture does not depend on the
 * order or the height of strips. */
#ifndef FG_RENDER_TILE_H
#define FG_RENDER_TILE_H

#include "render/sampler.h"
#include "render/turned_blur.h"

enum {
  FG_TILE_PX = 64,
  FG_SAMPLES = 3,  /* per pixel and axis */
  FG_COARSE_PX = 4 /* cells of the halo's map */
};

typedef struct fg_tiler {
  fg_sampler *sampler;
  int64_t margin_px; /* around a tile, for the blur; a multiple of 8 */
  int64_t halo_px;   /* around a tile, for the halo; 0 without */
  int taps[2];       /* of the kernel on each axis, each side of the centre */
  float *kernel[2];
  fg_turned_blur turned; /* without weights the blur separates along x and y */
  float *samples, *jump; /* buffers */
  float *cells, *cell_rows, *halo, *halo_kernel;
} fg_tiler;

fg_status fg_tiler_create(fg_context *ctx, fg_sampler *sampler, fg_tiler *tiler);
void fg_tiler_free(fg_tiler *tiler);

/* Distance beyond a tile at which its content matters: the larger of the two margins. */
int64_t fg_tiler_reach_px(const fg_tiler *tiler);

/* Draws the coverage of the tile at (x0_px, y0_px), rows `stride` floats apart. False when it is
 * empty and nothing was written. */
bool fg_tiler_draw(fg_tiler *tiler, const fg_band *band, int64_t x0_px, int64_t y0_px, float *out,
                   int64_t stride);

#endif
