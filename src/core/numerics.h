/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Basics of all numerics: GSL set up for a library (errors come back as codes, never as an abort),
 * the logarithm of gamma, and the product of two vectors. */
#ifndef FG_CORE_NUMERICS_H
#define FG_CORE_NUMERICS_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Turns off GSL's abort. Call it before any GSL function; it may be called from several threads and
 * more than once. */
void fg_numerics_start(void);

/* lgamma, which writes the sign into a global of all threads, for any thread. */
double fg_log_gamma(double x);

static inline double fg_dot(const double *a, const double *b, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += a[i] * b[i];
  return sum;
}

/* As fg_dot, in sums that do not wait for each other: faster on long vectors, and rounded
 * otherwise. */
double fg_dot_in_lanes(const double *a, const double *b, size_t count);

/* Vectors that fg_dots_in_lanes takes at a time. */
enum { FG_DOTS_AT_ONCE = 4 };

/* As fg_dot_in_lanes, of one vector with four: the same sums, with fewer loads. */
void fg_dots_in_lanes(const double *a, const double *const b[FG_DOTS_AT_ONCE], size_t count,
                      double sum[FG_DOTS_AT_ONCE]);

/* Subtracts share × b from v. */
void fg_subtract_share(double *v, double share, const double *b, size_t count);

#ifdef __cplusplus
}
#endif
#endif
