/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/departures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_linalg.h>

#include "core/memory.h"

/* Share of a column's largest value that its values in one level differ by, through rounding. */
#define ROUNDING 1e-9

/* Declared columns that are a function of the level, at every level. */
typedef struct declared_levels {
  size_t levels, count, constant; /* constant: index into `column`; count: none */
  size_t *column;                 /* count: parameters */
  double *value;                  /* count × levels */
  double *rows;                   /* levels: number of rows */
} declared_levels;

static size_t level_of_row(const fg_engine_training *training, size_t first, size_t columns,
                           size_t i) {
  for (size_t k = 0; k < columns; k++)
    if (training->x[(first + k) * training->n + i] > 0) return k + 1;
  return 0;
}

/* Fills a column's value at every level; false: it differs within one. */
static bool fill_value(const fg_engine_training *training, const size_t *level, size_t parameter,
                       const declared_levels *d, double *value) {
  const double *x = training->x + parameter * training->n;
  double largest = 0;
  for (size_t i = 0; i < training->n; i++) {
    value[level[i]] = x[i];
    largest = fmax(largest, fabs(x[i]));
  }
  for (size_t i = 0; i < training->n; i++)
    if (fabs(x[i] - value[level[i]]) > ROUNDING * largest) return false;
  for (size_t l = 0; l < d->levels; l++)
    if (!(d->rows[l] > 0)) return false;
  return largest > 0;
}

static bool is_constant(const declared_levels *d, const double *value) {
  for (size_t l = 1; l < d->levels; l++)
    if (fabs(value[l] - value[0]) > ROUNDING * fabs(value[0])) return false;
  return true;
}

static fg_status open_levels_of(fg_context *ctx, const fg_engine_training *training, size_t first,
                                size_t columns, declared_levels *d) {
  size_t parameters = training->problem->parameters, *level = NULL;
  fg_status status = FG_OK;
  *d = (declared_levels){.levels = columns + 1};
  FG_TRY_EXIT(fg_memory_allocate(ctx, training->n, sizeof *level, (void **)&level));
  FG_TRY_EXIT(fg_memory_allocate(ctx, parameters + 1, sizeof *d->column, (void **)&d->column));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, parameters + 1, d->levels * sizeof *d->value, (void **)&d->value));
  FG_TRY_EXIT(fg_memory_allocate(ctx, d->levels, sizeof *d->rows, (void **)&d->rows));
  for (size_t i = 0; i < training->n; i++)
    d->rows[level[i] = level_of_row(training, first, columns, i)]++;
  size_t constant = SIZE_MAX;
  for (size_t p = 0; p < parameters; p++) {
    double *value = d->value + d->count * d->levels;
    if (!fill_value(training, level, p, d, value)) continue;
    if (is_constant(d, value)) constant = d->count;
    d->column[d->count++] = p;
  }
  d->constant = constant < d->count ? constant : d->count;
exit:
  free(level);
  return status;
}

static void close_levels_of(declared_levels *d) {
  free(d->column);
  free(d->value);
  free(d->rows);
}

/* Sum over the rows of two functions of the level. */
static double over_rows(const declared_levels *d, const double *a, const double *b) {
  double sum = 0;
  for (size_t l = 0; l < d->levels; l++)
    sum += d->rows[l] * a[l] * b[l];
  return sum;
}

/* Fits one level's indicator by the declared columns, each of unit length: count coefficients.
 * false: the columns are collinear. */
static bool fit_indicator(const declared_levels *d, size_t level, gsl_matrix *normal, gsl_vector *g,
                          double *coefficient) {
  for (size_t j = 0; j < d->count; j++) {
    const double *a = d->value + j * d->levels;
    double length = sqrt(over_rows(d, a, a));
    for (size_t k = 0; k < d->count; k++) {
      const double *b = d->value + k * d->levels;
      gsl_matrix_set(normal, j, k, over_rows(d, a, b) / (length * sqrt(over_rows(d, b, b))));
    }
    gsl_vector_set(g, j, d->rows[level] * a[level] / length);
  }
  if (gsl_linalg_cholesky_decomp1(normal) != 0 || gsl_linalg_cholesky_svx(normal, g) != 0)
    return false;
  for (size_t j = 0; j < d->count; j++) {
    const double *a = d->value + j * d->levels;
    coefficient[j] = gsl_vector_get(g, j) / sqrt(over_rows(d, a, a));
  }
  return true;
}

