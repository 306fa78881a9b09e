/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whitening of rows with correlated noise: banded Cholesky for a Gaussian correlation, the
 * innovations of a Kalman filter with one state for an exponential one. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "rows/scatter.h"

/* A Gaussian correlation over more ranges than this is none: exp(-9) = 1e-4. */
#define BAND_RANGES 3.0
/* Lower limit of a row's innovation variance, as a share of its own. */
#define PIVOT_MIN 1e-4

/* A disc's edge is cut into arcs of this length. */
#define ARC_MAX_MM 4.0

size_t fg_edge_fit_arc_end(const fg_edge_fit *edge_fit, size_t from) {
  const fg_edge_fit_row *first = &edge_fit->rows[from];
  size_t to = from;
  while (to < edge_fit->row_count && edge_fit->rows[to].view == first->view &&
         edge_fit->rows[to].group == first->group &&
         fabs(edge_fit->rows[to].s_mm - first->s_mm) < ARC_MAX_MM)
    to++;
  return to;
}

static double distance_of_rows(const fg_edge_fit *edge_fit, size_t a, size_t b) {
  return fabs(edge_fit->rows[a].s_mm - edge_fit->rows[b].s_mm);
}

/* Returns the largest number of rows within a length of one row. */
static size_t rows_within(const fg_edge_fit *edge_fit, double length_mm) {
  size_t max = 1;
  for (size_t i = 0, from = 0, end = 0; i < edge_fit->row_count; i++) {
    if (i == end) {
      from = i;
      end = fg_edge_fit_arc_end(edge_fit, i);
    }
    while (distance_of_rows(edge_fit, i, from) > length_mm)
      from++;
    max = i - from > max ? i - from : max;
  }
  return max;
}

/* Computes row i of the banded factor from the rows before it; `lower` is `band` + 1 wide, the
 * diagonal first. */
static void factor_row(const fg_edge_fit *edge_fit, const fg_whitening *w, size_t i, size_t start,
                       double *lower) {
  const fg_scatter *s = &edge_fit->scatter;
  size_t width = w->band + 1, reach = i - start < w->band ? i - start : w->band;
  double *own = lower + i * width, square = 1;
  for (size_t k = reach; k > 0; k--) { /* with row i - k */
    const double *other = own - k * width;
    double d = distance_of_rows(edge_fit, i, i - k) / s->range_mm, sum = s->share * exp(-d * d);
    if (!w->used[i - k]) continue;
    for (size_t m = k + 1; m <= reach && m - k <= w->band; m++)
      sum -= own[m] * other[m - k];
    own[k] = sum / other[0];
    square -= own[k] * own[k];
  }
  own[0] = sqrt(fmax(square, PIVOT_MIN));
}

static fg_status factor(fg_context *ctx, const fg_edge_fit *edge_fit, fg_whitening *w) {
  size_t width = w->band + 1, start = 0;
  double *lower = NULL;
  FG_TRY(fg_memory_allocate(ctx, w->rows * width, sizeof *lower, (void **)&lower));
  for (size_t i = 0; i < w->rows; i++) {
    if (w->first[i]) start = i;
    if (!w->used[i]) continue;
    factor_row(edge_fit, w, i, start, lower);
    w->scale[i] = 1 / lower[i * width];
    w->log_determinant += 2 * log(lower[i * width]);
    memcpy(w->before + i * w->band, lower + i * width + 1, w->band * sizeof *lower);
  }
  free(lower);
  return FG_OK;
}

/* Computes, per row, the decay of the state from the row before, and the gain of an innovation. */
static void filter(const fg_edge_fit *edge_fit, fg_whitening *w) {
  const fg_scatter *s = &edge_fit->scatter;
  double known = s->share; /* variance of the state */
  size_t last = 0;
  for (size_t i = 0; i < w->rows; i++) {
    if (w->first[i]) last = w->rows;
    if (!w->used[i]) continue;
    double keep = last < w->rows ? exp(-distance_of_rows(edge_fit, i, last) / s->range_mm) : 0;
    known = keep * keep * known + (1 - keep * keep) * s->share;
    double square = known + 1 - s->share, gain = known / square;
    known *= 1 - gain;
    w->before[2 * i] = keep;
    w->before[2 * i + 1] = gain;
    w->scale[i] = 1 / sqrt(square);
    w->log_determinant += log(square);
    last = i;
  }
}

/* Ends the quarters at starts of arcs. */
static void find_quarters(fg_whitening *w) {
  for (size_t q = 0; q <= FG_WHITENING_QUARTERS; q++) {
    size_t i = q * w->rows / FG_WHITENING_QUARTERS;
    while (i < w->rows && !w->first[i])
      i++;
    w->quarter[q] = i;
  }
}

