/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/numerics.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <pthread.h>

#include "foilgauge/design.h"

static void turn_handler_off(void) {
  gsl_set_error_handler_off();
}

void fg_numerics_start(void) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  pthread_once(&once, turn_handler_off);
}

double fg_log_gamma(double x) {
  int sign;
  return lgamma_r(x, &sign);
}

fg_margin fg_margin_to(double lower, double upper, double value) {
  double below = value - lower, above = upper - value;
  bool is_upper = isfinite(upper) && !(isfinite(lower) && below < above);
  if (!isfinite(lower) && !isfinite(upper)) is_upper = true;
  return (fg_margin){is_upper ? upper : lower, is_upper ? above : below, is_upper};
}

/* The lanes are sums of their own, so wider vectors give the same numbers. */
__attribute__((target_clones("avx2", "default"))) static double
dot_in_lanes(const double *a, const double *b, size_t count) {
  enum { LANES = 8 };
  double sum[LANES] = {0};
  size_t i = 0;
  for (; i + LANES <= count; i += LANES)
    for (size_t k = 0; k < LANES; k++)
      sum[k] += a[i + k] * b[i + k];
  for (; i < count; i++)
    sum[0] += a[i] * b[i];
  return ((sum[0] + sum[4]) + (sum[1] + sum[5])) + ((sum[2] + sum[6]) + (sum[3] + sum[7]));
}

double fg_dot_in_lanes(const double *a, const double *b, size_t count) {
  return dot_in_lanes(a, b, count);
}
