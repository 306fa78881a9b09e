/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects without an error estimate, the power of the response, curvature. */
#include <math.h>
#include <stdlib.h>

#include "core/extended.h"
#include "core/memory.h"
#include "core/select.h"
#include "foilgauge/distribution.h"
#include "foilgauge/doe.h"
#include "stats/orthogonal.h"

static double median(const double *sorted, size_t count) {
  return count % 2 ? sorted[count / 2] : (sorted[count / 2 - 1] + sorted[count / 2]) / 2;
}

/* s0 = 1.5 median |c|; PSE = 1.5 median of those |c| below 2.5 s0. */
static double pseudo_standard_error(double *magnitude, size_t count) {
  fg_sort(magnitude, count);
  double first = 1.5 * median(magnitude, count);
  size_t kept = 0;
  while (kept < count && magnitude[kept] < 2.5 * first)
    kept++;
  return kept ? 1.5 * median(magnitude, kept) : 0;
}

fg_status fg_lenth_compute(fg_context *ctx, const double *estimates, size_t count,
                           double confidence, fg_lenth *lenth) {
  double *magnitude = NULL;
  *lenth = (fg_lenth){0};
  if (count < 3)
    return fg_fail(ctx, FG_ERR_DATA, "Lenth's method needs three effects, there are %zu", count);
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *magnitude, (void **)&magnitude));
  for (size_t i = 0; i < count; i++)
    magnitude[i] = fabs(estimates[i]);
  double pse = pseudo_standard_error(magnitude, count);
  free(magnitude);
  double dof = (double)count / 3;
  double together = (1 + pow(confidence, 1 / (double)count)) / 2;
  *lenth = (fg_lenth){.pseudo_standard_error = pse,
                      .margin = pse * fg_distribution_t_quantile((1 + confidence) / 2, dof),
                      .simultaneous_margin = pse * fg_distribution_t_quantile(together, dof),
                      .dof = dof};
  return FG_OK;
}

double fg_lenth_p_value(const fg_lenth *lenth, double estimate) {
  return fg_distribution_t_two_sided(estimate / lenth->pseudo_standard_error, lenth->dof);
}

static int compare_points(const void *a, const void *b) {
  const fg_half_normal *x = a, *y = b;
  if (x->magnitude != y->magnitude) return x->magnitude < y->magnitude ? -1 : 1;
  return (x->effect > y->effect) - (x->effect < y->effect);
}

fg_status fg_half_normal_points(fg_context *ctx, const double *estimates, size_t count,
                                fg_half_normal *points) {
  if (!count) return fg_fail(ctx, FG_ERR_USAGE, "no effects to plot");
  for (size_t i = 0; i < count; i++)
    points[i] = (fg_half_normal){.effect = i, .magnitude = fabs(estimates[i])};
  fg_sort_items(points, count, sizeof *points, compare_points);
  for (size_t i = 0; i < count; i++)
    points[i].quantile =
        fg_distribution_normal_quantile(0.5 + 0.5 * ((double)i + 0.5) / (double)count);
  return FG_OK;
}

/* The likelihood profile of lambda: one orthogonal basis serves all powers. */
typedef struct profile {
  const fg_orthogonal *basis;
  const double *log_response; /* centred: the geometric mean is 1, which preserves the unit */
  double *work;
} profile;

/* -n/2 ln RSS of (y^lambda - 1) / lambda with y scaled to geometric mean 1. */
static double log_likelihood(const profile *p, double lambda) {
  const fg_orthogonal *s = p->basis;
  double rss = 0;
  for (size_t i = 0; i < s->rows; i++)
    p->work[i] =
        fabs(lambda) < 1e-8 ? p->log_response[i] : expm1(lambda * p->log_response[i]) / lambda;
  for (size_t k = 0; k < s->rank; k++) {
    const fg_extended *q = s->q + s->kept[k] * s->rows;
    double shadow = 0;
    for (size_t i = 0; i < s->rows; i++)
      shadow += q[i].value * p->work[i];
    for (size_t i = 0; i < s->rows; i++)
      p->work[i] -= shadow * q[i].value;
  }
  for (size_t i = 0; i < s->rows; i++)
    rss += p->work[i] * p->work[i];
  return -0.5 * (double)s->rows * log(rss);
}

