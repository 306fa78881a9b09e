/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/spread_likelihood.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"

/* Smallest sd of a level over the rms of all, and steps of the logarithm per half range of a
 * column, up to 5 to either side. */
#define SMALLEST   0.02
#define SLOPE_STEP 0.5
/* Parabolas through the best slope and its neighbours, each with a step so many times smaller. */
enum { ROUNDS = 5, PARABOLAS = 2, FINER = 5 };

typedef struct weighted {
  const fg_engine_span *null;
  const double *y;
  double *basis, *residual, *scale, *kept; /* n × rank, then n each */
} weighted;

/* Fills the null's columns over the rows' scales, orthonormal; returns the logarithm of the squared
 * lengths that they had beside each other. */
static double span_weighted(const fg_engine_span *null, const double *scale, double *basis) {
  size_t n = null->n;
  double logs = 0;
  for (size_t k = 0; k < null->rank; k++) {
    double *column = basis + k * n;
    for (size_t i = 0; i < n; i++)
      column[i] = null->basis[k * n + i] / scale[i];
    double left = fg_engine_project_out(n, basis, k, column);
    logs += log(left);
    for (size_t i = 0; i < n; i++)
      column[i] /= sqrt(left);
  }
  return logs;
}

/* Twice the restricted log likelihood, up to what equal scales leave the same, of a response over
 * the rows' scales; `terms` is the share of the columns and scales alone. */
static double likelihood(const fg_engine_span *null, const double *basis, double terms,
                         double *residual) {
  double rss = fg_engine_project_out(null->n, basis, null->rank, residual);
  return -((double)(null->n - null->rank) * log(rss) + terms);
}

/* Fits with the rows' scales; `logs` is twice the sum of their logarithms. */
static double fit_weighted(const weighted *w, double logs) {
  for (size_t i = 0; i < w->null->n; i++)
    w->residual[i] = w->y[i] / w->scale[i];
  logs += span_weighted(w->null, w->scale, w->basis);
  return likelihood(w->null, w->basis, logs, w->residual);
}

/* Finds the share of its variance that each row's residual keeps. */
static void find_kept(const weighted *w) {
  size_t n = w->null->n;
  for (size_t i = 0; i < n; i++)
    w->kept[i] = 1;
  for (size_t k = 0; k < w->null->rank; k++)
    for (size_t i = 0; i < n; i++)
      w->kept[i] -= w->basis[k * n + i] * w->basis[k * n + i];
}

static double sum_of_logs(size_t n, const double *scale) {
  double sum = 0;
  for (size_t i = 0; i < n; i++)
    sum += 2 * log(scale[i]);
  return sum;
}

/* A scale of every level: squares of its residuals over the dof that it keeps. */
static void take_levels(const weighted *w, const size_t *level) {
  size_t n = w->null->n;
  double square[FG_LOOP_COLUMNS + 1] = {0}, dof[FG_LOOP_COLUMNS + 1] = {0}, all = 0;
  for (size_t i = 0; i < n; i++) {
    double own = w->residual[i] * w->scale[i];
    square[level[i]] += own * own;
    dof[level[i]] += fmax(w->kept[i], 0);
    all += own * own / (double)n;
  }
  for (size_t i = 0; i < n; i++) {
    size_t k = level[i];
    double variance = dof[k] > 0 ? square[k] / dof[k] : all;
    w->scale[i] = sqrt(fmax(variance, SMALLEST * SMALLEST * all));
  }
}

static double fit_equal(const weighted *w) {
  for (size_t i = 0; i < w->null->n; i++)
    w->scale[i] = 1;
  return fit_weighted(w, 0);
}

static double gain_of_levels(const weighted *w, const size_t *level) {
  double equal = fit_equal(w), best = -INFINITY;
  for (int round = 0; round < ROUNDS; round++) {
    find_kept(w);
    take_levels(w, level);
    best = fmax(best, fit_weighted(w, sum_of_logs(w->null->n, w->scale)));
  }
  return best - equal;
}

/* ---- slopes ---- */

enum { NO_SLOPE = FG_ENGINE_SPREAD_SLOPES / 2 };

