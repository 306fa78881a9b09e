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

/* Returns the number that a word counts, in a column of such words; NaN: none. */
typedef double counter(const char *word, const fg_column *column);

static double count_date(const char *word, const fg_column *column) {
  (void)column;
  return fg_date_days(word);
}

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

/* values: of the words; false when one of them counts nothing. */
static bool count_all(const fg_column *column, counter *count, double *values) {
  for (size_t i = 0; i < column->word_count; i++) {
    values[i] = count(column->words[i], column);
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
                            const double *values, char **said) {
  size_t first = 0;
  for (size_t i = 1; i < column->word_count; i++)
    if (values[i] < values[first]) first = i;
  fg_status status = fg_text_append(ctx, said, "%s%s counts days since %s", *said ? "; " : "",
                                    column->name, column->words[first]);
  make_numbers(column, table->rows, values, values[first]);
  return status;
}

static fg_status count_column(fg_context *ctx, const fg_table *table, fg_column *column, size_t max,
                              char **said) {
  double *values = NULL;
  const char *separator = *said ? "; " : "";
  FG_TRY(fg_memory_allocate(ctx, column->word_count, sizeof *values, (void **)&values));
  fg_status status = FG_OK;
  if (count_all(column, count_date, values)) {
    status = count_days(ctx, table, column, values, said);
  } else if (column->word_count > max && count_all(column, count_serial, values)) {
    status =
        fg_text_append(ctx, said, "%s%s counts by the digits behind '%.*s'", separator,
                       column->name, (int)length_before_digits(column->words[0]), column->words[0]);
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

fg_status fg_table_count_times(fg_context *ctx, fg_table *table, size_t max, const char *order,
                               const char **times, char **said) {
  size_t counted = 0;
  *times = NULL;
  for (size_t i = 0; i < table->columns; i++) {
    fg_column *column = &table->column[i];
    bool meant = order && !strcmp(column->name, order);
    bool recur = column->word_count <= max || 2 * table->rows >= 3 * column->word_count;
    double *values = NULL;
    if (column->word_count < 2 || column->number_count || column->uncertainty) continue;
    if (recur && !meant) continue;
    FG_TRY(fg_memory_allocate(ctx, column->word_count, sizeof *values, (void **)&values));
    fg_status status = FG_OK;
    if (count_all(column, count_date, values)) {
      status = count_days(ctx, table, column, values, said);
      *times = ++counted == 1 && !column->missing_count ? column->name : NULL;
    }
    free(values);
    FG_TRY(status);
  }
  return FG_OK;
}
