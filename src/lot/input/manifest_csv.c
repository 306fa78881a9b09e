/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Manifests as CSV: RFC 4180; the first row names the columns. */
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <csv.h>

#include "core/csv.h"
#include "core/memory.h"
#include "core/text.h"
#include "lot/input/manifest.h"

/* Limit of the columns: every line of the reports repeats them. */
enum { COLUMNS_MAX = 1000 };

typedef struct csv_reader {
  fg_context *ctx;
  fg_manifest *manifest;
  const char *source, *folder;
  size_t *column; /* column of the manifest by column of the file */
  size_t columns, capacity, cell, row, scan;
  unsigned char separator;
  char **cells; /* cells of the current row; NULL before the first */
  bool named, filled;
  fg_status status;
} csv_reader;

static fg_status add_heading(csv_reader *r, const char *text, size_t length) {
  size_t column;
  FG_TRY(fg_manifest_add_column(r->ctx, r->manifest, text, length, &column));
  FG_TRY(fg_memory_reserve(r->ctx, r->columns + 1, sizeof *r->column, &r->capacity,
                           (void **)&r->column));
  for (size_t i = 0; i < r->columns; i++)
    if (r->column[i] == column)
      return fg_fail(r->ctx, FG_ERR_DATA, "%s: the column '%.*s' is there twice", r->source,
                     (int)length, text);
  r->column[r->columns++] = column;
  return FG_OK;
}

static fg_status accept_cell(csv_reader *r, const char *text, size_t length) {
  fg_csv_drop_apostrophe(&text, &length);
  if (!r->named && r->columns == COLUMNS_MAX)
    return fg_fail(r->ctx, FG_ERR_DATA,
                   "%s: more than %d columns, which every line of the reports would repeat; keep "
                   "those that say which foil it is",
                   r->source, COLUMNS_MAX);
  if (!r->named) return add_heading(r, text, length);
  if (r->cell >= r->columns && length)
    return fg_fail(r->ctx, FG_ERR_DATA, "%s: row %zu has more cells than the heading (%zu)%s",
                   r->source, r->row + 1, r->columns,
                   r->separator == ',' ? "; decimal commas? Then separate the cells by semicolons"
                                       : "");
  if (r->cell >= r->columns) return FG_OK;
  if (!r->cells) FG_TRY(fg_manifest_add_item(r->ctx, r->manifest, &r->cells));
  size_t column = r->column[r->cell++];
  r->filled = r->filled || length;
  if (column == 0 && length && text[0] != '/' && *r->folder)
    return fg_text_print(r->ctx, &r->cells[0], "%s/%.*s", r->folder, (int)length, text);
  return fg_manifest_copy_text(r->ctx, text, length, &r->cells[column]);
}

static fg_status end_heading(csv_reader *r) {
  r->named = true;
  for (size_t i = 0; i < r->columns; i++)
    if (r->column[i] == 0) return FG_OK;
  return fg_fail(r->ctx, FG_ERR_DATA, "%s: no column `scan`; the first row must name the columns",
                 r->source);
}

static fg_status end_manifest_row(csv_reader *r) {
  if (!r->named) return r->columns ? end_heading(r) : FG_OK;
  char **cells = r->cells;
  bool filled = r->filled;
  r->row++;
  r->cells = NULL;
  r->cell = 0;
  r->filled = false;
  if (!cells) return FG_OK;
  if (!filled) { /* a line of commas */
    for (size_t i = 0; i < r->manifest->columns; i++)
      free(cells[i]);
    r->manifest->items--;
    return FG_OK;
  }
  if (cells[0] && cells[0][0]) return FG_OK;
  return fg_fail(r->ctx, FG_ERR_DATA, "%s: row %zu names no scan", r->source, r->row);
}

static void on_cell(void *text, size_t length, void *user) {
  csv_reader *r = user;
  if (r->status == FG_OK) r->status = accept_cell(r, text, length);
}

static void on_row(int end, void *user) {
  csv_reader *r = user;
  (void)end;
  if (r->status == FG_OK) r->status = end_manifest_row(r);
}

/* Returns true when the column's new cells are numbers, and one of them has a decimal comma. */
static bool has_decimal_commas(const fg_manifest *manifest, size_t from, size_t column) {
  bool commas = false;
  for (size_t i = from; i < manifest->items; i++) {
    const char *cell = fg_manifest_cell(manifest, i, column);
    fg_csv_number kind = fg_csv_number_kind(cell, strlen(cell));
    if (*cell && kind != FG_CSV_WHOLE && kind != FG_CSV_COMMA) return false;
    commas = commas || kind == FG_CSV_COMMA;
  }
  return commas;
}

/* A lot writes its tables with commas between the cells, so numbers get decimal points. */
static void write_decimal_points(fg_manifest *manifest, size_t from) {
  for (size_t column = 1; column < manifest->columns; column++) {
    if (!has_decimal_commas(manifest, from, column)) continue;
    for (size_t i = from; i < manifest->items; i++) {
      char *cell = manifest->cell[i * manifest->columns + column];
      char *comma = cell ? strchr(cell, ',') : NULL;
      if (comma) *comma = '.';
    }
  }
}

static fg_status parse_rows(csv_reader *r, const char *text) {
  struct csv_parser parser;
  size_t from = r->manifest->items, size = strlen(text);
  unsigned char separator = fg_csv_separator(text, size);
  size_t hint = fg_csv_hint(text, size, &separator);
  text += hint;
  size -= hint;
  if (csv_init(&parser, CSV_STRICT | CSV_STRICT_FINI) != 0)
    return fg_fail(r->ctx, FG_ERR_MEMORY, "out of memory: a CSV reader");
  csv_set_delim(&parser, separator);
  r->separator = separator;
  bool broken = csv_parse(&parser, text, size, on_cell, on_row, r) != size;
  broken = csv_fini(&parser, on_cell, on_row, r) != 0 || broken;
  csv_free(&parser);
  if (r->status == FG_OK && broken)
    return fg_fail(r->ctx, FG_ERR_DATA, "%s: a quote is not closed, near row %zu", r->source,
                   r->row + 1);
  if (r->status == FG_OK && !r->named)
    return fg_fail(r->ctx, FG_ERR_DATA, "%s: empty; the first row must name the columns",
                   r->source);
  if (r->status == FG_OK && separator != ',') write_decimal_points(r->manifest, from);
  return r->status;
}

fg_status fg_manifest_parse(fg_context *ctx, const char *source, const char *text,
                            const char *folder, fg_manifest *manifest) {
  csv_reader reader = {.ctx = ctx, .manifest = manifest, .source = source, .folder = folder};
  if (!strncmp(text, "\xEF\xBB\xBF", 3)) text += 3;
  fg_status status = fg_manifest_start(ctx, manifest);
  if (status == FG_OK) status = parse_rows(&reader, text);
  free(reader.column);
  return status;
}
