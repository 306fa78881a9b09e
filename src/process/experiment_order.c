/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Residuals over the order of the runs: tests for a drift, for correlated neighbours, and for an
 * outlier. The loop on tables identifies the cause. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>

#include "core/extended.h"
#include "core/memory.h"
#include "core/numerics.h"
#include "foilgauge/distribution.h"
#include "process/experiment_parts.h"

/* Draws of the neighbours' null: p is known to 0.003 at the level of the test, with the fewest
 * draws to 0.01. */
enum { DRAWS_MAX = 1999, DRAWS_MIN = 199 };

/* Draws end after this many on either side: p is then known to a tenth of itself (Besag and
 * Clifford 1991), and far from the level. */
enum { ENOUGH = 100 };

/* Multiplications: a quarter of a second each. */
static const double WORK_OF_BASIS = 3e7, WORK_OF_DRAWS = 3e8;

typedef struct checking {
  const fg_experiment *e;
  size_t rows, rank;
  double *basis;    /* rank × rows: orthonormal columns that span the weighted model */
  double *residual; /* rows, of one spread: times the root of the weight */
  size_t *in_order; /* rows */
  double *work;
} checking;

/* As the loop on tables chooses (src/table_loop/problem.c). */
static const fg_column *order_column(const fg_experiment *e) {
  static const char *const names[] = {"run", "order", "run_order", "experiment", "sequence"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    const fg_column *column;
    bool used = !strcmp(names[i], e->response);
    if (fg_table_find(NULL, &e->table, names[i], &column) != FG_OK) continue;
    for (size_t v = 0; v < e->model.formula.variables; v++)
      used = used || !strcmp(e->model.formula.variable[v].column, names[i]);
    if (!used && !column->word_count && !column->missing_count && !column->uncertainty)
      return column;
  }
  return NULL;
}

static int by_value(const void *a, const void *b, void *value) {
  const double *v = value;
  size_t i = *(const size_t *)a, k = *(const size_t *)b;
  if (v[i] != v[k]) return v[i] < v[k] ? -1 : 1;
  return (i > k) - (i < k);
}

/* false: two runs have one position, which is no order */
static bool sort_runs(const checking *c, double *value) {
  for (size_t i = 0; i < c->rows; i++)
    c->in_order[i] = i;
  qsort_r(c->in_order, c->rows, sizeof *c->in_order, by_value, value);
  for (size_t i = 1; i < c->rows; i++)
    if (value[c->in_order[i]] == value[c->in_order[i - 1]]) return false;
  return true;
}

static void choose_order(checking *c, fg_order_check *order, double *value) {
  const fg_column *column = order_column(c->e);
  order->value = value;
  for (size_t i = 0; i < c->rows; i++)
    value[i] = column ? column->number[i].value : (double)i;
  if (column && sort_runs(c, value)) {
    order->column = column->name;
    return;
  }
  for (size_t i = 0; i < c->rows; i++)
    value[i] = (double)i + 1;
  (void)sort_runs(c, value);
}

static double root_weight(const fg_experiment *e, size_t row) {
  return e->measurement.weight ? sqrt(e->measurement.weight[row]) : 1;
}

/* X U, with (X'WX)^-1 = U U': its columns times the root of the weights are orthonormal. */
static void fill_basis(checking *c) {
  const fg_regression *r = &c->e->regression;
  for (size_t k = 0; k < r->columns; k++) {
    if (r->coefficient[k].aliased) continue;
    double *column = c->basis + c->rank++ * c->rows;
    for (size_t i = 0; i < c->rows; i++) {
      fg_extended sum = {0, 0};
      for (size_t j = 0; j < r->columns; j++)
        sum = fg_extended_add(sum, fg_extended_multiply(c->e->model.matrix[j * c->rows + i],
                                                        r->inverse_root[j * r->columns + k]));
      column[i] = sum.value * root_weight(c->e, i);
    }
  }
}

/* Projects v beside the model. */
static void project_out(const checking *c, double *v) {
  for (size_t k = 0; k < c->rank; k++) {
    const double *q = c->basis + k * c->rows;
    double along = 0;
    for (size_t i = 0; i < c->rows; i++)
      along += q[i] * v[i];
    for (size_t i = 0; i < c->rows; i++)
      v[i] -= along * q[i];
  }
}

/* The slope of one more column, fitted beside the model (Frisch and Waugh 1933). */
static void check_drift(const checking *c, fg_order_check *order) {
  const fg_regression *r = &c->e->regression;
  double first = order->value[c->in_order[0]], last = order->value[c->in_order[c->rows - 1]];
  double dof = (double)r->residual_dof - 1, *x = c->work, whole = 0;
  for (size_t i = 0; i < c->rows; i++) {
    x[i] = ((order->value[i] - first) / (last - first) - 0.5) * root_weight(c->e, i);
    whole += x[i] * x[i];
  }
  project_out(c, x);
  double left = fg_dot(x, x, c->rows);
  if (!(dof > 0) || !(left > 1e-9 * whole)) return; /* the model follows the order itself */
  order->drift = fg_dot(x, c->residual, c->rows) / left;
  double rest = fmax(0, r->residual_ss - order->drift * order->drift * left);
  order->u_drift = sqrt(rest / dof / left);
  order->drift_p = fg_distribution_t_two_sided(order->drift / order->u_drift, dof);
}

