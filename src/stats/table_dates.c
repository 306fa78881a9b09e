/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stats/table_dates.h"

#include <math.h>
#include <stdio.h>

#include "core/date.h"
#include "core/date_order.h"

/* Rows from which on their order tells day from month: by chance one in 720 orders of six rises. */
enum { ROWS_THAT_TELL = 6 };

/* Times as many days, from which on a span of the dates is not believed: days of one month, as runs
 * have them, are one day of many months in the other order. */
#define CLOSE 10.0

bool fg_table_words_in_order(const fg_table *table, const fg_column *column, const double *values) {
  double last = NAN;
  bool up = false, down = false;
  for (size_t i = 0; i < table->rows; i++) {
    if (column->word[i] == FG_TABLE_MISSING) continue;
    double value = values[column->word[i]];
    up = up || value > last;
    down = down || value < last;
    last = value;
  }
  return !up || !down;
}

/* False where a word is no date in that order. */
static bool read_all(const fg_column *column, fg_date_order order, double *values) {
  for (size_t i = 0; i < column->word_count; i++) {
    values[i] = fg_date_days_in(column->words[i], order);
    if (!isfinite(values[i])) return false;
  }
  return true;
}

size_t fg_table_first_ambiguous(const fg_column *column) {
  size_t i = 0;
  while (i < column->word_count && fg_date_days_in(column->words[i], FG_DATE_DAY_FIRST) ==
                                       fg_date_days_in(column->words[i], FG_DATE_MONTH_FIRST))
    i++;
  return i;
}

static double span_of(const double *values, size_t count) {
  double first = INFINITY, last = -INFINITY;
  for (size_t i = 0; i < count; i++) {
    first = fmin(first, values[i]);
    last = fmax(last, values[i]);
  }
  return last - first;
}

/* Both orders are possible: does one of them alone have the rows in order of time, or the dates in
 * far fewer days? */
static fg_date_reading read_by_rows(const fg_table *table, const fg_column *column,
                                    double *values) {
  bool day_first = fg_table_words_in_order(table, column, values);
  double day_span = span_of(values, column->word_count);
  read_all(column, FG_DATE_MONTH_FIRST, values);
  bool month_first = fg_table_words_in_order(table, column, values);
  double month_span = span_of(values, column->word_count);
  fg_date_reading reading = FG_DATES_AMBIGUOUS;
  if (day_first != month_first && column->word_count >= ROWS_THAT_TELL)
    reading = day_first ? FG_DATES_ROWS_DAY_FIRST : FG_DATES_ROWS_MONTH_FIRST;
  else if (day_span > CLOSE * month_span)
    reading = FG_DATES_SPAN_MONTH_FIRST;
  else if (month_span > CLOSE * day_span)
    reading = FG_DATES_SPAN_DAY_FIRST;
  if (reading == FG_DATES_ROWS_DAY_FIRST || reading == FG_DATES_SPAN_DAY_FIRST)
    read_all(column, FG_DATE_DAY_FIRST, values);
  return reading;
}

fg_date_reading fg_table_read_dates(const fg_table *table, const fg_column *column,
                                    double *values) {
  bool month_first = read_all(column, FG_DATE_MONTH_FIRST, values);
  bool day_first = read_all(column, FG_DATE_DAY_FIRST, values);
  if (!day_first && !month_first) return FG_DATES_NONE;
  if (day_first && !month_first) return FG_DATES_DAY_FIRST;
  if (day_first)
    return fg_table_first_ambiguous(column) < column->word_count
               ? read_by_rows(table, column, values)
               : FG_DATES_PLAIN;
  read_all(column, FG_DATE_MONTH_FIRST, values);
  return FG_DATES_MONTH_FIRST;
}

const char *fg_table_date_words(fg_date_reading reading) {
  switch (reading) {
  case FG_DATES_DAY_FIRST:
    return ", read with the day first";
  case FG_DATES_MONTH_FIRST:
    return ", read with the month first";
  case FG_DATES_ROWS_DAY_FIRST:
    return ", read with the day first, which has the rows in order of time";
  case FG_DATES_ROWS_MONTH_FIRST:
    return ", read with the month first, which has the rows in order of time";
  case FG_DATES_SPAN_DAY_FIRST:
    return ", read with the day first, which has them close together";
  case FG_DATES_SPAN_MONTH_FIRST:
    return ", read with the month first, which has them close together";
  default:
    return "";
  }
}

bool fg_table_read_hours(const fg_column *column, double *values) {
  char text[32];
  for (size_t i = 0; i < column->word_count; i++) {
    snprintf(text, sizeof text, " %.30s", column->words[i]);
    values[i] = 24 * fg_date_time_of_day(text);
    if (!isfinite(values[i])) return false;
  }
  return column->word_count > 0;
}
