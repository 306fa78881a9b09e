/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/exchange_columns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "core/memory.h"
#include "effect/table_effects.h"
#include "table_loop/grid.h"

/* The row fits when chance alone makes a larger difference in one of so many rows. */
#define FITS_P 0.05

typedef struct one_row {
  const fg_engine_run *run;
  size_t row;
  fg_engine_training training; /* the other rows */
  fg_engine_fit fit;
  double *x; /* columns of the row's settings */
} one_row;

static fg_status open_row(fg_context *ctx, const fg_engine_run *run, fg_engine_noise noise,
                          size_t row, one_row *r) {
  const fg_loop_problem *problem = run->problem;
  bool *keep = NULL;
  *r = (one_row){.run = run, .row = row};
  FG_TRY(fg_memory_allocate(ctx, problem->rows, sizeof *keep, (void **)&keep));
  memcpy(keep, run->train, problem->rows * sizeof *keep);
  keep[row] = false;
  fg_status status = fg_engine_training_build(ctx, problem, keep, NULL, &r->training);
  free(keep);
  FG_TRY(status);
  FG_TRY(fg_engine_least_squares(ctx, &r->training, noise, &r->fit));
  return fg_memory_allocate(ctx, problem->parameters + 1, sizeof *r->x, (void **)&r->x);
}

static void close_row(one_row *r) {
  fg_engine_fit_free(&r->fit);
  fg_engine_training_free(&r->training);
  free(r->x);
}

/* P-value of the row's difference from the prediction at the settings x. */
static double row_fit_p(const one_row *r) {
  size_t columns = r->training.columns;
  double predicted = 0, variance = 1, dof = (double)r->training.n - (double)r->fit.rank;
  for (size_t k = 0; k < columns; k++) {
    predicted += r->x[k] * r->fit.beta[k];
    for (size_t m = 0; m < columns; m++)
      variance += r->x[k] * r->fit.inverse[k * columns + m] * r->x[m];
  }
  double sd = sqrt(variance * r->fit.rss / dof);
  return 2 * gsl_cdf_tdist_Q(fabs(r->run->problem->residual[r->row] - predicted) / sd, dof);
}

/* Declared columns of the row with two coordinates exchanged. */
static fg_status exchange_settings(fg_context *ctx, one_row *r, size_t a, size_t b) {
  const fg_loop_problem *problem = r->run->problem;
  fg_loop_problem grid = {0};
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_engine_grid_open(ctx, problem, 1, &grid));
  for (size_t c = 0; c < problem->coordinates; c++) {
    size_t from = c == a ? b : c == b ? a : c;
    double *value = NULL;
    FG_TRY_EXIT(fg_engine_grid_axis(ctx, &grid, c, &value));
    *value = problem->coordinate[from].value[r->row];
  }
  FG_TRY_EXIT(problem->declared(ctx, problem->declared_model, &grid, r->x));
  for (size_t k = 0; k < problem->parameters; k++)
    r->x[k] = ldexp(r->x[k], -r->run->units->column[k]);
exit:
  fg_engine_grid_close(&grid);
  return status;
}

static bool may_exchange_column(const fg_loop_coordinate *at) {
  unsigned no = FG_LOOP_ORDER | FG_LOOP_BUMP | FG_LOOP_SENSITIVITY | FG_LOOP_LEVEL;
  return !at->levels && !(at->roles & no);
}

/* Does the value of one column lie among the others of the other one? */
static bool lies_among(const fg_loop_problem *problem, size_t row, double value,
                       const fg_loop_coordinate *at) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < problem->rows; i++) {
    if (i == row) continue;
    low = fmin(low, at->value[i]);
    high = fmax(high, at->value[i]);
  }
  return value >= low && value <= high;
}

static bool may_exchange_pair(const fg_loop_problem *problem, size_t row, size_t a, size_t b) {
  const fg_loop_coordinate *x = &problem->coordinate[a], *y = &problem->coordinate[b];
  if (!may_exchange_column(x) || !may_exchange_column(y)) return false;
  if (!((x->roles | y->roles) & FG_LOOP_DECLARED)) return false;
  return lies_among(problem, row, x->value[row], y) && lies_among(problem, row, y->value[row], x);
}

fg_status fg_engine_find_exchanged_columns(fg_context *ctx, const fg_engine_run *run,
                                           fg_engine_noise noise, fg_loop_candidate *candidate) {
  const fg_loop_problem *problem = run->problem;
  double best = FITS_P;
  one_row r = {0};
  fg_status status = FG_OK;
  if (candidate->rows != 1 || fg_engine_is_exchange(candidate) || run->set.count ||
      !problem->declared || noise.rho != 0)
    return FG_OK;
  FG_TRY_EXIT(open_row(ctx, run, noise, candidate->row[0], &r));
  for (size_t a = 0; a < problem->coordinates; a++)
    for (size_t b = a + 1; b < problem->coordinates; b++) {
      if (!may_exchange_pair(problem, r.row, a, b)) continue;
      FG_TRY_EXIT(exchange_settings(ctx, &r, a, b));
      double p = row_fit_p(&r);
      if (!(p > best)) continue;
      best = p;
      candidate->effect = &fg_loop_outlier_effects()[2];
      candidate->a = a;
      candidate->b = b;
    }
exit:
  close_row(&r);
  return status;
}
