/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scans of a lot in their order, with the columns that came with them. */
#ifndef FG_LOT_INPUT_MANIFEST_H
#define FG_LOT_INPUT_MANIFEST_H

#include <stddef.h>

#include "foilgauge/lot.h"

#define FG_NO_COLUMN ((size_t)-1)

typedef struct fg_manifest {
  char **name; /* names of the columns; name[0] is "scan" */
  size_t columns;
  char **cell; /* cells, items × columns, row by row; "" where a row has none */
  size_t items;
  fg_lot_finding named_again;          /* scans that were named again and left out */
  fg_lot_finding empty_folders;        /* whose name ends as a scan's does */
  size_t name_capacity, cell_capacity; /* private */
} fg_manifest;

/* Collects folders (every file below them that has the name of a scan, sorted by the names' bytes),
 * scans, lists and manifests; see fg_lot_request. A scan that is named twice, under any spelling of
 * its path, counts once. FG_ERR_DATA: its columns differ, or there is no scan at all. `leave_out`
 * is a folder that is not searched (that of the results). `own` is the path that an earlier run has
 * written: its scans count from where they counted then. NULL: none. */
fg_status fg_manifest_collect(fg_context *ctx, const char *const *paths, size_t count,
                              const char *leave_out, const char *own, fg_manifest *manifest);

/* Parses the text of a manifest. Relative scans count from `folder`; "" leaves them as they are. */
fg_status fg_manifest_parse(fg_context *ctx, const char *source, const char *text,
                            const char *folder, fg_manifest *manifest);

/* Formats the manifest as CSV that parses to the same manifest. The caller frees the text. */
fg_status fg_manifest_format(fg_context *ctx, const fg_manifest *manifest, char **text);

const char *fg_manifest_cell(const fg_manifest *manifest, size_t item, size_t column);
const char *fg_manifest_scan(const fg_manifest *manifest, size_t item);

/* Label of an item for people: the column `foil` where there is one, else the scan's file name. */
const char *fg_manifest_label(const fg_manifest *manifest, size_t item);

/* Returns FG_NO_COLUMN when no column has the name, or when the name is "". */
size_t fg_manifest_column(const fg_manifest *manifest, const char *name);

/* Index of the items by path. */
typedef struct fg_manifest_index {
  size_t *slot; /* item + 1; 0 free */
  size_t slots;
} fg_manifest_index;

fg_status fg_manifest_index_build(fg_context *ctx, const fg_manifest *manifest,
                                  fg_manifest_index *index);
/* Returns the item of the scan, or manifest->items. */
size_t fg_manifest_index_find(const fg_manifest_index *index, const fg_manifest *manifest,
                              const char *scan);
void fg_manifest_index_free(fg_manifest_index *index);

void fg_manifest_free(fg_manifest *manifest);

/* Functions that grow a manifest while it is read. */

fg_status fg_manifest_copy_text(fg_context *ctx, const char *text, size_t length, char **copy);

/* Finds the column of that name or adds it. FG_ERR_USAGE: it is new, and there are rows already. */
fg_status fg_manifest_add_column(fg_context *ctx, fg_manifest *manifest, const char *name,
                                 size_t length, size_t *column);

/* Adds the column `scan` where it is missing. */
fg_status fg_manifest_start(fg_context *ctx, fg_manifest *manifest);

/* Adds a row of empty cells. */
fg_status fg_manifest_add_item(fg_context *ctx, fg_manifest *manifest, char ***row);

/* Adds a row of one scan. A relative one counts from `folder`; "" leaves it as it is. */
fg_status fg_manifest_add_scan(fg_context *ctx, fg_manifest *manifest, const char *folder,
                               const char *scan);

#endif
