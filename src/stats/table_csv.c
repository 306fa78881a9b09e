/* SPDX-License-Identifier: GPL-3.0-or-later */
/* CSV text in and out. libcsv splits the cells; this file assigns them rows, columns and lines. */
#include <csv.h>
#include <stdlib.h>
#include <string.h>

#include "core/csv.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/table.h"
#include "stats/column.h"

typedef struct csv_reader {
  fg_context *ctx;
  fg_table *table;
  const char *source;
  fg_status status;
  size_t line;   /* of the text, being fed */
  size_t column; /* of the next cell */
  bool header;   /* the header is complete */
  bool empty;    /* all cells of this row so far are empty */
  bool words;    /* no cell is a number */
  unsigned char separator;
  char **pending; /* cells of the row, stored until one of them is not empty */
  size_t *pending_length;
  size_t pending_capacity, pending_length_capacity;
} csv_reader;

static fg_status add_name(csv_reader *r, const char *text, size_t length) {
  fg_column *column = NULL;
  char name[256];
  if (memchr(text, 0, length))
    return fg_fail(r->ctx, FG_ERR_DATA, "%s: line %zu: a NUL byte in the header", r->source,
                   r->line);
  if (length >= sizeof name)
    return fg_fail(r->ctx, FG_ERR_DATA, "%s: the name of column %zu is longer than 255 bytes",
                   r->source, r->table->columns + 1);
  if (length == 0)
    return fg_fail(r->ctx, FG_ERR_DATA, "%s: column %zu has no name in the header; name it",
                   r->source, r->table->columns + 1);
  fg_text_clip(name, sizeof name, "%.*s", (int)length, text);
  size_t other = fg_column_find(r->table, name);
  if (other < r->table->columns)
    return fg_fail(r->ctx, FG_ERR_DATA, "%s: columns %zu and %zu are both called '%s'; rename one",
                   r->source, other + 1, r->table->columns + 1, name);
  return fg_column_open(r->ctx, r->table, name, &column);
}

static fg_status hold_cell(csv_reader *r, const char *text, size_t length) {
  if (length && memchr(text, 0, length))
    return fg_fail(r->ctx, FG_ERR_DATA, "%s: row %zu (line %zu): a NUL byte; is this a CSV file?",
                   r->source, r->table->rows + 1, r->line);
  size_t old = r->pending_capacity;
  FG_TRY(fg_memory_reserve(r->ctx, r->column + 1, sizeof *r->pending, &r->pending_capacity,
                           (void **)&r->pending));
  for (size_t i = old; i < r->pending_capacity; i++)
    r->pending[i] = NULL;
  FG_TRY(fg_memory_reserve(r->ctx, r->column + 1, sizeof *r->pending_length,
                           &r->pending_length_capacity, (void **)&r->pending_length));
  char *moved = realloc(r->pending[r->column], length + 1);
  if (!moved) return fg_fail(r->ctx, FG_ERR_MEMORY, "out of memory: %zu bytes", length + 1);
  if (length) memcpy(moved, text, length);
  moved[length] = 0;
  r->pending[r->column] = moved;
  r->pending_length[r->column] = length;
  if (length) r->empty = false;
  r->column++;
  return FG_OK;
}

/* Returns true for text that can come before a decimal comma (a sign, digits) or after it (digits,
 * an exponent). */
static bool is_comma_part(const char *text, bool before) {
  if (before) text += *text == '-' || *text == '+';
  size_t digits = strspn(text, "0123456789");
  if (!digits || before) return digits && !text[digits];
  text += digits;
  if (*text == 'e' || *text == 'E') {
    text++;
    text += *text == '-' || *text == '+';
    text += strspn(text, "0123456789");
  }
  return !*text;
}

/* Returns true when the row's surplus of cells is explained by decimal commas between commas. */
static bool commas_in_numbers(const csv_reader *r) {
  if (r->separator != ',' || r->column <= r->table->columns) return false;
  size_t pairs = 0;
  for (size_t i = 0; i + 1 < r->column; i++)
    if (is_comma_part(r->pending[i], true) && is_comma_part(r->pending[i + 1], false)) {
      pairs++;
      i++;
    }
  return pairs >= r->column - r->table->columns;
}

