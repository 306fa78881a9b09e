/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From formula and table to the model matrix. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/extended.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/formula.h"

static fg_status copy_formula(fg_context *ctx, const fg_formula *from, fg_formula *to) {
  *to = (fg_formula){.constant = from->constant};
  if (from->response) FG_TRY(fg_text_print(ctx, &to->response, "%s", from->response));
  for (size_t i = 0; i < from->variables; i++) {
    fg_variable *added = &to->variable[to->variables++];
    added->transform = from->variable[i].transform;
    FG_TRY(fg_text_print(ctx, &added->column, "%s", from->variable[i].column));
    FG_TRY(fg_text_print(ctx, &added->name, "%s", from->variable[i].name));
  }
  FG_TRY(fg_memory_reserve(ctx, from->terms, sizeof *to->term, &to->capacity, (void **)&to->term));
  for (size_t i = 0; i < from->terms; i++)
    to->term[i] = from->term[i];
  to->terms = from->terms;
  return FG_OK;
}

static bool is_factor(const fg_model *model, size_t variable) {
  return model->levels[variable].count > 0;
}

static bool is_used(const fg_formula *formula, size_t variable) {
  for (size_t i = 0; i < formula->terms; i++)
    if (formula->term[i].power[variable]) return true;
  return false;
}

/* A column of words is a factor, and so is factor(name); all others must be numbers. */
static fg_status bind_variable(fg_context *ctx, const fg_table *table, size_t i, fg_model *model) {
  const fg_variable *variable = &model->formula.variable[i];
  const fg_column *column = NULL;
  const fg_extended *numbers = NULL;
  if (!is_used(&model->formula, i)) return FG_OK;
  FG_TRY(fg_table_find(ctx, table, variable->column, &column));
  bool forced = variable->transform == FG_TRANSFORM_FACTOR;
  bool words = column->number_count == 0 && column->word_count > 0;
  if (!forced && !(words && variable->transform == FG_TRANSFORM_NONE))
    return fg_table_numbers(ctx, table, variable->column, &numbers);
  FG_TRY(fg_table_levels(ctx, table, variable->column, forced, &model->levels[i]));
  if (model->levels[i].count >= 2) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: the factor '%s' has one level only ('%s'): it cannot have an effect; "
                 "leave it out of the model",
                 table->source ? table->source : "table", variable->name, model->levels[i].name[0]);
}

/* The square of a factor is the factor: terms may then coincide. */
static void collapse_factors(fg_model *model) {
  fg_formula *f = &model->formula;
  size_t kept = 0;
  for (size_t i = 0; i < f->terms; i++) {
    fg_term term = f->term[i];
    bool known = false;
    for (size_t v = 0; v < f->variables; v++)
      if (term.power[v] && is_factor(model, v)) term.power[v] = 1;
    for (size_t k = 0; k < kept && !known; k++)
      known = memcmp(&f->term[k], &term, sizeof term) == 0;
    if (!known) f->term[kept++] = term;
  }
  f->terms = kept;
}

/* R's rule (its TermCode): a factor in a term is coded by contrasts when the term without it is in
 * the model already, as the constant or as a part of an earlier term. */
static bool has_margin(const fg_model *model, size_t term, size_t variable) {
  const fg_formula *f = &model->formula;
  fg_term rest = f->term[term];
  bool empty = true;
  rest.power[variable] = 0;
  for (size_t v = 0; v < f->variables; v++)
    empty = empty && !rest.power[v];
  if (empty && f->constant) return true;
  for (size_t i = 0; i < term; i++) {
    bool contained = true;
    for (size_t v = 0; v < f->variables; v++)
      if (rest.power[v] && f->term[i].power[v] != rest.power[v]) contained = false;
    /* Without the constant, the first factor alone spans it; numbers do not. */
    if (contained && empty) {
      contained = false;
      for (size_t v = 0; v < f->variables; v++)
        if (f->term[i].power[v] && is_factor(model, v)) contained = true;
    }
    if (contained) return true;
  }
  return false;
}

