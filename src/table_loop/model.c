/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The declared model of a table: a formula, or the constant arc length of the springback model. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/formula.h"
#include "quantity/quantity_rows.h"
#include "table_loop/parts.h"

bool fg_loop_table_is_arc_length(const fg_loop_table_spec *spec) {
  return !strcmp(spec->model, "arc_length");
}

static fg_status copy_model(fg_context *ctx, const fg_loop_table_state *build,
                            const fg_model *model) {
  fg_loop_problem *problem = &build->out->problem;
  problem->parameters = model->columns;
  FG_TRY(fg_memory_allocate(ctx, model->columns, problem->rows * sizeof *problem->jacobian,
                            (void **)&problem->jacobian));
  FG_TRY(fg_memory_allocate(ctx, model->columns, sizeof *problem->parameter_name,
                            (void **)&problem->parameter_name));
  for (size_t k = 0; k < model->columns; k++) {
    FG_TRY(fg_text_print(ctx, &problem->parameter_name[k], "%s", model->column[k].name));
    for (size_t i = 0; i < problem->rows; i++)
      problem->jacobian[k * problem->rows + i] =
          model->matrix[k * model->rows + build->out->row[i]].value;
  }
  for (size_t v = 0; v < model->formula.variables; v++) {
    fg_loop_coordinate *at = fg_loop_table_coordinate(problem, model->formula.variable[v].column);
    if (at) at->roles |= FG_LOOP_DECLARED;
  }
  return FG_OK;
}

/* Data for evaluating the declared formula at a setting. */
struct fg_loop_formula {
  fg_model model;                    /* without its matrix */
  double mean[FG_FORMULA_VARIABLES]; /* of the variables that are no coordinates */
};

void fg_loop_table_free_formula(struct fg_loop_formula *formula) {
  if (!formula) return;
  fg_model_free(&formula->model);
  free(formula);
}

/* Returns the level whose name is nearest to a number; the first where names are words. */
static double nearest_level(const fg_levels *levels, double value) {
  size_t nearest = 0;
  double min = INFINITY;
  for (size_t k = 0; k < levels->count; k++) {
    char *end;
    double apart = fabs(strtod(levels->name[k], &end) - value);
    if (*end || !(apart < min)) continue;
    min = apart;
    nearest = k;
  }
  return (double)nearest;
}

static double setting_of(const struct fg_loop_formula *formula, const fg_loop_problem *grid,
                         size_t variable, size_t row) {
  const fg_levels *levels = &formula->model.levels[variable];
  const char *column = formula->model.formula.variable[variable].column;
  const fg_loop_coordinate *at = fg_loop_table_coordinate(grid, column);
  if (!at) return formula->mean[variable];
  if (levels->count && !at->levels) return nearest_level(levels, at->value[row]);
  return at->value[row];
}

static fg_status declared_at(fg_context *ctx, const void *model, const fg_loop_problem *grid,
                             double *columns) {
  const struct fg_loop_formula *formula = model;
  size_t count = formula->model.columns;
  double setting[FG_FORMULA_VARIABLES] = {0}, *row = NULL;
  fg_status status = fg_memory_allocate(ctx, count, sizeof *row, (void **)&row);
  for (size_t i = 0; status == FG_OK && i < grid->rows; i++) {
    for (size_t v = 0; v < formula->model.formula.variables; v++)
      setting[v] = setting_of(formula, grid, v, i);
    status = fg_model_row(ctx, &formula->model, setting, row);
    for (size_t k = 0; k < count; k++)
      columns[k * grid->rows + i] = row[k];
  }
  free(row);
  return status;
}

/* Moves the model, without its matrix, to the problem. */
static fg_status keep_model(fg_context *ctx, const fg_loop_table_state *build, fg_model *model) {
  fg_loop_problem *problem = &build->out->problem;
  struct fg_loop_formula *formula = NULL;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *formula, (void **)&formula));
  free(model->matrix);
  model->matrix = NULL;
  formula->model = *model;
  *model = (fg_model){0};
  build->out->model = formula;
  problem->declared = declared_at;
  problem->declared_model = formula;
  for (size_t v = 0; v < formula->model.formula.variables; v++) {
    fg_context ignored = {0};
    const fg_extended *number = NULL;
    const char *column = formula->model.formula.variable[v].column;
    if (fg_table_numbers(&ignored, build->table, column, &number) != FG_OK) continue;
    for (size_t i = 0; i < problem->rows; i++)
      formula->mean[v] += number[i].value / (double)problem->rows;
  }
  return FG_OK;
}

