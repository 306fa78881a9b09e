/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/driver_light.h"

#include <math.h>
#include <pthread.h>

enum { REACH = 6, STEPS = 64, KNOTS = 2 * REACH * STEPS + 1 };
/* Beyond it a tail is so small that it is not taken from the table. */
#define TAIL_REACH 4.0

/* The normal distribution at -REACH, -REACH + 1/STEPS ... Cubics between the knots are within 1e-9
 * of it. */
typedef struct knot {
  double density, cumulative;
} knot;

static knot knots[KNOTS + 1];

static void fill_knots(void) {
  for (int i = 0; i <= KNOTS; i++) {
    double t = (double)i / STEPS - REACH;
    knots[i] = (knot){exp(-0.5 * t * t) / sqrt(2 * M_PI), 0.5 * erfc(-t * M_SQRT1_2)};
  }
}

static void require_knots(void) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, fill_knots);
}

/* A cubic from its values and its changes per step at 0 and 1. */
static inline double cubic_between(double v0, double v1, double m0, double m1, double f) {
  double rise = v1 - v0;
  return v0 + f * (m0 + f * (3 * rise - 2 * m0 - m1 + f * (m0 + m1 - 2 * rise)));
}

/* |t| < REACH */
static inline double cumulative_at(double t) {
  double at = (t + REACH) * STEPS;
  int i = (int)at;
  const knot *k = &knots[i];
  return cubic_between(k[0].cumulative, k[1].cumulative, k[0].density / STEPS, k[1].density / STEPS,
                       at - i);
}

static inline double density_at(double t) {
  double at = (t + REACH) * STEPS, from;
  int i = (int)at;
  const knot *k = &knots[i];
  from = (double)i / STEPS - REACH;
  return cubic_between(k[0].density, k[1].density, -from * k[0].density / STEPS,
                       -(from + 1.0 / STEPS) * k[1].density / STEPS, at - i);
}

fg_lit fg_lit_profile(const fg_driver *driver, const fg_driver_tone *tone, const double *values,
                      bool single) {
  fg_lit l = {.plateau = fg_driver_tone_inverse(tone, values[FG_DRIVEN_PLATEAU]),
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

/* A blurred step from 0 to 1 at t blurs outwards, and from 0 to a slope of 1. */
static inline void blurred_step(double t, double blur, double *cumulative, double *density) {
  *cumulative = t > 0;
  *density = 0;
  if (!(fabs(t) < REACH)) return;
  *cumulative = cumulative_at(t);
  *density = blur * density_at(t);
}

/* exp(x) P(X > y), X normal. */
static double scaled_tail(double x, double y) {
  if (y > 9) return 0;
  if (y <= -REACH) return exp(x);
  if (!(y <= TAIL_REACH)) return 0.5 * exp(x) * erfc(y * M_SQRT1_2);
  return exp(x) * (1 - cumulative_at(y));
}

/* Loss of a blurred step of 1 to a halo of length l: the step less its own blur by exp(-|x|/l)/2l,
 * in closed form. */
static double halo_loss(double d, double blur, double length) {
  double r = blur / length, t = d / blur;
  if (fabs(d) > 30 * length) return 0;
  return 0.5 * (scaled_tail(0.5 * r * r - d / length, r - t) -
                scaled_tail(0.5 * r * r + d / length, r + t));
}

void fg_lit_side_fill(const fg_lit *lit, int side, bool lossy, const double *across, size_t count,
                      fg_lit_side *out) {
  double edge = lit->edge[side], blur = lit->blur[side], sign = side ? 1 : -1;
  require_knots();
  out->edge = edge;
  out->blur = blur;
  out->halo_px = lossy ? lit->halo_px : NAN;
  for (size_t i = 0; i < count; i++) {
    double d = sign * (across[i] - edge);
    out->outwards[i] = d;
    blurred_step(d / blur, blur, &out->cumulative[i], &out->density[i]);
  }
  for (size_t i = 0; lossy && i < count; i++)
    out->loss[i] = halo_loss(out->outwards[i], blur, lit->halo_px);
}

__attribute__((target_clones("avx2", "default"))) static void add_side(const fg_lit_side *side,
                                                                       double step, double slope,
                                                                       double halo, size_t count,
                                                                       double *restrict light) {
  const double *restrict d = side->outwards, *restrict share = side->cumulative,
                         *restrict density = side->density, *restrict loss = side->loss;
  for (size_t i = 0; i < count; i++)
    light[i] += (step + slope * d[i]) * share[i] + slope * density[i];
  if (!(halo > 0)) return;
  double lost = halo * step;
  for (size_t i = 0; i < count; i++)
    light[i] -= lost * loss[i];
}

void fg_lit_add(const fg_lit *lit, const fg_lit_side *const sides[2], size_t count, double *light) {
  for (size_t i = 0; i < count; i++)
    light[i] = lit->plateau;
  if (lit->single) {
    for (size_t i = 0; i < count; i++)
      light[i] += lit->inner_slope * sides[1]->outwards[i];
    add_side(sides[1], lit->step[1], lit->slope[1] - lit->inner_slope, lit->halo, count, light);
    return;
  }
  for (int side = 0; side < 2; side++)
    add_side(sides[side], lit->step[side], lit->slope[side], lit->halo, count, light);
}
