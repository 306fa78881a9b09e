/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/select.h"

#include <math.h>
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

/* Counts values below `value`, and those equal to it. */
__attribute__((target_clones("avx2", "default"))) static void
count_ranks(const float *values, int count, float value, int *below, int *equal) {
  int less = 0, same = 0;
  for (int i = 0; i < count; i++) {
    less += values[i] < value;
    same += values[i] == value;
  }
  *below = less;
  *equal = same;
}

float fg_select_of_few(const float *values, int count, int k) {
  float low = -INFINITY, high = INFINITY;
  for (int i = 0; i < count; i++) {
    int below, equal;
    if (values[i] < low || values[i] > high) continue;
    count_ranks(values, count, values[i], &below, &equal);
    if (below <= k && k < below + equal) return values[i];
    if (below > k)
      high = values[i];
    else
      low = values[i];
  }
  return NAN;
}

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
