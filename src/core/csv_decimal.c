/* SPDX-License-Identifier: GPL-3.0-or-later */
/* CSV for spreadsheets whose decimal mark is a comma. Finished CSV is converted, so that its
 * writers do not depend on it. */
#include <stdlib.h>
#include <string.h>

#include "core/csv.h"
#include "core/file.h"
#include "core/memory.h"
#include "foilgauge/file.h"

/* Length of the cell at `text`. A quoted cell ends after a quote that no other follows. */
static size_t cell_length(const char *text, const char *end) {
  const char *at = text;
  bool quoted = at < end && *at == '"';
  if (!quoted) {
    while (at < end && *at != ',' && *at != '\n' && *at != '\r')
      at++;
    return (size_t)(at - text);
  }
  for (at++; at < end; at++) {
    if (*at != '"') continue;
    if (at + 1 == end || at[1] != '"') return (size_t)(at + 1 - text);
    at++;
  }
  return (size_t)(end - text);
}

/* Writes a cell with its quotes: the writer has quoted semicolons as well (fg_csv_needs_quotes). */
static void write_decimal_cell(FILE *out, const char *cell, size_t length) {
  const char *point = memchr(cell, '.', length);
  if (!point || fg_csv_number_kind(cell, length) != FG_CSV_POINT) {
    fwrite(cell, 1, length, out);
    return;
  }
  fwrite(cell, 1, (size_t)(point - cell), out);
  fputc(',', out);
  fwrite(point + 1, 1, length - (size_t)(point - cell) - 1, out);
}

static void convert_csv(const char *text, size_t size, FILE *out) {
  const char *end = text + size;
  fputs("\xef\xbb\xbf", out);
  while (text < end) {
    size_t length = cell_length(text, end);
    write_decimal_cell(out, text, length);
    text += length;
    if (text < end) fputc(*text == ',' ? ';' : *text, out);
    text++;
  }
}

fg_status fg_csv_write(fg_context *ctx, bool decimal_comma, fg_csv_writer *write, void *user,
                       FILE *out) {
  char *text = NULL;
  size_t size = 0;
  if (!decimal_comma) return write(ctx, user, out);
  FILE *memory = fg_stream_open(&text, &size);
  if (!memory) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory");
  fg_status status = write(ctx, user, memory);
  if (!fg_stream_keep(memory, &text) && status == FG_OK)
    status = fg_fail(ctx, FG_ERR_MEMORY, "out of memory");
  if (status == FG_OK) convert_csv(text, size, out);
  free(text);
  return status == FG_OK ? fg_stream_finish(ctx, out, "the table") : status;
}
