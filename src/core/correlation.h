/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Correlation of neighbouring values, from sums of products. */
#ifndef FG_CORE_CORRELATION_H
#define FG_CORE_CORRELATION_H

#include <stddef.h>

/* `products[k]` is the sum of the products of values that lie k apart, `pairs[k]` their number;
 * place 0 holds the squares. The correlation at a lag is its mean product over the mean square.
 * Both arrays have `lags` values. A lag counts while its correlation exceeds chance: two standard
 * errors, 2 / sqrt(pairs). */

/* Returns the number of lags that count, with 0: at least 1. */
size_t fg_correlation_lags(const double *products, const double *pairs, size_t lags);

/* Returns the integral of the correlation over the lags of both signs that count, at least 1. Noise
 * in n values averages like independent noise in n / integral values. */
double fg_correlation_integral(const double *products, const double *pairs, size_t lags);

#endif
