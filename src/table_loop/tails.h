/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Likelihood of outliers against heavy tails. */
#ifndef FG_TABLE_LOOP_TAILS_H
#define FG_TABLE_LOOP_TAILS_H

#include <stddef.h>

/* Returns the log likelihood ratio of two models, each at its best scale and tail: `rest` values of
 * normal noise and `wrong` values that may lie anywhere, over one Student's t for all. Any common
 * unit; rest > 1. */
double fg_engine_wrong_over_tail(size_t rest, const double *value, size_t wrong,
                                 const double *wrong_value);

/* Returns the log likelihood ratio of rows with two of them exchanged back over rows as they were
 * measured, each at its best scale and tail. */
double fg_engine_exchanged_over_tail(size_t count, const double *measured, const double *put_back);

#endif
