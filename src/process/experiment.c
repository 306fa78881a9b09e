/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a table of runs to a fitted model: sign, coding, blocks, formula. */
#include "foilgauge/experiment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "core/text.h"
#include "foilgauge/table_remarks.h"
#include "process/experiment_parts.h"

/* The lowest and highest number of a column. */
static void range_of(const fg_extended *numbers, size_t rows, double range[2]) {
  range[0] = range[1] = numbers[0].value;
  for (size_t i = 1; i < rows; i++) {
    range[0] = fmin(range[0], numbers[i].value);
    range[1] = fmax(range[1], numbers[i].value);
  }
}

static fg_status check_response(fg_context *ctx, const fg_table *runs, const char *response,
                                double range[2]) {
  const fg_extended *y = NULL;
  FG_TRY(fg_table_numbers(ctx, runs, response, &y));
  if (runs->rows < 2)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: one run only (row 1); an effect is a difference between runs: add runs",
                   runs->source ? runs->source : "the table");
  range_of(y, runs->rows, range);
  if (range[0] == range[1])
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: column '%s': all %zu values (rows 1 to %zu) are %.15g: there is nothing to "
                   "explain; is it the right column?",
                   runs->source ? runs->source : "the table", response, runs->rows, runs->rows,
                   range[0]);
  return FG_OK;
}

static fg_status apply_sign(fg_context *ctx, const fg_experiment_options *options,
                            fg_experiment *e) {
  double range[2] = {0, 0};
  FG_TRY(check_response(ctx, &e->table, e->response, range));
  bool one_sign = range[0] >= 0 || range[1] <= 0;
  bool springback = strstr(e->response, "springback_error") != NULL;
  e->sign_chosen = options->sign == FG_SIGN_AUTO;
  e->magnitude = options->sign == FG_SIGN_MAGNITUDE || (e->sign_chosen && springback && one_sign);
  if (e->sign_chosen && springback && !one_sign)
    FG_TRY(fg_experiment_note(ctx, e,
                              "%s has values of both signs, so it is modelled as it is and not as "
                              "a magnitude, which would fold it at zero",
                              e->response));
  if (e->magnitude && !one_sign)
    FG_TRY(fg_experiment_note(ctx, e,
                              "%s has values of both signs: its magnitude is folded at zero, which "
                              "no polynomial follows; --sign as-is models the values themselves",
                              e->response));
  if (!e->magnitude) return FG_OK;
  return fg_response_apply(ctx, FG_RESPONSE_MAGNITUDE, e->response, &e->table);
}

/* Writes the right side as requested, with the blocks in front. */
static fg_status write_formula(fg_context *ctx, const fg_experiment_options *options,
                               const fg_formula *parsed, fg_experiment *e) {
  char *right = NULL;
  const char *response = options->response ? options->response : parsed->response;
  if (!response)
    return fg_fail(
        ctx, FG_ERR_USAGE,
        "the formula names no response: say which column was measured by --response NAME");
  FG_TRY(fg_text_print(ctx, &e->response, "%s", response));
  FG_TRY(fg_formula_format(ctx, parsed, &right));
  fg_status status =
      options->block ? fg_text_print(ctx, &e->formula, "factor(`%s`) + %s", options->block, right)
                     : fg_text_print(ctx, &e->formula, "%s", right);
  free(right);
  return status;
}

static fg_status read_options(fg_context *ctx, const fg_experiment_options *options,
                              fg_experiment *e) {
  fg_formula parsed = {0};
  FG_TRY(fg_formula_parse(ctx, options->formula, &parsed));
  fg_status status = write_formula(ctx, options, &parsed, e);
  fg_formula_free(&parsed);
  FG_TRY(status);
  e->confidence = options->confidence > 0 ? options->confidence : FG_EXPERIMENT_CONFIDENCE;
  if (!(e->confidence < 1))
    return fg_fail(ctx, FG_ERR_USAGE, "the confidence %g is not between 0 and 1", e->confidence);
  if (options->block) FG_TRY(fg_text_print(ctx, &e->block, "%s", options->block));
  if (options->whole_plot) FG_TRY(fg_text_print(ctx, &e->whole_plot, "%s", options->whole_plot));
  return FG_OK;
}

