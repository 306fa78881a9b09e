/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Arithmetic on fg_extended: a number carried as the unevaluated sum of two doubles, 106 bits.
 *
 * The columns of a polynomial in raw units are so nearly parallel (condition number 1e15 for the
 * Filip data) that 13 digits of a coefficient need some 30 digits on the way, from the decimal text
 * of the data on. The sums and products are Dekker's and Knuth's error-free transformations (Dekker
 * 1971; Hida, Li and Bailey 2001); they need plain IEEE doubles: no -ffast-math here.
 */
#ifndef FG_CORE_EXTENDED_H
#define FG_CORE_EXTENDED_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/table.h"

/* Exact a + b; needs |a| >= |b|. */
static inline fg_extended fg_extended_renormalise(double a, double b) {
  double sum = a + b;
  return (fg_extended){sum, b - (sum - a)};
}

/* Exact a + b for any a, b. */
static inline fg_extended fg_extended_sum(double a, double b) {
  double sum = a + b;
  double part = sum - a;
  return (fg_extended){sum, (a - (sum - part)) + (b - part)};
}

static inline fg_extended fg_extended_of(double a) {
  return (fg_extended){a, 0.0};
}

static inline fg_extended fg_extended_negate(fg_extended a) {
  return (fg_extended){-a.value, -a.tail};
}

static inline fg_extended fg_extended_add(fg_extended a, fg_extended b) {
  fg_extended high = fg_extended_sum(a.value, b.value);
  fg_extended low = fg_extended_sum(a.tail, b.tail);
  high = fg_extended_renormalise(high.value, high.tail + low.value);
  return fg_extended_renormalise(high.value, high.tail + low.tail);
}

static inline fg_extended fg_extended_subtract(fg_extended a, fg_extended b) {
  return fg_extended_add(a, fg_extended_negate(b));
}

static inline fg_extended fg_extended_multiply(fg_extended a, fg_extended b) {
  double product = a.value * b.value;
  double error = fma(a.value, b.value, -product);
  return fg_extended_renormalise(product, error + (a.value * b.tail + a.tail * b.value));
}

/* Long division: each quotient digit is a double, each remainder is exact to 106 bits. */
static inline fg_extended fg_extended_divide(fg_extended a, fg_extended b) {
  double first = a.value / b.value;
  fg_extended rest = fg_extended_subtract(a, fg_extended_multiply(fg_extended_of(first), b));
  double second = rest.value / b.value;
  rest = fg_extended_subtract(rest, fg_extended_multiply(fg_extended_of(second), b));
  double third = rest.value / b.value;
  fg_extended quotient = fg_extended_renormalise(first, second);
  return fg_extended_add(quotient, fg_extended_of(third));
}

/* One Newton step from the double root doubles its digits. */
static inline fg_extended fg_extended_sqrt(fg_extended a) {
  if (!(a.value > 0)) return fg_extended_of(0.0);
  fg_extended root = fg_extended_of(sqrt(a.value));
  fg_extended rest = fg_extended_subtract(a, fg_extended_multiply(root, root));
  return fg_extended_add(root, fg_extended_of(rest.value / (2 * root.value)));
}

static inline fg_extended fg_extended_square(fg_extended a) {
  return fg_extended_multiply(a, a);
}

/* Returns a to a whole power. */
fg_extended fg_extended_power(fg_extended a, unsigned power);

/* Reads a decimal number (sign, digits, point, exponent; no locale) to all the digits that 106 bits
 * hold; false for any other text, nan and inf included. */
bool fg_extended_parse(const char *text, size_t length, fg_extended *number);

/* Returns the inner product of two columns. */
fg_extended fg_extended_dot(const fg_extended *a, const fg_extended *b, size_t count);

#endif