fg_status fg_model_check_size(fg_context *ctx, const char *source, size_t rows, size_t columns,
                              const char *widest, size_t widest_columns) {
  const char *table = source ? source : "table";
  double cells = (double)rows * (double)columns, work = cells * (double)columns;
  if (columns > FG_MODEL_COLUMNS_MAX && widest_columns > 1)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: the model has %zu columns, %zu of them for the levels of %.200s; %zu are "
                   "the most, as the time grows with their cube. Does that column name the rows? "
                   "Leave it out, or join its levels to fewer",
                   table, columns, widest_columns, widest, FG_MODEL_COLUMNS_MAX);
  if (columns > FG_MODEL_COLUMNS_MAX)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: the model has %zu columns; %zu are the most, as the time grows with their "
                   "cube. Leave out terms of high order",
                   table, columns, FG_MODEL_COLUMNS_MAX);
  if (cells > (double)FG_MODEL_CELLS_MAX || work > FG_MODEL_WORK_MAX)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: %zu rows of %zu model columns are too many to compute with in reasonable "
                   "time and memory (rows × columns at most %zu, rows × columns² at most %g); use "
                   "fewer rows, or a model with fewer terms or levels",
                   table, rows, columns, FG_MODEL_CELLS_MAX, FG_MODEL_WORK_MAX);
  return FG_OK;
}

/* Returns the number of columns of a term, capped above all limits. */
static size_t count_term_columns(const fg_model *model, size_t term) {
  const fg_formula *f = &model->formula;
  size_t count = 1;
  for (size_t v = 0; v < f->variables; v++) {
    if (!f->term[term].power[v] || !is_factor(model, v)) continue;
    size_t levels = model->levels[v].count - (has_margin(model, term, v) ? 1 : 0);
    count = levels && count > SIZE_MAX / 4 / levels ? SIZE_MAX / 4 : count * levels;
  }
  return count;
}

/* Before any of it is built. */
static fg_status check_columns(fg_context *ctx, const fg_table *table, const fg_model *model) {
  size_t columns = model->formula.constant ? 1 : 0, widest = 0, max = 0;
  for (size_t i = 0; i < model->formula.terms; i++) {
    size_t count = count_term_columns(model, i);
    columns = columns > SIZE_MAX - count ? SIZE_MAX : columns + count;
    if (count <= max) continue;
    max = count;
    widest = i;
  }
  return fg_model_check_size(ctx, table->source, table->rows, columns,
                             max ? model->term_name[widest] : "the constant", max);
}

static fg_status name_column(fg_context *ctx, const fg_model *model, fg_model_column *column) {
  for (size_t i = 0; i < column->parts; i++) {
    const fg_part *part = &column->part[i];
    FG_TRY(fg_text_append(ctx, &column->name, "%s%s", i ? ":" : "",
                          model->formula.variable[part->variable].name));
    if (part->level != FG_PART_NUMBER)
      FG_TRY(fg_text_append(ctx, &column->name, "%s",
                            model->levels[part->variable].name[part->level]));
    else if (part->power > 1)
      FG_TRY(fg_text_append(ctx, &column->name, "^%u", part->power));
  }
  return column->parts ? FG_OK : fg_text_append(ctx, &column->name, "(constant)");
}

static fg_status add_column(fg_context *ctx, fg_model *model, size_t term, const fg_part *parts,
                            size_t count) {
  FG_TRY(fg_memory_reserve(ctx, model->columns + 1, sizeof *model->column, &model->column_capacity,
                           (void **)&model->column));
  fg_model_column *column = &model->column[model->columns++];
  *column = (fg_model_column){.term = term, .parts = count};
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *column->part, (void **)&column->part));
  for (size_t i = 0; i < count; i++)
    column->part[i] = parts[i];
  return name_column(ctx, model, column);
}