static double slope_at(size_t k) {
  return SLOPE_STEP * ((double)k - NO_SLOPE);
}

static void fill_slope(const fg_engine_span *null, const double *z, size_t k,
                       fg_engine_spread_grid *grid) {
  size_t n = null->n;
  double scale[FG_ENGINE_SPREAD_ROWS];
  for (size_t i = 0; i < n; i++) {
    scale[i] = exp(slope_at(k) * z[i]);
    grid->inverse[k * n + i] = 1 / scale[i];
  }
  grid->terms[k] =
      sum_of_logs(n, scale) + span_weighted(null, scale, grid->basis + k * null->rank * n);
}

fg_status fg_engine_spread_grid_open(fg_context *ctx, const fg_engine_span *null, const double *z,
                                     fg_engine_spread_grid *grid) {
  size_t row = null->n * sizeof(double);
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, FG_ENGINE_SPREAD_SLOPES, row, (void **)&grid->inverse));
  FG_TRY_EXIT(fg_memory_allocate(ctx, FG_ENGINE_SPREAD_SLOPES, (null->rank + 1) * row,
                                 (void **)&grid->basis));
  for (size_t k = 0; k < FG_ENGINE_SPREAD_SLOPES; k++)
    fill_slope(null, z, k, grid);
exit:
  if (status != FG_OK) fg_engine_spread_grid_close(grid);
  return status;
}

void fg_engine_spread_grid_close(fg_engine_spread_grid *grid) {
  free(grid->inverse);
  free(grid->basis);
  *grid = (fg_engine_spread_grid){.inverse = NULL};
}

static double at_grid(const weighted *w, const fg_engine_spread_grid *grid, size_t k) {
  size_t n = w->null->n;
  for (size_t i = 0; i < n; i++)
    w->residual[i] = w->y[i] * grid->inverse[k * n + i];
  return likelihood(w->null, grid->basis + k * w->null->rank * n, grid->terms[k], w->residual);
}

static double at_slope(const weighted *w, const double *z, double slope) {
  double logs = 0;
  for (size_t i = 0; i < w->null->n; i++) {
    w->scale[i] = exp(slope * z[i]);
    logs += 2 * slope * z[i];
  }
  return fit_weighted(w, logs);
}

/* The likelihood between the slopes of the grid: without it a gain of less than two standard errors
 * would be 0, and the draws of the null would have no scale. */
static double gain_of_slope(const weighted *w, const double *z, const fg_engine_spread_grid *grid) {
  double tried[FG_ENGINE_SPREAD_SLOPES], step = SLOPE_STEP;
  size_t top = 0;
  for (size_t k = 0; k < FG_ENGINE_SPREAD_SLOPES; k++) {
    tried[k] = at_grid(w, grid, k);
    if (tried[k] > tried[top] || isnan(tried[top])) top = k;
  }
  double best = tried[top], at = slope_at(top);
  double below = top > 0 ? tried[top - 1] : at_slope(w, z, at - step),
         above = top + 1 < FG_ENGINE_SPREAD_SLOPES ? tried[top + 1] : at_slope(w, z, at + step);
  for (int k = 0; k < PARABOLAS; k++) {
    double bend = below - 2 * best + above, vertex = at + step * (below - above) / (2 * bend);
    if (!(bend < 0) || !(fabs(vertex - at) <= step)) break;
    double value = at_slope(w, z, vertex);
    if (value > best) {
      best = value;
      at = vertex;
    }
    if (k + 1 == PARABOLAS) break;
    step /= FINER;
    below = at_slope(w, z, at - step);
    above = at_slope(w, z, at + step);
  }
  return best - tried[NO_SLOPE];
}

double fg_engine_spread_gain(const fg_engine_span *null, fg_engine_spread_rows rows,
                             const double *y) {
  double basis[FG_ENGINE_SPREAD_ROWS * FG_ENGINE_SPREAD_ROWS], row[3][FG_ENGINE_SPREAD_ROWS];
  const weighted w = {null, y, basis, row[0], row[1], row[2]};
  double gain = rows.level ? gain_of_levels(&w, rows.level) : gain_of_slope(&w, rows.z, rows.grid);
  return fmax(gain, 0);
}
