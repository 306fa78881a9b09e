/* SPDX-License-Identifier: GPL-3.0-or-later */
/* From a lot's records to its report. */
#ifndef FG_LOT_RUN_LOT_H
#define FG_LOT_RUN_LOT_H

#include "foilgauge/lot.h"
#include "foilgauge/scan_loop.h"
#include "lot/input/manifest.h"
#include "lot/run/journal.h"

/* The copy of the scanner's model in the lot's folder. */
#define FG_LOT_MODEL_FILE "scanner_model.json"
enum { FG_LOT_MODEL_BYTES_MAX = 1 << 20 };

/* A lot in memory, in the manifest's order. */
typedef struct fg_lot {
  fg_lot_settings settings;
  fg_nominal nominal;
  fg_manifest manifest;
  fg_journal_head head;
  fg_record *records;      /* manifest.items */
  fg_scanner_model *model; /* of the scanner, that corrected every scan; NULL: none */
  bool decimal_comma;      /* of the report's tables */
} fg_lot;

/* Reads folder/results.jsonl and the copy of the scanner's model; settings and manifest are there
 * already (and belong to the lot from then on). */
fg_status fg_lot_load(fg_context *ctx, const char *folder, fg_lot *lot);
void fg_lot_free(fg_lot *lot);

/* Of scans with the same bytes the first counts: the others are scans that were not measured, and
 * their error says why. fg_lot_load does it. */
fg_status fg_lot_mark_repeats(fg_context *ctx, fg_lot *lot);
/* Returns the number of repeated scans; *first is the first of them, or NULL. */
size_t fg_lot_count_repeats(const fg_lot *lot, const fg_record **first);

/* Removes the report of an earlier run: it must not stand beside other results. */
fg_status fg_lot_remove_report(fg_context *ctx, const char *folder);

/* folder/name; the caller frees. */
fg_status fg_lot_path(fg_context *ctx, const char *folder, const char *name, char **path);

/* SHA-256 of the settings that a scan is measured with. */
fg_status fg_lot_sum_settings(fg_context *ctx, const fg_lot_settings *settings, char sum[65]);

/* A whole text under its name. */
fg_status fg_lot_write_text(fg_context *ctx, const char *folder, const char *name,
                            const char *text);
/* The copy of the model; NULL takes one of an earlier run away. */
fg_status fg_lot_write_model(fg_context *ctx, const char *folder, const char *text);

#endif
