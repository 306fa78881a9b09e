/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Order statistics. */
#ifndef FG_CORE_SELECT_H
#define FG_CORE_SELECT_H

#include <stddef.h>

/* Returns the value at position `k` of the sorted values (Hoare's selection); reorders them. count
 * > k. */
double fg_select(double *values, size_t count, size_t k);
float fg_select_float(float *values, size_t count, size_t k);

/* Selects among a few values without NaN, which keep their order: ranks are counted on vectors. */
float fg_select_of_few(const float *values, int count, int k);

/* qsort that accepts NULL for no items. */
void fg_sort_items(void *items, size_t count, size_t size,
                   int (*order)(const void *, const void *));

/* Sorts in ascending order. */
void fg_sort(double *values, size_t count);

#endif