/* A number enters the model as itself in every variable that names the column. */
static bool is_untransformed(const fg_formula *formula, const char *column) {
  for (size_t v = 0; v < formula->variables; v++)
    if (!strcmp(formula->variable[v].column, column) &&
        formula->variable[v].transform != FG_TRANSFORM_NONE)
      return false;
  return true;
}

static const fg_coding *given_coding(const fg_experiment_options *options, const char *name) {
  for (size_t i = 0; i < options->codings; i++)
    if (!strcmp(options->coding[i].name, name)) return &options->coding[i];
  return NULL;
}

static fg_status check_levels(fg_context *ctx, const fg_table *runs, const char *name) {
  const fg_extended *x = NULL;
  double range[2] = {0, 0};
  FG_TRY(fg_table_numbers(ctx, runs, name, &x));
  range_of(x, runs->rows, range);
  if (range[0] < range[1]) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: column '%s': the factor is %.15g in all %zu rows: its effect cannot be seen; "
                 "leave it out of the formula",
                 runs->source ? runs->source : "the table", name, range[0], runs->rows);
}

static fg_status add_factor(fg_context *ctx, const fg_experiment_options *options,
                            const fg_formula *formula, size_t variable, fg_experiment *e) {
  const char *name = formula->variable[variable].column;
  const fg_column *column = NULL;
  FG_TRY(fg_table_find(ctx, &e->table, name, &column));
  bool words = column->number_count == 0;
  if (words || formula->variable[variable].transform == FG_TRANSFORM_FACTOR) return FG_OK;
  for (size_t k = 0; k < e->factors; k++)
    if (!strcmp(e->factor[k].name, name)) return FG_OK;
  FG_TRY(check_levels(ctx, &e->table, name));
  fg_factor *factor = &e->factor[e->factors++];
  const fg_coding *given = given_coding(options, name);
  *factor = (fg_factor){.name = column->name, .variable = variable};
  factor->transformed = !is_untransformed(formula, name);
  if (factor->transformed && given)
    return fg_fail(ctx, FG_ERR_USAGE, "'%s' cannot be coded: the formula puts it in a function",
                   name);
  if (factor->transformed || (options->uncoded && !given)) return FG_OK;
  factor->coded = true;
  if (given)
    factor->coding = *given;
  else
    FG_TRY(fg_coding_from_data(ctx, &e->table, name, &factor->coding));
  return fg_coding_apply(ctx, &factor->coding, &e->table);
}

static fg_status code_factors(fg_context *ctx, const fg_experiment_options *options,
                              fg_experiment *e) {
  fg_formula formula = {0};
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_formula_parse(ctx, e->formula, &formula));
  for (size_t v = 0; v < formula.variables; v++) {
    if (!strcmp(formula.variable[v].column, e->response))
      FG_TRY_EXIT(fg_fail(ctx, FG_ERR_USAGE, "'%s' is the response and in the formula as well",
                          e->response));
    FG_TRY_EXIT(add_factor(ctx, options, &formula, v, e));
  }
  for (size_t i = 0; i < options->codings; i++) {
    bool used = false;
    for (size_t k = 0; k < e->factors; k++)
      used = used || !strcmp(e->factor[k].name, options->coding[i].name);
    if (!used)
      FG_TRY_EXIT(fg_fail(ctx, FG_ERR_USAGE,
                          "--code %s: the formula has no numeric factor of that name",
                          options->coding[i].name));
  }
exit:
  fg_formula_free(&formula);
  return status;
}

