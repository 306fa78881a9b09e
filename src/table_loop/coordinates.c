/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Columns as coordinates: every one that is not itself a result of the measurement. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/text.h"
#include "foilgauge/formula.h"
#include "quantity/quantity_rows.h"
#include "table_loop/places.h"

fg_loop_coordinate *fg_loop_table_coordinate(const fg_loop_problem *problem, const char *name) {
  for (size_t i = 0; i < problem->coordinates; i++)
    if (!strcmp(problem->coordinate[i].name, name)) return &problem->coordinate[i];
  return NULL;
}

fg_status fg_loop_table_add_coordinate(fg_context *ctx, const fg_loop_table_state *build,
                                       const char *name, unsigned roles,
                                       fg_loop_coordinate **added) {
  fg_loop_problem *problem = &build->out->problem;
  size_t capacity = problem->coordinates;
  FG_TRY(fg_memory_reserve(ctx, problem->coordinates + 1, sizeof *problem->coordinate, &capacity,
                           (void **)&problem->coordinate));
  fg_loop_coordinate *at = &problem->coordinate[problem->coordinates];
  *at = (fg_loop_coordinate){.roles = roles};
  FG_TRY(fg_memory_allocate(ctx, problem->rows, sizeof *at->value, (void **)&at->value));
  fg_text_clip(at->name, sizeof at->name, "%s", name);
  problem->coordinates++;
  *added = at;
  return FG_OK;
}

void fg_loop_table_finish_coordinate(const fg_loop_problem *problem, fg_loop_coordinate *at) {
  double *sorted = malloc((problem->rows + 1) * sizeof *sorted);
  if (!sorted) return;
  memcpy(sorted, at->value, problem->rows * sizeof *sorted);
  fg_sort(sorted, problem->rows);
  at->low = sorted[0];
  at->high = sorted[problem->rows - 1];
  at->distinct = 0;
  for (size_t i = 0; i < problem->rows; i++) {
    if (i > 0 && !(sorted[i] > sorted[i - 1])) continue;
    if (at->distinct <= FG_LOOP_COLUMNS) at->few[at->distinct] = sorted[i];
    at->distinct++;
  }
  for (size_t k = 0; k <= FG_LOOP_COLUMNS; k++) {
    double at_row = (double)k / FG_LOOP_COLUMNS * (double)(problem->rows - 1);
    at->quantile[k] = sorted[(size_t)(at_row + 0.5)];
  }
  fg_loop_places_measure(sorted, problem->rows, at);
  free(sorted);
}

bool fg_loop_table_name_ends(const char *name, const char *end) {
  size_t length = strlen(name), size = strlen(end);
  return length > size && !strcasecmp(name + length - size, end);
}

/* Returns true for two levels that say from which side a place was approached. */
static bool is_direction(const fg_loop_coordinate *at) {
  static const char *const names[] = {"direction", "approach", "sense", "reversal", "stroke"};
  static const char *const levels[] = {"up",  "down",   "forward", "backward",  "forth", "back",
                                       "cw",  "ccw",    "loading", "unloading", "+",     "-",
                                       "out", "return", "rising",  "falling"};
  size_t known = 0;
  if (at->levels ? at->levels != 2 : at->distinct != 2) return false;
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (strcasestr(at->name, names[i])) return true;
  for (size_t k = 0; k < at->levels; k++)
    for (size_t i = 0; i < sizeof levels / sizeof *levels; i++)
      known += !strcasecmp(at->level_name[k], levels[i]);
  return known == 2;
}

/* Derives a column's roles from the unit in its name; without a unit it has none. */
static void give_roles(fg_loop_coordinate *at) {
  if (is_direction(at)) at->roles |= FG_LOOP_DIRECTION;
  if (strcasestr(at->name, "temp") && fg_loop_table_name_ends(at->name, "_C")) {
    at->roles |= FG_LOOP_TEMPERATURE;
    at->kelvin_offset = 273.15;
  } else if (strcasestr(at->name, "temp") && fg_loop_table_name_ends(at->name, "_K")) {
    at->roles |= FG_LOOP_TEMPERATURE;
  }
  if ((strcasestr(at->name, "duration") || strcasestr(at->name, "time")) &&
      (fg_loop_table_name_ends(at->name, "_h") || fg_loop_table_name_ends(at->name, "_min") ||
       fg_loop_table_name_ends(at->name, "_s")))
    at->roles |= FG_LOOP_DURATION;
}

fg_status fg_loop_table_leave_out(fg_context *ctx, const fg_loop_table_state *build,
                                  const char *name, const char *why) {
  char **text = &build->out->excluded;
  return fg_text_append_remark(ctx, text, "%s: %s", name, why);
}

/* Rows that a column lacks, and the way to look into it nevertheless. */
static fg_status leave_out_gaps(fg_context *ctx, const fg_loop_table_state *build,
                                const fg_column *column) {
  char why[200];
  size_t rows = build->table->rows, missing = column->missing_count;
  fg_text_clip(why, sizeof why, "cells are missing in %zu of %zu rows%s", missing, rows,
               2 * missing < rows ? " (--complete leaves out these rows instead)" : "");
  return fg_loop_table_leave_out(ctx, build, column->name, why);
}

