/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scans of a lot in their order, with the columns that came with them. */
#ifndef FG_LOT_INPUT_MANIFEST_H
#define FG_LOT_INPUT_MANIFEST_H

#include <stddef.h>

#include "foilgauge/status.h"

#define FG_NO_COLUMN ((size_t)-1)

typedef struct fg_manifest {
  char **name; /* columns; name[0] is "scan" */
  size_t columns;
  char **cell; /* items × columns, row by row; "" where a row has none */
  size_t items;
  size_t doubles;         /* scans that were named once more, and left out */
  char first_double[512]; /* the first of them, and under which other name it counts */
  size_t empty;           /* folders that are called as a scan is and hold none */
  char first_empty[512];
  size_t name_capacity, cell_capacity; /* private */
} fg_manifest;

/* Folders (every file below them that is called as a scan is, in order of their names' bytes),
 * scans, lists and manifests; see fg_lot_request. A scan that is there twice, under whatever
 * spelling of its path, counts once; FG_ERR_DATA when its columns differ, or for no scan at all.
 * `leave_out` is a folder that is not searched (the results'). `own` is the one of the paths that
 * an earlier run has written, whose scans count from where they did then; NULL: none. */
fg_status fg_manifest_collect(fg_context *ctx, const char *const *paths, size_t count,
                              const char *leave_out, const char *own, fg_manifest *manifest);

/* From the text of a manifest; relative scans count from `folder` ("": they stay as they are). */
fg_status fg_manifest_parse(fg_context *ctx, const char *source, const char *text,
                            const char *folder, fg_manifest *manifest);

/* As CSV text, which parses to the same. The caller frees it. */
fg_status fg_manifest_format(fg_context *ctx, const fg_manifest *manifest, char **text);

const char *fg_manifest_cell(const fg_manifest *manifest, size_t item, size_t column);
const char *fg_manifest_scan(const fg_manifest *manifest, size_t item);

/* What people call it: the column `foil` where there is one, else the scan's file name. */
const char *fg_manifest_label(const fg_manifest *manifest, size_t item);

/* FG_NO_COLUMN when there is none of that name (or the name is ""). */
size_t fg_manifest_column(const fg_manifest *manifest, const char *name);

/* Finds the item of a scan: an index by path. */
typedef struct fg_manifest_index {
  size_t *slot; /* item + 1; 0 free */
  size_t slots;
} fg_manifest_index;

fg_status fg_manifest_index_build(fg_context *ctx, const fg_manifest *manifest,
                                  fg_manifest_index *index);
/* The item, or manifest->items. */
size_t fg_manifest_index_find(const fg_manifest_index *index, const fg_manifest *manifest,
                              const char *scan);
void fg_manifest_index_free(fg_manifest_index *index);

void fg_manifest_free(fg_manifest *manifest);

/* The functions below grow a manifest while it is read. */

fg_status fg_manifest_copy_text(fg_context *ctx, const char *text, size_t length, char **copy);

/* The column of that name, new or known. FG_ERR_USAGE: new, and there are rows already. */
fg_status fg_manifest_add_column(fg_context *ctx, fg_manifest *manifest, const char *name,
                                 size_t length, size_t *column);

/* The column `scan`, where there is none yet. */
fg_status fg_manifest_start(fg_context *ctx, fg_manifest *manifest);

/* A row of empty cells. */
fg_status fg_manifest_add_item(fg_context *ctx, fg_manifest *manifest, char ***row);

/* A row of one scan; a relative one counts from `folder` ("": it stays as it is). */
fg_status fg_manifest_add_scan(fg_context *ctx, fg_manifest *manifest, const char *folder,
                               const char *scan);

#endif
