/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Building a problem from a table: rows in order, groups, model, coordinates, held-out rows. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/extended.h"
#include "core/memory.h"
#include "core/select.h"
#include "core/text.h"
#include "foilgauge/table_times.h"
#include "table_loop/engine.h"
#include "table_loop/places.h"

static const char *const order_names[] = {"run", "order", "run_order", "experiment", "sequence"};
static const char *const bump_names[] = {"bump", "bump_number", "bump_index"};

static const char *first_column(const fg_table *table, const char *const *names, size_t count) {
  fg_context ignored = {0};
  const fg_column *column;
  for (size_t i = 0; i < count; i++)
    if (fg_table_find(&ignored, table, names[i], &column) == FG_OK && !column->word_count &&
        !column->missing_count)
      return names[i];
  return NULL;
}

fg_status fg_loop_table_count_times(fg_context *ctx, fg_table *table, fg_loop_table_spec *spec,
                                    char **said) {
  const char *times;
  FG_TRY(fg_table_count_times(ctx, table, spec->order, &times, said));
  if (!spec->order && !spec->group && !first_column(table, order_names, 5)) spec->order = times;
  return FG_OK;
}

static fg_status choose_order(fg_context *ctx, fg_loop_table_state *build) {
  const fg_extended *ignored;
  build->order = build->spec->order;
  if (build->order) return fg_table_numbers(ctx, build->table, build->order, &ignored);
  build->order = build->spec->group ? first_column(build->table, bump_names, 3)
                                    : first_column(build->table, order_names, 5);
  return FG_OK;
}

typedef struct row_key {
  size_t group, row;
  double order;
} row_key;

static int by_key(const void *a, const void *b) {
  const row_key *x = a, *y = b;
  if (x->group != y->group) return x->group < y->group ? -1 : 1;
  if (x->order != y->order) return x->order < y->order ? -1 : 1;
  return (x->row > y->row) - (x->row < y->row);
}

/* Groups are numbered in order of appearance; numbers as names in their own order. */
static fg_status group_keys(fg_context *ctx, const fg_loop_table_state *build, row_key *key) {
  size_t rows = build->table->rows;
  fg_levels levels = {0};
  const fg_column *column;
  if (!build->spec->group) return FG_OK;
  FG_TRY(fg_table_find(ctx, build->table, build->spec->group, &column));
  FG_TRY(fg_table_levels(ctx, build->table, build->spec->group, true, &levels));
  size_t *number = NULL, next = 0;
  fg_status status = fg_memory_allocate(ctx, levels.count, sizeof *number, (void **)&number);
  for (size_t i = 0; status == FG_OK && i < rows; i++) {
    size_t level = levels.index[i];
    if (column->word_count && !number[level]) number[level] = ++next;
    key[i].group = column->word_count ? number[level] - 1 : level;
  }
  free(number);
  fg_levels_free(&levels);
  return status;
}

static fg_status sort_rows(fg_context *ctx, const fg_loop_table_state *build) {
  fg_loop_table_problem *out = build->out;
  size_t rows = build->table->rows;
  const fg_extended *order = NULL;
  row_key *key = NULL;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *key, (void **)&key));
  fg_status status = FG_OK;
  if (build->order) FG_TRY_EXIT(fg_table_numbers(ctx, build->table, build->order, &order));
  FG_TRY_EXIT(group_keys(ctx, build, key));
  for (size_t i = 0; i < rows; i++) {
    key[i].row = i;
    key[i].order = order ? order[i].value : (double)i;
  }
  fg_sort_items(key, rows, sizeof *key, by_key);
  for (size_t i = 0; i < rows; i++) {
    out->row[i] = key[i].row;
    out->problem.group[i] = build->spec->group ? key[i].group : i;
    out->problem.series[i] = key[i].group;
  }
  out->problem.groups = out->problem.group[rows - 1] + 1;
exit:
  free(key);
  return status;
}

static fg_status allocate_rows(fg_context *ctx, size_t rows, fg_loop_table_problem *out) {
  fg_loop_problem *problem = &out->problem;
  problem->rows = rows;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *out->row, (void **)&out->row));
  problem->table_row = out->row;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *problem->group, (void **)&problem->group));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *problem->series, (void **)&problem->series));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *problem->held_out, (void **)&problem->held_out));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *problem->residual, (void **)&problem->residual));
  return fg_memory_allocate(ctx, rows, sizeof *problem->response, (void **)&problem->response);
}

static fg_status fill_response(fg_context *ctx, const fg_loop_table_state *build) {
  fg_loop_problem *problem = &build->out->problem;
  const fg_extended *response;
  FG_TRY(fg_table_numbers(ctx, build->table, build->spec->response, &response));
  for (size_t i = 0; i < problem->rows; i++)
    problem->response[i] = problem->residual[i] = response[build->out->row[i]].value;
  double largest = 0;
  for (size_t i = 0; i < problem->rows; i++)
    largest = fmax(largest, fabs(problem->response[i]));
  if (largest == 0 || (largest >= FG_LOOP_TABLE_SMALLEST && largest <= FG_LOOP_TABLE_LARGEST))
    return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: the numbers of '%s' reach %g: too %s to compute with; give the response in "
                 "another unit",
                 build->table->source, build->spec->response, largest,
                 largest > 1 ? "large" : "small");
}

/* Subtracts the first response as origin, with all digits of the table, where the declared model
 * has a constant, which absorbs it. */
