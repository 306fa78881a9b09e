/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scan_loop/bump_pattern.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sf_gamma.h>
#include <math.h>
#include <stdlib.h>

#include "core/select.h"
#include "core/splitmix.h"

/* Draws of the null; number of patterns. */
enum { DRAWS = 4999, PATTERNS = 2 };
/* Maximum share of bumps that deviate: with more there are two kinds of bumps. */
static const double largest_share = 1.0 / 3;
/* Cycles over the bumps are tried in such steps, from two cycles up to a period of two bumps. */
static const double cycle_step = 0.25;

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double gain_of(const fg_bump_values *at, double taken, double columns, double whole) {
  double left = fmax(whole - taken, 1e-12 * whole) + at->noise_square;
  double dof = (double)at->n - 1 - columns + at->noise_dof;
  return whole > 0 ? taken / columns / (left / dof) : 0;
}

static double square_about_mean(const double *value, size_t n, double *mean) {
  double sum = 0;
  *mean = 0;
  for (size_t i = 0; i < n; i++)
    *mean += value[i] / (double)n;
  for (size_t i = 0; i < n; i++)
    sum += (value[i] - *mean) * (value[i] - *mean);
  return sum;
}

/* Finds the best few values to set apart, which are the largest or the smallest. `limit`: they lie
 * above it for by > 0, below it for by < 0. */
static double best_apart(const fg_bump_values *at, double *by, double *limit) {
  const double *value = at->value;
  size_t n = at->n;
  double sorted[FG_BUMP_PATTERN_MAX], mean, best = 0;
  double whole = square_about_mean(value, n, &mean);
  for (size_t i = 0; i < n; i++)
    sorted[i] = value[i];
  fg_sort_items(sorted, n, sizeof *sorted, ascending);
  size_t max = (size_t)(largest_share * (double)n);
  for (int top = 0; top < 2; top++) {
    double sum = 0;
    for (size_t k = 1; k <= max; k++) {
      size_t last = top ? n - k : k - 1;
      sum += sorted[last] - mean;
      double of = (double)k * (double)(n - k) / (double)n; /* of the two means' difference */
      double d = sum / (double)k + sum / (double)(n - k);
      double gain = gain_of(at, of * d * d, 1, whole);
      if (gain <= best) continue;
      best = gain;
      *by = d;
      *limit = sorted[last];
    }
  }
  return best;
}

/* Fits a cosine and a sine beside the mean. */
static double cycle_gain(const fg_bump_values *at, double period, fg_bump_pattern *to) {
  const double *value = at->value;
  double c[FG_BUMP_PATTERN_MAX], s[FG_BUMP_PATTERN_MAX], mean[3],
      whole = square_about_mean(value, at->n, mean);
  for (size_t i = 0; i < at->n; i++) {
    c[i] = cos(2 * M_PI * at->number[i] / period);
    s[i] = sin(2 * M_PI * at->number[i] / period);
  }
  double cc = square_about_mean(c, at->n, &mean[1]), ss = square_about_mean(s, at->n, &mean[2]);
  double cs = 0, cv = 0, sv = 0;
  for (size_t i = 0; i < at->n; i++) {
    cs += (c[i] - mean[1]) * (s[i] - mean[2]);
    cv += (c[i] - mean[1]) * (value[i] - mean[0]);
    sv += (s[i] - mean[2]) * (value[i] - mean[0]);
  }
  double det = cc * ss - cs * cs;
  if (!(det > 1e-6 * cc * (double)at->n)) return 0; /* a period of two: one column */
  to->cosine = (cv * ss - sv * cs) / det;
  to->sine = (sv * cc - cv * cs) / det;
  to->period = period;
  return gain_of(at, to->cosine * cv + to->sine * sv, 2, whole);
}

static double best_cycle(const fg_bump_values *at, fg_bump_pattern *best) {
  double range = at->number[at->n - 1] - at->number[0] + 1, max = 0;
  for (double cycles = 2; cycles <= range / 2; cycles += cycle_step) {
    fg_bump_pattern one = {0};
    double gain = cycle_gain(at, range / cycles, &one);
    if (gain <= max) continue;
    max = gain;
    *best = one;
  }
  return max;
}

static fg_bump_pattern find_apart(const fg_bump_values *at) {
  fg_bump_pattern found = {0};
  double limit = 0;
  found.gain = best_apart(at, &found.by, &limit);
  for (size_t i = 0; i < at->n; i++) {
    found.apart[i] = found.by > 0 ? at->value[i] >= limit : at->value[i] <= limit;
    found.count += found.apart[i];
  }
  return found;
}

static fg_bump_pattern find_cycle(const fg_bump_values *at) {
  fg_bump_pattern found = {0};
  double gain = best_cycle(at, &found);
  found.gain = gain;
  found.by = hypot(found.cosine, found.sine);
  return found;
}

/* Finds the share of normal draws in which either pattern gains as much. */
static void find_p(const fg_bump_values *at, uint64_t seed, const double gain[PATTERNS],
                   double p[PATTERNS]) {
  size_t beyond[PATTERNS] = {1, 1};
  fg_bump_values drawn = *at;
  for (size_t d = 0; d < DRAWS; d++) {
    double by, limit;
    fg_bump_pattern one;
    drawn.noise_square = 0;
    for (size_t i = 0; i < at->n; i++)
      drawn.value[i] = fg_splitmix_normal(&seed);
    for (double f = 0; f < at->noise_dof; f++)
      drawn.noise_square += pow(fg_splitmix_normal(&seed), 2);
    beyond[0] += best_apart(&drawn, &by, &limit) >= gain[0];
    beyond[1] += best_cycle(&drawn, &one) >= gain[1];
  }
  for (int pattern = 0; pattern < PATTERNS; pattern++)
    p[pattern] = (double)beyond[pattern] / (DRAWS + 1);
}

/* Returns Bonferroni's bound for the best few of all possible choices: for p-values that draws
 * cannot resolve. */
static double bound_of_apart(const fg_bump_values *at, double gain) {
  size_t max = (size_t)(largest_share * (double)at->n);
  double subsets = 0;
  for (size_t k = 1; k <= max; k++)
    subsets += gsl_sf_choose((unsigned)at->n, (unsigned)k);
  double dof = (double)at->n - 2 + at->noise_dof;
  return fmin(1, subsets * gsl_cdf_fdist_Q(gain, 1, dof));
}

fg_bump_pattern fg_bump_pattern_find(const fg_bump_values *at, uint64_t seed, double *p_value) {
  const fg_bump_pattern found[PATTERNS] = {find_apart(at), find_cycle(at)};
  const double gain[PATTERNS] = {found[0].gain, found[1].gain};
  double p[PATTERNS];
  find_p(at, seed, gain, p);
  p[0] = fmin(p[0], bound_of_apart(at, gain[0]));
  int best = p[1] < p[0] || (p[1] == p[0] && gain[1] > gain[0]);
  *p_value = fmin(1, PATTERNS * p[best]);
  return found[best];
}

double fg_bump_pattern_at(const fg_bump_pattern *pattern, const fg_bump_values *at, size_t k) {
  double turn = pattern->period > 0 ? 2 * M_PI * at->number[k] / pattern->period : 0;
  return pattern->period > 0 ? pattern->cosine * cos(turn) + pattern->sine * sin(turn)
         : pattern->apart[k] ? pattern->by
                             : 0;
}
