/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/table.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/extended.h"
#include "core/memory.h"
#include "core/select.h"
#include "core/text.h"
#include "stats/column.h"

void fg_table_free(fg_table *table) {
  if (!table) return;
  for (size_t i = 0; i < table->columns; i++)
    fg_column_free(&table->column[i]);
  free(table->column);
  free(table->line);
  free(table->name_slot);
  free(table->source);
  *table = (fg_table){0};
}

static fg_status open_checked(fg_context *ctx, fg_table *table, const char *name, size_t rows,
                              fg_column **column) {
  if (table->columns && table->rows != rows)
    return fg_fail(ctx, FG_ERR_USAGE, "column '%s' has %zu rows, the table %zu", name, rows,
                   table->rows);
  FG_TRY(fg_column_open(ctx, table, name, column));
  table->rows = rows;
  return FG_OK;
}

/* A column that could not be filled leaves the table as it was. */
static fg_status drop_last(fg_table *table, fg_status status) {
  if (status != FG_OK) fg_column_drop_last(table);
  return status;
}

fg_status fg_table_add_extended(fg_context *ctx, fg_table *table, const char *name,
                                const fg_extended *values, size_t rows) {
  fg_column *column = NULL;
  fg_status status = FG_OK;
  FG_TRY(open_checked(ctx, table, name, rows, &column));
  for (size_t i = 0; i < rows && status == FG_OK; i++)
    status = fg_column_push_number(ctx, column, i, values[i]);
  return drop_last(table, status);
}

fg_status fg_table_add_numbers(fg_context *ctx, fg_table *table, const char *name,
                               const double *values, size_t rows) {
  fg_column *column = NULL;
  fg_status status = FG_OK;
  FG_TRY(open_checked(ctx, table, name, rows, &column));
  for (size_t i = 0; i < rows && status == FG_OK; i++)
    status = fg_column_push_number(ctx, column, i, fg_extended_of(values[i]));
  return drop_last(table, status);
}

fg_status fg_table_add_words(fg_context *ctx, fg_table *table, const char *name,
                             const char *const *words, size_t rows) {
  fg_column *column = NULL;
  fg_status status = FG_OK;
  FG_TRY(open_checked(ctx, table, name, rows, &column));
  for (size_t i = 0; i < rows && status == FG_OK; i++)
    status = fg_column_push_word(ctx, column, i, words[i]);
  return drop_last(table, status);
}

/* Lists as many columns as a message has room for. */
static fg_status list_columns(fg_context *ctx, const fg_table *table, char **known) {
  enum { SHOWN = 40 };
  for (size_t i = 0; i < table->columns && i < SHOWN; i++)
    FG_TRY(fg_text_append(ctx, known, "%s%s", i ? ", " : "", table->column[i].name));
  if (table->columns <= SHOWN) return FG_OK;
  return fg_text_append(ctx, known, " ... (%zu)", table->columns);
}

fg_status fg_table_find(fg_context *ctx, const fg_table *table, const char *name,
                        const fg_column **column) {
  char *known = NULL;
  size_t found = fg_column_find(table, name);
  if (found < table->columns) {
    *column = &table->column[found];
    return FG_OK;
  }
  fg_status status = list_columns(ctx, table, &known);
  if (status == FG_OK)
    status = fg_fail(ctx, FG_ERR_DATA, "%s: there is no column '%s'; the columns are %s",
                     table->source ? table->source : "table", name, known ? known : "none");
  free(known);
  return status;
}

fg_status fg_table_drop(fg_context *ctx, fg_table *table, const char *name) {
  const fg_column *column = NULL;
  FG_TRY(fg_table_find(ctx, table, name, &column));
  fg_column_drop(table, (size_t)(column - table->column));
  return FG_OK;
}

/* Fails with "runs.csv: row 3 (line 4), column 'T': " and the reason. */
static fg_status fail_at(fg_context *ctx, const fg_table *table, const fg_column *column,
                         size_t row, const char *what) {
  const char *source = table->source ? table->source : "table";
  if (!table->line)
    return fg_fail(ctx, FG_ERR_DATA, "%s: row %zu, column '%s': %s", source, row + 1, column->name,
                   what);
  return fg_fail(ctx, FG_ERR_DATA, "%s: row %zu (line %zu), column '%s': %s", source, row + 1,
                 table->line[row], column->name, what);
}

/* The first row that is missing, or a word when `words` is set; rows when there is none. */
static size_t first_other(const fg_table *table, const fg_column *column, bool words) {
  if (!column->word) return table->rows;
  for (size_t i = 0; i < table->rows; i++) {
    if (column->word[i] == FG_TABLE_MISSING) return i;
    if (words && column->word[i] != FG_TABLE_NOT_A_WORD) return i;
  }
  return table->rows;
}

