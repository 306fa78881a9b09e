/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mean of values, and measures of the spread of residuals. */
#ifndef FG_CORE_SPREAD_H
#define FG_CORE_SPREAD_H

#include <stddef.h>

/* Returns NaN without values. */
double fg_mean(const double *values, size_t count);

/* Sum of squared differences from `mean`. */
double fg_squares_about(const double *values, size_t count, double mean);

/* Returns the middle value, or the mean of the middle two; reorders the values. count > 0. */
double fg_median(double *values, size_t count);

/* Returns the upper of the middle two, or the middle value, by one selection; NaN without values.
 * Reorders them. */
double fg_upper_median(double *values, size_t count);

/* Ratio of the sd of a normal distribution to the median of its absolute values. */
#define FG_SD_PER_MEDIAN 1.4826

/* robust_sd: FG_SD_PER_MEDIAN times fg_median. p95:
 * the value at place 0.95 (count - 1), rounded down, of the ascending sizes from place 0. maximum:
 * the largest. */
typedef struct fg_spread {
  double robust_sd, p95, maximum;
} fg_spread;

/* Returns FG_SD_PER_MEDIAN times the upper median: for limits. NaN without values. */
double fg_robust_sd(double *sizes, size_t count);

/* Spread of |residual|; reorders them. All NaN without values. */
fg_spread fg_spread_of(double *sizes, size_t count);

/* Returns `deviations` robust standard deviations of `sizes` (FG_SD_PER_MEDIAN times the upper
 * median each); INFINITY without values. Reorders them. */
double fg_spread_limit(double *sizes, size_t count, double deviations);

#endif
