/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a manifest grows while it is read. */
#ifndef FG_LOT_INPUT_MANIFEST_BUILD_H
#define FG_LOT_INPUT_MANIFEST_BUILD_H

#include "lot/input/manifest.h"

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