static fg_status fill_words(fg_context *ctx, const fg_loop_table_state *build,
                            const fg_column *column, fg_loop_coordinate *at) {
  const size_t *row = build->out->row;
  fg_levels levels = {0};
  FG_TRY(fg_table_levels(ctx, build->table, column->name, true, &levels));
  for (size_t i = 0; i < build->out->problem.rows; i++)
    at->value[i] = (double)levels.index[row[i]];
  at->levels = levels.count;
  at->level_name = levels.name;
  levels.name = NULL;
  levels.count = 0;
  fg_levels_free(&levels);
  return FG_OK;
}

/* Beyond these, sums and differences of a column's values are no numbers any more. */
static bool is_in_range(const fg_table *table, const fg_column *column) {
  double largest = 0;
  for (size_t i = 0; column->number && i < table->rows; i++)
    largest = fmax(largest, fabs(column->number[i].value));
  return largest == 0 || (largest >= FG_LOOP_TABLE_SMALLEST && largest <= FG_LOOP_TABLE_LARGEST);
}

/* Returns true for columns of names: groups, and those that the model puts into factor(). */
static bool names_are_meant(const fg_loop_table_spec *spec, const char *column) {
  fg_context ignored = {0};
  fg_formula formula = {0};
  bool meant = spec->group && !strcmp(spec->group, column);
  if (!meant && fg_formula_parse(&ignored, spec->model, &formula) == FG_OK)
    for (size_t v = 0; v < formula.variables; v++)
      meant = meant || (formula.variable[v].transform == FG_TRANSFORM_FACTOR &&
                        !strcmp(formula.variable[v].column, column));
  fg_formula_free(&formula);
  return meant;
}

static fg_status add_column(fg_context *ctx, const fg_loop_table_state *build,
                            const fg_column *column) {
  fg_loop_problem *problem = &build->out->problem;
  const fg_loop_table_spec *spec = build->spec;
  fg_loop_coordinate *at;
  unsigned roles = 0;
  bool words = column->word_count > 0;
  if (!strcmp(column->name, spec->response)) return FG_OK;
  if (spec->offset && !strcmp(column->name, spec->offset)) return FG_OK;
  if (fg_quantity_is_result(column->name)) return FG_OK;
  if (column->missing_count) return leave_out_gaps(ctx, build, column);
  if (column->uncertainty || (words && column->number_count))
    return names_are_meant(spec, column->name)
               ? fg_loop_table_leave_out(ctx, build, column->name, "words among numbers")
               : fg_table_check(ctx, build->table, column->name);
  if (!words && !is_in_range(build->table, column))
    return fg_loop_table_leave_out(
        ctx, build, column->name,
        "numbers too large or too small to compute with; give it in another unit");
  if (spec->group && !strcmp(column->name, spec->group)) roles = FG_LOOP_ORDER;
  if (build->order && !strcmp(column->name, build->order))
    roles = spec->group ? FG_LOOP_BUMP : FG_LOOP_ORDER;
  size_t members = spec->group ? problem->groups : problem->rows;
  bool recur = 2 * members >= 3 * column->word_count; /* as random levels */
  if (words && column->word_count > FG_LOOP_COLUMNS && !roles && !recur)
    return fg_loop_table_leave_out(ctx, build, column->name, "more levels than an effect may have");
  FG_TRY(fg_loop_table_add_coordinate(ctx, build, column->name, roles, &at));
  for (size_t i = 0; i < problem->rows && !words; i++)
    at->value[i] = column->number[build->out->row[i]].value;
  for (size_t i = 0; i < problem->rows && words && roles; i++)
    at->value[i] = (double)problem->group[i] + 1; /* foils by name: in order of appearance */
  if (words && !roles) FG_TRY(fill_words(ctx, build, column, at));
  fg_loop_table_finish_coordinate(problem, at);
  give_roles(at);
  if (at->distinct >= 2) return FG_OK;
  FG_TRY(fg_loop_table_leave_out(ctx, build, column->name, "the same in every row"));
  fg_loop_table_drop(problem, problem->coordinates - 1);
  return FG_OK;
}

/* One sentence for all: a lot's table has dozens. */
static fg_status say_results(fg_context *ctx, const fg_loop_table_state *build) {
  size_t said = 0;
  for (size_t c = 0; c < build->table->columns; c++) {
    const char *name = build->table->column[c].name;
    char **text = &build->out->excluded;
    if (!strcmp(name, build->spec->response) || !fg_quantity_is_result(name)) continue;
    FG_TRY(fg_text_append(ctx, text, "%s%s",
                          said    ? ", "
                          : *text ? "; results of the same measurement, not causes: "
                                  : "results of the same measurement, not causes: ",
                          name));
    said++;
  }
  return FG_OK;
}

fg_status fg_loop_table_fill_coordinates(fg_context *ctx, const fg_loop_table_state *build) {
  fg_loop_problem *problem = &build->out->problem;
  for (size_t c = 0; c < build->table->columns; c++)
    FG_TRY(add_column(ctx, build, &build->table->column[c]));
  FG_TRY(say_results(ctx, build));
  if (build->order || build->spec->group) return FG_OK;
  fg_loop_coordinate *at;
  FG_TRY(fg_loop_table_add_coordinate(ctx, build, "row", FG_LOOP_ORDER, &at));
  for (size_t i = 0; i < problem->rows; i++)
    at->value[i] = (double)build->out->row[i] + 1;
  fg_loop_table_finish_coordinate(problem, at);
  return FG_OK;
}
