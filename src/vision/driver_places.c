/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/driver_places.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

/* Reach of a Gaussian kernel, in sd. */
#define KERNEL_REACH 4.0
enum { KERNEL_MAX = 128, SIDE_ARRAYS = 4, ARRAYS = 4 * SIDE_ARRAYS + 5 };

fg_status fg_driven_places_create(fg_context *ctx, size_t count, bool masked,
                                  fg_driven_places *places) {
  size_t size = count + (masked ? FG_DRIVEN_MAX + 2 * KERNEL_MAX : 0);
  memset(places, 0, sizeof *places);
  FG_TRY(fg_memory_allocate(ctx, ARRAYS * size, sizeof *places->memory, (void **)&places->memory));
  double *next = places->memory;
  fg_lit_side *sides[] = {&places->kept[0], &places->kept[1], &places->other[0], &places->other[1]};
  for (size_t i = 0; i < 4; i++) {
    double **arrays[] = {&sides[i]->outwards, &sides[i]->cumulative, &sides[i]->density,
                         &sides[i]->loss};
    for (size_t k = 0; k < SIDE_ARRAYS; k++, next += size)
      *arrays[k] = next;
  }
  double **arrays[] = {&places->across, &places->plain, &places->blurred, &places->other_plain,
                       &places->other_blurred};
  for (size_t k = 0; k < 5; k++, next += size)
    *arrays[k] = next;
  return FG_OK;
}

void fg_driven_places_free(fg_driven_places *places) {
  free(places->memory);
  memset(places, 0, sizeof *places);
}

static size_t kernel_reach(double radius_px) {
  return (size_t)fmin(ceil(KERNEL_REACH * radius_px / FG_DRIVEN_STEP_PX), KERNEL_MAX);
}

/* Number of places asked for that are not the grid's. */
static size_t apart_count(const fg_driven_places *places) {
  return places->regular ? 0 : places->count;
}

static size_t all_count(const fg_driven_places *places) {
  return apart_count(places) + (places->grid ? places->grid + 2 * places->reach : 0);
}

static void place_grid(fg_driven_places *places) {
  double *to = places->across + apart_count(places);
  for (size_t i = 0; i < places->grid + 2 * places->reach; i++)
    to[i] = places->from_px + ((double)i - (double)places->reach) * FG_DRIVEN_STEP_PX;
}

void fg_driven_places_of_bins(const fg_driven_profile *profile, bool masked, double radius_px,
                              fg_driven_places *places) {
  const fg_profile_bin *bins = profile->bins;
  places->count = profile->count;
  places->single = profile->single;
  places->regular = false;
  places->grid = 0;
  for (size_t i = 0; i < profile->count; i++)
    places->across[i] = bins[i].across_px;
  if (!masked || !profile->count) return;
  double from = bins[0].across_px, to = bins[profile->count - 1].across_px;
  places->from_px = from - 2 * FG_DRIVEN_STEP_PX;
  places->grid = (size_t)fmin((to - from) / FG_DRIVEN_STEP_PX + 5, FG_DRIVEN_MAX);
  places->reach = kernel_reach(radius_px);
  place_grid(places);
}

void fg_driven_places_of_grid(double from_px, size_t count, bool single, double radius_px,
                              fg_driven_places *places) {
  places->count = places->grid = count;
  places->single = single;
  places->regular = true;
  places->from_px = from_px;
  places->reach = radius_px > 0 ? kernel_reach(radius_px) : 0;
  place_grid(places);
}

/* The blur of counts on a grid by the unsharp mask's Gaussian; `at` is the grid's first. */
__attribute__((target_clones("avx2", "default"))) static void
add_shifted(const double *restrict at, size_t shift, double weight, size_t count,
            double *restrict sum) {
  for (size_t i = 0; i < count; i++)
    sum[i] += weight * ((at - shift)[i] + at[i + shift]);
}

static void blur_grid(double radius_px, const double *at, size_t count, double *blurred) {
  size_t reach = kernel_reach(radius_px);
  double weights[KERNEL_MAX + 1], sum = 0;
  for (size_t j = 0; j <= reach; j++) {
    double t = (double)j * FG_DRIVEN_STEP_PX / radius_px;
    weights[j] = exp(-0.5 * t * t);
    sum += (j ? 2 : 1) * weights[j];
  }
  for (size_t i = 0; i < count; i++)
    blurred[i] = weights[0] / sum * at[i];
  for (size_t j = 1; j <= reach; j++)
    add_shifted(at, j, weights[j] / sum, count, blurred);
}

/* A cubic through four neighbours; `at` from the grid's first value. */
static inline double cubic_at(const double *grid, int last, double at) {
  int i = at > 1 ? (int)at : 1;
  i = i < last ? i : last;
  double f = at - i, f0 = f + 1, f1 = f - 1, f2 = f - 2;
  return grid[i - 1] * (-f * f1 * f2 / 6) + grid[i] * (f0 * f1 * f2 / 2) +
         grid[i + 1] * (-f0 * f * f2 / 2) + grid[i + 2] * (f0 * f * f1 / 6);
}

