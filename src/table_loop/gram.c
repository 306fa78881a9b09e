/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/gram.h"

#include <math.h>
#include <string.h>

#include "table_loop/dots.h"

/* Rows that are read while a block of the columns stays in the nearest cache. */
enum { BLOCK = 512 };

void fg_engine_gram_take(size_t n, const double *columns, size_t count, const double *weight,
                         const double *vectors, size_t rank, fg_engine_gram *gram) {
  double weighted[BLOCK];
  gram->count = count;
  gram->rank = rank;
  memset(gram->own, 0, sizeof gram->own);
  memset(gram->cross, 0, count * (rank + 1) * sizeof *gram->cross);
  for (size_t from = 0; from < n; from += BLOCK) {
    size_t rows = n - from < BLOCK ? n - from : BLOCK;
    for (size_t k = 0; k < count; k++) {
      const double *own = columns + k * n + from, *a = own;
      fg_engine_add_dots(rows, own, vectors + from, n, rank + 1, gram->cross + k * (rank + 1));
      if (weight) {
        for (size_t i = 0; i < rows; i++)
          weighted[i] = own[i] * weight[from + i];
        a = weighted;
      }
      fg_engine_add_dots(rows, a, columns + from, n, k + 1, gram->own + k * FG_LOOP_COLUMNS);
    }
  }
}

/* Share of a column's squared length below which it lies in the span. */
static const double same_span = 1e-9;

/* Computes row k of the Cholesky factor of F'F - (F'Q)(F'Q)' over the columns kept so far; returns
 * the remaining |f_k|². */
static double factor_row(fg_engine_gram *gram, size_t k, const size_t *kept, size_t rank,
                         double *u) {
  const size_t width = gram->rank + 1;
  double *row = gram->own + k * FG_LOOP_COLUMNS, left = row[k];
  const double *cross = gram->cross + k * width;
  for (size_t m = 0; m < rank; m++) {
    size_t j = kept[m];
    double sum = row[j];
    for (size_t q = 0; q < gram->rank; q++)
      sum -= cross[q] * gram->cross[j * width + q];
    for (size_t i = 0; i < m; i++)
      sum -= row[kept[i]] * gram->own[j * FG_LOOP_COLUMNS + kept[i]];
    row[j] = sum / gram->own[j * FG_LOOP_COLUMNS + j];
    left -= row[j] * row[j];
    u[k] -= row[j] * u[j];
  }
  return left;
}

fg_engine_beside_null fg_engine_gram_solve(fg_engine_gram *gram) {
  fg_engine_beside_null beside = {0};
  const size_t width = gram->rank + 1;
  double u[FG_LOOP_COLUMNS], whole = 0;
  size_t kept[FG_LOOP_COLUMNS];
  for (size_t k = 0; k < gram->count; k++) {
    double *own = &gram->own[k * FG_LOOP_COLUMNS + k], size = *own;
    const double *cross = gram->cross + k * width;
    for (size_t q = 0; q < gram->rank; q++)
      *own -= cross[q] * cross[q];
    *own = fmax(*own, 0);
    whole += size;
    beside.length += *own / (double)gram->count;
    u[k] = cross[gram->rank];
    double left = factor_row(gram, k, kept, beside.rank, u);
    if (!(left > same_span * size)) continue;
    *own = sqrt(left);
    u[k] /= *own;
    beside.gain += u[k] * u[k];
    kept[beside.rank++] = k;
  }
  beside.share = whole > 0 ? beside.length * (double)gram->count / whole : 0;
  return beside;
}