enum { GRID = 201 };
static const double SPAN = 5;

static double most_likely(const profile *p) {
  double best = 0, highest = -INFINITY, step = 2 * SPAN / (GRID - 1);
  for (int i = 0; i < GRID; i++) {
    double lambda = -SPAN + step * i, value = log_likelihood(p, lambda);
    if (value > highest) {
      highest = value;
      best = lambda;
    }
  }
  double low = best - step, high = best + step;
  for (int i = 0; i < 60; i++) { /* thirds: the interval shrinks by 1.5 each time */
    double a = low + (high - low) / 3, b = high - (high - low) / 3;
    if (log_likelihood(p, a) < log_likelihood(p, b))
      low = a;
    else
      high = b;
  }
  return (low + high) / 2;
}

/* Finds where the likelihood falls below `level` between lambda and `end`; `end` when it does not.
 */
static double crossing(const profile *p, double lambda, double end, double level) {
  double inside = lambda, outside = end;
  if (log_likelihood(p, end) >= level) return end;
  for (int i = 0; i < 60; i++) {
    double middle = (inside + outside) / 2;
    if (log_likelihood(p, middle) >= level)
      inside = middle;
    else
      outside = middle;
  }
  return inside;
}

static fg_status centred_logs(fg_context *ctx, const fg_extended *response, size_t rows,
                              double *logs) {
  double mean = 0;
  for (size_t i = 0; i < rows; i++) {
    if (!(response[i].value > 0))
      return fg_fail(ctx, FG_ERR_DATA,
                     "row %zu: the response %.15g is not positive; Box-Cox needs positive ones",
                     i + 1, response[i].value);
    logs[i] = log(response[i].value);
    mean += logs[i] / (double)rows;
  }
  for (size_t i = 0; i < rows; i++)
    logs[i] -= mean;
  return FG_OK;
}

fg_status fg_box_cox_compute(fg_context *ctx, const fg_model *model, const fg_extended *response,
                             fg_box_cox *box_cox) {
  fg_status status = FG_OK;
  double *logs = NULL, *work = NULL;
  fg_orthogonal basis = {0};
  const fg_least_squares problem = {.matrix = model->matrix,
                                    .response = response,
                                    .rows = model->rows,
                                    .columns = model->columns,
                                    .tolerance = 1e-13};
  FG_TRY_EXIT(fg_memory_allocate(ctx, model->rows, sizeof *logs, (void **)&logs));
  FG_TRY_EXIT(fg_memory_allocate(ctx, model->rows, sizeof *work, (void **)&work));
  FG_TRY_EXIT(centred_logs(ctx, response, model->rows, logs));
  FG_TRY_EXIT(fg_orthogonal_solve(ctx, &problem, &basis));
  if (basis.rank == basis.rows)
    FG_TRY_EXIT(fg_fail(ctx, FG_ERR_NUMERIC, "no residual freedom: the power cannot be judged"));
  const profile p = {&basis, logs, work};
  double lambda = most_likely(&p), highest = log_likelihood(&p, lambda);
  double level = highest - fg_distribution_chi2_quantile(0.95, 1) / 2;
  *box_cox = (fg_box_cox){.lambda = lambda,
                          .low = crossing(&p, lambda, -SPAN, level),
                          .high = crossing(&p, lambda, SPAN, level),
                          .log_likelihood = highest,
                          .log_likelihood_one = log_likelihood(&p, 1)};
exit:
  fg_orthogonal_free(&basis);
  free(logs);
  free(work);
  return status;
}

/* Kinds of runs: a corner has every factor at ±1, given by its bits. */
typedef enum run_kind { RUN_OTHER, RUN_CORNER, RUN_CENTRE } run_kind;

