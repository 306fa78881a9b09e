/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The quality of a JPEG from its pixels alone.
 *
 * Its coefficients were rounded to whole steps, so those of its blocks lie at multiples of the
 * steps, but for the rounding of pixels to counts (an sd of 0.29). Finer steps always fit, coarse
 * ones by chance where a step is wide: a quality's score is its fit beyond chance. */
#include <math.h>

#include "scan/jpeg_tables.h"
#include "vision/picture.h"

enum { SIDE = 8, FIRST_AC = 1, QUALITIES = 100, COEFFICIENTS_MIN = 200 };
#define NEAR     1.0 /* 3.4 sd of the pixels' rounding; nearer to 0 a coefficient is no evidence */
#define FITS_MIN 0.9 /* share of coefficients */

typedef struct quality_search {
  double cosines[SIDE][SIDE];
  double steps[QUALITIES][FG_JPEG_STEPS];
  int rows[FG_JPEG_STEPS], columns[FG_JPEG_STEPS]; /* frequencies along y and x */
  double fits[QUALITIES], beyond_chance[QUALITIES], count;
} quality_search;

static void prepare_search(quality_search *s) {
  for (int u = 0; u < SIDE; u++)
    for (int x = 0; x < SIDE; x++)
      s->cosines[u][x] = (u ? 0.5 : sqrt(0.125)) * cos((2 * x + 1) * u * M_PI / (2 * SIDE));
  for (int i = 0; i < FG_JPEG_STEPS; i++) {
    int place = fg_jpeg_place_of(i);
    s->rows[i] = place / SIDE;
    s->columns[i] = place % SIDE;
    for (int q = 0; q < QUALITIES; q++)
      s->steps[q][i] = fg_jpeg_step_at(q + 1, i);
  }
}

static void add_coefficient(quality_search *s, int i, double value) {
  if (fabs(value) < NEAR) return;
  s->count++;
  for (int q = 0; q < QUALITIES; q++) {
    double step = s->steps[q][i];
    bool fits = fabs(remainder(value, step)) < NEAR;
    s->fits[q] += fits;
    s->beyond_chance[q] += fits - fmin(1, 2 * NEAR / step);
  }
}

static void add_block(quality_search *s, double pixels[SIDE][SIDE]) {
  double along[SIDE][SIDE]; /* transformed along x */
  for (int y = 0; y < SIDE; y++)
    for (int v = 0; v < SIDE; v++) {
      along[y][v] = 0;
      for (int x = 0; x < SIDE; x++)
        along[y][v] += s->cosines[v][x] * pixels[y][x];
    }
  for (int i = FIRST_AC; i < FG_JPEG_STEPS; i++) {
    double value = 0;
    for (int y = 0; y < SIDE; y++)
      value += s->cosines[s->rows[i]][y] * along[y][s->columns[i]];
    add_coefficient(s, i, value);
  }
}

static void add_tile(quality_search *s, const fg_tile *tile, int bytes_per_pixel,
                     const size_t first[2]) {
  double pixels[SIDE][SIDE];
  for (size_t top = first[1]; top + SIDE <= FG_TILE_PX; top += SIDE)
    for (size_t left = first[0]; left + SIDE <= FG_TILE_PX; left += SIDE) {
      for (size_t y = 0; y < SIDE; y++)
        for (size_t x = 0; x < SIDE; x++)
          pixels[y][x] = fg_tile_count(tile, bytes_per_pixel, (top + y) * FG_TILE_PX + left + x);
      add_block(s, pixels);
    }
}

int fg_picture_jpeg_quality(const fg_tile_choice *choice, int bytes_per_pixel,
                            const size_t first[2]) {
  quality_search s = {.count = 0};
  int best = 0;
  prepare_search(&s);
  for (size_t i = 0; i < choice->count; i++)
    add_tile(&s, choice->tiles[i], bytes_per_pixel, first);
  if (s.count < COEFFICIENTS_MIN) return 0;
  for (int q = 0; q < QUALITIES; q++)
    if (s.fits[q] >= FITS_MIN * s.count && s.beyond_chance[q] > 0 &&
        (!best || s.beyond_chance[q] > s.beyond_chance[best - 1]))
      best = q + 1;
  return best;
}
