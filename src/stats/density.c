/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/density.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/splitmix.h"

enum { BIN_ABOVE = 8192, GRID_POINTS = 4096, PAIR_BINS = 1000, SEARCH_POINTS = 1024 };

static const double root_two_pi = 2.50662827463100050242;

/* A Gaussian is 0 in double precision beyond this many standard deviations. */
static const double kernel_reach = 8.5;

const char *fg_bandwidth_word(fg_bandwidth_rule rule) {
  switch (rule) {
  case FG_BANDWIDTH_SILVERMAN:
    return "silverman";
  case FG_BANDWIDTH_SCOTT:
    return "scott";
  case FG_BANDWIDTH_SHEATHER_JONES:
    return "sheather_jones";
  }
  return "";
}

double fg_sample_quantile(const double *sorted, size_t count, double probability) {
  double at = probability * (double)(count - 1);
  size_t below = (size_t)at;
  if (below + 1 >= count) return sorted[count - 1];
  double share = at - (double)below;
  return sorted[below] + share * (sorted[below + 1] - sorted[below]);
}

static double sample_sd(const double *values, size_t count) {
  double mean = 0, squares = 0;
  for (size_t i = 0; i < count; i++)
    mean += (values[i] - values[0]) / (double)count;
  mean += values[0];
  for (size_t i = 0; i < count; i++)
    squares += (values[i] - mean) * (values[i] - mean);
  return sqrt(squares / (double)(count - 1));
}

/* min(s, IQR / divisor); where more than half of the values are equal the IQR is 0 and is ignored.
 */
static double robust_spread(const double *sorted, size_t count, double divisor) {
  double sd = sample_sd(sorted, count);
  double iqr = fg_sample_quantile(sorted, count, 0.75) - fg_sample_quantile(sorted, count, 0.25);
  return iqr > 0 ? fmin(sd, iqr / divisor) : sd;
}

/* Number of pairs of values that lie k bins apart: the functionals below depend on nothing else. */
typedef struct pair_counts {
  double pairs[PAIR_BINS];
  double width, count;
} pair_counts;

static fg_status count_pairs(fg_context *ctx, const double *sorted, size_t count,
                             pair_counts **result) {
  void *block;
  double filled[PAIR_BINS] = {0};
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof **result, &block));
  pair_counts *counts = block;
  counts->count = (double)count;
  counts->width = (sorted[count - 1] - sorted[0]) * 1.01 / PAIR_BINS;
  for (size_t i = 0; i < count; i++)
    filled[(size_t)((sorted[i] - sorted[0]) / counts->width)] += 1;
  for (size_t i = 0; i < PAIR_BINS; i++) {
    counts->pairs[0] += filled[i] * (filled[i] - 1) / 2;
    for (size_t k = 0; k < i; k++)
      counts->pairs[i - k] += filled[i] * filled[k];
  }
  *result = counts;
  return FG_OK;
}

/* Estimates of the integrals of f'' squared and f''' squared (Sheather and Jones 1991, eq 12). */
static double functional(const pair_counts *counts, double h, int order) {
  double sum = 0;
  for (size_t i = 0; i < PAIR_BINS; i++) {
    double d = (double)i * counts->width / h, square = d * d;
    if (square >= 1000) break;
    double term = order == 4 ? square * square - 6 * square + 3
                             : square * square * square - 15 * square * square + 45 * square - 15;
    sum += exp(-square / 2) * term * counts->pairs[i];
  }
  sum = 2 * sum + counts->count * (order == 4 ? 3 : -15);
  return sum / (counts->count * (counts->count - 1) * pow(h, order + 1) * root_two_pi);
}

static double sheather_jones_gap(const pair_counts *counts, double h, double alpha) {
  double c1 = 1 / (2 * sqrt(3.14159265358979323846) * counts->count);
  return pow(c1 / functional(counts, alpha * pow(h, 5.0 / 7), 4), 0.2) - h;
}

/* The equation is solved by bisection between a hundredth of Scott's bandwidth and twice it. */
static double solve_sheather_jones(const pair_counts *counts, double spread, double fallback) {
  double a = 1.24 * spread * pow(counts->count, -1.0 / 7);
  double b = 1.23 * spread * pow(counts->count, -1.0 / 9);
  double alpha = 1.357 * pow(functional(counts, a, 4) / -functional(counts, b, 6), 1.0 / 7);
  double high = 1.144 * spread * pow(counts->count, -0.2) * 2, low = high / 200;
  if (!isfinite(alpha) || !(sheather_jones_gap(counts, low, alpha) > 0) ||
      !(sheather_jones_gap(counts, high, alpha) < 0))
    return fallback;
  for (int i = 0; i < 100; i++) {
    double middle = (low + high) / 2;
    if (sheather_jones_gap(counts, middle, alpha) > 0)
      low = middle;
    else
      high = middle;
  }
  return (low + high) / 2;
}

static fg_status choose_bandwidth(fg_context *ctx, const double *sorted, size_t count,
                                  fg_bandwidth_rule rule, double *bandwidth) {
  double shrink = pow((double)count, -0.2);
  double spread = robust_spread(sorted, count, 1.34);
  *bandwidth = (rule == FG_BANDWIDTH_SILVERMAN ? 0.9 : 1.06) * spread * shrink;
  if (rule != FG_BANDWIDTH_SHEATHER_JONES) return FG_OK;
  pair_counts *counts;
  FG_TRY(count_pairs(ctx, sorted, count, &counts));
  *bandwidth = solve_sheather_jones(counts, robust_spread(sorted, count, 1.349), *bandwidth);
  free(counts);
  return FG_OK;
}

