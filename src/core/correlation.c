/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/correlation.h"

#include <math.h>

/* Min size of a correlation beyond chance, in standard errors. */
#define CHANCE_ERRORS 2.0

static double correlation_at(const double *products, const double *pairs, size_t lag) {
  return products[lag] / pairs[lag] / (products[0] / pairs[0]);
}

size_t fg_correlation_lags(const double *products, const double *pairs, size_t lags) {
  size_t lag = 1;
  if (!(products[0] > 0)) return lag;
  while (lag < lags && pairs[lag] > 0 &&
         correlation_at(products, pairs, lag) >= CHANCE_ERRORS / sqrt(pairs[lag]))
    lag++;
  return lag;
}

double fg_correlation_integral(const double *products, const double *pairs, size_t lags) {
  double integral = 1;
  size_t count = fg_correlation_lags(products, pairs, lags);
  for (size_t lag = 1; lag < count; lag++)
    integral += 2 * correlation_at(products, pairs, lag);
  return integral;
}