static run_kind classify(const fg_extended *const *x, size_t factors, size_t row, size_t *corner) {
  size_t zeros = 0, units = 0;
  *corner = 0;
  for (size_t k = 0; k < factors; k++) {
    double value = x[k][row].value;
    zeros += fabs(value) < 1e-9;
    units += fabs(fabs(value) - 1) < 1e-9;
    if (value > 0) *corner |= (size_t)1 << k;
  }
  if (zeros == factors) return RUN_CENTRE;
  return units == factors ? RUN_CORNER : RUN_OTHER;
}

typedef struct cell {
  size_t key; /* corner + 1, or 0 for the centre */
  double y;
} cell;

static int compare_cells(const void *a, const void *b) {
  const cell *x = a, *y = b;
  return (x->key > y->key) - (x->key < y->key);
}

/* Pooled over groups of equal key. */
static double squares_within_cells(cell *cells, size_t count, size_t *dof) {
  double sum = 0;
  fg_sort_items(cells, count, sizeof *cells, compare_cells);
  for (size_t start = 0, end = 0; start < count; start = end) {
    double mean = 0;
    for (end = start; end < count && cells[end].key == cells[start].key; end++)
      mean += cells[end].y;
    mean /= (double)(end - start);
    for (size_t i = start; i < end; i++)
      sum += (cells[i].y - mean) * (cells[i].y - mean);
    *dof += end - start - 1;
  }
  return sum;
}

static void judge_curvature(cell *cells, size_t count, fg_curvature *c) {
  for (size_t i = 0; i < count; i++) {
    if (cells[i].key)
      c->corner_mean += cells[i].y / (double)c->corners;
    else
      c->centre_mean += cells[i].y / (double)c->centres;
  }
  double corners = (double)c->corners, centres = (double)c->centres;
  double gap = c->corner_mean - c->centre_mean;
  c->sum_of_squares = corners * centres * gap * gap / (corners + centres);
  double within = squares_within_cells(cells, count, &c->error_dof);
  c->error_mean_square = c->error_dof ? within / (double)c->error_dof : NAN;
  c->f = c->sum_of_squares / c->error_mean_square;
  c->p_value = fg_distribution_f_upper(c->f, 1, (double)c->error_dof);
}

fg_status fg_curvature_compute(fg_context *ctx, const fg_table *table, const char *const *factors,
                               size_t factor_count, const char *response, fg_curvature *curvature) {
  fg_status status = FG_OK;
  const fg_extended *x[FG_FORMULA_VARIABLES], *y = NULL;
  cell *cells = NULL;
  size_t count = 0;
  *curvature = (fg_curvature){0};
  if (!factor_count || factor_count > FG_FORMULA_VARIABLES)
    return fg_fail(ctx, FG_ERR_USAGE, "%zu factors; 1 to 40 are possible", factor_count);
  for (size_t k = 0; k < factor_count; k++)
    FG_TRY_EXIT(fg_table_numbers(ctx, table, factors[k], &x[k]));
  FG_TRY_EXIT(fg_table_numbers(ctx, table, response, &y));
  FG_TRY_EXIT(fg_memory_allocate(ctx, table->rows, sizeof *cells, (void **)&cells));
  for (size_t i = 0; i < table->rows; i++) {
    size_t corner = 0;
    run_kind kind = classify(x, factor_count, i, &corner);
    curvature->others += kind == RUN_OTHER;
    if (kind == RUN_OTHER) continue;
    curvature->corners += kind == RUN_CORNER;
    curvature->centres += kind == RUN_CENTRE;
    cells[count++] = (cell){kind == RUN_CENTRE ? 0 : corner + 1, y[i].value};
  }
  if (!curvature->corners || !curvature->centres)
    FG_TRY_EXIT(fg_fail(ctx, FG_ERR_DATA,
                        "%zu corner runs and %zu centre runs: the curvature test needs both",
                        curvature->corners, curvature->centres));
  judge_curvature(cells, count, curvature);
exit:
  free(cells);
  return status;
}
