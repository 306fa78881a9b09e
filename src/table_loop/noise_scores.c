/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/noise_scores.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "effect/table_effects.h"
#include "table_loop/between.h"

/* Variance over squared mean of a normal residual's size (pi / 2 - 1); an exponential one has 1. */
#define SIZE_DISPERSION 0.5707963267948966
/* Sizes of a level are not smaller than this share of all rows': rounding may make them equal. */
#define SMALLEST_SIZE 1e-12
#define STEEPEST      1.5
enum { NEWTON_STEPS = 6 };
/* Of a step: the next one is its square. */
#define CONVERGED 1e-5

/* Levels of a candidate that lie within the groups have their variance in them: the groups are
 * fixed. Levels that hold the groups are tested between groups. */
static fg_status open_stratum(fg_context *ctx, const fg_engine_noise_scores *scores,
                              const double *columns, size_t count, fg_engine_spread *spread) {
  const fg_engine_training *training = scores->training;
  if (!training->levels) return FG_OK;
  spread->between = fg_engine_constant_in_levels(training, columns, count);
  return fg_engine_between_basis(ctx, training, scores->noise, scores->null, &spread->stratum,
                                 &spread->stratum_rank);
}

/* Whitened indicators of the levels beside the null's columns. */
static fg_status open_levels(fg_context *ctx, const fg_engine_noise_scores *scores,
                             const fg_loop_candidate *candidate, fg_engine_spread *spread) {
  const fg_engine_training *training = scores->training;
  const fg_loop_coordinate *at = &training->problem->coordinate[candidate->a];
  size_t n = training->n, rank = scores->null->rank;
  double *columns = NULL, *basis = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, at->levels * sizeof *columns, (void **)&columns));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, at->levels * sizeof *columns, (void **)&spread->unit));
  for (size_t i = 0; i < n; i++)
    columns[(size_t)at->value[training->row[i]] * n + i] = 1;
  FG_TRY_EXIT(open_stratum(ctx, scores, columns, at->levels, spread));
  for (size_t k = 0; k < at->levels; k++)
    fg_engine_whiten(training, scores->noise, columns + k * n);
  size_t fixed = spread->between ? 0 : spread->stratum_rank;
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, (rank + fixed + 1) * sizeof *basis, (void **)&basis));
  memcpy(basis, scores->null->basis, n * rank * sizeof *basis);
  if (fixed) memcpy(basis + rank * n, spread->stratum, n * fixed * sizeof *basis);
  spread->rank =
      fg_engine_orthonormal(n, basis, rank + fixed, columns, at->levels, spread->unit, NULL);
exit:
  free(columns);
  free(basis);
  return status;
}

static bool has_few_rows(const fg_engine_noise_scores *scores) {
  return scores->training->n <= FG_ENGINE_SPREAD_ROWS && !scores->training->scale &&
         fg_engine_independent(scores->noise);
}

static fg_status open_spread(fg_context *ctx, const fg_engine_noise_scores *scores,
                             const fg_loop_candidate *candidate, fg_engine_spread *spread) {
  const fg_engine_training *training = scores->training;
  size_t n = training->n, count = fg_engine_candidate_columns(training->problem, candidate);
  double *columns = NULL;
  fg_status status = FG_OK;
  spread->serial = fg_engine_is_serial(candidate);
  if (spread->serial) return FG_OK;
  spread->columns = count;
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, count * sizeof *columns, (void **)&columns));
  FG_TRY_EXIT(fg_engine_gather(ctx, training, candidate, (double[FG_LOOP_SHAPES]){0}, columns));
  if (count == 1 && !fg_loop_spread_by_levels(training->problem, candidate)) {
    spread->z = columns;
    return has_few_rows(scores)
               ? fg_engine_spread_grid_open(ctx, scores->null, columns, &spread->grid)
               : FG_OK;
  }
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, sizeof *spread->level, (void **)&spread->level));
  for (size_t k = 0; k < count; k++)
    for (size_t i = 0; i < n; i++)
      if (columns[k * n + i] > 0) spread->level[i] = k + 1;
exit:
  if (spread->z != columns) free(columns);
  return status;
}

fg_status fg_engine_noise_scores_open(fg_context *ctx, const fg_engine_training *training,
                                      fg_engine_noise noise, const fg_engine_span *null,
                                      const fg_loop_candidate *candidate, size_t candidates,
                                      fg_engine_noise_scores *scores) {
  fg_status status = FG_OK;
  *scores = (fg_engine_noise_scores){
      .training = training, .noise = noise, .null = null, .count = candidates};
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, candidates + 1, sizeof *scores->spread, (void **)&scores->spread));
  for (size_t c = 0; c < candidates; c++)
    FG_TRY_EXIT(fg_engine_is_levels(&candidate[c])
                    ? open_levels(ctx, scores, &candidate[c], &scores->spread[c])
                    : open_spread(ctx, scores, &candidate[c], &scores->spread[c]));
exit:
  if (status != FG_OK) fg_engine_noise_scores_close(scores);
  return status;
}

void fg_engine_noise_scores_close(fg_engine_noise_scores *scores) {
  for (size_t c = 0; scores->spread && c < scores->count; c++) {
    free(scores->spread[c].z);
    free(scores->spread[c].level);
    free(scores->spread[c].unit);
    free(scores->spread[c].stratum);
    fg_engine_spread_grid_close(&scores->spread[c].grid);
  }
  free(scores->spread);
  *scores = (fg_engine_noise_scores){0};
}

