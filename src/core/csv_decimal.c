/* SPDX-License-Identifier: GPL-3.0-or-later */
/* CSV for spreadsheets whose decimal mark is a comma. Finished CSV is converted, so that its
 * writers do not depend on it. */
#include <stdio_ext.h>
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

/* Stream that converts cells as they become whole, so that a long table needs no memory. */
typedef struct csv_converter {
  FILE *out;
  char *text; /* begin of a cell; owned */
  size_t length, capacity;
  bool failed; /* out of memory */
} csv_converter;

/* A cell is whole when a byte follows it; `last`: at the end of the table. */
static void convert_cells(csv_converter *c, bool last) {
  const char *at = c->text, *end = c->text + c->length;
  while (at < end) {
    size_t length = cell_length(at, end);
    if (at + length == end && !last) break;
    write_decimal_cell(c->out, at, length);
    at += length;
    if (at < end) fputc(*at == ',' ? ';' : *at, c->out);
    at += at < end;
  }
  c->length = (size_t)(end - at);
  if (c->length) memmove(c->text, at, c->length);
}

static ssize_t receive_csv(void *cookie, const char *bytes, size_t count) {
  csv_converter *c = cookie;
  fg_context unused;
  if (c->failed ||
      fg_memory_reserve(&unused, c->length + count, 1, &c->capacity, (void **)&c->text) != FG_OK) {
    c->failed = true;
    return 0;
  }
  memcpy(c->text + c->length, bytes, count);
  c->length += count;
  convert_cells(c, false);
  return (ssize_t)count;
}

fg_status fg_csv_write(fg_context *ctx, bool decimal_comma, fg_csv_writer *write, void *user,
                       FILE *out) {
  csv_converter converter = {.out = out};
  if (!decimal_comma) return write(ctx, user, out);
  FILE *cells = fopencookie(&converter, "w", (cookie_io_functions_t){.write = receive_csv});
  if (!cells) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory");
  __fsetlocking(cells, FSETLOCKING_BYCALLER); /* one thread writes to it */
  fputs("\xef\xbb\xbf", out);
  fg_status status = write(ctx, user, cells);
  fclose(cells);
  if (converter.failed) status = fg_fail(ctx, FG_ERR_MEMORY, "out of memory");
  if (status == FG_OK) convert_cells(&converter, true);
  free(converter.text);
  return status == FG_OK ? fg_stream_finish(ctx, out, "the table") : status;
}
