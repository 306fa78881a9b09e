/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Moments in a table: dates with a time of day, as loggers and spreadsheets write them. */
#ifndef FOILGAUGE_TABLE_TIMES_H
#define FOILGAUGE_TABLE_TIMES_H

#include <stddef.h>

#include "foilgauge/status.h"
#include "foilgauge/table.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Makes moments numbers: days since the earliest of their column, or hours of a day without a date.
 * Those are in the column `order` (NULL: none), and in columns in which they hardly recur; dates
 * that recur stay words, as each may have a level of its own. Dates that may have the day or the
 * month first are read as all rows allow, or as has the rows in order of time; `said` tells, and
 * where nothing decides they stay words. *times becomes the name of the only column of moments that
 * has one in every row, else NULL. `said` is as of fg_table_count_words. */
fg_status fg_table_count_times(fg_context *ctx, fg_table *table, const char *order,
                               const char **times, char **said);

#ifdef __cplusplus
}
#endif
#endif