/* The correlation of neighbours, over its standard error were there none. */
static double serial_score(const fg_engine_training *training, const double *white) {
  double along = 0, square = 0;
  for (size_t b = 0; b < training->blocks; b++)
    for (size_t i = training->start[b]; i < training->start[b + 1]; i++) {
      square += white[i] * white[i];
      if (i > training->start[b]) along += white[i] * white[i - 1];
    }
  return square > 0 ? along / square * sqrt((double)training->n) : NAN;
}

/* -2 log likelihood of sizes with means exp(intercept + slope z), by Newton's method from slope 0;
 * exponential, because it is less sensitive to tails than squares are. */
static double slope_likelihood(size_t n, const double *z, const double *size, double mean) {
  double a = log(mean), b = 0, value = 0;
  for (int step = 0; step < NEWTON_STEPS; step++) {
    double right[2] = {0}, cross[3] = {0};
    for (size_t i = 0; i < n; i++) {
      double share = size[i] * exp(-a - b * z[i]);
      right[0] += share - 1;
      right[1] += (share - 1) * z[i];
      cross[0] += share;
      cross[1] += share * z[i];
      cross[2] += share * z[i] * z[i];
    }
    double det = cross[0] * cross[2] - cross[1] * cross[1];
    if (!(det > 0)) break;
    double move = (cross[0] * right[1] - cross[1] * right[0]) / det;
    double shift = (cross[2] * right[0] - cross[1] * right[1]) / det;
    a += fmin(fmax(shift, -1), 1);
    b += fmin(fmax(move, -STEEPEST), STEEPEST);
    if (fabs(move) < CONVERGED && fabs(shift) < CONVERGED) break;
  }
  for (size_t i = 0; i < n; i++)
    value += 2 * (a + b * z[i] + size[i] * exp(-a - b * z[i]));
  return value;
}

static double level_likelihood(size_t n, const fg_engine_spread *spread, const double *size) {
  double sum[FG_LOOP_COLUMNS + 1] = {0}, count[FG_LOOP_COLUMNS + 1] = {0}, value = 0;
  for (size_t i = 0; i < n; i++) {
    sum[spread->level[i]] += size[i];
    count[spread->level[i]]++;
  }
  for (size_t k = 0; k <= spread->columns; k++)
    if (count[k] > 0) value += 2 * count[k] * (log(fmax(sum[k] / count[k], SMALLEST_SIZE)) + 1);
  return value;
}

/* The residuals' sizes against the columns: root of twice the logarithm of a likelihood ratio. */
static double spread_score(const fg_engine_training *training, const fg_engine_spread *spread,
                           const double *size) {
  size_t n = training->n;
  double mean = 0;
  for (size_t i = 0; i < n; i++)
    mean += size[i] / (double)n;
  if (spread->columns == 0 || spread->columns + 4 > n || !(mean > 0)) return NAN;
  double null = 2 * (double)n * (log(mean) + 1);
  double with = spread->level ? level_likelihood(n, spread, size)
                              : slope_likelihood(n, spread->z, size, mean);
  return sqrt(fmax(null - with, 0) / SIZE_DISPERSION);
}

/* Wald's F ratio between the levels, exact for any number of rows in each: that their variance is 0
 * (Seely and El-Bassiouni 1983). */
static double levels_score(const fg_engine_noise_scores *scores, const fg_engine_spread *spread,
                           const double *white) {
  size_t n = scores->training->n, dof = n - scores->null->rank;
  double along = fg_engine_along(n, spread->stratum, spread->stratum_rank, white), whole = 0;
  for (size_t i = 0; i < n; i++)
    whole += white[i] * white[i];
  whole = spread->between ? along : whole - along;
  dof = spread->between ? spread->stratum_rank : dof - spread->stratum_rank;
  if (spread->rank == 0 || spread->rank + 2 > dof || !(whole > 0)) return NAN;
  double gain = fg_engine_along(n, spread->unit, spread->rank, white);
  double ratio = fmin(fmax(1 - gain / whole, FG_ENGINE_RATIO_MIN), 1);
  return fg_engine_deviate(ratio, (double)spread->rank, (double)dof);
}

static double score_of(const fg_engine_noise_scores *scores, size_t c, const double *y,
                       const double *white, const double *size) {
  const fg_engine_spread *spread = &scores->spread[c];
  if (spread->serial) return serial_score(scores->training, white);
  if (spread->unit) return levels_score(scores, spread, white);
  double z = spread_score(scores->training, spread, size);
  if (!isfinite(z) || !has_few_rows(scores)) return z;
  const fg_engine_spread_rows rows = {spread->level, spread->z, &spread->grid};
  return sqrt(fg_engine_spread_gain(scores->null, rows, y));
}

void fg_engine_noise_scores_of(const fg_engine_noise_scores *scores, const double *y, double *work,
                               double *z) {
  const fg_engine_training *training = scores->training;
  size_t n = training->n;
  double *white = work, *size = work + n, mean = 0;
  if (scores->count == 0) return;
  memcpy(white, y, n * sizeof *white);
  fg_engine_whiten(training, scores->noise, white);
  fg_engine_project_out(n, scores->null->basis, scores->null->rank, white);
  for (size_t i = 0; i < n; i++)
    size[i] = fabs(white[i]) / fg_engine_span_kept_sd(scores->null, i);
  for (size_t i = 0; i < n; i++)
    mean += size[i] / (double)n;
  for (size_t i = 0; mean > 0 && i < n; i++)
    size[i] /= mean;
  for (size_t c = 0; c < scores->count; c++)
    z[c] = score_of(scores, c, y, white, size);
}
