/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ambiguous numbers of a table: decimal commas beside points, thousands separators. */
#include <string.h>

#include "core/csv.h"
#include "core/text.h"
#include "stats/column.h"

static fg_status uncertainty(fg_context *ctx, const fg_table *table, fg_column *column, size_t row,
                             const char *what) {
  if (column->uncertainty) return FG_OK;
  return fg_text_print(ctx, &column->uncertainty, "%s: row %zu (line %zu), column '%s': %s",
                       table->source, row, table->line[row - 1], column->name, what);
}

static size_t first_row(const fg_table *table, const fg_column *column, size_t word) {
  size_t row = 0;
  while (row < table->rows && column->word[row] != word)
    row++;
  return row + 1;
}

/* A word of the column that is no number to people either; NULL: none. */
static const char *true_word(const fg_column *column) {
  for (size_t i = 0; i < column->word_count; i++)
    if (fg_csv_number_kind(column->words[i], strlen(column->words[i])) == FG_CSV_WORD)
      return column->words[i];
  return NULL;
}

/* Warns of words that look like numbers: such a column would be names, or names among numbers. */
static fg_status warn_words(fg_context *ctx, const fg_table *table, fg_column *column,
                            unsigned char separator) {
  char what[500];
  for (size_t i = 0; i < column->word_count; i++) {
    const char *word = column->words[i];
    fg_csv_number kind = fg_csv_number_kind(word, strlen(word));
    if (kind != FG_CSV_COMMA && kind != FG_CSV_THOUSANDS) continue;
    const char *advice =
        kind == FG_CSV_THOUSANDS ? "write the number without separators of thousands"
        : separator == ','
            ? "a decimal comma needs semicolons between the cells; else write a point"
            : "write it with a point";
    const char *other = true_word(column);
    fg_text_clip(what, sizeof what,
                 "'%.80s' is a number to people and a word to a program: %s%s%.80s%s", word, advice,
                 other ? "; and '" : "", other ? other : "",
                 other ? "' in the same column is none" : "");
    return uncertainty(ctx, table, column, first_row(table, column, i), what);
  }
  return FG_OK;
}

/* Finds the first column with a decimal comma; `proven` when a comma anywhere cannot separate
 * thousands. */
static const fg_column *find_comma(const fg_table *table, bool *proven) {
  const fg_column *first = NULL;
  *proven = false;
  for (size_t i = 0; i < table->columns; i++) {
    const fg_column *column = &table->column[i];
    if (!first && column->comma_row) first = column;
    *proven = *proven || column->comma_proven;
  }
  return first;
}

static fg_status warn_points(fg_context *ctx, const fg_table *table, fg_column *column,
                             const fg_column *comma) {
  char what[700];
  const fg_column *other = column->comma_row ? column : comma;
  fg_text_clip(what, sizeof what,
               "a point, but a comma in line %zu, column '%.200s': which is the decimal mark? "
               "Write all numbers alike, and thousands without a separator",
               table->line[other->comma_row - 1], other->name);
  return uncertainty(ctx, table, column, column->point_row, what);
}

fg_status fg_table_warn_decimals(fg_context *ctx, fg_table *table, unsigned char separator) {
  bool proven;
  const fg_column *comma = find_comma(table, &proven);
  for (size_t i = 0; i < table->columns; i++) {
    fg_column *column = &table->column[i];
    FG_TRY(warn_words(ctx, table, column, separator));
    if (comma && column->point_row) FG_TRY(warn_points(ctx, table, column, comma));
    if (separator == '\t' && !proven && column->comma_row)
      FG_TRY(uncertainty(
          ctx, table, column, column->comma_row,
          "a comma with three digits behind it, as in all numbers with one: a decimal mark "
          "or thousands? Separate the cells by semicolons if it is a decimal mark, else "
          "write the numbers without it"));
  }
  return FG_OK;
}
