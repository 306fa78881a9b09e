/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A column of words as dates: all of its cells decide how they are read. */
#ifndef FG_STATS_TABLE_DATES_H
#define FG_STATS_TABLE_DATES_H

#include <stdbool.h>

#include "foilgauge/table.h"

typedef enum fg_date_reading {
  FG_DATES_NONE, /* the words are no dates */
  FG_DATES_PLAIN,
  FG_DATES_DAY_FIRST,        /* some date cannot have its month first */
  FG_DATES_MONTH_FIRST,      /* some date cannot have its day first */
  FG_DATES_ROWS_DAY_FIRST,   /* both are possible, and day first has all rows in order of time */
  FG_DATES_ROWS_MONTH_FIRST, /* month first has */
  FG_DATES_SPAN_DAY_FIRST,   /* both are possible, and day first has all dates close together */
  FG_DATES_SPAN_MONTH_FIRST, /* month first has */
  FG_DATES_AMBIGUOUS         /* both are possible, and nothing decides */
} fg_date_reading;

/* values: days since 1970 of each of the column's words, where they are dates that can be read. */
fg_date_reading fg_table_read_dates(const fg_table *table, const fg_column *column, double *values);

/* Returns the first of the column's dates that is another day with its month first; word_count:
 * none is. */
size_t fg_table_first_ambiguous(const fg_column *column);

/* Returns how dates were read, to stand behind "counts days since ..."; "" where nothing was to be
 * decided. */
const char *fg_table_date_words(fg_date_reading reading);

/* values: hours of words that are times of a day (07:35, 7:35:10 PM); false where they are not. */
bool fg_table_read_hours(const fg_column *column, double *values);

/* True when the rows' values, by their words, only rise or only fall. */
bool fg_table_words_in_order(const fg_table *table, const fg_column *column, const double *values);

#endif
