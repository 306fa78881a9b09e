/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/dots.h"

#include <string.h>

/* Rows that are read while a block of one vector stays in the nearest cache. */
enum { BLOCK = 1024, TOGETHER = 4 };

typedef double lane __attribute__((vector_size(32), aligned(8)));

__attribute__((target_clones("avx2", "default"))) static void
add_dots(size_t n, const double *a, const double *v, size_t stride, size_t count, double *sums) {
  size_t whole = n / 4 * 4;
  for (size_t k = 0; k < count; k += TOGETHER) {
    size_t here = count - k < TOGETHER ? count - k : TOGETHER;
    const double *at[TOGETHER];
    lane sum[TOGETHER] = {{0}};
    for (size_t m = 0; m < TOGETHER; m++)
      at[m] = v + (k + (m < here ? m : 0)) * stride;
    for (size_t i = 0; i < whole; i += 4) {
      lane x = *(const lane *)(a + i);
      for (size_t m = 0; m < TOGETHER; m++)
        sum[m] += x * *(const lane *)(at[m] + i);
    }
    for (size_t m = 0; m < here; m++) {
      double rest = (sum[m][0] + sum[m][1]) + (sum[m][2] + sum[m][3]);
      for (size_t i = whole; i < n; i++)
        rest += a[i] * at[m][i];
      sums[k + m] += rest;
    }
  }
}

void fg_engine_add_dots(size_t n, const double *a, const double *v, size_t stride, size_t count,
                        double *sums) {
  add_dots(n, a, v, stride, count, sums);
}

__attribute__((target_clones("avx2", "default"))) static void
subtract_block(size_t n, const double *basis, size_t stride, size_t count, const double *along,
               double *v) {
  size_t whole = n / 4 * 4;
  for (size_t k = 0; k < count; k += TOGETHER) {
    size_t here = count - k < TOGETHER ? count - k : TOGETHER;
    const double *at[TOGETHER];
    double share[TOGETHER];
    for (size_t m = 0; m < TOGETHER; m++) {
      at[m] = basis + (k + (m < here ? m : 0)) * stride;
      share[m] = m < here ? along[k + m] : 0;
    }
    for (size_t i = 0; i < whole; i += 4) {
      lane sum = *(lane *)(v + i);
      for (size_t m = 0; m < TOGETHER; m++)
        sum -= share[m] * *(const lane *)(at[m] + i);
      *(lane *)(v + i) = sum;
    }
    for (size_t i = whole; i < n; i++)
      for (size_t m = 0; m < here; m++)
        v[i] -= share[m] * at[m][i];
  }
}

void fg_engine_dots(size_t n, const double *basis, size_t count, const double *v, double *along) {
  memset(along, 0, count * sizeof *along);
  for (size_t from = 0; from < n; from += BLOCK)
    fg_engine_add_dots(n - from < BLOCK ? n - from : BLOCK, v + from, basis + from, n, count,
                       along);
}

void fg_engine_subtract(size_t n, const double *basis, size_t count, const double *along,
                        double *v) {
  for (size_t from = 0; from < n; from += BLOCK)
    subtract_block(n - from < BLOCK ? n - from : BLOCK, basis + from, n, count, along, v + from);
}
