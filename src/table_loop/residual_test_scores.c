/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "table_loop/residual_tests.h"

/* Minimum number of differences between repeats for estimating their scatter. */
enum { REPEATS_MIN = 4 };
/* Of a residual's sum of squares: repeats that differ by less were copied, not measured. */
#define COPIES 1e-12

/* Row with its settings: columns of the null, then recorded columns. */
typedef struct keyed_row {
  const double *key;
  size_t width, row;
} keyed_row;

static int by_key(const void *a, const void *b) {
  const keyed_row *x = a, *y = b;
  for (size_t k = 0; k < x->width; k++)
    if (x->key[k] != y->key[k]) return x->key[k] < y->key[k] ? -1 : 1;
  return 0;
}

static bool is_setting(const fg_loop_coordinate *at) {
  return !(at->roles & (FG_LOOP_ORDER | FG_LOOP_BUMP | FG_LOOP_SENSITIVITY | FG_LOOP_LEVEL));
}

static void fill_keys(const fg_engine_training *training, size_t width, double *key,
                      keyed_row *rows) {
  const fg_loop_problem *problem = training->problem;
  for (size_t i = 0; i < training->n; i++) {
    double *own = key + i * width;
    size_t k = 0;
    for (; k < training->columns; k++)
      own[k] = training->x[k * training->n + i];
    for (size_t c = 0; k < width; c++)
      if (is_setting(&problem->coordinate[c]))
        own[k++] = problem->coordinate[c].value[training->row[i]];
    rows[i] = (keyed_row){own, width, i};
  }
}

static void weigh_cells(const fg_engine_training *training, fg_engine_cells *cells) {
  for (size_t i = 0; i < training->n; i++) {
    double scale = training->scale ? training->scale[i] : 1;
    cells->weight[cells->cell[i]] += 1 / (scale * scale);
  }
}

fg_status fg_engine_cells_open(fg_context *ctx, const fg_engine_training *training, size_t rank,
                               bool recorded, fg_engine_cells *cells) {
  const fg_loop_problem *problem = training->problem;
  size_t n = training->n, width = training->columns;
  keyed_row *rows = NULL;
  double *key = NULL;
  fg_status status = FG_OK;
  *cells = (fg_engine_cells){0};
  for (size_t c = 0; recorded && c < problem->coordinates; c++)
    width += is_setting(&problem->coordinate[c]);
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, (width + 1) * sizeof *key, (void **)&key));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, sizeof *rows, (void **)&rows));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, sizeof *cells->cell, (void **)&cells->cell));
  fill_keys(training, width, key, rows);
  fg_sort_items(rows, n, sizeof *rows, by_key);
  for (size_t i = 0; i < n; i++) {
    cells->count += i == 0 || by_key(&rows[i], &rows[i - 1]);
    cells->cell[rows[i].row] = cells->count - 1;
  }
  FG_TRY_EXIT(fg_memory_allocate(ctx, cells->count, sizeof(double), (void **)&cells->weight));
  FG_TRY_EXIT(fg_memory_allocate(ctx, cells->count, sizeof(double), (void **)&cells->sum));
  weigh_cells(training, cells);
  cells->dof[0] = (double)cells->count - (double)rank;
  cells->dof[1] = (double)n - (double)cells->count;
exit:
  free(rows);
  free(key);
  if (status != FG_OK || cells->dof[0] < 1 || cells->dof[1] < REPEATS_MIN)
    fg_engine_cells_close(cells);
  return status;
}

void fg_engine_cells_close(fg_engine_cells *cells) {
  free(cells->cell);
  free(cells->weight);
  free(cells->sum);
  *cells = (fg_engine_cells){0};
}

double fg_engine_lack_of_fit(const fg_engine_training *training, fg_engine_cells *cells,
                             const double *white) {
  double all = 0, between = 0;
  memset(cells->sum, 0, cells->count * sizeof *cells->sum);
  for (size_t i = 0; i < training->n; i++) {
    cells->sum[cells->cell[i]] += white[i] / (training->scale ? training->scale[i] : 1);
    all += white[i] * white[i];
  }
  for (size_t c = 0; c < cells->count; c++)
    between += cells->sum[c] * cells->sum[c] / cells->weight[c];
  double repeats = all - between;
  if (!(repeats > COPIES * all)) return NAN;
  return between / cells->dof[0] / (repeats / cells->dof[1]);
}

double fg_engine_lag_score(const fg_engine_training *training, const double *white, size_t lag) {
  double sum = 0, squares = 0;
  for (size_t b = 0; b < training->blocks; b++)
    for (size_t i = training->start[b] + lag; i < training->start[b + 1]; i++) {
      double product = white[i] * white[i - lag];
      sum += product;
      squares += product * product;
    }
  return squares > 0 ? sum / sqrt(squares) : 0;
}

double fg_engine_lag_correlation(const fg_engine_training *training, const double *white,
                                 size_t lag) {
  double sum = 0, squares = 0;
  for (size_t i = 0; i < training->n; i++)
    squares += white[i] * white[i];
  for (size_t b = 0; b < training->blocks; b++)
    for (size_t i = training->start[b] + lag; i < training->start[b + 1]; i++)
      sum += white[i] * white[i - lag];
  return squares > 0 ? sum / squares : 0;
}
