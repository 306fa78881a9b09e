/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/context.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/date.h"
#include "core/memory.h"

/* The words of a cell; NULL: it is a number or missing. */
static const char *cell_word(const fg_column *column, size_t row) {
  if (!column->word || column->word[row] >= column->word_count) return NULL;
  return column->words[column->word[row]];
}

static double cell_number(const fg_column *column, size_t row) {
  bool number = !column->word || column->word[row] == FG_TABLE_NOT_A_WORD;
  return number ? column->number[row].value : NAN;
}

static bool is_digits(const char *text) {
  return *text && text[strspn(text, "0123456789")] == '\0';
}

/* Compares serial numbers. Digits alone are compared as a number of any length: a spreadsheet drops
 * zeros before it. */
static int compare_serials(const char *one, const char *other) {
  bool digits = is_digits(one), other_digits = is_digits(other);
  if (digits != other_digits) return digits ? -1 : 1;
  if (!digits) return strcmp(one, other);
  one += strspn(one, "0");
  other += strspn(other, "0");
  size_t length = strlen(one), other_length = strlen(other);
  return length != other_length ? (length > other_length) - (length < other_length)
                                : strcmp(one, other);
}

static const char *row_serial(const fg_station_context *context, size_t row) {
  const char *word = cell_word(&context->serials.column[context->key], row);
  return word ? word : "";
}

static int compare_context_rows(const void *a, const void *b, void *user) {
  const fg_station_context *context = user;
  const size_t i = *(const size_t *)a, k = *(const size_t *)b;
  if (context->by_time)
    return (context->days[i] > context->days[k]) - (context->days[i] < context->days[k]);
  return compare_serials(row_serial(context, i), row_serial(context, k));
}

static bool find_key(fg_station_context *context) {
  static const char *const times[] = {"time", "date", "at"};
  for (size_t i = 0; i < context->table.columns; i++) {
    const char *name = context->table.column[i].name;
    context->key = i;
    context->by_time = false;
    if (!strcasecmp(name, "serial")) return true;
    context->by_time = true;
    for (size_t k = 0; k < sizeof times / sizeof *times; k++)
      if (!strcasecmp(name, times[k])) return true;
  }
  return false;
}

static fg_status read_days(fg_context *ctx, const char *path, fg_station_context *context) {
  const fg_column *column = &context->table.column[context->key];
  for (size_t i = 0; i < context->table.rows; i++) {
    const char *word = cell_word(column, i);
    context->days[i] = word ? fg_date_days(word) : NAN;
    if (isnan(context->days[i]))
      return fg_fail(ctx, FG_ERR_DATA,
                     "%.300s: row %zu: %s \"%.40s\" is no time such as 2026-03-01 14:02", path,
                     i + 1, column->name, word ? word : "");
  }
  return FG_OK;
}

static fg_status load_context(fg_context *ctx, const char *path, fg_station_context *context) {
  char sum[65], words_sum[65];
  FG_TRY(fg_table_load(ctx, path, &context->table, sum));
  if (!find_key(context))
    return fg_fail(ctx, FG_ERR_DATA,
                   "%.300s: a context needs a column `serial` or `time`, which says what foils its "
                   "rows belong to",
                   path);
  size_t rows = context->table.rows;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *context->order, (void **)&context->order));
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *context->days, (void **)&context->days));
  if (context->by_time)
    FG_TRY(read_days(ctx, path, context));
  else
    FG_TRY(fg_table_load_words(ctx, path, &context->serials, words_sum));
  if (!context->by_time && strcmp(sum, words_sum) != 0)
    return fg_fail(ctx, FG_ERR_IO, "%.300s: it changed while it was read", path);
  for (size_t i = 0; i < rows; i++)
    context->order[i] = i;
  qsort_r(context->order, rows, sizeof *context->order, compare_context_rows, context);
  return FG_OK;
}

fg_status fg_station_contexts_load(fg_context *ctx, const fg_station_request *request,
                                   fg_station_contexts *contexts) {
  *contexts = (fg_station_contexts){0};
  for (size_t i = 0; i < request->context_count; i++) {
    fg_status status = load_context(ctx, request->contexts[i], &contexts->one[contexts->count++]);
    if (status == FG_OK) continue;
    fg_station_contexts_free(contexts);
    return status;
  }
  return FG_OK;
}

void fg_station_contexts_free(fg_station_contexts *contexts) {
  for (size_t i = 0; i < contexts->count; i++) {
    fg_table_free(&contexts->one[i].table);
    fg_table_free(&contexts->one[i].serials);
    free(contexts->one[i].order);
    free(contexts->one[i].days);
  }
  *contexts = (fg_station_contexts){0};
}

/* Number of rows whose key is not above the foil's. */
static size_t count_rows_before(const fg_station_context *context, const char *serial,
                                double days) {
  size_t low = 0, high = context->table.rows;
  while (low < high) {
    size_t middle = low + (high - low) / 2, row = context->order[middle];
    bool before = context->by_time ? context->days[row] <= days
                                   : compare_serials(row_serial(context, row), serial) <= 0;
    if (before)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* Numbers between two rows are interpolated. The last one holds for as long as that before it did.
 */
static double interpolate(const fg_station_context *context, const fg_column *column, size_t behind,
                          double days) {
  size_t before = context->order[behind - 1];
  double value = cell_number(column, before), from = context->days[before];
  if (from == days) return value;
  if (behind == context->table.rows) {
    double gap = behind > 1 ? from - context->days[context->order[behind - 2]] : 0;
    return days - from <= gap ? value : NAN;
  }
  size_t next = context->order[behind];
  double share = (days - from) / (context->days[next] - from);
  return value + share * (cell_number(column, next) - value);
}

fg_context_value fg_station_context_value(const fg_station_context *context, size_t column,
                                          const char *serial, double days) {
  fg_context_value value = {NULL, NAN};
  const fg_column *cells = &context->table.column[column];
  size_t behind = count_rows_before(context, serial, days);
  if (!behind) return value;
  size_t row = context->order[behind - 1];
  if (!context->by_time && compare_serials(row_serial(context, row), serial) != 0) return value;
  value.word = cell_word(cells, row);
  if (value.word) return value;
  value.number =
      context->by_time ? interpolate(context, cells, behind, days) : cell_number(cells, row);
  return value;
}
