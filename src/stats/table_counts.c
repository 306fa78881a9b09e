/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words that count: dates and serial numbers as numbers, so that a trend over them can be seen. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/date.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/table_times.h"
#include "stats/column.h"
#include "stats/table_dates.h"

static size_t length_before_digits(const char *word) {
  size_t length = strlen(word);
  while (length && word[length - 1] >= '0' && word[length - 1] <= '9')
    length--;
  return length;
}

static double count_serial(const char *word, const fg_column *column) {
  size_t length = length_before_digits(word), first = length_before_digits(column->words[0]);
  bool alike = length == first && !memcmp(word, column->words[0], length);
  size_t digits = strlen(word) - length;
  return alike && digits && digits <= 15 ? strtod(word + length, NULL) : NAN;
}

/* values: of the words; false when one of them is no serial number like the first. */
static bool count_serials(const fg_column *column, double *values) {
  for (size_t i = 0; i < column->word_count; i++) {
    values[i] = count_serial(column->words[i], column);
    if (!isfinite(values[i])) return false;
  }
  return true;
}

static void make_numbers(fg_column *column, size_t rows, const double *values, double origin) {
  for (size_t i = 0; i < rows; i++) {
    if (column->word[i] == FG_TABLE_MISSING) continue;
    column->number[i] = (fg_extended){values[column->word[i]] - origin, 0};
    column->word[i] = FG_TABLE_NOT_A_WORD;
    column->number_count++;
  }
  for (size_t i = 0; i < column->word_count; i++)
    free(column->words[i]);
  column->word_count = 0;
  memset(column->slot, 0, column->slot_count * sizeof *column->slot);
}

static fg_status count_days(fg_context *ctx, const fg_table *table, fg_column *column,
                            fg_date_reading reading, const double *values, char **said) {
  size_t first = 0;
  for (size_t i = 1; i < column->word_count; i++)
    if (values[i] < values[first]) first = i;
  fg_status status = fg_text_append_remark(ctx, said, "%s counts days since %s%s", column->name,
                                           column->words[first], fg_table_date_words(reading));
  make_numbers(column, table->rows, values, values[first]);
  return status;
}

static fg_status say_ambiguous(fg_context *ctx, const fg_column *column, char **said) {
  return fg_text_append_remark(
      ctx, said,
      "%s is not counted as time: dates such as %s may have the day or the month "
      "first, and no row tells; write them as 2026-03-31",
      column->name, column->words[fg_table_first_ambiguous(column)]);
}

/* *counted: the column is one of dates, and they were counted. */
static fg_status count_dates(fg_context *ctx, const fg_table *table, fg_column *column,
                             double *values, bool *counted, char **said) {
  fg_date_reading reading = fg_table_read_dates(table, column, values);
  *counted = reading != FG_DATES_NONE && reading != FG_DATES_AMBIGUOUS;
  if (reading == FG_DATES_AMBIGUOUS) return say_ambiguous(ctx, column, said);
  return *counted ? count_days(ctx, table, column, reading, values, said) : FG_OK;
}

static fg_status count_column(fg_context *ctx, const fg_table *table, fg_column *column, size_t max,
                              char **said) {
  double *values = NULL;
  bool counted;
  FG_TRY(fg_memory_allocate(ctx, column->word_count, sizeof *values, (void **)&values));
  fg_status status = count_dates(ctx, table, column, values, &counted, said);
  if (status == FG_OK && !counted && column->word_count > max && count_serials(column, values)) {
    status = fg_text_append_remark(ctx, said, "%s counts by the digits behind '%.*s'", column->name,
                                   (int)length_before_digits(column->words[0]), column->words[0]);
    make_numbers(column, table->rows, values, 0);
  }
  free(values);
  return status;
}

fg_status fg_table_count_words(fg_context *ctx, fg_table *table, size_t max, char **said) {
  for (size_t i = 0; i < table->columns; i++) {
    fg_column *column = &table->column[i];
    if (column->word_count > 1 && !column->number_count && !column->uncertainty)
      FG_TRY(count_column(ctx, table, column, max, said));
  }
  return FG_OK;
}

