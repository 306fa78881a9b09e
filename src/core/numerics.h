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

#ifdef __cplusplus
}
#endif
#endif
