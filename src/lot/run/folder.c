/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Folder of a lot: its paths, its checksums, loading it. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/sha256.h"
#include "core/text.h"
#include "lot/run/lot.h"

fg_status fg_lot_path(fg_context *ctx, const char *folder, const char *name, char **path) {
  return fg_text_print(ctx, path, "%s/%s", folder, name);
}

/* Tolerances and statistics come after a measurement, so they are not part of the sum. The names of
 * the quantities are: other quantities put the values in another order. */
fg_status fg_lot_sum_settings(fg_context *ctx, const fg_lot_settings *settings, char sum[65]) {
  fg_lot_settings bare;
  char *text, *names;
  fg_lot_settings_default(&bare);
  bare.design = settings->design;
  bare.design.tolerance_count = 0;
  bare.dpi = settings->dpi;
  bare.allow_lossy = settings->allow_lossy;
  strcpy(bare.model_sha256, settings->model_sha256);
  FG_TRY(fg_record_format_names(ctx, &names));
  fg_status status = fg_lot_settings_format(ctx, &bare, false, &text);
  if (status == FG_OK) status = fg_text_append(ctx, &text, "%s", names);
  if (status == FG_OK) fg_sha256_text(text, sum);
  free(text);
  free(names);
  return status;
}

fg_status fg_lot_write_text(fg_context *ctx, const char *folder, const char *name,
                            const char *text) {
  char *path;
  fg_output output;
  FG_TRY(fg_lot_path(ctx, folder, name, &path));
  fg_status status = fg_output_open(ctx, path, &output);
  free(path);
  FG_TRY(status);
  fputs(text, output.stream);
  return fg_output_commit(ctx, &output);
}

static fg_status remove_lot_file(fg_context *ctx, const char *folder, const char *name) {
  char *path;
  FG_TRY(fg_lot_path(ctx, folder, name, &path));
  bool gone = unlink(path) == 0 || errno == ENOENT;
  fg_status status = gone ? FG_OK
                          : fg_fail(ctx, fg_status_of_errno(errno), "%s: cannot be removed: %s",
                                    path, strerror(errno));
  free(path);
  return status;
}

fg_status fg_lot_write_model(fg_context *ctx, const char *folder, const char *text) {
  return text ? fg_lot_write_text(ctx, folder, FG_LOT_MODEL_FILE, text)
              : remove_lot_file(ctx, folder, FG_LOT_MODEL_FILE);
}

static const char *const report_files[] = {"lot.json",    "index.html", "foils.csv",
                                           "bumps.csv",   "beams.csv",  "bearings.csv",
                                           "results.qif", "results.dfq"};

fg_status fg_lot_remove_report(fg_context *ctx, const char *folder) {
  for (size_t i = 0; i < sizeof report_files / sizeof *report_files; i++)
    FG_TRY(remove_lot_file(ctx, folder, report_files[i]));
  return FG_OK;
}

typedef struct loader {
  fg_lot *lot;
  fg_manifest_index index;
} loader;

static fg_status move_record(fg_context *ctx, void *user, fg_record *record,
                             fg_journal_entry entry) {
  loader *l = user;
  (void)ctx;
  (void)entry;
  size_t item = fg_manifest_index_find(&l->index, &l->lot->manifest, record->scan);
  if (item == l->lot->manifest.items) return FG_OK;
  fg_record_free(&l->lot->records[item]);
  l->lot->records[item] = *record;
  *record = (fg_record){0};
  return FG_OK;
}

static fg_status load_records(fg_context *ctx, const char *folder, fg_lot *lot) {
  loader l = {.lot = lot};
  const fg_journal_visitor by = {.visit = move_record, .user = &l, .threads = lot->threads};
  char *path = NULL;
  void *block;
  fg_journal_damage damage;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, lot->manifest.items, sizeof *lot->records, &block));
  lot->records = block;
  FG_TRY_EXIT(fg_manifest_index_build(ctx, &lot->manifest, &l.index));
  FG_TRY_EXIT(fg_lot_path(ctx, folder, "results.jsonl", &path));
  FG_TRY_EXIT(fg_journal_read(ctx, path, &lot->head, &damage, &by));
  for (size_t i = 0; i < lot->manifest.items; i++)
    if (!lot->records[i].scan)
      FG_TRY_EXIT(fg_fail(ctx, FG_ERR_DATA, "%s: no record of %s; measure it with --resume", path,
                          fg_manifest_scan(&lot->manifest, i)));
exit:
  free(path);
  fg_manifest_index_free(&l.index);
  return status;
}

/* The copy has one name in every folder, so a report does not depend on the model's origin. */
static fg_status load_model_copy(fg_context *ctx, const char *folder, fg_lot *lot) {
  char *path, *text = NULL;
  FG_TRY(fg_lot_path(ctx, folder, FG_LOT_MODEL_FILE, &path));
  fg_status status = fg_file_read_text(ctx, path, FG_LOT_MODEL_BYTES_MAX, &text);
  if (status == FG_OK) status = fg_scanner_model_parse(ctx, FG_LOT_MODEL_FILE, text, &lot->model);
  if (status == FG_OK) fg_scanner_model_trace(lot->model, &lot->settings.design);
  free(path);
  free(text);
  return status;
}

/* Names the lot after the folder itself, even where the path ends in "." or a link. */
static void name_by_folder(const char *folder, char *name, size_t size) {
  char *path = realpath(folder, NULL);
  const char *slash = path ? strrchr(path, '/') : NULL;
  fg_text_clip(name, size, "%s", slash && slash[1] ? slash + 1 : "lot");
  free(path);
}

fg_status fg_lot_load(fg_context *ctx, const char *folder, fg_lot *lot) {
  FG_TRY(fg_design_derive(ctx, &lot->settings.design, &lot->nominal));
  if (!lot->records) FG_TRY(load_records(ctx, folder, lot));
  FG_TRY(fg_lot_mark_repeats(ctx, lot));
  if (!lot->settings.name[0]) name_by_folder(folder, lot->settings.name, sizeof lot->settings.name);
  return lot->settings.model[0] ? load_model_copy(ctx, folder, lot) : FG_OK;
}

void fg_lot_free(fg_lot *lot) {
  for (size_t i = 0; lot->records && i < lot->manifest.items; i++)
    fg_record_free(&lot->records[i]);
  free(lot->records);
  fg_manifest_free(&lot->manifest);
  if (lot->model) fg_scanner_model_free(lot->model);
  *lot = (fg_lot){0};
}
