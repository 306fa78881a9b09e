/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/spread.h"

#include <math.h>

#include "core/select.h"

double fg_mean(const double *values, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += values[i];
  return sum / (double)count;
}

double fg_squares_about(const double *values, size_t count, double mean) {
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += (values[i] - mean) * (values[i] - mean);
  return sum;
}

/* Selection leaves the larger values behind the middle. */
double fg_median(double *values, size_t count) {
  size_t middle = (count - 1) / 2;
  double low = fg_select(values, count, middle), high = INFINITY;
  if (count % 2) return low;
  for (size_t i = middle + 1; i < count; i++)
    high = fmin(high, values[i]);
  return low + 0.5 * (high - low);
}

double fg_upper_median(double *values, size_t count) {
  return count ? fg_select(values, count, count / 2) : NAN;
}

fg_spread fg_spread_of(double *sizes, size_t count) {
  if (!count) return (fg_spread){NAN, NAN, NAN};
  size_t last = count - 1;
  return (fg_spread){.robust_sd = FG_SD_PER_MEDIAN * fg_median(sizes, count),
                     .p95 = fg_select(sizes, count, last * 95 / 100),
                     .maximum = fg_select(sizes, count, last)};
}

double fg_robust_sd(double *sizes, size_t count) {
  return FG_SD_PER_MEDIAN * fg_upper_median(sizes, count);
}

double fg_spread_limit(double *sizes, size_t count, double deviations) {
  return count ? deviations * fg_robust_sd(sizes, count) : INFINITY;
}
