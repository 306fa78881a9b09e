/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A table from a file, with its sum. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/sha256.h"
#include "foilgauge/table.h"
#include "stats/column.h"

enum { CSV_BYTES_MAX = 1 << 30 };

static bool is_standard(const char *path) {
  return !strcmp(path, "-");
}

/* The whole input, NUL bytes included (the table's reader names their place). */
static fg_status read_all(fg_context *ctx, const char *path, char **text, size_t *size) {
  FILE *in = stdin;
  size_t capacity = 0, got;
  fg_status status = FG_OK;
  *text = NULL;
  *size = 0;
  if (!is_standard(path)) FG_TRY(fg_file_open(ctx, path, &in));
  do {
    FG_TRY_EXIT(fg_memory_reserve(ctx, *size + 65536, 1, &capacity, (void **)text));
    got = fread(*text + *size, 1, capacity - *size, in);
    *size += got;
    if (*size > CSV_BYTES_MAX)
      FG_TRY_EXIT(fg_fail(ctx, FG_ERR_DATA, "%s: more than 1 GiB; is it a table of runs?", path));
  } while (got > 0);
  if (ferror(in)) FG_TRY_EXIT(fg_fail(ctx, FG_ERR_IO, "%s: cannot be read; is it a file?", path));
exit:
  if (in != stdin) fclose(in);
  return status;
}

typedef fg_status parse_table(fg_context *ctx, const char *source, const char *text, size_t size,
                              fg_table *table);

static fg_status load_table(fg_context *ctx, const char *path, parse_table *parse, fg_table *table,
                            char sha256[65]) {
  struct sha256_ctx sum;
  char *text = NULL;
  size_t size = 0;
  fg_status status = read_all(ctx, path, &text, &size);
  if (status == FG_OK) {
    sha256_init(&sum);
    sha256_update(&sum, size, (const uint8_t *)text);
    fg_sha256_finish(&sum, sha256);
    status = parse(ctx, is_standard(path) ? "standard input" : path, text, size, table);
  }
  free(text);
  return status;
}

fg_status fg_table_load(fg_context *ctx, const char *path, fg_table *table, char sha256[65]) {
  return load_table(ctx, path, fg_table_parse, table, sha256);
}

fg_status fg_table_load_words(fg_context *ctx, const char *path, fg_table *table, char sha256[65]) {
  return load_table(ctx, path, fg_table_parse_words, table, sha256);
}
