/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "geometry/disc_fit.h"

enum { HARMONICS = 160, GRID = 720, SIMULATIONS = 48, SMOOTH = 2, SEED = 1 };
#define CUTOFF_UPR 50.0

/* Filtered harmonics, cos and sin, and the sd of either's noise. */
typedef struct spectrum {
  size_t count; /* harmonics 2 to count - 1 */
  double c[HARMONICS][2];
  double noise[HARMONICS];
  double cosine[GRID], sine[GRID];
} spectrum;

/* ISO 16610-21: half of the amplitude passes at the cut-off. */
static double transmission(size_t harmonic) {
  double ratio = (double)harmonic / CUTOFF_UPR;
  return exp(-M_LN2 * ratio * ratio);
}

static void transform_to_harmonics(const double *values, size_t n, double u, spectrum *s) {
  s->count = n / 2 < HARMONICS ? n / 2 : HARMONICS;
  for (size_t i = 0; i < GRID; i++) {
    s->cosine[i] = cos(2 * M_PI * (double)i / GRID);
    s->sine[i] = sin(2 * M_PI * (double)i / GRID);
  }
  for (size_t k = 2; k < s->count; k++) {
    double sum[2] = {0}, turn = 2 * M_PI * (double)k / (double)n;
    for (size_t i = 0; i < n; i++) {
      double angle = turn * ((double)i + 0.5);
      sum[0] += values[i] * cos(angle);
      sum[1] += values[i] * sin(angle);
    }
    for (int part = 0; part < 2; part++)
      s->c[k][part] = sum[part] * transmission(k) * 2 / (double)n;
    s->noise[k] = u * sqrt(2 / (double)n) * transmission(k);
  }
}

/* Peak to valley of a set of harmonics on a grid of directions. */
static double peak_to_valley(const spectrum *s, double c[HARMONICS][2]) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < GRID; i++) {
    double sum = 0;
    for (size_t k = 2; k < s->count; k++) {
      size_t at = k * i % GRID;
      sum += c[k][0] * s->cosine[at] + c[k][1] * s->sine[at];
    }
    low = fmin(low, sum);
    high = fmax(high, sum);
  }
  return high - low;
}

/* Shrinks the harmonics to their part beyond noise: power over a few neighbours against the
 * noise's. */
static void shrink_harmonics(const spectrum *s, double c[HARMONICS][2]) {
  for (size_t k = 2; k < s->count; k++) {
    double power = 0, noise = 0;
    for (size_t j = k < 2 + SMOOTH ? 2 : k - SMOOTH; j <= k + SMOOTH && j < s->count; j++) {
      power += s->c[j][0] * s->c[j][0] + s->c[j][1] * s->c[j][1];
      noise += 2 * s->noise[j] * s->noise[j];
    }
    double share = power > noise ? sqrt(1 - noise / power) : 0;
    for (int part = 0; part < 2; part++)
      c[k][part] = share * s->c[k][part];
  }
}

/* Mean rise and scatter of the peak to valley when noise is added to the harmonics `c`. */
static fg_status simulate_noise(fg_context *ctx, const spectrum *s, double c[HARMONICS][2],
                                double *rise, double *scatter) {
  double noisy[HARMONICS][2], sum = 0, squares = 0, clean = peak_to_valley(s, c);
  fg_numerics_start();
  gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
  if (!random) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: random numbers");
  gsl_rng_set(random, SEED);
  for (int i = 0; i < SIMULATIONS; i++) {
    for (size_t k = 2; k < s->count; k++)
      for (int part = 0; part < 2; part++)
        noisy[k][part] = c[k][part] + gsl_ran_gaussian(random, s->noise[k]);
    double off = peak_to_valley(s, noisy) - clean;
    sum += off;
    squares += off * off;
  }
  gsl_rng_free(random);
  *rise = sum / SIMULATIONS;
  *scatter = sqrt(fmax(0, squares / SIMULATIONS - *rise * *rise));
  return FG_OK;
}

fg_status fg_roundness(fg_context *ctx, const double *values, size_t count, double u,
                       double *roundness, double *u_roundness) {
  double real[HARMONICS][2], rise = 0, scatter = 0;
  spectrum *s = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *s, (void **)&s));
  transform_to_harmonics(values, count, u, s);
  shrink_harmonics(s, real);
  double seen = peak_to_valley(s, s->c);
  fg_status status = simulate_noise(ctx, s, real, &rise, &scatter);
  free(s);
  *roundness = fmax(0, seen - rise);
  *u_roundness = hypot(scatter, 0.25 * rise);
  return status;
}