static fg_status fail_other(fg_context *ctx, const fg_table *table, const fg_column *column,
                            size_t row, const char *advice) {
  char what[400];
  if (column->word[row] == FG_TABLE_MISSING)
    return fail_at(ctx, table, column, row,
                   "the cell is empty or not a finite number; fill it in or leave the row out");
  fg_text_clip(what, sizeof what, "'%.80s' is not a number; %s", column->words[column->word[row]],
               advice);
  return fail_at(ctx, table, column, row, what);
}

static fg_status check_column(fg_context *ctx, const fg_table *table, const fg_column *column,
                              const char *advice) {
  if (column->uncertainty) return fg_fail(ctx, FG_ERR_DATA, "%s", column->uncertainty);
  if (!column->number_count || !column->word_count) return FG_OK;
  size_t row = 0;
  while (column->word[row] == FG_TABLE_NOT_A_WORD || column->word[row] == FG_TABLE_MISSING)
    row++;
  return fail_other(ctx, table, column, row, advice);
}

fg_status fg_table_check(fg_context *ctx, const fg_table *table, const char *name) {
  const fg_column *column = NULL;
  FG_TRY(fg_table_find(ctx, table, name, &column));
  return check_column(ctx, table, column,
                      "other cells of the column are: correct it, leave it empty where nothing is "
                      "known, or take the column out; names get a letter in every row");
}

fg_status fg_table_numbers(fg_context *ctx, const fg_table *table, const char *name,
                           const fg_extended **numbers) {
  const fg_column *column = NULL;
  FG_TRY(fg_table_find(ctx, table, name, &column));
  if (column->uncertainty) return fg_fail(ctx, FG_ERR_DATA, "%s", column->uncertainty);
  size_t row = first_other(table, column, true);
  if (row < table->rows) return fail_other(ctx, table, column, row, "correct it");
  *numbers = column->number;
  return FG_OK;
}

static int compare_numbers(const void *a, const void *b) {
  const fg_extended *x = a, *y = b;
  if (x->value != y->value) return x->value < y->value ? -1 : 1;
  return (x->tail > y->tail) - (x->tail < y->tail);
}

typedef struct word_rank {
  const char *word;
  size_t index;
} word_rank;

static int compare_words(const void *a, const void *b) {
  return strcmp(((const word_rank *)a)->word, ((const word_rank *)b)->word);
}

/* The distinct numbers of the column, ascending. */
static fg_status distinct_numbers(fg_context *ctx, const fg_table *table, const fg_column *column,
                                  fg_extended **numbers, size_t *count) {
  fg_extended *sorted = NULL;
  size_t filled = 0, kept = 0;
  FG_TRY(fg_memory_allocate(ctx, column->number_count, sizeof *sorted, (void **)&sorted));
  for (size_t i = 0; i < table->rows; i++)
    if (!column->word || column->word[i] == FG_TABLE_NOT_A_WORD)
      sorted[filled++] = column->number[i];
  fg_sort_items(sorted, filled, sizeof *sorted, compare_numbers);
  for (size_t i = 0; i < filled; i++)
    if (!kept || compare_numbers(&sorted[kept - 1], &sorted[i]) != 0) sorted[kept++] = sorted[i];
  *numbers = sorted;
  *count = kept;
  return FG_OK;
}

/* Words in order, and where each went. */
static fg_status rank_words(fg_context *ctx, const fg_column *column, word_rank **ranked) {
  FG_TRY(fg_memory_allocate(ctx, column->word_count, sizeof **ranked, (void **)ranked));
  for (size_t i = 0; i < column->word_count; i++)
    (*ranked)[i] = (word_rank){column->words[i], i};
  fg_sort_items(*ranked, column->word_count, sizeof **ranked, compare_words);
  return FG_OK;
}

static fg_status name_levels(fg_context *ctx, fg_levels *levels, const fg_extended *numbers,
                             size_t number_count, const word_rank *ranked, size_t word_count) {
  size_t count = number_count + word_count;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *levels->name, (void **)&levels->name));
  for (size_t i = 0; i < count; i++) {
    if (i < number_count)
      FG_TRY(fg_text_print(ctx, &levels->name[i], "%.15g", numbers[i].value));
    else
      FG_TRY(fg_text_print(ctx, &levels->name[i], "%s", ranked[i - number_count].word));
    levels->count = i + 1;
  }
  return FG_OK;
}

