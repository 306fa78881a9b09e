/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A lot in memory and its folder. */
#ifndef FG_LOT_RUN_LOT_H
#define FG_LOT_RUN_LOT_H

#include "foilgauge/lot.h"
#include "foilgauge/scan_loop.h"
#include "lot/input/manifest.h"
#include "lot/run/journal.h"

/* Name of the scanner's model in the lot's folder. */
#define FG_LOT_MODEL_FILE "scanner_model.json"
enum { FG_LOT_MODEL_BYTES_MAX = 1 << 20 };

/* Lot in memory; records are in the manifest's order. */
typedef struct fg_lot {
  fg_lot_settings settings;
  fg_nominal nominal;
  fg_manifest manifest;
  fg_journal_head head;
  fg_record *records;      /* one for each item of the manifest */
  fg_scanner_model *model; /* model of the scanner that corrected every scan; NULL: none */
  bool decimal_comma;      /* tables of the report have decimal commas */
  unsigned threads;        /* that read records and write the report; 0: as many as cores */
} fg_lot;

/* Reads folder/results.jsonl and the copy of the scanner's model into `lot`, which has its settings
 * and manifest already and owns them from then on. A lot that has its records and head, as they
 * were read from the file, keeps them. */
fg_status fg_lot_load(fg_context *ctx, const char *folder, fg_lot *lot);
void fg_lot_free(fg_lot *lot);

/* Marks repeats: of scans with the same bytes the first counts, and the others become scans that
 * were not measured, with that reason. fg_lot_load calls it. */
fg_status fg_lot_mark_repeats(fg_context *ctx, fg_lot *lot);
/* Finds repeated scans; `first` has the reason that its record states. */
fg_lot_finding fg_lot_find_repeats(const fg_lot *lot);

/* Removes the report of an earlier run: it must not lie beside other results. */
fg_status fg_lot_remove_report(fg_context *ctx, const char *folder);

/* Sets *path to folder/name; the caller frees it. */
fg_status fg_lot_path(fg_context *ctx, const char *folder, const char *name, char **path);

/* SHA-256 of the settings that scans are measured with. */
fg_status fg_lot_sum_settings(fg_context *ctx, const fg_lot_settings *settings, char sum[65]);

/* Writes a text to folder/name; the file appears once it is whole. */
fg_status fg_lot_write_text(fg_context *ctx, const char *folder, const char *name,
                            const char *text);
/* Writes the model's copy; NULL removes the copy of an earlier run. */
fg_status fg_lot_write_model(fg_context *ctx, const char *folder, const char *text);

#endif
