/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wrong values, or one heavy tail of all? */
#ifndef FG_TABLE_LOOP_TAILS_H
#define FG_TABLE_LOOP_TAILS_H

#include <stddef.h>

/* Logarithm of a likelihood ratio: `rest` values of normal noise and `wrong` ones that may lie
 * anywhere, over all of them from one Student's t, each at its best scale and tail. Values are in
 * one unit, whatever it is; rest > 1. */
double fg_engine_wrong_over_tail(size_t rest, const double *value, size_t wrong,
                                 const double *wrong_value);

#endif
