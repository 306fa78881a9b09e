/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mean of values; how large the sizes of residuals are. */
#ifndef FG_CORE_SPREAD_H
#define FG_CORE_SPREAD_H

#include <stddef.h>

/* NaN when there are none. */
double fg_mean(const double *values, size_t count);

/* Sum of squared differences from `mean`. */
double fg_squares_about(const double *values, size_t count, double mean);

/* The sd of a normal distribution over the median of its sizes. */
#define FG_SD_PER_MEDIAN 1.4826

/* robust_sd: FG_SD_PER_MEDIAN times the median (of an even number the mean of the two in the
 * middle); p95: the value at place 0.95 (count - 1), rounded down, of the ascending sizes from
 * place 0; the largest. */
typedef struct fg_spread {
  double robust_sd, p95, maximum;
} fg_spread;

/* The same from the upper of the two in the middle, which costs one selection: for limits. NaN when
 * there are none. */
double fg_robust_sd(double *sizes, size_t count);

/* Of |residual|; reorders them. All NaN when there are none. */
fg_spread fg_spread_of(double *sizes, size_t count);

/* So many robust standard deviations of what has these sizes (FG_SD_PER_MEDIAN times the upper
 * median each); INFINITY when there are none. Reorders them. */
double fg_spread_limit(double *sizes, size_t count, double deviations);

#endif
