/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/comparison.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/spread.h"
#include "foilgauge/distribution.h"

typedef struct moments {
  double mean, variance, n;
} moments;

static moments moments_of(fg_sample sample) {
  moments m = {.n = (double)sample.count};
  for (size_t i = 0; i < sample.count; i++)
    m.mean += (sample.values[i] - sample.values[0]) / m.n;
  m.mean += sample.values[0];
  for (size_t i = 0; i < sample.count; i++)
    m.variance += (sample.values[i] - m.mean) * (sample.values[i] - m.mean) / (m.n - 1);
  return m;
}

double fg_effective_dof(const double *u, const double *dof, size_t count) {
  double sum = 0, shares = 0;
  for (size_t i = 0; i < count; i++)
    sum += u[i] * u[i];
  for (size_t i = 0; i < count; i++)
    shares += pow(u[i], 4) / dof[i];
  return sum * sum / shares;
}

static void compare_means(moments a, moments b, double confidence, fg_comparison *result) {
  const double u[2] = {sqrt(a.variance / a.n), sqrt(b.variance / b.n)};
  const double dof[2] = {a.n - 1, b.n - 1};
  double error = hypot(u[0], u[1]);
  result->difference = a.mean - b.mean;
  result->dof = fg_effective_dof(u, dof, 2);
  result->t = result->difference / error;
  result->p_means = fg_distribution_t_two_sided(result->t, result->dof);
  double reach = error * fg_distribution_t_quantile((1 + confidence) / 2, result->dof);
  result->low = result->difference - reach;
  result->high = result->difference + reach;
}

static void compare_variances(moments a, moments b, double confidence, fg_comparison *result) {
  double f = a.variance / b.variance, alpha = 1 - confidence;
  double upper = fg_distribution_f_upper(f, a.n - 1, b.n - 1);
  result->variance_ratio = f;
  result->p_variances = 2 * fmin(upper, 1 - upper);
  result->f_low = f / fg_distribution_f_quantile(1 - alpha / 2, a.n - 1, b.n - 1);
  result->f_high = f / fg_distribution_f_quantile(alpha / 2, a.n - 1, b.n - 1);
}

/* Distances from the sample's median. */
static void list_distances(fg_sample sample, double *distance) {
  memcpy(distance, sample.values, sample.count * sizeof *distance);
  double median = fg_median(distance, sample.count);
  for (size_t i = 0; i < sample.count; i++)
    distance[i] = fabs(sample.values[i] - median);
}

/* One-way analysis of variance of the distances. */
static fg_status compare_spreads(fg_context *ctx, fg_sample a, fg_sample b, fg_comparison *result) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, a.count + b.count, sizeof(double), &block));
  double *distance = block;
  list_distances(a, distance);
  list_distances(b, distance + a.count);
  moments first = moments_of((fg_sample){distance, a.count});
  moments second = moments_of((fg_sample){distance + a.count, b.count});
  free(distance);
  double n = first.n + second.n, grand = (first.n * first.mean + second.n * second.mean) / n;
  double between = first.n * pow(first.mean - grand, 2) + second.n * pow(second.mean - grand, 2);
  double within = (first.n - 1) * first.variance + (second.n - 1) * second.variance;
  result->levene = between / (within / (n - 2));
  result->p_levene = fg_distribution_f_upper(result->levene, 1, n - 2);
  return FG_OK;
}

fg_status fg_comparison_compute(fg_context *ctx, fg_sample a, fg_sample b, double confidence,
                                fg_comparison *result) {
  *result = (fg_comparison){0};
  if (a.count < 2 || b.count < 2)
    return fg_fail(ctx, FG_ERR_DATA, "a comparison needs two values on each side");
  moments first = moments_of(a), second = moments_of(b);
  if (!(first.variance + second.variance > 0))
    return fg_fail(ctx, FG_ERR_DATA, "a comparison needs values that differ");
  compare_means(first, second, confidence, result);
  compare_variances(first, second, confidence, result);
  return compare_spreads(ctx, a, b, result);
}
