/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of a manifest: columns, rows, cells. */
#include "lot/input/manifest.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/csv.h"
#include "core/file.h"
#include "core/memory.h"
#include "core/text.h"

fg_status fg_manifest_copy_text(fg_context *ctx, const char *text, size_t length, char **copy) {
  *copy = strndup(text, length);
  return *copy ? FG_OK : fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a manifest");
}

fg_status fg_manifest_add_column(fg_context *ctx, fg_manifest *manifest, const char *name,
                                 size_t length, size_t *column) {
  for (*column = 0; *column < manifest->columns; (*column)++)
    if (strlen(manifest->name[*column]) == length && !memcmp(manifest->name[*column], name, length))
      return FG_OK;
  if (manifest->items)
    return fg_fail(ctx, FG_ERR_USAGE, "a manifest with columns must be the only input");
  FG_TRY(fg_memory_reserve(ctx, manifest->columns + 1, sizeof *manifest->name,
                           &manifest->name_capacity, (void **)&manifest->name));
  FG_TRY(fg_manifest_copy_text(ctx, name, length, &manifest->name[manifest->columns]));
  manifest->columns++;
  return FG_OK;
}

fg_status fg_manifest_start(fg_context *ctx, fg_manifest *manifest) {
  size_t column;
  return manifest->columns ? FG_OK : fg_manifest_add_column(ctx, manifest, "scan", 4, &column);
}

fg_status fg_manifest_add_item(fg_context *ctx, fg_manifest *manifest, char ***row) {
  size_t used = manifest->items * manifest->columns;
  FG_TRY(fg_memory_reserve(ctx, used + manifest->columns, sizeof *manifest->cell,
                           &manifest->cell_capacity, (void **)&manifest->cell));
  *row = manifest->cell + used;
  memset(*row, 0, manifest->columns * sizeof **row);
  manifest->items++;
  return FG_OK;
}

fg_status fg_manifest_add_scan(fg_context *ctx, fg_manifest *manifest, const char *folder,
                               const char *scan) {
  char **row;
  FG_TRY(fg_manifest_start(ctx, manifest));
  FG_TRY(fg_manifest_add_item(ctx, manifest, &row));
  bool relative = *folder && scan[0] != '/';
  return fg_text_print(ctx, &row[0], "%s%s%s", relative ? folder : "", relative ? "/" : "", scan);
}

fg_status fg_manifest_format(fg_context *ctx, const fg_manifest *manifest, char **text) {
  size_t size;
  *text = NULL;
  FILE *out = fg_stream_open(text, &size);
  if (!out) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a manifest");
  for (size_t row = 0; row <= manifest->items; row++)
    for (size_t i = 0; i < manifest->columns; i++) {
      fg_csv_put_text(out, row ? fg_manifest_cell(manifest, row - 1, i) : manifest->name[i], NULL);
      fputc(i + 1 < manifest->columns ? ',' : '\n', out);
    }
  if (fg_stream_keep(out, text)) return FG_OK;
  return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a manifest");
}

const char *fg_manifest_cell(const fg_manifest *manifest, size_t item, size_t column) {
  if (column >= manifest->columns) return "";
  const char *cell = manifest->cell[item * manifest->columns + column];
  return cell ? cell : "";
}

const char *fg_manifest_scan(const fg_manifest *manifest, size_t item) {
  return fg_manifest_cell(manifest, item, 0);
}

const char *fg_manifest_label(const fg_manifest *manifest, size_t item) {
  const char *label = fg_manifest_cell(manifest, item, fg_manifest_column(manifest, "foil"));
  if (*label) return label;
  const char *scan = fg_manifest_scan(manifest, item), *slash = strrchr(scan, '/');
  return slash && slash[1] ? slash + 1 : scan;
}

size_t fg_manifest_column(const fg_manifest *manifest, const char *name) {
  for (size_t i = 0; *name && i < manifest->columns; i++)
    if (!strcmp(manifest->name[i], name)) return i;
  return FG_NO_COLUMN;
}

void fg_manifest_free(fg_manifest *manifest) {
  for (size_t i = 0; i < manifest->columns; i++)
    free(manifest->name[i]);
  for (size_t i = 0; i < manifest->items * manifest->columns; i++)
    free(manifest->cell[i]);
  free(manifest->name);
  free(manifest->cell);
  *manifest = (fg_manifest){0};
}
