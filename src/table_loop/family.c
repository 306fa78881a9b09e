/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shares by kind. The kinds' p-values come from their own maxima over the draws, extended beyond
 * the number of draws by a fitted tail. The smallest p-value over its share would be the family's
 * by Bonferroni's inequality; the draws give its distribution, so that kinds which see the same
 * patterns do not pay twice. */
#include "table_loop/family.h"

#include <math.h>
#include <stdlib.h>

#include <gsl/gsl_cdf.h>

#include "core/memory.h"
#include "core/select.h"

/* Share of the draws in the tail that is fitted, and over which the family's distribution is taken
 * from the draws themselves. */
#define TAIL 0.06
/* Weight, in draws, of the tail of a normal maximum: a power estimated from few draws alone would
 * be wrong by their relative scatter, far beyond them. */
#define PRIOR_DRAWS 25
/* Steepest and flattest tail. */
#define POWER_MIN 0.6
#define POWER_MAX 1.15
enum { BISECTIONS = 80 };

/* -log(1 - q), q the upper tail of a normal deviate. */
static double exceedance(double z) {
  return -log1p(-gsl_cdf_ugaussian_Q(z));
}

/* Fits tests × x^power to the smallest exceedances: the number of tests at the tail's edge by
 * maximum likelihood for a censored exponential sample, the power by Hill's estimator, pulled
 * towards that of a normal maximum. `x` is sorted. */
static void fit_tail(size_t draws, const double *x, double *tests, double *power) {
  size_t tail = (size_t)ceil(TAIL * (double)draws);
  double logs = 0, sum = 0;
  *tests = *power = 1;
  if (tail < 2 || !(x[tail - 1] > 0) || !isfinite(x[tail - 1])) return;
  for (size_t i = 0; i < tail; i++)
    logs += log(x[tail - 1] / fmax(x[i], 1e-300));
  *power = ((double)tail + PRIOR_DRAWS) / (logs + PRIOR_DRAWS);
  *power = fmin(fmax(*power, POWER_MIN), POWER_MAX);
  for (size_t i = 0; i < tail; i++)
    sum += pow(x[i], *power);
  sum += (double)(draws - tail) * pow(x[tail - 1], *power);
  *tests = (double)tail / sum;
}

static fg_status fit_kind(fg_context *ctx, size_t draws, const double *maxima, size_t kind,
                          fg_engine_family *family) {
  double *x = NULL;
  FG_TRY(fg_memory_allocate(ctx, draws, sizeof *x, (void **)&x));
  for (size_t b = 0; b < draws; b++)
    x[b] = exceedance(maxima[b * FG_LOOP_KINDS + kind]);
  fg_sort(x, draws);
  fit_tail(draws, x, &family->tests[kind], &family->power[kind]);
  free(x);
  return FG_OK;
}

double fg_engine_family_kind_p(const fg_engine_family *family, fg_loop_kind kind, double z) {
  if (!isfinite(z)) return 1;
  return -expm1(-family->tests[kind] * pow(exceedance(z), family->power[kind]));
}

static double weighted_p(const fg_engine_family *family, fg_loop_kind kind, double z) {
  return fg_engine_family_kind_p(family, kind, z) / family->share[kind];
}

/* Shares of the kinds that are drawn: single rows are tested by other means. */
static double drawn_share(const fg_engine_family *family) {
  return 1 - family->share[FG_LOOP_KIND_ROWS];
}

fg_status fg_engine_family_fit(fg_context *ctx, size_t draws, const double *maxima,
                               fg_engine_family *family) {
  for (size_t k = 0; k < FG_LOOP_KINDS; k++)
    FG_TRY(fit_kind(ctx, draws, maxima, k, family));
  free(family->min_p);
  family->min_p = NULL;
  FG_TRY(fg_memory_allocate(ctx, draws, sizeof *family->min_p, (void **)&family->min_p));
  family->draws = draws;
  for (size_t b = 0; b < draws; b++) {
    family->min_p[b] = INFINITY;
    for (size_t k = 0; k < FG_LOOP_KINDS; k++)
      family->min_p[b] = fmin(family->min_p[b],
                              weighted_p(family, (fg_loop_kind)k, maxima[b * FG_LOOP_KINDS + k]));
  }
  fg_sort(family->min_p, draws);
  fit_tail(draws, family->min_p, &family->min_p_tests, &family->min_p_power);
  return FG_OK;
}

/* By Bonferroni's inequality. */
void fg_engine_family_count(const double tests[FG_LOOP_KINDS], fg_engine_family *family) {
  for (size_t k = 0; k < FG_LOOP_KINDS; k++) {
    family->tests[k] = tests[k];
    family->power[k] = 1;
  }
  family->min_p_tests = drawn_share(family);
  family->min_p_power = 1;
}

/* Share of the draws whose smallest weighted p-value is at most that one. */
static double drawn_p(const fg_engine_family *family, double weighted) {
  size_t low = 0, high = family->draws;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (family->min_p[middle] <= weighted)
      low = middle + 1;
    else
      high = middle;
  }
  return (double)(low + 1) / (double)(family->draws + 1);
}

double fg_engine_family_p(const fg_engine_family *family, fg_loop_kind kind, double z) {
  double weighted = weighted_p(family, kind, z);
  double p = -expm1(-family->min_p_tests * pow(weighted, family->min_p_power));
  if (family->min_p && p > TAIL) p = drawn_p(family, weighted);
  return fmin(p / drawn_share(family), 1);
}

double fg_engine_family_critical(const fg_engine_family *family, fg_loop_kind kind, double p) {
  double low = -10, high = 37;
  for (int i = 0; i < BISECTIONS; i++) {
    double middle = (low + high) / 2;
    if (fg_engine_family_p(family, kind, middle) > p)
      low = middle;
    else
      high = middle;
  }
  return high;
}

void fg_engine_family_free(fg_engine_family *family) {
  free(family->min_p);
  family->min_p = NULL;
}