static fg_status build_model(fg_context *ctx, fg_experiment *e) {
  fg_formula formula = {0};
  FG_TRY(fg_formula_parse(ctx, e->formula, &formula));
  fg_status status = fg_model_build(ctx, &e->table, &formula, &e->model);
  fg_formula_free(&formula);
  FG_TRY(status);
  free(e->formula);
  e->formula = NULL;
  FG_TRY(fg_formula_format(ctx, &e->model.formula, &e->formula));
  e->block_variable = FG_FORMULA_VARIABLES;
  for (size_t v = 0; e->block && v < e->model.formula.variables; v++)
    if (!strcmp(e->model.formula.variable[v].column, e->block)) e->block_variable = v;
  return FG_OK;
}

/* Every run as fg_model_row wants it, and the ranges of the factors. */
static fg_status fill_settings(fg_context *ctx, fg_experiment *e) {
  size_t variables = e->model.formula.variables, rows = e->model.rows;
  if (rows && variables > (size_t)-1 / rows)
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu runs", rows);
  FG_TRY(fg_memory_allocate(ctx, rows * variables, sizeof *e->setting, (void **)&e->setting));
  for (size_t v = 0; v < variables; v++) {
    const fg_levels *levels = &e->model.levels[v];
    const fg_column *column = NULL;
    FG_TRY(fg_table_find(ctx, &e->table, e->model.formula.variable[v].column, &column));
    for (size_t i = 0; i < rows; i++)
      e->setting[i * variables + v] =
          levels->count ? (double)levels->index[i] : column->number[i].value;
  }
  for (size_t k = 0; k < e->factors; k++) {
    fg_factor *factor = &e->factor[k];
    double range[2];
    const fg_extended *x = NULL;
    for (size_t v = 0; v < variables; v++)
      if (!strcmp(e->model.formula.variable[v].column, factor->name)) factor->variable = v;
    FG_TRY(fg_table_numbers(ctx, &e->table, factor->name, &x));
    range_of(x, rows, range);
    factor->lowest = range[0];
    factor->highest = range[1];
  }
  return FG_OK;
}

static fg_status read_uncertainty(fg_context *ctx, const fg_experiment_options *options,
                                  fg_experiment *e) {
  const fg_extended *u = NULL;
  double squares = 0;
  e->measurement.u_rms = NAN;
  if (!options->uncertainty) return FG_OK;
  FG_TRY(fg_table_numbers(ctx, &e->table, options->uncertainty, &u));
  FG_TRY(
      fg_memory_allocate(ctx, e->table.rows, sizeof *e->measurement.u, (void **)&e->measurement.u));
  for (size_t i = 0; i < e->table.rows; i++) {
    if (u[i].value < 0)
      return fg_fail(ctx, FG_ERR_DATA, "row %zu, column '%s': an uncertainty of %.15g is negative",
                     i + 1, options->uncertainty, u[i].value);
    e->measurement.u[i] = u[i].value;
    squares += u[i].value * u[i].value;
  }
  e->measurement.u_rms = sqrt(squares / (double)e->table.rows);
  return FG_OK;
}

static fg_status fit_experiment(fg_context *ctx, fg_experiment *e) {
  const fg_regression_options options = {.confidence = e->confidence,
                                         .dof_subtracted = e->subtracted.dof,
                                         .subtracted = e->subtracted.sum};
  const fg_extended *y = NULL;
  FG_TRY(fg_table_numbers(ctx, &e->table, e->response, &y));
  FG_TRY(fg_regression_fit(ctx, &e->model, y, &options, &e->regression));
  FG_TRY(fg_experiment_weigh(ctx, e, y));
  for (size_t i = 0; i < e->regression.notes; i++)
    FG_TRY(fg_experiment_note(ctx, e, "%s", e->regression.note[i]));
  return FG_OK;
}