fg_status fg_loop_table_fill_model(fg_context *ctx, const fg_loop_table_state *build) {
  fg_status status = FG_OK;
  fg_formula formula = {0};
  fg_model model = {0};
  FG_TRY(fg_formula_parse(ctx, build->spec->model, &formula));
  FG_TRY_EXIT(fg_model_build(ctx, build->table, &formula, &model));
  for (size_t v = 0; v < formula.variables; v++)
    if (!strcmp(formula.variable[v].column, build->spec->response)) {
      status = fg_fail(ctx, FG_ERR_USAGE, "the model uses the response '%s' itself",
                       build->spec->response);
      goto exit;
    }
  FG_TRY_EXIT(copy_model(ctx, build, &model));
  FG_TRY_EXIT(keep_model(ctx, build, &model));
exit:
  fg_model_free(&model);
  fg_formula_free(&formula);
  return status;
}

/* The bump's quantities that constant arc length predicts, for a message. */
static void list_predicted(char *text, size_t size) {
  size_t count, last = 0;
  const fg_quantity *rows = fg_quantities(FG_QUANTITY_OF_BUMP, &count);
  for (size_t i = 0; i < count; i++)
    if (rows[i].by_arc_length) last = i;
  text[0] = '\0';
  for (size_t i = 0; i < count; i++) {
    size_t used = strlen(text);
    if (rows[i].by_arc_length)
      fg_text_clip(text + used, size - used, "%s%s",
                   !used       ? ""
                   : i == last ? " or "
                               : ", ",
                   rows[i].name);
  }
}

static fg_status find_response(fg_context *ctx, const char *response, const fg_quantity **row) {
  char predicted[200];
  *row = fg_quantity_find(FG_QUANTITY_OF_BUMP, response);
  if (*row && (*row)->by_arc_length) return FG_OK;
  list_predicted(predicted, sizeof predicted);
  return fg_fail(ctx, FG_ERR_USAGE, "model arc_length predicts %s from the bump radius, not '%s'",
                 predicted, response);
}

/* The prediction with an arc longer by the share `stretch`; nothing else of the design changes. */
static double predict_response(const fg_design *design, const fg_nominal *nominal, double radius_mm,
                               double stretch, const fg_quantity *response) {
  fg_design stretched = *design;
  fg_springback model;
  stretched.bumps.angle_deg *= 1 + stretch;
  fg_design_springback(&stretched, nominal, radius_mm, &model);
  return response->by_arc_length(design, &model);
}

static fg_status radius_column(fg_context *ctx, const fg_table *table, const fg_extended **radius) {
  fg_context ignored = {0};
  if (fg_table_numbers(&ignored, table, "bump_radius_mm", radius) == FG_OK) return FG_OK;
  if (fg_table_numbers(&ignored, table, "radius_mm", radius) == FG_OK) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: model arc_length needs the bump radius of every row in a column "
                 "bump_radius_mm or radius_mm",
                 table->source);
}

fg_status fg_loop_table_fill_arc_length(fg_context *ctx, const fg_loop_table_state *build) {
  fg_loop_problem *problem = &build->out->problem;
  const fg_design *design = build->spec->design;
  const fg_extended *radius;
  fg_nominal nominal;
  const fg_quantity *response = NULL;
  fg_loop_coordinate *constant, *slope;
  FG_TRY(find_response(ctx, build->spec->response, &response));
  FG_TRY(radius_column(ctx, build->table, &radius));
  FG_TRY(fg_design_derive(ctx, design, &nominal));
  FG_TRY(fg_loop_table_add_coordinate(ctx, build, "constant", FG_LOOP_SENSITIVITY, &constant));
  FG_TRY(fg_loop_table_add_coordinate(ctx, build, "with the radius", FG_LOOP_SENSITIVITY, &slope));
  constant = fg_loop_table_coordinate(problem, "constant");
  for (size_t i = 0; i < problem->rows; i++) {
    size_t row = build->out->row[i];
    double r = radius[row].value, small = 1e-4;
    if (!(r > 0))
      return fg_fail(ctx, FG_ERR_DATA, "%s: row %zu: the bump radius is %g mm; it must be above 0",
                     build->table->source, row + 1, r);
    problem->residual[i] -= predict_response(design, &nominal, r, 0, response);
    constant->value[i] = (predict_response(design, &nominal, r, small, response) -
                          predict_response(design, &nominal, r, -small, response)) /
                         (2 * small);
    slope->value[i] = constant->value[i] * (r / design->bumps.radius_mm - 1);
  }
  fg_loop_table_finish_coordinate(problem, constant);
  fg_loop_table_finish_coordinate(problem, slope);
  return FG_OK;
}