static fg_status make_levels(fg_context *ctx, const fg_table *table, const fg_column *column,
                             fg_levels *levels) {
  fg_status status = FG_OK;
  fg_extended *numbers = NULL;
  word_rank *ranked = NULL;
  size_t *place = NULL, number_count = 0;
  levels->rows = table->rows;
  FG_TRY_EXIT(distinct_numbers(ctx, table, column, &numbers, &number_count));
  FG_TRY_EXIT(rank_words(ctx, column, &ranked));
  FG_TRY_EXIT(fg_memory_allocate(ctx, column->word_count, sizeof *place, (void **)&place));
  for (size_t i = 0; i < column->word_count; i++)
    place[ranked[i].index] = number_count + i;
  FG_TRY_EXIT(name_levels(ctx, levels, numbers, number_count, ranked, column->word_count));
  FG_TRY_EXIT(fg_memory_allocate(ctx, table->rows, sizeof *levels->index, (void **)&levels->index));
  for (size_t i = 0; i < table->rows; i++) {
    if (column->word && column->word[i] != FG_TABLE_NOT_A_WORD) {
      levels->index[i] = place[column->word[i]];
      continue;
    }
    const fg_extended *found =
        bsearch(&column->number[i], numbers, number_count, sizeof *numbers, compare_numbers);
    levels->index[i] = (size_t)(found - numbers);
  }
exit:
  free(place);
  free(ranked);
  free(numbers);
  if (status != FG_OK) fg_levels_free(levels);
  return status;
}

fg_status fg_table_levels(fg_context *ctx, const fg_table *table, const char *name, bool forced,
                          fg_levels *levels) {
  const fg_column *column = NULL;
  *levels = (fg_levels){0};
  FG_TRY(fg_table_find(ctx, table, name, &column));
  if (column->uncertainty && !forced) return fg_fail(ctx, FG_ERR_DATA, "%s", column->uncertainty);
  size_t row = first_other(table, column, column->number_count > 0 && !forced);
  if (row < table->rows)
    return fail_other(ctx, table, column, row,
                      "correct it, or write factor(name) in the formula if the column holds names");
  return make_levels(ctx, table, column, levels);
}

void fg_levels_free(fg_levels *levels) {
  if (!levels) return;
  for (size_t i = 0; i < levels->count; i++)
    free(levels->name[i]);
  free(levels->name);
  free(levels->index);
  *levels = (fg_levels){0};
}

static fg_status select_column(fg_context *ctx, const fg_column *from, const size_t *rows,
                               size_t count, fg_column *to) {
  for (size_t i = 0; i < count; i++) {
    size_t row = rows ? rows[i] : i;
    size_t mark = from->word ? from->word[row] : FG_TABLE_NOT_A_WORD;
    if (mark == FG_TABLE_NOT_A_WORD)
      FG_TRY(fg_column_push_number(ctx, to, i, from->number[row]));
    else if (mark == FG_TABLE_MISSING)
      FG_TRY(fg_column_push_missing(ctx, to, i));
    else
      FG_TRY(fg_column_push_word(ctx, to, i, from->words[mark]));
  }
  return FG_OK;
}

fg_status fg_table_select(fg_context *ctx, const fg_table *table, const size_t *rows, size_t count,
                          fg_table *selection) {
  fg_status status = FG_OK;
  fg_column *column = NULL;
  *selection = (fg_table){.rows = count};
  for (size_t i = 0; rows && i < count; i++)
    if (rows[i] >= table->rows)
      return fg_fail(ctx, FG_ERR_USAGE, "the table has %zu rows, row %zu was asked for",
                     table->rows, rows[i] + 1);
  if (table->source) FG_TRY_EXIT(fg_text_print(ctx, &selection->source, "%s", table->source));
  for (size_t i = 0; i < table->columns; i++) {
    FG_TRY_EXIT(fg_column_open(ctx, selection, table->column[i].name, &column));
    FG_TRY_EXIT(select_column(ctx, &table->column[i], rows, count, column));
    if (table->column[i].uncertainty)
      FG_TRY_EXIT(fg_text_print(ctx, &column->uncertainty, "%s", table->column[i].uncertainty));
  }
  if (table->line) {
    FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *selection->line, (void **)&selection->line));
    for (size_t i = 0; i < count; i++)
      selection->line[i] = table->line[rows ? rows[i] : i];
  }
exit:
  if (status != FG_OK) fg_table_free(selection);
  return status;
}

fg_status fg_table_copy(fg_context *ctx, const fg_table *table, fg_table *copy) {
  return fg_table_select(ctx, table, NULL, table->rows, copy);
}
