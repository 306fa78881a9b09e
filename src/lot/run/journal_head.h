/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The first line of a journal, and the errors of its files. */
#ifndef FG_LOT_RUN_JOURNAL_HEAD_H
#define FG_LOT_RUN_JOURNAL_HEAD_H

#include <stdio.h>

#include "foilgauge/lot.h"

/* First line: identifies the lot that the records belong to. */
typedef struct fg_journal_head {
  char version[32];
  fg_lot_shard shard;
  size_t items; /* of the manifest */
  char manifest_sha256[65], recipe_sha256[65], measured_with[65];
} fg_journal_head;

/* *length: of the line with its newline. */
fg_status fg_journal_write_head(fg_context *ctx, FILE *out, const fg_journal_head *head,
                                size_t *length);

typedef enum fg_head_state { FG_HEAD_GOOD, FG_HEAD_EARLIER, FG_HEAD_DAMAGED } fg_head_state;

fg_status fg_journal_parse_head(fg_context *ctx, const char *line, fg_journal_head *head,
                                fg_head_state *state);
/* Says why a journal cannot be read. */
fg_status fg_journal_fail_head(fg_context *ctx, const char *path, fg_head_state state);

/* By errno: "PATH: cannot be WHAT: why". */
fg_status fg_journal_fail(fg_context *ctx, const char *path, const char *what);

#endif