static const char *what_to_do(const csv_reader *r) {
  if (commas_in_numbers(r)) return "; decimal commas? Then separate the cells by semicolons";
  if (r->table->columns == 1) return "; is a title above it? The first row must name the columns";
  return "";
}

static fg_status push_cell_text(const csv_reader *r, fg_column *column, const char *text,
                                size_t length) {
  size_t row = r->table->rows;
  return r->words ? fg_column_push_as_word(r->ctx, column, row, text, length)
                  : fg_column_push_text(r->ctx, column, row, text, length, r->separator != ',');
}

static fg_status end_row(csv_reader *r) {
  fg_table *table = r->table;
  if (r->empty) return FG_OK;
  if (r->column != table->columns)
    return fg_fail(r->ctx, FG_ERR_DATA,
                   "%s: row %zu (line %zu) has %zu cells, the header names %zu columns%s",
                   r->source, table->rows + 1, r->line, r->column, table->columns, what_to_do(r));
  for (size_t i = 0; i < table->columns; i++)
    FG_TRY(push_cell_text(r, &table->column[i], r->pending[i], r->pending_length[i]));
  FG_TRY(fg_memory_reserve(r->ctx, table->rows + 1, sizeof *table->line, &table->line_capacity,
                           (void **)&table->line));
  table->line[table->rows++] = r->line;
  return FG_OK;
}

static void on_cell(void *text, size_t length, void *reader) {
  csv_reader *r = reader;
  if (r->status != FG_OK) return;
  const char *cell = text ? text : "";
  fg_csv_drop_apostrophe(&cell, &length);
  r->status = r->header ? hold_cell(r, cell, length) : add_name(r, cell, length);
}

static void on_row(int terminator, void *reader) {
  csv_reader *r = reader;
  (void)terminator;
  if (r->status != FG_OK) return;
  if (r->header) r->status = end_row(r);
  r->header = true;
  r->column = 0;
  r->empty = true;
}

static fg_status fail_syntax(csv_reader *r) {
  return fg_fail(r->ctx, FG_ERR_DATA,
                 "%s: line %zu: a quote that is not closed, or stands inside a cell; "
                 "write \"...\" around the cell and \"\" for a quote",
                 r->source, r->line);
}

/* Feeds line by line, so that an error can name the line: libcsv keeps its state between the calls.
 */
static fg_status feed_lines(csv_reader *r, struct csv_parser *parser, const char *text,
                            size_t size) {
  while (size && r->status == FG_OK) {
    const char *newline = memchr(text, '\n', size);
    size_t length = newline ? (size_t)(newline - text) + 1 : size;
    r->line++;
    if (csv_parse(parser, text, length, on_cell, on_row, r) != length && r->status == FG_OK)
      return fail_syntax(r);
    text += length;
    size -= length;
  }
  if (r->status == FG_OK && csv_fini(parser, on_cell, on_row, r) != 0) return fail_syntax(r);
  return r->status;
}

static fg_status check_encoding(fg_context *ctx, const char *source, const char **text,
                                size_t *size) {
  const unsigned char *b = (const unsigned char *)*text;
  if (*size >= 2 && ((b[0] == 0xff && b[1] == 0xfe) || (b[0] == 0xfe && b[1] == 0xff)))
    return fg_fail(ctx, FG_ERR_DATA, "%s: the text is UTF-16; save it as UTF-8", source);
  if (*size >= 3 && b[0] == 0xef && b[1] == 0xbb && b[2] == 0xbf) {
    *text += 3;
    *size -= 3;
  }
  return FG_OK;
}

