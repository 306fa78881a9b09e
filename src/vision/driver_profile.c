/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The counts across edges under a driver's model. */
#include <math.h>

#include "vision/driver_model.h"

/* Reach of a Gaussian kernel, in sd. */
#define KERNEL_REACH 4.0
enum { KERNEL_MAX = 128 };

/* One profile in light. */
typedef struct lit {
  double plateau, step[2], slope[2], blur[2], edge[2], inner_slope;
  double halo, halo_px;
  bool single;
} lit;

static lit lit_profile(const fg_driver *driver, const fg_driver_tone *tone, const double *values,
                       bool single) {
  lit l = {.plateau = fg_driver_tone_inverse(tone, values[FG_DRIVEN_PLATEAU]),
           .halo = driver->values[FG_DRIVER_HALO],
           .halo_px = driver->values[FG_DRIVER_HALO_PX],
           .single = single};
  for (int side = 0; side < 2; side++) {
    double level = fg_driver_tone_inverse(tone, values[FG_DRIVEN_LEVEL_L + side]);
    double counts = values[FG_DRIVEN_LEVEL_L + side] - values[FG_DRIVEN_PLATEAU];
    l.step[side] = level - l.plateau;
    l.slope[side] = values[FG_DRIVEN_SLOPE_L + side] * (counts != 0 ? l.step[side] / counts : 1);
    l.blur[side] = values[FG_DRIVEN_BLUR_L + side];
    l.edge[side] = values[FG_DRIVEN_LEFT + side];
  }
  if (single) {
    double counts = values[FG_DRIVEN_LEVEL_R] - values[FG_DRIVEN_PLATEAU];
    l.inner_slope = values[FG_DRIVEN_SLOPE_L] * (counts != 0 ? l.step[1] / counts : 1);
  }
  return l;
}

/* A blurred step from 0 to `step` + slope d, d outwards. */
static double step_light(double d, double step, double slope, double blur) {
  double t = d / blur;
  if (t < -6) return 0;
  if (t > 6) return step + slope * d;
  double cumulative = 0.5 * erfc(-t * M_SQRT1_2), density = exp(-0.5 * t * t) / sqrt(2 * M_PI);
  return (step + slope * d) * cumulative + slope * blur * density;
}

/* exp(x) P(X > y), X normal. */
static double scaled_tail(double x, double y) {
  if (y > 9) return 0;
  if (y < -6) return exp(x);
  return 0.5 * exp(x) * erfc(y * M_SQRT1_2);
}

/* Loss of a blurred step of 1 to a halo of length l: the step less its own blur by exp(-|x|/l)/2l,
 * in closed form. */
static double halo_loss(double d, double blur, double length) {
  double r = blur / length, t = d / blur;
  if (fabs(d) > 30 * length) return 0;
  return 0.5 * (scaled_tail(0.5 * r * r - d / length, r - t) -
                scaled_tail(0.5 * r * r + d / length, r + t));
}

/* A step of the light, with its halo. */
static double side_light(const lit *l, int side, double d, double extra_slope) {
  double light = step_light(d, l->step[side], extra_slope, l->blur[side]);
  if (l->halo > 0) light -= l->halo * l->step[side] * halo_loss(d, l->blur[side], l->halo_px);
  return light;
}

static double light_at(const lit *l, double across) {
  double right = across - l->edge[1];
  if (l->single) {
    double extra = l->slope[1] - l->inner_slope;
    return l->plateau + l->inner_slope * right + side_light(l, 1, right, extra);
  }
  return l->plateau + side_light(l, 0, l->edge[0] - across, l->slope[0]) +
         side_light(l, 1, right, l->slope[1]);
}

static double plain_count(const lit *l, const fg_driver_tone *tone, double across) {
  double rate;
  return fg_driver_tone_at(tone, light_at(l, across), &rate);
}

typedef struct kernel {
  int reach;
  double weights[KERNEL_MAX + 1]; /* from the middle outwards */
} kernel;