static inline double on_scale(double count) {
  double low = count > 0 ? count : 0; /* fmin and fmax are calls */
  return low < 255 ? low : 255;
}

/* Values at the places, of a function that is given on the grid. */
__attribute__((target_clones("avx2", "default"))) static void
read_grid(const double *restrict across, double from_px, const double *restrict grid, size_t size,
          size_t count, double *restrict values) {
  int last = (int)size - 3;
  for (size_t i = 0; i < count; i++)
    values[i] = cubic_at(grid, last, (across[i] - from_px) / FG_DRIVEN_STEP_PX);
}

__attribute__((target_clones("avx2", "default"))) static void
mask_counts(double amount, const double *restrict asked, const double *blurred, size_t count,
            double *counts) {
  for (size_t i = 0; i < count; i++)
    counts[i] = on_scale((1 + amount) * asked[i] - amount * blurred[i]);
}

/* The counts from those before the mask, and from their blur. */
static void sharpen_counts(const fg_driven_places *places, double amount, const double *plain,
                           const double *blurred, double *counts) {
  const double *asked = plain + (places->regular ? places->reach : 0);
  if (amount == 0) {
    for (size_t i = 0; i < places->count; i++)
      counts[i] = on_scale(asked[i]);
    return;
  }
  if (!places->regular) {
    read_grid(places->across, places->from_px, blurred, places->grid, places->count, counts);
    blurred = counts;
  }
  mask_counts(amount, asked, blurred, places->count, counts);
}

static void blur_plain(const fg_driven_places *places, const fg_driver *driver, const double *plain,
                       double *blurred) {
  const double *at = plain + apart_count(places) + places->reach;
  if (places->grid && driver->values[FG_DRIVER_AMOUNT] != 0)
    blur_grid(driver->values[FG_DRIVER_RADIUS], at, places->grid, blurred);
}

void fg_driven_places_keep(const fg_driver *driver, const fg_driver_tone *tone,
                           const double *values, bool lossy, fg_driven_places *places,
                           double *counts) {
  fg_lit lit = fg_lit_profile(driver, tone, values, places->single);
  const fg_lit_side *sides[2] = {&places->kept[0], &places->kept[1]};
  size_t count = all_count(places);
  places->driver = *driver;
  memcpy(places->values, values, sizeof places->values);
  for (int side = places->single; side < 2; side++)
    fg_lit_side_fill(&lit, side, lossy, places->across, count, &places->kept[side]);
  fg_lit_add(&lit, sides, count, places->plain);
  fg_driver_tone_all(tone, count, places->plain);
  blur_plain(places, driver, places->plain, places->blurred);
  sharpen_counts(places, driver->values[FG_DRIVER_AMOUNT], places->plain, places->blurred, counts);
}

/* Returns true when two drivers make the same of the light before the mask. */
static bool is_same_plain(const fg_driver *a, const fg_driver *b) {
  static const int values[] = {FG_DRIVER_LN_GAMMA, FG_DRIVER_STEEPNESS, FG_DRIVER_CENTRE,
                               FG_DRIVER_HALO, FG_DRIVER_HALO_PX};
  for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
    if (a->values[values[i]] != b->values[values[i]]) return false;
  return true;
}

/* The kept side where it still holds, or a new one. */
static const fg_lit_side *side_for(const fg_lit *lit, int side, fg_driven_places *places) {
  const fg_lit_side *kept = &places->kept[side];
  bool lossy = lit->halo > 0;
  if (kept->edge == lit->edge[side] && kept->blur == lit->blur[side] &&
      (!lossy || kept->halo_px == lit->halo_px))
    return kept;
  fg_lit_side_fill(lit, side, lossy, places->across, all_count(places), &places->other[side]);
  return &places->other[side];
}

void fg_driven_places_vary(const fg_driver *driver, const fg_driver_tone *tone,
                           const double *values, fg_driven_places *places, double *counts) {
  const double *plain = places->plain, *blurred = places->blurred;
  bool same = is_same_plain(driver, &places->driver) &&
              memcmp(values, places->values, sizeof places->values) == 0;
  if (!same) {
    fg_lit lit = fg_lit_profile(driver, tone, values, places->single);
    const fg_lit_side *sides[2] = {NULL, NULL};
    for (int side = places->single; side < 2; side++)
      sides[side] = side_for(&lit, side, places);
    fg_lit_add(&lit, sides, all_count(places), places->other_plain);
    fg_driver_tone_all(tone, all_count(places), places->other_plain);
    plain = places->other_plain;
  }
  bool was_blurred = places->driver.values[FG_DRIVER_AMOUNT] != 0 &&
                     driver->values[FG_DRIVER_RADIUS] == places->driver.values[FG_DRIVER_RADIUS];
  if (!same || !was_blurred) {
    blur_plain(places, driver, plain, places->other_blurred);
    blurred = places->other_blurred;
  }
  sharpen_counts(places, driver->values[FG_DRIVER_AMOUNT], plain, blurred, counts);
}
