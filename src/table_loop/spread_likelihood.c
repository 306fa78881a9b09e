/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/spread_likelihood.h"

#include <math.h>

/* Smallest sd of a level over the rms of all, and steepest logarithm per half range of a column. */
#define SMALLEST   0.02
#define STEEPEST   5.0
#define SLOPE_STEP 0.5
/* Parabolas through the best slope and its neighbours, each with a step so many times smaller. */
enum { ROUNDS = 5, PARABOLAS = 2, FINER = 5 };

typedef struct weighted {
  const fg_engine_span *null;
  const double *y;
  double *basis, *residual, *scale, *kept; /* n × rank, then n each */
} weighted;

/* Fits with the rows' scales: residuals over them, and the share of its variance that each keeps.
 * Returns twice the restricted log likelihood, up to what equal scales leave the same. */
static double fit_weighted(const weighted *w) {
  size_t n = w->null->n, rank = w->null->rank;
  double logs = 0;
  for (size_t i = 0; i < n; i++) {
    w->residual[i] = w->y[i] / w->scale[i];
    w->kept[i] = 1;
    logs += 2 * log(w->scale[i]);
  }
  for (size_t k = 0; k < rank; k++) {
    double *column = w->basis + k * n;
    for (size_t i = 0; i < n; i++)
      column[i] = w->null->basis[k * n + i] / w->scale[i];
    double left = fg_engine_project_out(n, w->basis, k, column);
    logs += log(left);
    for (size_t i = 0; i < n; i++) {
      column[i] /= sqrt(left);
      w->kept[i] -= column[i] * column[i];
    }
  }
  double rss = fg_engine_project_out(n, w->basis, rank, w->residual);
  return -((double)(n - rank) * log(rss) + logs);
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

static double of_levels(const weighted *w, const size_t *level) {
  double best = -INFINITY;
  for (int round = 0; round < ROUNDS; round++) {
    take_levels(w, level);
    best = fmax(best, fit_weighted(w));
  }
  return best;
}

static double at_slope(const weighted *w, const double *z, double slope) {
  for (size_t i = 0; i < w->null->n; i++)
    w->scale[i] = exp(slope * z[i]);
  return fit_weighted(w);
}

/* The likelihood between the slopes of the grid: without it a gain of less than two standard errors
 * would be 0, and the draws of the null would have no scale. */
static double of_slope(const weighted *w, const double *z) {
  double best = -INFINITY, at = 0, step = SLOPE_STEP;
  for (double slope = -STEEPEST; slope <= STEEPEST; slope += SLOPE_STEP) {
    double value = at_slope(w, z, slope);
    if (!(value > best)) continue;
    best = value;
    at = slope;
  }
  for (int k = 0; k < PARABOLAS; k++, step /= FINER) {
    double below = at_slope(w, z, at - step), above = at_slope(w, z, at + step),
           bend = below - 2 * best + above, vertex = at + step * (below - above) / (2 * bend);
    if (!(bend < 0) || !(fabs(vertex - at) <= step)) break;
    double value = at_slope(w, z, vertex);
    if (!(value > best)) continue;
    best = value;
    at = vertex;
  }
  return best;
}

double fg_engine_spread_gain(const fg_engine_span *null, fg_engine_spread_rows rows,
                             const double *y) {
  double basis[FG_ENGINE_SPREAD_ROWS * FG_ENGINE_SPREAD_ROWS], row[3][FG_ENGINE_SPREAD_ROWS];
  const weighted w = {null, y, basis, row[0], row[1], row[2]};
  size_t n = null->n;
  for (size_t i = 0; i < n; i++)
    w.scale[i] = 1;
  double equal = fit_weighted(&w);
  double unequal = rows.level ? of_levels(&w, rows.level) : of_slope(&w, rows.z);
  return fmax(unequal - equal, 0);
}
