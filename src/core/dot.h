/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Product of two vectors. */
#ifndef FG_CORE_DOT_H
#define FG_CORE_DOT_H

#include <stddef.h>

static inline double fg_dot(const double *a, const double *b, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += a[i] * b[i];
  return sum;
}

#endif
