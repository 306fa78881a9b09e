/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/numerics.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

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

enum { LANES = 8 };

static inline double sum_of_lanes(const double *lane) {
  return ((lane[0] + lane[4]) + (lane[1] + lane[5])) + ((lane[2] + lane[6]) + (lane[3] + lane[7]));
}

/* The lanes are sums of their own, so wider vectors give the same numbers. */
__attribute__((target_clones("avx2", "default"))) static double
dot_in_lanes(const double *a, const double *b, size_t count) {
  double sum[LANES] = {0};
  size_t i = 0;
  for (; i + LANES <= count; i += LANES)
    for (size_t k = 0; k < LANES; k++)
      sum[k] += a[i + k] * b[i + k];
  for (; i < count; i++)
    sum[0] += a[i] * b[i];
  return sum_of_lanes(sum);
}

double fg_dot_in_lanes(const double *a, const double *b, size_t count) {
  return dot_in_lanes(a, b, count);
}

/* Half of the lanes, at any address: the compiler does not find this form of four sums itself. */
typedef double half __attribute__((vector_size(LANES / 2 * sizeof(double)), aligned(8)));

static inline void add_products(const half a[2], const double *b, half sum[2]) {
  sum[0] += a[0] * *(const half *)b;
  sum[1] += a[1] * *(const half *)(b + LANES / 2);
}

__attribute__((target_clones("avx2", "default"))) static void
dots_in_lanes(const double *a, const double *const *b, size_t count, double *sum) {
  half s0[2] = {{0}}, s1[2] = {{0}}, s2[2] = {{0}}, s3[2] = {{0}};
  double lane[FG_DOTS_AT_ONCE][LANES];
  size_t i = 0;
  for (; i + LANES <= count; i += LANES) {
    const half own[2] = {*(const half *)(a + i), *(const half *)(a + i + LANES / 2)};
    add_products(own, b[0] + i, s0);
    add_products(own, b[1] + i, s1);
    add_products(own, b[2] + i, s2);
    add_products(own, b[3] + i, s3);
  }
  memcpy(lane[0], s0, sizeof s0);
  memcpy(lane[1], s1, sizeof s1);
  memcpy(lane[2], s2, sizeof s2);
  memcpy(lane[3], s3, sizeof s3);
  for (size_t v = 0; v < FG_DOTS_AT_ONCE; v++) {
    for (size_t k = i; k < count; k++)
      lane[v][0] += a[k] * b[v][k];
    sum[v] = sum_of_lanes(lane[v]);
  }
}

void fg_dots_in_lanes(const double *a, const double *const b[FG_DOTS_AT_ONCE], size_t count,
                      double sum[FG_DOTS_AT_ONCE]) {
  dots_in_lanes(a, b, count, sum);
}

__attribute__((target_clones("avx2", "default"))) static void
subtract_share(double *restrict v, double share, const double *restrict b, size_t count) {
  for (size_t i = 0; i < count; i++)
    v[i] -= share * b[i];
}

void fg_subtract_share(double *v, double share, const double *b, size_t count) {
  subtract_share(v, share, b, count);
}