static fg_status parse_cells(fg_context *ctx, const char *source, const char *text, size_t size,
                             bool words, fg_table *table) {
  fg_status status = FG_OK;
  struct csv_parser parser;
  csv_reader reader = {.ctx = ctx, .table = table, .source = source, .empty = true, .words = words};
  *table = (fg_table){0};
  FG_TRY(check_encoding(ctx, source, &text, &size));
  size_t hint = fg_csv_hint(text, size, &reader.separator);
  if (hint) {
    text += hint;
    size -= hint;
    reader.line = 1;
  } else {
    reader.separator = fg_csv_separator(text, size);
  }
  if (csv_init(&parser, CSV_STRICT | CSV_STRICT_FINI) != 0)
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory");
  csv_set_delim(&parser, reader.separator);
  FG_TRY_EXIT(fg_text_print(ctx, &table->source, "%s", source));
  FG_TRY_EXIT(feed_lines(&reader, &parser, text, size));
  if (!reader.header)
    FG_TRY_EXIT(fg_fail(ctx, FG_ERR_DATA, "%s: empty; the first row must name columns", source));
  if (!table->rows) FG_TRY_EXIT(fg_fail(ctx, FG_ERR_DATA, "%s: a header, but no rows", source));
  FG_TRY_EXIT(fg_table_warn_decimals(ctx, table, reader.separator));
exit:
  csv_free(&parser);
  for (size_t i = 0; i < reader.pending_capacity; i++)
    free(reader.pending[i]);
  free(reader.pending);
  free(reader.pending_length);
  if (status != FG_OK) fg_table_free(table);
  return status;
}

fg_status fg_table_parse(fg_context *ctx, const char *source, const char *text, size_t size,
                         fg_table *table) {
  return parse_cells(ctx, source, text, size, false, table);
}

fg_status fg_table_parse_words(fg_context *ctx, const char *source, const char *text, size_t size,
                               fg_table *table) {
  return parse_cells(ctx, source, text, size, true, table);
}

/* Text under construction. */
typedef struct writer {
  char *text;
  size_t length, capacity;
} writer;

static fg_status write_bytes(fg_context *ctx, writer *w, const char *bytes, size_t length) {
  FG_TRY(fg_memory_reserve(ctx, w->length + length + 1, 1, &w->capacity, (void **)&w->text));
  memcpy(w->text + w->length, bytes, length);
  w->length += length;
  w->text[w->length] = 0;
  return FG_OK;
}

static fg_status write_word(fg_context *ctx, writer *w, const char *word) {
  bool quoted = fg_csv_needs_quotes(word);
  if (quoted) FG_TRY(write_bytes(ctx, w, "\"", 1));
  if (fg_csv_needs_apostrophe(word)) FG_TRY(write_bytes(ctx, w, "'", 1));
  for (; *word; word++) {
    if (*word == '"') FG_TRY(write_bytes(ctx, w, "\"", 1));
    FG_TRY(write_bytes(ctx, w, word, 1));
  }
  return quoted ? write_bytes(ctx, w, "\"", 1) : FG_OK;
}

/* The fewest digits that read back as the same double. */
static fg_status write_number(fg_context *ctx, writer *w, double number) {
  char text[40];
  for (int digits = 15; digits <= 17; digits++) {
    fg_text_clip(text, sizeof text, "%.*g", digits, number);
    if (strtod(text, NULL) == number) break;
  }
  return write_bytes(ctx, w, text, strlen(text));
}

static fg_status write_csv_cell(fg_context *ctx, writer *w, const fg_column *column, size_t row) {
  size_t mark = column->word ? column->word[row] : FG_TABLE_NOT_A_WORD;
  if (mark == FG_TABLE_MISSING) return FG_OK;
  if (mark == FG_TABLE_NOT_A_WORD) return write_number(ctx, w, column->number[row].value);
  return write_word(ctx, w, column->words[mark]);
}

fg_status fg_table_format(fg_context *ctx, const fg_table *table, char **text) {
  fg_status status = FG_OK;
  writer w = {0};
  FG_TRY_EXIT(write_bytes(ctx, &w, "", 0));
  for (size_t i = 0; i < table->columns; i++) {
    if (i) FG_TRY_EXIT(write_bytes(ctx, &w, ",", 1));
    FG_TRY_EXIT(write_word(ctx, &w, table->column[i].name));
  }
  FG_TRY_EXIT(write_bytes(ctx, &w, "\n", 1));
  for (size_t row = 0; row < table->rows; row++) {
    for (size_t i = 0; i < table->columns; i++) {
      if (i) FG_TRY_EXIT(write_bytes(ctx, &w, ",", 1));
      FG_TRY_EXIT(write_csv_cell(ctx, &w, &table->column[i], row));
    }
    FG_TRY_EXIT(write_bytes(ctx, &w, "\n", 1));
  }
exit:
  if (status != FG_OK) {
    free(w.text);
    w.text = NULL;
  }
  *text = w.text;
  return status;
}
