/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/select.h"

#include <stdlib.h>

/* For double and for float. */
#define SELECTION(type, name)                                                                      \
  type name(type *values, size_t count, size_t k) {                                                \
    ptrdiff_t low = 0, high = (ptrdiff_t)count - 1, wanted = (ptrdiff_t)k;                         \
    while (low < high) {                                                                           \
      type pivot = values[low + (high - low) / 2];                                                 \
      ptrdiff_t i = low, j = high;                                                                 \
      while (i <= j) {                                                                             \
        while (values[i] < pivot)                                                                  \
          i++;                                                                                     \
        while (values[j] > pivot)                                                                  \
          j--;                                                                                     \
        if (i > j) break;                                                                          \
        type swap = values[i];                                                                     \
        values[i++] = values[j];                                                                   \
        values[j--] = swap;                                                                        \
      }                                                                                            \
      if (wanted <= j)                                                                             \
        high = j;                                                                                  \
      else if (wanted >= i)                                                                        \
        low = i;                                                                                   \
      else                                                                                         \
        break;                                                                                     \
    }                                                                                              \
    return values[k];                                                                              \
  }

SELECTION(double, fg_select)
SELECTION(float, fg_select_float)

static int compare_doubles(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

void fg_sort(double *values, size_t count) {
  qsort(values, count, sizeof *values, compare_doubles);
}

void fg_sort_items(void *items, size_t count, size_t size,
                   int (*order)(const void *, const void *)) {
  if (count) qsort(items, count, size, order);
}
