/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/regression.h"

#include <math.h>
#include <stdlib.h>

#include "core/extended.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/distribution.h"
#include "stats/regression_parts.h"

/* Rounding in 106 bits leaves some 1e-62 of the sum of squares; data typed with 20 digits that
 * differ in the last one leave 1e-40. */
static double clean_ss(double ss, double scale) {
  return ss <= 1e-50 * scale ? 0 : ss;
}

/* With z = Q'y, |y|² = sum z² + |residual|². The constant, where there is one, is column 0. */
static void sum_squares(const fg_fit *fit, fg_regression *reg) {
  const fg_orthogonal *s = &fit->solution;
  fg_extended model = {0, 0}, all = {0, 0};
  fg_extended residual = fg_extended_dot(s->residual, s->residual, s->rows);
  for (size_t k = 0; k < s->rank; k++) {
    fg_extended square = fg_extended_square(s->z[s->kept[k]]);
    all = fg_extended_add(all, square);
    if (!(reg->constant && s->kept[k] == 0)) model = fg_extended_add(model, square);
  }
  double scale = fg_extended_add(all, residual).value;
  reg->residual_ss = reg->residual_dof ? clean_ss(residual.value, scale) : 0;
  reg->model_ss = clean_ss(model.value, scale);
  reg->total_ss = reg->residual_ss == 0 || reg->model_ss == 0
                      ? reg->residual_ss + reg->model_ss
                      : fg_extended_add(model, residual).value;
  /* 1 - residual / total would lose the digits of an R² near zero; the quotient loses none. */
  reg->r2 = reg->total_ss > 0 ? reg->model_ss / reg->total_ss : NAN;
}

static void summarise_fit(fg_regression *reg) {
  size_t model_dof = reg->rank - (reg->constant ? 1 : 0);
  double dof = (double)reg->residual_dof;
  double mean_square = reg->residual_dof ? reg->residual_ss / dof : NAN;
  reg->residual_sd = sqrt(mean_square);
  double total_dof = (double)(reg->rows - (reg->constant ? 1 : 0));
  reg->adjusted_r2 = 1 - (1 - reg->r2) * total_dof / dof;
  if (!reg->residual_dof) reg->adjusted_r2 = NAN;
  reg->model_f = model_dof ? reg->model_ss / (double)model_dof / mean_square : NAN;
  reg->model_p_value = fg_distribution_f_upper(reg->model_f, (double)model_dof, dof);
}

static fg_status note_limits(fg_context *ctx, fg_regression *reg) {
  if (!reg->residual_dof)
    FG_TRY(fg_regression_note(
        ctx, reg,
        "%zu runs and %zu coefficients: no residual freedom, so no standard errors, t or p; repeat "
        "runs, drop terms, or judge the effects by Lenth's method and the half-normal plot",
        reg->rows, reg->rank));
  if (reg->total_ss == 0)
    FG_TRY(fg_regression_note(ctx, reg,
                              "all responses are equal: there is nothing to explain and R² has no "
                              "meaning; check the response column"));
  else if (reg->residual_dof && reg->residual_ss == 0)
    FG_TRY(fg_regression_note(ctx, reg,
                              "the model reproduces the response exactly: the errors are zero and "
                              "the tests have no meaning"));
  return FG_OK;
}

/* Sums of squares, and the rounding of their 106 bits, must be numbers. */
static fg_status check_size(fg_context *ctx, const char *what, const char *name,
                            const fg_extended *number, size_t count) {
  static const double smallest = 1e-130, greatest = 1e150;
  double largest = 0;
  for (size_t i = 0; i < count; i++)
    largest = fmax(largest, fabs(number[i].value));
  if (largest == 0 || (largest >= smallest && largest <= greatest)) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s%s: its numbers reach %g, and their squares are too %s to compute with; give "
                 "it in another unit",
                 what, name, largest, largest > 1 ? "large" : "small");
}

static fg_status check_input(fg_context *ctx, const fg_model *model, const fg_extended *response,
                             const double *weights) {
  if (!model->rows) return fg_fail(ctx, FG_ERR_DATA, "no runs to fit: the table has no rows");
  if (!model->columns) return fg_fail(ctx, FG_ERR_USAGE, "the model has no columns");
  for (size_t i = 0; i < model->rows; i++) {
    if (!isfinite(response[i].value))
      return fg_fail(ctx, FG_ERR_DATA, "row %zu: the response is not a finite number", i + 1);
    if (weights && !(weights[i] > 0 && isfinite(weights[i])))
      return fg_fail(ctx, FG_ERR_USAGE, "row %zu: the weight is not positive", i + 1);
  }
  for (size_t k = 0; k < model->columns; k++)
    FG_TRY(check_size(ctx, "the model's column ", model->column[k].name,
                      model->matrix + k * model->rows, model->rows));
  return check_size(ctx, "the response", "", response, model->rows);
}