/* Correlation of neighbours in the order, about zero. */
static double neighbours(const checking *c, const double *v) {
  double products = 0;
  for (size_t i = 1; i < c->rows; i++)
    products += v[c->in_order[i]] * v[c->in_order[i - 1]];
  return products / fg_dot(v, v, c->rows);
}

/* Draws the null through the model: its projection correlates the residuals of independent errors.
 */
static fg_status draw_neighbours(fg_context *ctx, const checking *c, int draws,
                                 fg_order_check *order) {
  gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
  size_t above = 1, below = 1;
  if (!random) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: random numbers");
  int drawn = 0;
  for (; drawn < draws && (above <= ENOUGH || below <= ENOUGH); drawn++) {
    for (size_t i = 0; i < c->rows; i++)
      c->work[i] = gsl_ran_gaussian_ziggurat(random, 1);
    project_out(c, c->work);
    double null = neighbours(c, c->work);
    above += null >= order->neighbours;
    below += null <= order->neighbours;
  }
  gsl_rng_free(random);
  order->neighbours_p = fmin(1, 2 * (double)(above < below ? above : below) / (drawn + 1));
  return FG_OK;
}

static fg_status check_neighbours(fg_context *ctx, const checking *c, fg_order_check *order) {
  double squares = 0;
  if (c->e->regression.residual_dof < 2) return FG_OK;
  for (size_t i = 1; i < c->rows; i++)
    squares += pow(c->residual[c->in_order[i]] - c->residual[c->in_order[i - 1]], 2);
  order->durbin_watson = squares / fg_dot(c->residual, c->residual, c->rows);
  order->neighbours = neighbours(c, c->residual);
  double draws = WORK_OF_DRAWS / (2.0 * (double)c->rows * (double)(c->rank + 1));
  if (draws >= DRAWS_MIN) return draw_neighbours(ctx, c, (int)fmin(draws, DRAWS_MAX), order);
  /* Number of runs from which the normal approximation is used: normal with variance 1 / runs (Box
   * and Jenkins 1970). */
  order->neighbours_p = erfc(fabs(order->neighbours) * sqrt((double)c->rows / 2));
  return FG_OK;
}

static void check_farthest(const checking *c, fg_order_check *order) {
  const fg_regression *r = &c->e->regression;
  for (size_t i = 0; i < c->rows; i++)
    if (!isnan(r->external[i]) && !(fabs(r->external[i]) <= fabs(order->farthest_t))) {
      order->farthest = i;
      order->farthest_t = r->external[i];
    }
  if (isnan(order->farthest_t) || r->residual_dof < 2) return;
  double one = isinf(order->farthest_t)
                   ? 0
                   : fg_distribution_t_two_sided(order->farthest_t, (double)r->residual_dof - 1);
  order->farthest_p = fmin(1, one * (double)c->rows);
}

static fg_status check_residuals(fg_context *ctx, checking *c, fg_experiment *e) {
  fg_order_check *order = &e->order;
  size_t rows = c->rows;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *e->order_value, (void **)&e->order_value));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *c->in_order, (void **)&c->in_order));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *c->residual, (void **)&c->residual));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *c->work, (void **)&c->work));
  FG_TRY(
      fg_memory_allocate(ctx, rows * e->regression.columns, sizeof *c->basis, (void **)&c->basis));
  *order = (fg_order_check){.drift = NAN,
                            .u_drift = NAN,
                            .drift_p = NAN,
                            .neighbours = NAN,
                            .durbin_watson = NAN,
                            .neighbours_p = NAN,
                            .farthest_t = NAN,
                            .farthest_p = NAN};
  for (size_t i = 0; i < rows; i++)
    c->residual[i] = e->regression.residual[i] * root_weight(e, i);
  choose_order(c, order, e->order_value);
  fill_basis(c);
  check_drift(c, order);
  FG_TRY(check_neighbours(ctx, c, order));
  check_farthest(c, order);
  e->has_order = true;
  return FG_OK;
}

/* Skips tests with whole plots, whose own scatter is common to neighbours. */
fg_status fg_experiment_check_order(fg_context *ctx, fg_experiment *e) {
  checking c = {.e = e, .rows = e->regression.rows};
  const fg_regression *r = &e->regression;
  if (e->has_split_plot || !r->residual_dof || !(r->residual_ss > 1e-24 * r->total_ss))
    return FG_OK;
  if ((double)r->rows * (double)r->columns * (double)r->columns > WORK_OF_BASIS)
    return fg_experiment_note(
        ctx, e,
        "%zu runs and %zu coefficients: the residuals were not looked at over "
        "the order of the runs",
        r->rows, r->columns);
  fg_status status = check_residuals(ctx, &c, e);
  free(c.basis);
  free(c.residual);
  free(c.in_order);
  free(c.work);
  return status;
}
