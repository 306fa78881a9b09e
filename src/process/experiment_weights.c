/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Weights of runs by the uncertainty of their measurement. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "process/experiment_parts.h"

/* Each trial is a whole fit. */
enum { TRIALS = 50, RUNS_MAX = 5000 };

static fg_status median_u(fg_context *ctx, const fg_experiment *e, double *median) {
  double *copy = NULL;
  size_t rows = e->model.rows;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *copy, (void **)&copy));
  memcpy(copy, e->u, rows * sizeof *copy);
  *median = fg_select(copy, rows, rows / 2);
  free(copy);
  return FG_OK;
}

/* Fits with weights (s² + m²) / (s² + u²), so that a run with the middle uncertainty m weighs 1. */
static fg_status fit_with(fg_context *ctx, fg_experiment *e, const fg_extended *response,
                          double process_sd, double median, fg_regression *fit) {
  const fg_regression_options options = {.confidence = e->confidence,
                                         .weights = e->weight,
                                         .dof_taken = e->dof_taken,
                                         .taken = e->taken_out};
  double typical = process_sd * process_sd + median * median;
  for (size_t i = 0; i < e->model.rows; i++)
    e->weight[i] = typical / (process_sd * process_sd + e->u[i] * e->u[i]);
  return fg_regression_fit(ctx, &e->model, response, &options, fit);
}

/* Computes the ratio of the weighted residuals' variance to that by s and u: it falls as s grows.
 */
static fg_status excess(fg_context *ctx, fg_experiment *e, const fg_extended *response,
                        double process_sd, double median, double *ratio) {
  fg_regression fit = {0};
  FG_TRY(fit_with(ctx, e, response, process_sd, median, &fit));
  *ratio = fit.residual_sd * fit.residual_sd / (process_sd * process_sd + median * median);
  fg_regression_free(&fit);
  return FG_OK;
}

/* Mandel and Paule (1970), by bisection. */
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
  e->process_sd = high;
  return FG_OK;
}

fg_status fg_experiment_weigh(fg_context *ctx, fg_experiment *e, const fg_extended *response) {
  double median = 0, largest = 0;
  size_t rows = e->model.rows;
  fg_regression weighted = {0};
  e->process_sd = NAN;
  if (!e->u || !e->regression.residual_dof || rows > RUNS_MAX) return FG_OK;
  for (size_t i = 0; i < rows; i++)
    largest = fmax(largest, e->u[i]);
  FG_TRY(median_u(ctx, e, &median));
  if (!(median > 0) || largest < 2 * median || largest < 0.3 * e->regression.residual_sd)
    return FG_OK;
  if (e->whole_plot)
    return fg_experiment_note(ctx, e,
                              "the uncertainty of the responses differs between runs (up to %.3g, "
                              "in the middle %.3g), which the analysis of whole plots does not "
                              "weigh: measure the worst again, or leave them out",
                              largest, median);
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *e->weight, (void **)&e->weight));
  FG_TRY(find_process_sd(ctx, e, response, median));
  FG_TRY(fit_with(ctx, e, response, e->process_sd, median, &weighted));
  fg_regression_free(&e->regression);
  e->regression = weighted;
  return fg_experiment_note(ctx, e,
                            "the uncertainty of the responses differs between runs (up to %.3g, in "
                            "the middle %.3g): the runs are weighed by it",
                            largest, median);
}