/* Adds to the map of the coefficients what one level's coefficient becomes. `given`: to the
 * declared columns. */
static void map_level(const declared_levels *d, size_t first, size_t k, const double *given,
                      size_t columns, double *map) {
  double at_first = 0;
  for (size_t l = 0; l < d->levels; l++) {
    double left = l == k + 1;
    for (size_t j = 0; j < d->count; j++)
      left -= d->value[j * d->levels + l] * given[j];
    if (l == 0)
      at_first = left;
    else
      map[(first + l - 1) * columns + first + k] = left - at_first;
  }
  for (size_t j = 0; j < d->count; j++)
    map[d->column[j] * columns + first + k] += given[j];
  map[d->column[d->constant] * columns + first + k] += at_first / d->value[d->constant * d->levels];
}

/* beta becomes M beta, its covariance M C M'. */
static fg_status apply_map(fg_context *ctx, const double *map, fg_engine_fit *fit) {
  size_t n = fit->columns;
  double *half = NULL, *beta = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, n * sizeof *half, (void **)&half));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, sizeof *beta, (void **)&beta));
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < n; k++) {
      beta[i] += map[i * n + k] * fit->beta[k];
      for (size_t j = 0; j < n; j++)
        half[i * n + j] += map[i * n + k] * fit->inverse[k * n + j];
    }
  memcpy(fit->beta, beta, n * sizeof *beta);
  memset(fit->inverse, 0, n * n * sizeof *half);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++)
      for (size_t k = 0; k < n; k++)
        fit->inverse[i * n + j] += half[i * n + k] * map[j * n + k];
exit:
  free(half);
  free(beta);
  return status;
}

static fg_status take_member(fg_context *ctx, const fg_engine_training *training, size_t first,
                             size_t count, fg_engine_fit *fit) {
  declared_levels d = {0};
  double *map = NULL, *given = NULL;
  gsl_matrix *normal = NULL;
  gsl_vector *g = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(open_levels_of(ctx, training, first, count, &d));
  if (d.count < 2 || d.constant == d.count) goto exit;
  FG_TRY_EXIT(fg_memory_allocate(ctx, fit->columns, fit->columns * sizeof *map, (void **)&map));
  FG_TRY_EXIT(fg_memory_allocate(ctx, d.count, sizeof *given, (void **)&given));
  normal = gsl_matrix_alloc(d.count, d.count);
  g = gsl_vector_alloc(d.count);
  if (!normal || !g) FG_TRY_EXIT(fg_fail(ctx, FG_ERR_MEMORY, "out of memory"));
  for (size_t i = 0; i < fit->columns; i++)
    map[i * fit->columns + i] = 1;
  for (size_t k = 0; k < count; k++) {
    if (!fit_indicator(&d, k + 1, normal, g, given)) goto exit;
    map_level(&d, first, k, given, fit->columns, map);
  }
  FG_TRY_EXIT(apply_map(ctx, map, fit));
exit:
  gsl_matrix_free(normal);
  gsl_vector_free(g);
  free(map);
  free(given);
  close_levels_of(&d);
  return status;
}

fg_status fg_engine_take_departures(fg_context *ctx, const fg_engine_training *training,
                                    const fg_engine_set *set, fg_engine_fit *fit) {
  size_t first = training->problem->parameters;
  for (size_t m = 0; m < set->count; m++) {
    const fg_loop_candidate *candidate = &set->candidate[m];
    if (fg_engine_is_exchange(candidate) || fg_engine_is_noise(candidate)) continue;
    size_t count = fg_engine_candidate_columns(training->problem, candidate);
    if (candidate->effect->reads == FG_LOOP_READS_LEVELS &&
        training->problem->coordinate[candidate->a].roles & FG_LOOP_DECLARED)
      FG_TRY(take_member(ctx, training, first, count, fit));
    first += count;
  }
  return FG_OK;
}
