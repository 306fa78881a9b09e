/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Blur whose ellipse is turned against the rows and columns: it does not separate along them, so
 * its kernel is two-dimensional. */
#ifndef FG_RENDER_TURNED_BLUR_H
#define FG_RENDER_TURNED_BLUR_H

#include <stdbool.h>
#include <stdint.h>

#include "foilgauge/status.h"

/* Weights of the samples around a pixel's middle, rows of 2 taps[0] + 1. */
typedef struct fg_turned_blur {
  int samples; /* per pixel */
  int taps[2]; /* each side of the centre, along x and y */
  float *weights;
  int *first, *end; /* of each row: range of its weights that are not negligible */
} fg_turned_blur;

/* The blur of a picture, in pixels. */
typedef struct fg_blur_ellipse {
  double sd[2];      /* along its own axes */
  double angle_deg;  /* of the first axis, from x (right) towards y (down) */
  double sampled[2]; /* sd of the samples themselves, along x and y */
  double motion;     /* length of a box along y */
} fg_blur_ellipse;

/* Returns true when a two-dimensional kernel is needed: an ellipse, not a circle, off the rows and
 * columns. */
bool fg_blur_is_turned(const fg_blur_ellipse *ellipse);

fg_status fg_turned_blur_create(fg_context *ctx, const fg_blur_ellipse *ellipse, int samples,
                                fg_turned_blur *blur);
void fg_turned_blur_free(fg_turned_blur *blur);

/* Samples to be blurred; sorted by fg_turned_blur_sort. */
typedef struct fg_sample_square {
  float *values;    /* `side` rows of `side` */
  int64_t side;     /* a multiple of the samples per pixel */
  int64_t margin;   /* pixels around the output */
  int64_t width_px; /* output pixels of each row */
} fg_sample_square;

/* Puts the first samples of all pixels of a row before all second ones, and so on, so that the
 * values that one tap needs of neighbouring pixels lie side by side. `line` has room for a row. */
void fg_turned_blur_sort(const fg_turned_blur *blur, const fg_sample_square *square, float *line);

/* Blurs one row of output pixels, counted from the first. */
void fg_turned_blur_row(const fg_turned_blur *blur, const fg_sample_square *square, int64_t y_px,
                        float *out);

#endif