static fg_status allocate_whitening(fg_context *ctx, const fg_edge_fit *edge_fit, fg_whitening *w) {
  const fg_scatter *s = &edge_fit->scatter;
  w->rows = edge_fit->row_count;
  w->exponential = s->model == FG_SCATTER_EXPONENTIAL;
  w->band = w->exponential ? 2 : rows_within(edge_fit, BAND_RANGES * s->range_mm);
  FG_TRY(fg_memory_allocate(ctx, w->rows, sizeof *w->used, (void **)&w->used));
  FG_TRY(fg_memory_allocate(ctx, w->rows, sizeof *w->first, (void **)&w->first));
  FG_TRY(fg_memory_allocate(ctx, w->rows, sizeof *w->scale, (void **)&w->scale));
  return fg_memory_allocate(ctx, w->rows * w->band, sizeof *w->before, (void **)&w->before);
}

fg_status fg_whitening_open(fg_context *ctx, const fg_edge_fit *edge_fit, fg_whitening *w) {
  *w = (fg_whitening){.rows = edge_fit->row_count};
  if (!(edge_fit->scatter.share > 0) || !edge_fit->row_count) return FG_OK;
  fg_status status = FG_OK;
  FG_TRY_EXIT(allocate_whitening(ctx, edge_fit, w));
  for (size_t i = 0; i < w->rows; i++)
    w->used[i] = edge_fit->rows[i].weight > 0;
  for (size_t i = 0; i < w->rows; i = fg_edge_fit_arc_end(edge_fit, i))
    w->first[i] = true;
  find_quarters(w);
  if (w->exponential)
    filter(edge_fit, w);
  else
    FG_TRY_EXIT(factor(ctx, edge_fit, w));
  double size = sqrt(edge_fit->scatter.integral); /* smooth values keep theirs */
  for (size_t i = 0; i < w->rows; i++)
    w->scale[i] *= size;
  w->unit = 1 / size;
exit:
  if (status != FG_OK) fg_whitening_close(w);
  return status;
}

void fg_whitening_close(fg_whitening *w) {
  free(w->used);
  free(w->first);
  free(w->scale);
  free(w->before);
  *w = (fg_whitening){.rows = 0};
}

/* Place of a filter of rows in their order. */
typedef struct run {
  size_t row, start; /* start: of the row's arc */
  double state;
} run;

static inline void factor_next(const fg_whitening *w, double *v, run *at) {
  size_t i = at->row++;
  if (w->first[i]) at->start = i;
  if (!w->used[i]) {
    v[i] = 0;
    return;
  }
  const double *before = w->before + i * w->band;
  size_t reach = i - at->start < w->band ? i - at->start : w->band;
  double sum = 0;
  for (size_t k = 1; k <= reach; k++)
    sum += before[k - 1] * v[i - k];
  v[i] = (v[i] - sum * w->unit) * w->scale[i];
}

static inline void filter_next(const fg_whitening *w, double *v, run *at) {
  size_t i = at->row++;
  if (w->first[i]) at->state = 0;
  if (!w->used[i]) {
    v[i] = 0;
    return;
  }
  at->state *= w->before[2 * i];
  double innovation = v[i] - at->state;
  at->state += w->before[2 * i + 1] * innovation;
  v[i] = innovation * w->scale[i];
}

/* No arc knows of the ones before it, so quarters of the rows are whitened side by side: in a
 * single run, each row would wait for the row before. */
static inline void apply_to_quarters(const fg_whitening *w, double *v,
                                     void (*next)(const fg_whitening *, double *, run *)) {
  run at[FG_WHITENING_QUARTERS];
  size_t common = w->rows;
  for (size_t q = 0; q < FG_WHITENING_QUARTERS; q++) {
    size_t from = w->quarter[q], count = w->quarter[q + 1] - from;
    at[q] = (run){from, from, 0};
    common = count < common ? count : common;
  }
  for (size_t i = 0; i < common; i++)
    for (size_t q = 0; q < FG_WHITENING_QUARTERS; q++)
      next(w, v, &at[q]);
  for (size_t q = 0; q < FG_WHITENING_QUARTERS; q++)
    while (at[q].row < w->quarter[q + 1])
      next(w, v, &at[q]);
}

void fg_whitening_apply(const fg_whitening *w, double *values) {
  if (!w->band) return;
  if (w->exponential)
    apply_to_quarters(w, values, filter_next);
  else
    apply_to_quarters(w, values, factor_next);
}