static fg_status subtract_origin(fg_context *ctx, const fg_loop_table_state *build) {
  fg_loop_problem *problem = &build->out->problem;
  const fg_extended *response;
  size_t k = 0, rows = problem->rows;
  for (; k < problem->parameters; k++) {
    size_t i = 0;
    while (i < rows && problem->jacobian[k * rows + i] == 1)
      i++;
    if (i == rows) break;
  }
  if (k == problem->parameters) return FG_OK;
  FG_TRY(fg_table_numbers(ctx, build->table, build->spec->response, &response));
  fg_extended first = response[build->out->row[0]];
  for (size_t i = 0; i < rows; i++)
    problem->residual[i] =
        fg_extended_add(response[build->out->row[i]], fg_extended_negate(first)).value;
  problem->origin = first.value;
  problem->constant = k;
  return FG_OK;
}

/* Subtracts the offset column from the residual. The response stays as measured: exchanged
 * responses are exchanged with it. */
static fg_status subtract_offset(fg_context *ctx, const fg_loop_table_state *build) {
  fg_loop_problem *problem = &build->out->problem;
  const char *name = build->spec->offset;
  const fg_extended *offset;
  if (!name) return FG_OK;
  if (!strcmp(name, build->spec->response))
    return fg_fail(ctx, FG_ERR_USAGE, "the response '%s' cannot be its own prediction", name);
  FG_TRY(fg_table_numbers(ctx, build->table, name, &offset));
  for (size_t i = 0; i < problem->rows; i++)
    problem->residual[i] -= offset[build->out->row[i]].value;
  return FG_OK;
}

/* Adds the declared model's prediction of the response as a coordinate, unless a column has the
 * same content: the scatter may follow it. */
static fg_status add_level(fg_context *ctx, const fg_loop_table_state *build) {
  fg_loop_problem *problem = &build->out->problem;
  fg_engine_training training;
  fg_engine_fit fit = {0};
  fg_loop_coordinate *at = NULL;
  char name[FG_LOOP_NAME];
  if (problem->parameters < 3)
    return FG_OK; /* a constant and one column: the column is that coordinate */
  fg_text_clip(name, sizeof name, "the level of %s", build->spec->response);
  FG_TRY(fg_loop_table_add_coordinate(ctx, build, name, FG_LOOP_LEVEL, &at));
  FG_TRY(fg_engine_training_build(ctx, problem, NULL, NULL, &training));
  fg_status status = fg_engine_least_squares(ctx, &training, (fg_engine_noise){0}, &fit);
  for (size_t i = 0; status == FG_OK && i < problem->rows; i++)
    for (size_t k = 0; k < problem->parameters; k++)
      at->value[i] += fit.beta[k] * problem->jacobian[k * problem->rows + i];
  fg_engine_fit_free(&fit);
  fg_engine_training_free(&training);
  fg_loop_table_finish_coordinate(problem, at);
  return status;
}

static fg_status build_all(fg_context *ctx, fg_loop_table_state *build) {
  fg_loop_problem *problem = &build->out->problem;
  size_t rows = build->table->rows;
  if (rows == 0) return fg_fail(ctx, FG_ERR_DATA, "%s: no rows", build->table->source);
  FG_TRY(choose_order(ctx, build));
  FG_TRY(allocate_rows(ctx, rows, build->out));
  FG_TRY(sort_rows(ctx, build));
  FG_TRY(fill_response(ctx, build));
  FG_TRY(fg_loop_table_fill_coordinates(ctx, build));
  if (fg_loop_table_is_arc_length(build->spec))
    FG_TRY(fg_loop_table_fill_arc_length(ctx, build));
  else
    FG_TRY(fg_loop_table_fill_model(ctx, build));
  if (!fg_loop_table_is_arc_length(build->spec)) FG_TRY(subtract_origin(ctx, build));
  FG_TRY(subtract_offset(ctx, build));
  bool grouped = build->spec->group != NULL;
  problem->level = grouped ? "bumps" : "runs";
  problem->group_level = grouped && rows >= 2 * problem->groups;
  problem->correlated = grouped ? rows >= 4 * problem->groups : rows >= 8;
  problem->exchangeable = true;
  FG_TRY(fg_loop_table_merge_codes(ctx, build));
  FG_TRY(fg_loop_places_find_bases(ctx, build));
  FG_TRY(add_level(ctx, build));
  return fg_loop_table_hold_out(ctx, build);
}

fg_status fg_loop_table_problem_build(fg_context *ctx, const fg_table *table,
                                      const fg_loop_table_spec *spec,
                                      fg_loop_table_problem *problem) {
  fg_loop_table_state build = {table, spec, problem, NULL};
  *problem = (fg_loop_table_problem){0};
  fg_status status = build_all(ctx, &build);
  if (status != FG_OK) fg_loop_table_problem_free(problem);
  return status;
}

void fg_loop_table_problem_free(fg_loop_table_problem *out) {
  fg_loop_problem *problem = &out->problem;
  for (size_t i = 0; i < problem->coordinates; i++) {
    for (size_t k = 0; k < problem->coordinate[i].levels; k++)
      free(problem->coordinate[i].level_name[k]);
    free(problem->coordinate[i].level_name);
    free(problem->coordinate[i].value);
  }
  for (size_t i = 0; problem->parameter_name && i < problem->parameters; i++)
    free(problem->parameter_name[i]);
  free(problem->coordinate);
  free(problem->parameter_name);
  free(problem->jacobian);
  free(problem->group);
  free(problem->series);
  free(problem->held_out);
  free(problem->residual);
  free(problem->response);
  fg_loop_table_free_formula(out->model);
  free(out->row);
  free(out->excluded);
  *out = (fg_loop_table_problem){0};
}