/* All combinations of the levels in the term; the first factor runs fastest, as in R. */
static fg_status add_term_columns(fg_context *ctx, fg_model *model, size_t term) {
  const fg_formula *f = &model->formula;
  fg_part part[FG_FORMULA_VARIABLES];
  size_t first[FG_FORMULA_VARIABLES] = {0}, count = 0;
  for (size_t v = 0; v < f->variables; v++) {
    if (!f->term[term].power[v]) continue;
    first[count] = is_factor(model, v) && has_margin(model, term, v) ? 1 : 0;
    part[count] = (fg_part){.variable = v,
                            .level = is_factor(model, v) ? first[count] : FG_PART_NUMBER,
                            .power = f->term[term].power[v]};
    count++;
  }
  for (;;) {
    size_t i = 0;
    FG_TRY(add_column(ctx, model, term, part, count));
    for (; i < count; i++) {
      if (part[i].level == FG_PART_NUMBER) continue;
      if (++part[i].level < model->levels[part[i].variable].count) break;
      part[i].level = first[i];
    }
    if (i == count) return FG_OK;
  }
}

static bool transform_number(fg_transform transform, fg_extended *a) {
  switch (transform) {
  case FG_TRANSFORM_LOG:
    *a = fg_extended_of(log(a->value));
    break;
  case FG_TRANSFORM_LOG10:
    *a = fg_extended_of(log10(a->value));
    break;
  case FG_TRANSFORM_EXP:
    *a = fg_extended_of(exp(a->value));
    break;
  case FG_TRANSFORM_SQRT:
    if (a->value < 0) return false;
    *a = fg_extended_sqrt(*a);
    break;
  case FG_TRANSFORM_INVERSE:
    *a = fg_extended_divide(fg_extended_of(1.0), *a);
    break;
  case FG_TRANSFORM_NONE:
  case FG_TRANSFORM_FACTOR:
    break;
  }
  return isfinite(a->value);
}

/* The variable's numbers, transformed. */
static fg_status transform_column(fg_context *ctx, const fg_table *table,
                                  const fg_variable *variable, fg_extended **values) {
  const fg_extended *numbers = NULL;
  FG_TRY(fg_table_numbers(ctx, table, variable->column, &numbers));
  FG_TRY(fg_memory_allocate(ctx, table->rows, sizeof **values, (void **)values));
  for (size_t i = 0; i < table->rows; i++) {
    (*values)[i] = numbers[i];
    if (!transform_number(variable->transform, &(*values)[i]))
      return fg_fail(ctx, FG_ERR_DATA, "%s: row %zu, column '%s': %s of %.15g is not a number",
                     table->source ? table->source : "table", i + 1, variable->column,
                     variable->name, numbers[i].value);
  }
  return FG_OK;
}

static void fill_column(const fg_model *model, fg_extended *const *values, size_t index) {
  const fg_model_column *column = &model->column[index];
  fg_extended *out = model->matrix + index * model->rows;
  for (size_t i = 0; i < model->rows; i++) {
    fg_extended product = fg_extended_of(1.0);
    for (size_t k = 0; k < column->parts; k++) {
      const fg_part *part = &column->part[k];
      if (part->level != FG_PART_NUMBER) {
        if (model->levels[part->variable].index[i] != part->level) product = fg_extended_of(0.0);
        continue;
      }
      product =
          fg_extended_multiply(product, fg_extended_power(values[part->variable][i], part->power));
    }
    out[i] = product;
  }
}

/* A product that is 0, or has lost digits, although none of its numbers is 0. */
static bool underflows(const fg_model *model, fg_extended *const *values, size_t index,
                       size_t row) {
  const fg_model_column *column = &model->column[index];
  double product = model->matrix[index * model->rows + row].value;
  if (isnormal(product)) return false;
  for (size_t k = 0; k < column->parts; k++) {
    const fg_part *part = &column->part[k];
    bool number = part->level == FG_PART_NUMBER;
    if (number ? values[part->variable][row].value == 0
               : model->levels[part->variable].index[row] != part->level)
      return false;
  }
  return true;
}