/* Times of a day without a date: hours, and an order only where they never go back, as over
 * midnight. */
static fg_status count_hours(fg_context *ctx, const fg_table *table, fg_column *column,
                             double *values, bool *is_order, char **said) {
  *is_order = false;
  if (!fg_table_read_hours(column, values)) return FG_OK;
  *is_order = fg_table_words_in_order(table, column, values);
  make_numbers(column, table->rows, values, 0);
  return fg_text_append_remark(ctx, said, "%s counts hours of the day", column->name);
}

/* *moments: the column has a moment in each row that has a cell, and they may be an order. */
static fg_status count_moments(fg_context *ctx, const fg_table *table, fg_column *column,
                               bool *moments, char **said) {
  double *values = NULL;
  *moments = false;
  FG_TRY(fg_memory_allocate(ctx, column->word_count, sizeof *values, (void **)&values));
  fg_status status = count_dates(ctx, table, column, values, moments, said);
  if (status == FG_OK && !*moments) status = count_hours(ctx, table, column, values, moments, said);
  free(values);
  return status;
}

/* Days of a date that is written as one number, 20260331; NaN: none. */
static double days_of_digits(double number) {
  if (number != floor(number) || number < 1e7 || number >= 1e8) return NAN;
  int date = (int)number;
  return fg_date_of_day(date / 10000, date / 100 % 100, date % 100);
}

/* A column that is called date with such numbers alone: days since the first of them. */
static fg_status count_digits(fg_context *ctx, const fg_table *table, fg_column *column,
                              char **said) {
  double first = INFINITY, earliest = 0;
  if (!strcasestr(column->name, "date") && !strcasestr(column->name, "datum")) return FG_OK;
  for (size_t i = 0; i < table->rows; i++) {
    double number = column->number[i].value, days = days_of_digits(number);
    if (!isfinite(days)) return FG_OK;
    if (days < first) earliest = number;
    first = fmin(first, days);
  }
  for (size_t i = 0; i < table->rows; i++)
    column->number[i] = (fg_extended){days_of_digits(column->number[i].value) - first, 0};
  return fg_text_append_remark(ctx, said, "%s counts days since %.0f", column->name, earliest);
}

/* The order that is asked for cannot be counted. Other words than dates are refused where they are
 * used. */
static fg_status refuse_order(fg_context *ctx, const fg_table *table, const fg_column *column) {
  char *words = NULL;
  double *values = NULL;
  FG_TRY(fg_memory_allocate(ctx, column->word_count, sizeof *values, (void **)&values));
  fg_date_reading reading = fg_table_read_dates(table, column, values);
  free(values);
  if (reading != FG_DATES_AMBIGUOUS) return FG_OK;
  fg_status status = say_ambiguous(ctx, column, &words);
  if (status == FG_OK) status = fg_fail(ctx, FG_ERR_DATA, "%s: column %s", table->source, words);
  free(words);
  return status;
}

fg_status fg_table_count_times(fg_context *ctx, fg_table *table, const char *order,
                               const char **times, char **said) {
  size_t counted = 0;
  *times = NULL;
  for (size_t i = 0; i < table->columns; i++) {
    fg_column *column = &table->column[i];
    bool meant = order && !strcmp(column->name, order), moments;
    bool recur = 2 * table->rows >= 3 * column->word_count;
    if (column->number_count == table->rows) FG_TRY(count_digits(ctx, table, column, said));
    if (column->word_count < 2 || column->number_count || column->uncertainty) continue;
    if (recur && !meant) continue;
    FG_TRY(count_moments(ctx, table, column, &moments, said));
    if (meant && column->word_count) FG_TRY(refuse_order(ctx, table, column));
    if (moments) *times = ++counted == 1 && !column->missing_count ? column->name : NULL;
  }
  return FG_OK;
}