/* Notes columns of a plan that the analysis needs but was not given as options. */
static fg_status note_forgotten(fg_context *ctx, fg_experiment *e) {
  for (size_t i = 0; i < e->table.columns; i++) {
    const char *name = e->table.column[i].name;
    if (!strcmp(name, "whole_plot") && !e->whole_plot)
      FG_TRY(fg_experiment_note(ctx, e,
                                "the sheet has a column 'whole_plot', but the runs are analysed as "
                                "if all were in random order; --whole-plot whole_plot judges every "
                                "factor by its own error"));
    if (!strcmp(name, "block") && !e->block)
      FG_TRY(fg_experiment_note(ctx, e,
                                "the sheet has a column 'block', which the analysis leaves out; "
                                "--block block takes the differences between blocks out of the "
                                "error"));
  }
  return FG_OK;
}

static fg_status copy_subtracted(fg_context *ctx, const fg_experiment_options *options,
                                 fg_experiment *e) {
  size_t rows = e->table.rows;
  if (!options->subtracted_count) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, options->subtracted_count, sizeof *e->subtracted.effects,
                            (void **)&e->subtracted.effects));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *e->subtracted.sum, (void **)&e->subtracted.sum));
  memcpy(e->subtracted.effects, options->subtracted,
         options->subtracted_count * sizeof *e->subtracted.effects);
  memcpy(e->subtracted.sum, options->subtracted_sum, rows * sizeof *e->subtracted.sum);
  e->subtracted.count = options->subtracted_count;
  for (size_t i = 0; i < e->subtracted.count; i++)
    if (e->subtracted.effects[i].applied) e->subtracted.dof += e->subtracted.effects[i].parameters;
  return FG_OK;
}

fg_status fg_experiment_fit(fg_context *ctx, const fg_table *runs,
                            const fg_experiment_options *options, fg_experiment *e) {
  FG_TRY(read_options(ctx, options, e));
  FG_TRY(fg_table_copy(ctx, runs, &e->table));
  FG_TRY(copy_subtracted(ctx, options, e));
  FG_TRY(apply_sign(ctx, options, e));
  FG_TRY(code_factors(ctx, options, e));
  FG_TRY(build_model(ctx, e));
  FG_TRY(fill_settings(ctx, e));
  FG_TRY(read_uncertainty(ctx, options, e));
  FG_TRY(fit_experiment(ctx, e));
  FG_TRY(note_forgotten(ctx, e));
  FG_TRY(fg_experiment_effects(ctx, e));
  return fg_experiment_check_order(ctx, e);
}

static fg_status note_remarks(fg_context *ctx, const fg_table *runs,
                              const fg_experiment_options *options, fg_experiment *e) {
  char *said = NULL;
  fg_status status = FG_OK;
  if (options->reading) status = fg_experiment_note(ctx, e, "%s", options->reading);
  if (status == FG_OK) status = fg_table_remark(ctx, runs, e->response, &said);
  if (status == FG_OK && said) status = fg_experiment_note(ctx, e, "%s", said);
  free(said);
  return status;
}

static fg_status analyse(fg_context *ctx, const fg_table *runs,
                         const fg_experiment_options *options, fg_experiment *e) {
  FG_TRY(fg_experiment_fit(ctx, runs, options, e));
  FG_TRY(note_remarks(ctx, runs, options, e));
  FG_TRY(fg_experiment_surface(ctx, options, NULL, e));
  FG_TRY(fg_experiment_reduce(ctx, runs, options, e));
  FG_TRY(fg_experiment_optimise(ctx, options, NULL, e));
  return fg_experiment_ask(ctx, options, e);
}

fg_status fg_experiment_analyse(fg_context *ctx, const fg_table *runs,
                                const fg_experiment_options *options, fg_experiment *experiment) {
  fg_numerics_start();
  *experiment = (fg_experiment){0};
  fg_status status = analyse(ctx, runs, options, experiment);
  if (status != FG_OK) fg_experiment_free(experiment);
  return status;
}