static fg_status solve_least_squares(fg_context *ctx, fg_fit *fit, double tolerance) {
  fg_extended *scale = NULL;
  size_t rows = fit->model->rows;
  if (fit->weights) {
    FG_TRY(fg_memory_allocate(ctx, rows, sizeof *scale, (void **)&scale));
    for (size_t i = 0; i < rows; i++)
      scale[i] = fg_extended_sqrt(fg_extended_of(fit->weights[i]));
  }
  const fg_least_squares problem = {.matrix = fit->model->matrix,
                                    .response = fit->response,
                                    .scale = scale,
                                    .rows = rows,
                                    .columns = fit->model->columns,
                                    .tolerance = tolerance > 0 ? tolerance : 1e-13};
  fg_status status = fg_orthogonal_solve(ctx, &problem, &fit->solution);
  free(scale);
  return status;
}

static fg_status subtract_dof(fg_context *ctx, const fg_regression_options *options,
                              fg_regression *regression) {
  size_t dof = regression->rows - regression->rank, subtracted = options->dof_subtracted;
  if (subtracted && dof && subtracted >= dof)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%zu runs, %zu coefficients and %zu parameters of what was taken out before: no "
                   "freedom is left to judge anything by; leave terms out, or add runs",
                   regression->rows, regression->rank, subtracted);
  regression->residual_dof = dof ? dof - subtracted : 0;
  return FG_OK;
}

fg_status fg_regression_fit(fg_context *ctx, const fg_model *model, const fg_extended *response,
                            const fg_regression_options *options, fg_regression *regression) {
  const fg_regression_options defaults = {0};
  fg_status status = FG_OK;
  if (!options) options = &defaults;
  fg_fit fit = {.model = model, .response = response, .weights = options->weights};
  *regression = (fg_regression){.rows = model->rows,
                                .columns = model->columns,
                                .constant = model->formula.constant,
                                .confidence = options->confidence > 0 ? options->confidence : 0.95};
  FG_TRY_EXIT(check_input(ctx, model, response, options->weights));
  FG_TRY_EXIT(solve_least_squares(ctx, &fit, options->alias_tolerance));
  regression->rank = fit.solution.rank;
  FG_TRY_EXIT(subtract_dof(ctx, options, regression));
  sum_squares(&fit, regression);
  summarise_fit(regression);
  FG_TRY_EXIT(note_limits(ctx, regression));
  FG_TRY_EXIT(fg_regression_coefficients(ctx, &fit, regression));
  FG_TRY_EXIT(fg_regression_aliases(ctx, &fit, regression));
  FG_TRY_EXIT(fg_regression_empty_cells(ctx, model, regression));
  FG_TRY_EXIT(fg_regression_condition(ctx, &fit, regression));
  FG_TRY_EXIT(fg_regression_anova(ctx, &fit, regression));
  FG_TRY_EXIT(fg_regression_lack_of_fit(ctx, &fit, options, regression));
  FG_TRY_EXIT(fg_regression_diagnostics(ctx, &fit, regression));
exit:
  fg_orthogonal_free(&fit.solution);
  if (status != FG_OK) fg_regression_free(regression);
  return status;
}

fg_status fg_regression_analyse(fg_context *ctx, const fg_table *table, const char *formula,
                                const char *response, const fg_regression_options *options,
                                fg_model *model, fg_regression *regression) {
  fg_status status = FG_OK;
  fg_formula parsed;
  const fg_extended *numbers = NULL;
  *model = (fg_model){0};
  *regression = (fg_regression){0};
  FG_TRY(fg_formula_parse(ctx, formula, &parsed));
  if (!response) response = parsed.response;
  if (!response)
    FG_TRY_EXIT(fg_fail(ctx, FG_ERR_USAGE, "formula '%s': no response is named", formula));
  FG_TRY_EXIT(fg_table_numbers(ctx, table, response, &numbers));
  FG_TRY_EXIT(fg_model_build(ctx, table, &parsed, model));
  FG_TRY_EXIT(fg_regression_fit(ctx, model, numbers, options, regression));
exit:
  fg_formula_free(&parsed);
  if (status != FG_OK) fg_model_free(model);
  return status;
}