static kernel gaussian_kernel(double radius_px) {
  kernel k = {.reach = (int)ceil(KERNEL_REACH * radius_px / FG_DRIVEN_STEP_PX)};
  double sum = 0;
  if (k.reach > KERNEL_MAX) k.reach = KERNEL_MAX;
  for (int i = 0; i <= k.reach; i++) {
    double t = i * FG_DRIVEN_STEP_PX / radius_px;
    k.weights[i] = exp(-0.5 * t * t);
    sum += (i ? 2 : 1) * k.weights[i];
  }
  for (int i = 0; i <= k.reach; i++)
    k.weights[i] /= sum;
  return k;
}

/* Counts on a grid and their blur by the unsharp mask's Gaussian. */
static void blurred_grid(const fg_driver *driver, const fg_driver_tone *tone, const lit *l,
                         double from_px, size_t count, double *blurred) {
  double raw[FG_DRIVEN_MAX + 2 * KERNEL_MAX];
  kernel k = gaussian_kernel(driver->values[FG_DRIVER_RADIUS]);
  size_t reach = (size_t)k.reach;
  for (size_t i = 0; i < count + 2 * reach; i++)
    raw[i] = plain_count(l, tone, from_px + ((double)i - (double)reach) * FG_DRIVEN_STEP_PX);
  for (size_t i = 0; i < count; i++) {
    const double *at = raw + i + reach;
    double sum = k.weights[0] * at[0];
    for (int j = 1; j <= k.reach; j++)
      sum += k.weights[j] * (at[-j] + at[j]);
    blurred[i] = sum;
  }
}

/* A cubic through four neighbours; `at` from the grid's first value. */
static double cubic_at(const double *grid, size_t count, double at) {
  size_t i = at > 1 ? (size_t)at : 1;
  if (i + 3 > count) i = count - 3;
  double f = at - (double)i;
  return grid[i - 1] * (-f * (f - 1) * (f - 2) / 6) + grid[i] * ((f + 1) * (f - 1) * (f - 2) / 2) +
         grid[i + 1] * (-(f + 1) * f * (f - 2) / 2) + grid[i + 2] * ((f + 1) * f * (f - 1) / 6);
}

static double on_scale(double count) {
  return fmin(fmax(count, 0), 255);
}

static double sharpen_count(const fg_driver *driver, double count, double blurred) {
  double amount = driver->values[FG_DRIVER_AMOUNT];
  return on_scale((1 + amount) * count - amount * blurred);
}

void fg_driven_grid(const fg_driver *driver, const fg_driver_tone *tone, const double *values,
                    bool single, double from_px, size_t count, double *counts) {
  lit l = lit_profile(driver, tone, values, single);
  if (driver->values[FG_DRIVER_AMOUNT] != 0) blurred_grid(driver, tone, &l, from_px, count, counts);
  for (size_t i = 0; i < count; i++) {
    double plain = plain_count(&l, tone, from_px + (double)i * FG_DRIVEN_STEP_PX);
    counts[i] = driver->values[FG_DRIVER_AMOUNT] == 0 ? on_scale(plain)
                                                      : sharpen_count(driver, plain, counts[i]);
  }
}

void fg_driven_counts(const fg_driver *driver, const fg_driver_tone *tone,
                      const fg_driven_profile *profile, const double *values, double *counts) {
  lit l = lit_profile(driver, tone, values, profile->single);
  double blurred[FG_DRIVEN_MAX], from = 0;
  size_t grid = 0;
  if (driver->values[FG_DRIVER_AMOUNT] != 0) {
    from = profile->bins[0].across_px;
    double to = profile->bins[profile->count - 1].across_px;
    grid = (size_t)fmin((to - from) / FG_DRIVEN_STEP_PX + 5, FG_DRIVEN_MAX);
    from -= 2 * FG_DRIVEN_STEP_PX;
    blurred_grid(driver, tone, &l, from, grid, blurred);
  }
  for (size_t i = 0; i < profile->count; i++) {
    double across = profile->bins[i].across_px, plain = plain_count(&l, tone, across);
    counts[i] = !grid ? on_scale(plain)
                      : sharpen_count(driver, plain,
                                      cubic_at(blurred, grid, (across - from) / FG_DRIVEN_STEP_PX));
  }
}