static fg_status fill_matrix(fg_context *ctx, const fg_table *table, fg_model *model) {
  fg_status status = FG_OK;
  fg_extended *values[FG_FORMULA_VARIABLES] = {NULL};
  model->rows = table->rows;
  if (model->columns && model->rows > ((size_t)-1) / model->columns)
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu rows of %zu columns", model->rows,
                   model->columns);
  FG_TRY_EXIT(fg_memory_allocate(ctx, model->rows * model->columns, sizeof *model->matrix,
                                 (void **)&model->matrix));
  for (size_t v = 0; v < model->formula.variables; v++)
    if (is_used(&model->formula, v) && !is_factor(model, v))
      FG_TRY_EXIT(transform_column(ctx, table, &model->formula.variable[v], &values[v]));
  for (size_t i = 0; i < model->columns; i++) {
    fill_column(model, values, i);
    for (size_t k = 0; k < model->rows; k++)
      if (!isfinite(model->matrix[i * model->rows + k].value))
        FG_TRY_EXIT(fg_fail(ctx, FG_ERR_DATA,
                            "%s: row %zu: the term %s overflows; code the factors",
                            table->source ? table->source : "table", k + 1, model->column[i].name));
      else if (underflows(model, values, i, k))
        FG_TRY_EXIT(fg_fail(ctx, FG_ERR_DATA,
                            "%s: row %zu: the term %s is too small to compute with; give its "
                            "columns in other units",
                            table->source ? table->source : "table", k + 1, model->column[i].name));
  }
exit:
  for (size_t v = 0; v < FG_FORMULA_VARIABLES; v++)
    free(values[v]);
  return status;
}

fg_status fg_model_build(fg_context *ctx, const fg_table *table, const fg_formula *formula,
                         fg_model *model) {
  fg_status status = FG_OK;
  *model = (fg_model){0};
  FG_TRY_EXIT(copy_formula(ctx, formula, &model->formula));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, formula->variables, sizeof *model->levels, (void **)&model->levels));
  for (size_t i = 0; i < formula->variables; i++)
    FG_TRY_EXIT(bind_variable(ctx, table, i, model));
  collapse_factors(model);
  if (!model->formula.constant && !model->formula.terms)
    FG_TRY_EXIT(fg_fail(ctx, FG_ERR_USAGE, "the model has no terms, not even the constant"));
  FG_TRY_EXIT(fg_memory_allocate(ctx, model->formula.terms, sizeof *model->term_name,
                                 (void **)&model->term_name));
  for (size_t i = 0; i < model->formula.terms; i++)
    FG_TRY_EXIT(
        fg_formula_term_name(ctx, &model->formula, &model->formula.term[i], &model->term_name[i]));
  FG_TRY_EXIT(check_columns(ctx, table, model));
  if (model->formula.constant) FG_TRY_EXIT(add_column(ctx, model, FG_MODEL_CONSTANT, NULL, 0));
  for (size_t i = 0; i < model->formula.terms; i++)
    FG_TRY_EXIT(add_term_columns(ctx, model, i));
  FG_TRY_EXIT(fill_matrix(ctx, table, model));
exit:
  if (status != FG_OK) fg_model_free(model);
  return status;
}

fg_status fg_model_row(fg_context *ctx, const fg_model *model, const double *setting, double *row) {
  for (size_t i = 0; i < model->columns; i++) {
    const fg_model_column *column = &model->column[i];
    fg_extended product = fg_extended_of(1.0);
    for (size_t k = 0; k < column->parts; k++) {
      const fg_part *part = &column->part[k];
      const fg_variable *variable = &model->formula.variable[part->variable];
      fg_extended value = fg_extended_of(setting[part->variable]);
      if (part->level != FG_PART_NUMBER)
        value = fg_extended_of((double)part->level == setting[part->variable] ? 1.0 : 0.0);
      else if (!transform_number(variable->transform, &value))
        return fg_fail(ctx, FG_ERR_DATA, "%s of %.15g is not a number", variable->name,
                       setting[part->variable]);
      product = fg_extended_multiply(product, fg_extended_power(value, part->power));
    }
    row[i] = product.value;
  }
  return FG_OK;
}

void fg_model_free(fg_model *model) {
  if (!model) return;
  for (size_t i = 0; model->levels && i < model->formula.variables; i++)
    fg_levels_free(&model->levels[i]);
  for (size_t i = 0; model->term_name && i < model->formula.terms; i++)
    free(model->term_name[i]);
  for (size_t i = 0; i < model->columns; i++) {
    free(model->column[i].name);
    free(model->column[i].part);
  }
  free(model->levels);
  free(model->term_name);
  free(model->column);
  free(model->matrix);
  fg_formula_free(&model->formula);
  *model = (fg_model){0};
}
