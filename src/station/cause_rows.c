/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/cause_rows.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"

enum { ROWS_MAX = 1500, GROUP_BYTES = 24 };
#define HOURS_OF_ROW 2.0

typedef struct cell_key {
  size_t cell, key, foil;
} cell_key;

static int compare_keys(const void *a, const void *b) {
  const cell_key *one = a, *other = b;
  if (one->cell != other->cell) return one->cell < other->cell ? -1 : 1;
  if (one->key != other->key) return one->key < other->key ? -1 : 1;
  return (one->foil > other->foil) - (one->foil < other->foil);
}

/* Splits the rows by another key; rows keep the order of their first foils. */
static fg_status split_cells(fg_context *ctx, const fg_cause_data *data, const size_t *key,
                             size_t *cell, size_t *cells) {
  cell_key *sorted = NULL;
  size_t *number = NULL, groups = 0;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, data->foils, sizeof *sorted, (void **)&sorted));
  FG_TRY_EXIT(fg_memory_allocate(ctx, data->foils, sizeof *number, (void **)&number));
  for (size_t i = 0; i < data->foils; i++)
    sorted[i] = (cell_key){cell[i], key[i], i};
  fg_sort_items(sorted, data->foils, sizeof *sorted, compare_keys);
  for (size_t i = 0; i < data->foils; i++) {
    groups += !i || sorted[i].cell != sorted[i - 1].cell || sorted[i].key != sorted[i - 1].key;
    cell[sorted[i].foil] = groups - 1;
  }
  *cells = 0;
  for (size_t i = 0; i < data->foils; i++) {
    if (!number[cell[i]]) number[cell[i]] = ++*cells;
    cell[i] = number[cell[i]] - 1;
  }
exit:
  free(sorted);
  free(number);
  return status;
}

fg_status fg_cause_split_hours(fg_context *ctx, fg_cause_pass *pass) {
  const fg_cause_column *hour = fg_cause_column_find(pass->data, FG_CAUSE_HOUR);
  size_t *key;
  if (!hour) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, pass->data->foils, sizeof *key, (void **)&key));
  for (size_t i = 0; i < pass->data->foils; i++)
    key[i] = (size_t)(hour->number[i] / HOURS_OF_ROW);
  fg_status status = split_cells(ctx, pass->data, key, pass->cell, &pass->cells);
  free(key);
  return status;
}

fg_status fg_cause_split_columns(fg_context *ctx, fg_cause_pass *pass, bool within) {
  for (size_t c = 0; c < pass->data->columns; c++) {
    const fg_cause_column *column = &pass->data->column[c];
    if (!column->words || column->within_days != within) continue;
    FG_TRY(split_cells(ctx, pass->data, column->level, pass->cell, &pass->cells));
  }
  return FG_OK;
}

fg_status fg_cause_split_days(fg_context *ctx, fg_cause_pass *pass) {
  FG_TRY(fg_memory_allocate(ctx, pass->data->foils, sizeof *pass->cell, (void **)&pass->cell));
  FG_TRY(split_cells(ctx, pass->data, pass->data->day, pass->cell, &pass->cells));
  FG_TRY(split_cells(ctx, pass->data, pass->data->lot, pass->cell, &pass->cells));
  return fg_cause_split_columns(ctx, pass, false);
}

static fg_status add_means(fg_context *ctx, const fg_cause_pass *pass, const char *name,
                           const double *number, fg_table *table) {
  double *sum = NULL, *count = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, pass->cells, sizeof *sum, (void **)&sum));
  FG_TRY_EXIT(fg_memory_allocate(ctx, pass->cells, sizeof *count, (void **)&count));
  for (size_t i = 0; i < pass->data->foils; i++) {
    sum[pass->cell[i]] += number[i];
    count[pass->cell[i]]++;
  }
  for (size_t r = 0; r < pass->cells; r++)
    sum[r] /= count[r];
  status = fg_table_add_numbers(ctx, table, name, sum + pass->first, pass->cells - pass->first);
exit:
  free(sum);
  free(count);
  return status;
}

static fg_status add_levels(fg_context *ctx, const fg_cause_pass *pass,
                            const fg_cause_column *column, fg_table *table) {
  const char **word;
  FG_TRY(fg_memory_allocate(ctx, pass->cells, sizeof *word, (void **)&word));
  for (size_t i = 0; i < pass->data->foils; i++) {
    const char *level = column->level_name[column->level[i]];
    word[pass->cell[i]] = level[0] ? level : "(not given)";
  }
  fg_status status =
      fg_table_add_words(ctx, table, column->name, word + pass->first, pass->cells - pass->first);
  free(word);
  return status;
}

/* Words with a letter at their end: numbers would be a candidate themselves. */
static fg_status add_group(fg_context *ctx, const fg_cause_pass *pass, fg_table *table) {
  char(*name)[GROUP_BYTES] = NULL;
  const char **word = NULL;
  fg_status status = FG_OK;
  if (!pass->group) return FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, pass->cells, sizeof *name, (void **)&name));
  FG_TRY_EXIT(fg_memory_allocate(ctx, pass->cells, sizeof *word, (void **)&word));
  for (size_t i = 0; i < pass->data->foils; i++) {
    snprintf(name[pass->cell[i]], GROUP_BYTES, "%zug", pass->group[i]);
    word[pass->cell[i]] = name[pass->cell[i]];
  }
  status =
      fg_table_add_words(ctx, table, FG_CAUSE_GROUP, word + pass->first, pass->cells - pass->first);
exit:
  free(name);
  free(word);
  return status;
}

/* A constant column tells nothing; the newest rows alone may have one. */
static bool is_sought(const fg_cause_pass *pass, const fg_cause_column *column) {
  if (!strcmp(column->name, FG_CAUSE_TIME)) return false;
  if (!strcmp(column->name, FG_CAUSE_HOUR)) return pass->within;
  return column->words ? (column->within_days ? pass->within : pass->between)
                       : (pass->between || column->within_days);
}

fg_status fg_cause_table(fg_context *ctx, fg_cause_pass *pass, fg_table *table) {
  const fg_cause_column *when = fg_cause_column_find(pass->data, FG_CAUSE_TIME);
  pass->first = pass->cells > ROWS_MAX ? pass->cells - ROWS_MAX : 0;
  FG_TRY(add_means(ctx, pass, FG_CAUSE_VALUE, pass->value, table));
  if (when) FG_TRY(add_means(ctx, pass, when->name, when->number, table));
  FG_TRY(add_group(ctx, pass, table));
  for (size_t c = 0; c < pass->data->columns; c++) {
    const fg_cause_column *column = &pass->data->column[c];
    if (!is_sought(pass, column)) continue;
    if (column->words)
      FG_TRY(add_levels(ctx, pass, column, table));
    else
      FG_TRY(add_means(ctx, pass, column->name, column->number, table));
  }
  return FG_OK;
}
