/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Building a table cell by cell: shared by the CSV reader and the tables made in memory. */
#ifndef FG_STATS_COLUMN_H
#define FG_STATS_COLUMN_H

#include "foilgauge/table.h"

/* Appends a column without rows; the name is copied. FG_ERR_USAGE when the name is taken. */
fg_status fg_column_open(fg_context *ctx, fg_table *table, const char *name, fg_column **column);

/* Returns the index of the column of that name, or table->columns when there is none. */
size_t fg_column_find(const fg_table *table, const char *name);

/* Removes the last column, or the one at `index`. */
void fg_column_drop_last(fg_table *table);
void fg_column_drop(fg_table *table, size_t index);
void fg_column_free(fg_column *column); /* Frees the members of a column, not the column itself. */

/* Appends a cell to the column, which holds `row` cells so far. */
fg_status fg_column_push_number(fg_context *ctx, fg_column *column, size_t row, fg_extended number);
fg_status fg_column_push_missing(fg_context *ctx, fg_column *column, size_t row);
fg_status fg_column_push_word(fg_context *ctx, fg_column *column, size_t row, const char *word);

/* Appends a text as number, missing value or word. With `commas` a number may have a decimal comma.
 */
fg_status fg_column_push_text(fg_context *ctx, fg_column *column, size_t row, const char *text,
                              size_t length, bool commas);

/* Appends a text as a word, or as missing where it is empty. */
fg_status fg_column_push_as_word(fg_context *ctx, fg_column *column, size_t row, const char *text,
                                 size_t length);

/* As fg_table_parse, all cells as words (fg_table_load_words). */
fg_status fg_table_parse_words(fg_context *ctx, const char *source, const char *text, size_t size,
                               fg_table *table);

/* Sets `uncertainty` of columns with ambiguous decimal marks. Call it once all rows are read: it
 * compares all columns. */
fg_status fg_table_warn_decimals(fg_context *ctx, fg_table *table, unsigned char separator);

#endif
