/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of runs: named columns of numbers or words, read from CSV text.
 *
 * Numbers keep the digits of their decimal text: 0.1 is the double nearest to 0.1 plus its
 * remainder. Regression needs both (see regression.h); other users read `.value`.
 *
 * A cell is a number, a word, or missing (empty, NA, NaN, inf). The type of a column is decided by
 * its user: a column of words is a factor; a column of numbers with a word in it is most likely a
 * typing error, so FG_ERR_DATA names row and column, unless the formula says factor(name). A column
 * of ambiguous numbers is an error, too: decimal commas beside decimal points, separators of
 * thousands.
 */
#ifndef FOILGAUGE_TABLE_H
#define FOILGAUGE_TABLE_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* value + tail, |tail| <= half a unit in the last place of value: some 31 decimal digits. */
typedef struct fg_extended {
  double value;
  double tail;
} fg_extended;

#define FG_TABLE_NOT_A_WORD ((size_t)-1) /* in fg_column.word: the cell is a number */
#define FG_TABLE_MISSING    ((size_t)-2) /* the cell is empty, NA, NaN or inf */

/* One column. All pointers belong to the table. */
typedef struct fg_column {
  char *name;
  fg_extended *number; /* rows; 0 where the cell is not a number */
  size_t *word;        /* rows, or NULL when every cell is a number: index into words[], or one of
                          the two marks above */
  char **words;        /* the distinct words, in order of appearance */
  size_t word_count;
  size_t number_count;         /* cells that are numbers */
  size_t missing_count;        /* cells that are missing */
  size_t point_row, comma_row; /* from 1, the first number with a decimal point, and with a comma;
                                  0: none */
  bool comma_proven;           /* a decimal comma that cannot separate thousands: 0,5 */
  char *uncertainty; /* reason, with the place, why its numbers are ambiguous; NULL: they are not */
  size_t capacity, word_capacity, mark_capacity;
  size_t *slot; /* hash of words[]: index + 1, 0 where free */
  size_t slot_count;
} fg_column;

typedef struct fg_table {
  char *source; /* the file's name, for messages */
  size_t rows, columns;
  fg_column *column;
  size_t *line; /* rows, or NULL: line of the text where the row ends */
  size_t column_capacity, line_capacity;
  size_t *name_slot; /* hash of the columns' names: number + 1, 0 free; 0 of them: not made yet */
  size_t name_slots;
} fg_table;

/* Reads CSV (RFC 4180; LF, CRLF or CR; UTF-8 with or without a byte order mark; comma, semicolon
 * or tab: fg_csv_separator). Between semicolons and tabs a comma may be the decimal mark, in all
 * columns alike. The first row names the columns. Blank rows and rows
 * whose cells are all empty are left out. FG_ERR_DATA names row (first data row = 1), line and
 * column: no header, no rows, duplicate or empty names, too few or too many cells, an open
 * quote, a NUL byte, UTF-16. `source` is the file's name for messages. Free with fg_table_free. */
fg_status fg_table_parse(fg_context *ctx, const char *source, const char *text, size_t size,
                         fg_table *table);

/* Loads the table of a file ("-": standard input) of at most 1 GiB, and the SHA-256 of its bytes in
 * hexadecimal. FG_ERR_IO, and as fg_table_parse. */
fg_status fg_table_load(fg_context *ctx, const char *path, fg_table *table, char sha256[65]);

/* As fg_table_load, of names and numbers of things: every cell is a word as it is written (000471,
 * 1e3, NA), without the spaces around it; an empty one is missing. */
fg_status fg_table_load_words(fg_context *ctx, const char *path, fg_table *table, char sha256[65]);

/* Builds a table in memory: start from {0}, add columns of equal length. FG_ERR_USAGE for an
 * existing name or another number of rows. Values that are not finite count as missing. */
fg_status fg_table_add_numbers(fg_context *ctx, fg_table *table, const char *name,
                               const double *values, size_t rows);
fg_status fg_table_add_extended(fg_context *ctx, fg_table *table, const char *name,
                                const fg_extended *values, size_t rows);
fg_status fg_table_add_words(fg_context *ctx, fg_table *table, const char *name,
                             const char *const *words, size_t rows);

/* Finds a column; FG_ERR_DATA lists the columns of the table. */
fg_status fg_table_find(fg_context *ctx, const fg_table *table, const char *name,
                        const fg_column **column);

/* FG_ERR_DATA, with row, line and what to do, for words among the column's numbers and for numbers
 * that are in doubt. Missing cells are neither. */
fg_status fg_table_check(fg_context *ctx, const fg_table *table, const char *name);

/* The column as numbers: FG_ERR_DATA with the row of the first cell that is missing or a word. */
fg_status fg_table_numbers(fg_context *ctx, const fg_table *table, const char *name,
                           const fg_extended **numbers);

/* The column as a factor: levels in order (numbers ascending, words by byte value, as R in the C
 * locale), and for every row the index of its level. The caller frees both with
 * fg_levels_free. FG_ERR_DATA for missing cells; for what fg_table_check refuses unless `forced`.
 */
typedef struct fg_levels {
  size_t count, rows;
  char **name;   /* count */
  size_t *index; /* rows */
} fg_levels;
fg_status fg_table_levels(fg_context *ctx, const fg_table *table, const char *name, bool forced,
                          fg_levels *levels);
void fg_levels_free(fg_levels *levels);

/* Takes a column out. FG_ERR_DATA with the names that there are. */
fg_status fg_table_drop(fg_context *ctx, fg_table *table, const char *name);

/* Makes words that count numbers: dates (2024-05-31, 31.05.2024, 31-May-2024, those of the whole
 * column that tell day from month in 5/31/2024; a time of day behind them or not) become days since
 * the earliest of their column; more than `most` different words that differ in the digits at their
 * end only (F001, F002 ...) these digits. `said` (appended to; may be NULL at first) tells which
 * columns and how; the caller frees it. */
fg_status fg_table_count_words(fg_context *ctx, fg_table *table, size_t max, char **said);

/* A copy that may be changed. */
fg_status fg_table_copy(fg_context *ctx, const fg_table *table, fg_table *copy);

/* A deep copy of the rows listed, in that order. FG_ERR_USAGE for a row that is not there. */
fg_status fg_table_select(fg_context *ctx, const fg_table *table, const size_t *rows, size_t count,
                          fg_table *selection);

/* The table as CSV text (LF, quotes where needed, 17 significant digits at most). Caller frees. */
fg_status fg_table_format(fg_context *ctx, const fg_table *table, char **text);

void fg_table_free(fg_table *table);

#ifdef __cplusplus
}
#endif
#endif