static fg_status allocate_points(fg_context *ctx, size_t count, fg_density *density) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof(double), &block));
  density->value = block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof(double), &block));
  density->weight = block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof(double), &block));
  density->cumulative = block;
  density->count = count;
  return FG_OK;
}

/* A value between two points of the grid is shared by both in proportion: mean and mass stay. */
static void bin_values(const double *sorted, size_t count, fg_density *density) {
  double step = (sorted[count - 1] - sorted[0]) / (GRID_POINTS - 1);
  for (size_t i = 0; i < GRID_POINTS; i++)
    density->value[i] = sorted[0] + step * (double)i;
  for (size_t i = 0; i < count; i++) {
    double at = (sorted[i] - sorted[0]) / step;
    size_t below = (size_t)fmin(at, GRID_POINTS - 2);
    double share = at - (double)below;
    density->weight[below] += (1 - share) / (double)count;
    density->weight[below + 1] += share / (double)count;
  }
}

static void place_values(const double *sorted, size_t count, fg_density *density) {
  if (count > BIN_ABOVE) {
    bin_values(sorted, count, density);
  } else {
    memcpy(density->value, sorted, count * sizeof *sorted);
    for (size_t i = 0; i < count; i++)
      density->weight[i] = 1 / (double)count;
  }
  double sum = 0;
  for (size_t i = 0; i < density->count; i++)
    density->cumulative[i] = sum += density->weight[i];
}

fg_status fg_density_fit(fg_context *ctx, const double *values, size_t count,
                         fg_bandwidth_rule rule, fg_density *density) {
  void *block = NULL;
  fg_status status = FG_OK;
  *density = (fg_density){0};
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof(double), &block));
  double *sorted = block;
  if (count) memcpy(sorted, values, count * sizeof *sorted);
  fg_sort(sorted, count);
  if (count < 2 || !(sorted[count - 1] > sorted[0]))
    FG_TRY_EXIT(fg_fail(ctx, FG_ERR_DATA, "a density needs two different values at least"));
  FG_TRY_EXIT(allocate_points(ctx, count > BIN_ABOVE ? GRID_POINTS : count, density));
  place_values(sorted, count, density);
  FG_TRY_EXIT(choose_bandwidth(ctx, sorted, count, rule, &density->bandwidth));
exit:
  free(block);
  if (status != FG_OK) fg_density_free(density);
  return status;
}

void fg_density_free(fg_density *density) {
  free(density->value);
  free(density->weight);
  free(density->cumulative);
  *density = (fg_density){0};
}

/* The first of the ascending values that is not below x. */
static size_t first_from(const double *ascending, size_t count, double x) {
  size_t low = 0, high = count;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (ascending[middle] < x)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

double fg_density_at(const fg_density *density, double x) {
  double h = density->bandwidth, sum = 0;
  size_t i = first_from(density->value, density->count, x - kernel_reach * h);
  for (; i < density->count && density->value[i] <= x + kernel_reach * h; i++) {
    double z = (x - density->value[i]) / h;
    sum += density->weight[i] * exp(-z * z / 2);
  }
  return sum / (h * root_two_pi);
}

double fg_density_probability(const fg_density *density, double x) {
  double h = density->bandwidth;
  size_t i = first_from(density->value, density->count, x - kernel_reach * h);
  double sum = i ? density->cumulative[i - 1] : 0;
  for (; i < density->count && density->value[i] <= x + kernel_reach * h; i++)
    sum += density->weight[i] * erfc((density->value[i] - x) / (h * sqrt(2))) / 2;
  return fmin(sum, 1);
}

double fg_density_quantile(const fg_density *density, double probability) {
  double reach = kernel_reach * density->bandwidth;
  double low = density->value[0] - reach, high = density->value[density->count - 1] + reach;
  for (int i = 0; i < 80; i++) {
    double middle = (low + high) / 2;
    if (fg_density_probability(density, middle) < probability)
      low = middle;
    else
      high = middle;
  }
  return (low + high) / 2;
}

/* Searches the whole range on a grid, then by golden section about the best point. */
double fg_density_mode(const fg_density *density) {
  static const double golden = 0.61803398874989485;
  double first = density->value[0], span = density->value[density->count - 1] - first;
  double step = span / SEARCH_POINTS, best = first, highest = -1;
  for (int i = 0; i <= SEARCH_POINTS; i++) {
    double value = fg_density_at(density, first + step * i);
    if (value <= highest) continue;
    highest = value;
    best = first + step * i;
  }
  double low = best - step, high = best + step;
  for (int i = 0; i < 60; i++) {
    double a = high - golden * (high - low), b = low + golden * (high - low);
    if (fg_density_at(density, a) > fg_density_at(density, b))
      high = b;
    else
      low = a;
  }
  return (low + high) / 2;
}

/* A draw is one of the values and the kernel's own normal error. */
double fg_density_draw(const fg_density *density, uint64_t *seed) {
  double total = density->cumulative[density->count - 1];
  size_t i = first_from(density->cumulative, density->count, fg_splitmix_uniform(seed) * total);
  if (i >= density->count) i = density->count - 1;
  double normal = fg_splitmix_normal(seed);
  return density->value[i] + density->bandwidth * normal;
}
