/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/driver_light.h"

#include <math.h>
#include <pthread.h>

enum { REACH = 6, STEPS = 64, RATIO_REACH = 13 };

/* Cubics between neighbouring knots, 1/STEPS apart, exact to 1e-9. */
typedef struct cubic {
  double c[4];
} cubic;

/* Of the normal distribution from -REACH on, and of Mills' ratio, its upper tail over its density,
 * from 0 on. */
static struct { cubic density, cumulative; } normal[2 * REACH * STEPS + 1];
static cubic ratio[RATIO_REACH * STEPS + 1];

/* A cubic from its values and its derivatives at both ends of a step. */
static cubic cubic_between(const double value[2], const double rate[2]) {
  double rise = value[1] - value[0], m0 = rate[0] / STEPS, m1 = rate[1] / STEPS;
  return (cubic){{value[0], m0, 3 * rise - 2 * m0 - m1, m0 + m1 - 2 * rise}};
}

static inline double cubic_at(const cubic *k, double f) {
  return k->c[0] + f * (k->c[1] + f * (k->c[2] + f * k->c[3]));
}

static void fill_normal(void) {
  for (int i = 0; i <= 2 * REACH * STEPS; i++) {
    double cumulative[2], density[2], bend[2];
    for (int k = 0; k < 2; k++) {
      double t = (double)(i + k) / STEPS - REACH;
      cumulative[k] = 0.5 * erfc(-t * M_SQRT1_2);
      density[k] = exp(-0.5 * t * t) / sqrt(2 * M_PI);
      bend[k] = -t * density[k];
    }
    normal[i].cumulative = cubic_between(cumulative, density);
    normal[i].density = cubic_between(density, bend);
  }
}

static void fill_ratio(void) {
  for (int i = 0; i <= RATIO_REACH * STEPS; i++) {
    double value[2], rate[2];
    for (int k = 0; k < 2; k++) {
      double y = (double)(i + k) / STEPS;
      value[k] = sqrt(M_PI / 2) * exp(0.5 * y * y) * erfc(y * M_SQRT1_2);
      rate[k] = y * value[k] - 1;
    }
    ratio[i] = cubic_between(value, rate);
  }
}

static void fill_tables(void) {
  fill_normal();
  fill_ratio();
}

static void require_tables(void) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, fill_tables);
}

/* Mills' ratio at y >= 0; beyond the table by its series. */
static inline double ratio_at(double y) {
  double at = y * STEPS;
  if (!(y < RATIO_REACH)) return (1 - 1 / (y * y)) / y;
  int i = (int)at;
  return cubic_at(&ratio[i], at - i);
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

/* exp(x) P(X > y), X normal, where x = y²/2 - t²/2 and the density at t is given. */
static inline double scaled_tail(double x, double y, double density) {
  return y < 0 ? exp(x) - density * ratio_at(-y) : density * ratio_at(y);
}

/* Loss of a blurred step of 1, t blurs outwards, to a halo r times shorter than the blur: the step
 * less its own blur by exp(-|x|/l)/2l, in closed form. */
static inline double halo_loss(double t, double r, double density) {
  if (fabs(t) > 30 / r) return 0;
  return 0.5 * (scaled_tail(r * (0.5 * r - t), r - t, density) -
                scaled_tail(r * (0.5 * r + t), r + t, density));
}

void fg_lit_side_fill(const fg_lit *lit, int side, bool lossy, const double *across, size_t count,
                      fg_lit_side *out) {
  double edge = lit->edge[side], blur = lit->blur[side], sign = side ? 1 : -1;
  double r = blur / lit->halo_px, per_px = 1 / blur;
  require_tables();
  out->edge = edge;
  out->blur = blur;
  out->halo_px = lossy ? lit->halo_px : NAN;
  for (size_t i = 0; i < count; i++) {
    double d = sign * (across[i] - edge), t = d * per_px, cumulative = t > 0, density = 0;
    if (fabs(t) < REACH) {
      double at = (t + REACH) * STEPS;
      int k = (int)at;
      cumulative = cubic_at(&normal[k].cumulative, at - k);
      density = cubic_at(&normal[k].density, at - k);
    }
    out->outwards[i] = d;
    out->cumulative[i] = cumulative;
    out->density[i] = blur * density;
    if (lossy) out->loss[i] = halo_loss(t, r, density);
  }
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
