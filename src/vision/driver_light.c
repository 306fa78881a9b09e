/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/driver_light.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* Beyond so many sd the normal distribution is 0 or 1. */
#define REACH 6.0

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

/* exp(x) for -100 < x <= 0 to 1e-15, without branches: loops over it run on vectors. */
static inline double exp_of(double x) {
  const double shift = 0x1.8p52;
  double n = x * M_LOG2E + shift, k = n - shift;
  double f = (x - k * 0x1.62e42fefa3800p-1) - k * 0x1.ef35793c76730p-45, sum = 1.0 / 479001600;
  uint64_t scale, bits;
  sum = 1.0 / 39916800 + f * sum;
  sum = 1.0 / 3628800 + f * sum;
  sum = 1.0 / 362880 + f * sum;
  sum = 1.0 / 40320 + f * sum;
  sum = 1.0 / 5040 + f * sum;
  sum = 1.0 / 720 + f * sum;
  sum = 1.0 / 120 + f * sum;
  sum = 1.0 / 24 + f * sum;
  sum = 1.0 / 6 + f * sum;
  sum = 1 + f * (1 + f * (0.5 + f * sum));
  memcpy(&scale, &n, sizeof scale);
  memcpy(&bits, &sum, sizeof bits);
  bits += scale << 52;
  memcpy(&sum, &bits, sizeof sum);
  return sum;
}

/* Mills' ratio, the normal distribution's upper tail over its density, at y >= 0 to 1e-11: a
 * polynomial of (y - 4) / (y + 4), which interpolates (y + 1) times the ratio at Chebyshev's
 * points.
 */
static inline double ratio_at(double y) {
  static const double c[] = {1.1832619145678,       -0.242399670500285,    0.0350918802698045,
                             0.0716904801699021,    -0.080708011345706,    0.0449591434747527,
                             -0.0125390801485437,   -0.000716040893677494, 0.0017416988806751,
                             -0.000236405033215092, -0.000219701840588726, 5.27183850493884e-05,
                             3.31411105776169e-05,  -8.04675138965649e-06, -5.36413989493667e-06,
                             7.52492383071512e-07,  5.91305251873564e-07};
  double z = (y - 4) / (y + 4), zz = z * z, even = c[16], odd = c[15]; /* side by side: faster */
#pragma GCC unroll 8
  for (int i = 14; i > 0; i -= 2) {
    even = c[i] + zz * even;
    odd = c[i - 1] + zz * odd;
  }
  double sum = c[0] + zz * even + z * odd;
  return sum / (y + 1);
}

/* The normal distribution's density at t. */
static inline double density_at(double t) {
  double x = -0.5 * t * t, near = x > -0.5 * REACH * REACH ? x : -0.5 * REACH * REACH;
  double density = exp_of(near) * (M_2_SQRTPI * M_SQRT1_2 / 2);
  return fabs(t) < REACH ? density : 0;
}

/* Loss of a blurred step of 1, t blurs outwards, to a halo r times shorter than the blur: the step
 * less its own blur by exp(-|x|/l)/2l, in closed form. exp(x) P(X > y), X normal, is the density
 * at t times Mills' ratio at y >= 0, where x = y²/2 - t²/2. */
static inline double halo_loss(double t, double r, double density) {
  double off = fabs(t), y = r - off, x = r * (0.5 * r - off), limit = 30 / r;
  double tail = density * ratio_at(fabs(y)), far = density * ratio_at(r + off);
  double whole = exp_of(x < 0 ? (x > -40 ? x : -40) : 0);
  double near = y < 0 ? whole - tail : tail;
  double loss = off > limit ? 0 : 0.5 * (near - far);
  return t < 0 ? -loss : loss;
}

/* Places that are filled at once. */
enum { BLOCK = 16 };

__attribute__((target_clones("avx2", "default"))) static void
fill_shares(double per_px, double blur, size_t count, const double *restrict outwards,
            double *restrict cumulative, double *restrict density) {
  for (size_t i = 0; i < count; i++) {
    double t = outwards[i] * per_px, rise = density_at(t), tail = rise * ratio_at(fabs(t));
    cumulative[i] = t > 0 ? 1 - tail : tail;
    density[i] = blur * rise;
  }
}

__attribute__((target_clones("avx2", "default"))) static void
fill_losses(double per_px, double r, size_t count, const double *restrict outwards,
            const double *restrict density, double *restrict loss) {
  for (size_t i = 0; i < count; i++)
    loss[i] = halo_loss(outwards[i] * per_px, r, density[i] * per_px);
}

/* Loss where the blur does not reach. */
__attribute__((target_clones("avx2", "default"))) static void
fill_far_losses(double per_px, double r, size_t count, const double *restrict outwards,
                double *restrict loss) {
  for (size_t i = 0; i < count; i++) {
    double t = outwards[i] * per_px, off = fabs(t), x = r * (0.5 * r - off);
    double whole = off > 30 / r ? 0 : 0.5 * exp_of(x > -40 ? x : -40);
    loss[i] = t < 0 ? -whole : whole;
  }
}

/* Fills the places [from, from + count). */
static void fill_block(double blur, double r, bool lossy, size_t from, size_t count,
                       fg_lit_side *out) {
  double *outwards = out->outwards + from, *cumulative = out->cumulative + from,
         *density = out->density + from, *loss = out->loss + from, reach = REACH * blur;
  size_t near = 0;
  for (size_t i = 0; i < count; i++)
    near += fabs(outwards[i]) < reach;
  if (near) {
    fill_shares(1 / blur, blur, count, outwards, cumulative, density);
    if (lossy) fill_losses(1 / blur, r, count, outwards, density, loss);
    return;
  }
  for (size_t i = 0; i < count; i++) {
    cumulative[i] = outwards[i] > 0;
    density[i] = 0;
  }
  if (lossy) fill_far_losses(1 / blur, r, count, outwards, loss);
}

void fg_lit_side_fill(const fg_lit *lit, int side, bool lossy, const double *across, size_t count,
                      fg_lit_side *out) {
  double edge = lit->edge[side], blur = lit->blur[side], sign = side ? 1 : -1;
  out->edge = edge;
  out->blur = blur;
  out->halo_px = lossy ? lit->halo_px : NAN;
  for (size_t i = 0; i < count; i++)
    out->outwards[i] = sign * (across[i] - edge);
  for (size_t i = 0; i < count; i += BLOCK)
    fill_block(blur, blur / lit->halo_px, lossy, i, count - i < BLOCK ? count - i : BLOCK, out);
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
