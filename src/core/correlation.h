/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Correlation of neighbouring values, from sums of products. */
#ifndef FG_CORE_CORRELATION_H
#define FG_CORE_CORRELATION_H

#include <stddef.h>

/* Sum of the products of values that lie `lag` apart, and how many there are: place 0 holds the
 * squares. The correlation at a lag is its mean product over the mean square; `lags` arrays long.
 * A lag counts as long as its correlation is no chance: two standard errors, 2 / sqrt(pairs). */

/* Lags that count, with 0: at least 1. */
size_t fg_correlation_lags(const double *products, const double *pairs, size_t lags);

/* Integral of the correlation over the lags of both signs that count, at least 1: noise in n values
 * averages like that in n over it. */
double fg_correlation_integral(const double *products, const double *pairs, size_t lags);

#endif
