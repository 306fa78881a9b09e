/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Weights of runs by the uncertainty of their measurement. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "core/select.h"
#include "process/experiment_parts.h"

/* Each trial is a whole fit. */
enum { TRIALS = 50, RUNS_MAX = 5000 };

static fg_status sort_u(fg_context *ctx, const fg_experiment *e, double *smallest, double *quartile,
                        double *median) {
  double *copy = NULL;
  size_t rows = e->model.rows;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *copy, (void **)&copy));
  memcpy(copy, e->measurement.u, rows * sizeof *copy);
  fg_sort(copy, rows);
  *smallest = copy[0];
  *quartile = copy[rows / 4];
  *median = copy[rows / 2];
  free(copy);
  return FG_OK;
}

/* Fits with weights (s² + m²) / (s² + u²), so that a run with the middle uncertainty m weighs 1. */
static fg_status fit_with(fg_context *ctx, fg_experiment *e, const fg_extended *response,
                          double process_sd, double median, fg_regression *fit) {
  const fg_regression_options options = {.confidence = e->confidence,
                                         .weights = e->measurement.weight,
                                         .dof_subtracted = e->subtracted.dof,
                                         .subtracted = e->subtracted.sum};
  double typical = process_sd * process_sd + median * median;
  for (size_t i = 0; i < e->model.rows; i++)
    e->measurement.weight[i] =
        typical / (process_sd * process_sd + e->measurement.u[i] * e->measurement.u[i]);
  return fg_regression_fit(ctx, &e->model, response, &options, fit);
}

/* Computes |P y|² / trace P, P = W - W X (X'WX)^-1 X' W: above 1 where s is too small. Restricted
 * likelihood has its maximum where it is 1. Precise runs dominate it, while the weighted sum of
 * squares (Mandel and Paule 1970) takes the luck of poor runs for the scatter of the process. */
static fg_status excess(fg_context *ctx, fg_experiment *e, const fg_extended *response,
                        double process_sd, double median, double *ratio) {
  fg_regression fit = {0};
  double square = 0, trace = 0;
  FG_TRY(fit_with(ctx, e, response, process_sd, median, &fit));
  for (size_t i = 0; i < fit.rows; i++) {
    square += pow(e->measurement.weight[i] * fit.residual[i], 2);
    trace += e->measurement.weight[i] * (1 - fit.leverage[i]);
  }
  *ratio = square / (trace * (process_sd * process_sd + median * median));
  fg_regression_free(&fit);
  return FG_OK;
}

/* By bisection. */
static fg_status find_process_sd(fg_context *ctx, fg_experiment *e, const fg_extended *response,
                                 double median) {
  double low = 1e-6 * median, high = e->regression.residual_sd + median, ratio;
  for (int i = 0; i < TRIALS; i++) {
    double middle = sqrt(low * high);
    FG_TRY(excess(ctx, e, response, middle, median, &ratio));
    if (ratio > 1)
      low = middle;
    else
      high = middle;
  }
  e->measurement.process_sd = high;
  return FG_OK;
}

/* Row i of the weighted model in the coordinates of U: w_i x_i' U, with (X'WX)^-1 = U U'. */
static void weighted_row(const fg_experiment *e, size_t i, double *row) {
  const fg_regression *reg = &e->regression;
  memset(row, 0, reg->columns * sizeof *row);
  for (size_t j = 0; j < reg->columns; j++)
    for (size_t k = 0; k < reg->columns && !reg->coefficient[j].aliased; k++)
      row[k] += e->measurement.weight[i] * e->model.matrix[j * reg->rows + i].value *
                reg->inverse_root[j * reg->columns + k].value;
}

/* Satterthwaite's (1946) dof: the process's variance s² enters the variance V = c' c of an
 * estimate, c = U' row, by dV/ds² = c' G c with G = U' X' W² X U, and is known with the variance 2
 * / trace(P P), P = W - W X U U' X' W. Where few runs are precise, they alone tell s: their number
 * counts, not that of all runs. With equal weights this is the residual dof. */
static fg_status find_weighted_dof(fg_context *ctx, fg_experiment *e) {
  size_t n = e->regression.columns;
  double *row = NULL;
  FG_TRY(fg_memory_allocate(ctx, n * n, sizeof *e->measurement.weight_gram,
                            (void **)&e->measurement.weight_gram));
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *row, (void **)&row));
  e->measurement.weight_trace = 0;
  for (size_t i = 0; i < e->regression.rows; i++) {
    weighted_row(e, i, row);
    double square = e->measurement.weight[i] * e->measurement.weight[i];
    e->measurement.weight_trace += square - 2 * e->measurement.weight[i] * fg_dot(row, row, n);
    for (size_t j = 0; j < n; j++)
      for (size_t k = 0; k < n; k++)
        e->measurement.weight_gram[j * n + k] += row[j] * row[k];
  }
  e->measurement.weight_trace +=
      fg_dot(e->measurement.weight_gram, e->measurement.weight_gram, n * n);
  free(row);
  return FG_OK;
}

double fg_experiment_weighted_dof(const fg_experiment *e, const double *row) {
  const fg_regression *reg = &e->regression;
  size_t n = reg->columns;
  double c[FG_MODEL_COLUMNS_MAX] = {0}, slope = 0, dof = (double)reg->residual_dof;
  for (size_t j = 0; j < n; j++)
    for (size_t k = 0; k < n && row[j] != 0 && !reg->coefficient[j].aliased; k++)
      c[k] += reg->inverse_root[j * n + k].value * row[j];
  for (size_t j = 0; j < n; j++)
    slope += c[j] * fg_dot(e->measurement.weight_gram + j * n, c, n);
  double variance = fg_dot(c, c, n);
  if (!(slope > 0)) return dof;
  return fmax(fmin(variance * variance * e->measurement.weight_trace / (slope * slope), dof), 1);
}

fg_status fg_experiment_weigh(fg_context *ctx, fg_experiment *e, const fg_extended *response) {
  double smallest = 0, quartile = 0, median = 0, largest = 0;
  size_t rows = e->model.rows;
  fg_regression weighted = {0};
  e->measurement.process_sd = NAN;
  if (!e->measurement.u || !e->regression.residual_dof || rows > RUNS_MAX) return FG_OK;
  for (size_t i = 0; i < rows; i++)
    largest = fmax(largest, e->measurement.u[i]);
  FG_TRY(sort_u(ctx, e, &smallest, &quartile, &median));
  if (!(median > 0) || largest < 2 * quartile || largest < 0.3 * e->regression.residual_sd)
    return FG_OK;
  if (e->whole_plot)
    return fg_experiment_note(ctx, e,
                              "the uncertainty of the responses differs between runs (from %.3g "
                              "to %.3g), which the analysis of whole plots does not "
                              "weigh: measure the worst again, or leave them out",
                              smallest, largest);
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *e->measurement.weight,
                            (void **)&e->measurement.weight));
  FG_TRY(find_process_sd(ctx, e, response, median));
  FG_TRY(fit_with(ctx, e, response, e->measurement.process_sd, median, &weighted));
  fg_regression_free(&e->regression);
  e->regression = weighted;
  FG_TRY(find_weighted_dof(ctx, e));
  return fg_experiment_note(ctx, e,
                            "the uncertainty of the responses differs between runs (from %.3g to "
                            "%.3g): the runs are weighed by it",
                            smallest, largest);
}
