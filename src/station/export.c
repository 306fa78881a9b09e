/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/export.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/date.h"
#include "core/memory.h"
#include "core/sha256.h"
#include "core/text.h"
#include "foilgauge/measure.h"
#include "lot/input/recipe.h"
#include "lot/run/folder_lock.h"
#include "lot/run/lot.h"
#include "report/lot/files.h"
#include "station/intake.h"
#include "station/lot_content.h"
#include "station/lot_folder.h"
#include "station/stored_name.h"

/* A lot on its way to its folder. */
typedef struct export {
  fg_inspection *station;
  const char *folder; /* of the lot */
  fg_exported_lot *exported;
  fg_lot_content content;
  fg_manifest manifest;
  fg_lot_settings settings; /* with which its newest scan was measured */
  char *recipe_text, *manifest_text;
  char *model_text; /* NULL: none */
  fg_scanner_model *model;
  fg_journal_head head;
  int lock;
}
export;

static fg_status read_setup(fg_context *ctx, export *at, char **recipe) {
  fg_query query;
  fg_status status = FG_OK;
  fg_query_begin(at->station->database.reader, "SELECT recipe, model FROM setups WHERE id = ?",
                 &query);
  fg_query_integer(&query, at->content.setup);
  if (fg_query_row(&query)) {
    status = fg_text_print(ctx, recipe, "%s", fg_query_get_text(&query, 0));
    if (status == FG_OK && !fg_query_is_null(&query, 1))
      status = fg_text_print(ctx, &at->model_text, "%s", fg_query_get_text(&query, 1));
  }
  fg_status ended = fg_query_end(ctx, &query, "reading the lot's setup");
  return status == FG_OK ? ended : status;
}

static fg_status read_database(fg_context *ctx, export *at, const char *lot, char **recipe) {
  fg_station_database *database = &at->station->database;
  pthread_mutex_lock(&database->reading);
  fg_status status = fg_lot_content_read(ctx, database->reader, lot, &at->content);
  if (status == FG_OK) status = read_setup(ctx, at, recipe);
  pthread_mutex_unlock(&database->reading);
  if (status == FG_OK && !*recipe)
    status = fg_fail(ctx, FG_ERR_DATA, "the database has no setup for the lot '%.127s'", lot);
  return status;
}

/* A recipe may name columns that only somebody's manifest has. */
static void keep_column(const fg_manifest *manifest, char *column, const char *usual) {
  if (fg_manifest_column(manifest, column) == FG_NO_COLUMN) strcpy(column, usual);
}

void fg_station_keep_columns(const fg_manifest *manifest, fg_lot_settings *settings) {
  fg_lot_settings usual;
  fg_lot_settings_default(&usual);
  keep_column(manifest, settings->group_column, usual.group_column);
  keep_column(manifest, settings->part_column, usual.part_column);
  keep_column(manifest, settings->operator_column, usual.operator_column);
  keep_column(manifest, settings->bearing_column, usual.bearing_column);
  keep_column(manifest, settings->pad_column, usual.pad_column);
}

static fg_status use_setup(fg_context *ctx, export *at, const char *lot, const char *recipe) {
  fg_lot_settings_default(&at->settings);
  FG_TRY(fg_lot_settings_parse(ctx, "the setup in the database", recipe, &at->settings));
  if (*lot) fg_text_clip(at->settings.name, sizeof at->settings.name, "%s", lot);
  fg_station_keep_columns(&at->manifest, &at->settings);
  if (!at->model_text) return FG_OK;
  strcpy(at->settings.model, FG_LOT_MODEL_FILE);
  return fg_scanner_model_parse(ctx, FG_LOT_MODEL_FILE, at->model_text, &at->model);
}

enum { SCAN, FOIL, LOT, DIE, OPERATOR, COLUMNS };

static const char of_scan[] = "foils_of_scan";
static const char *const more_names[FG_LOT_MORE] = {"coil",  "oven",        "scanner",
                                                    "order", "disposition", "withheld"};

/* Further columns are there where a row needs them. */
static fg_status name_columns(fg_context *ctx, fg_manifest *manifest, bool split,
                              const bool more[FG_LOT_MORE]) {
  static const char *const names[] = {"scan", "foil", "lot", "die", "operator"};
  size_t column;
  for (size_t i = 0; i < COLUMNS; i++)
    FG_TRY(fg_manifest_add_column(ctx, manifest, names[i], strlen(names[i]), &column));
  if (split) FG_TRY(fg_manifest_add_column(ctx, manifest, of_scan, strlen(of_scan), &column));
  for (size_t i = 0; i < FG_LOT_MORE; i++)
    if (more[i])
      FG_TRY(fg_manifest_add_column(ctx, manifest, more_names[i], strlen(more_names[i]), &column));
  return FG_OK;
}

/* "1 3 of 4": a bed with foils of several lots. */
static fg_status list_numbers(fg_context *ctx, const fg_lot_scan *scan, char **text) {
  for (size_t i = 0; i < scan->count; i++)
    FG_TRY(fg_text_append(ctx, text, "%d ", scan->numbers[i]));
  return fg_text_append(ctx, text, "of %zu", scan->of);
}

/* A bed is called as its foils are without their numbers, unless somebody gave them names. */
static fg_status name_scan(fg_context *ctx, const fg_lot_scan *scan, char **name) {
  char *all = NULL;
  const char *end = strchr(scan->serial, ' '),
             *dot = memrchr(scan->serial, '.', end ? (size_t)(end - scan->serial) : 0);
  int base = (int)(dot ? dot - scan->serial : 0);
  fg_status status = FG_OK;
  for (size_t i = 0; i < scan->count && base && status == FG_OK; i++)
    status =
        fg_text_append(ctx, &all, "%s%.*s.%d", i ? " " : "", base, scan->serial, scan->numbers[i]);
  bool usual = all && !strcmp(all, scan->serial);
  free(all);
  FG_TRY(status);
  return usual ? fg_text_print(ctx, name, "%.*s", base, scan->serial)
               : fg_text_print(ctx, name, "%s", scan->serial);
}

static fg_status add_row(fg_context *ctx, export *at, const char *folder, const char *lot,
                         const fg_lot_scan *scan) {
  char **row;
  FG_TRY(fg_manifest_add_item(ctx, &at->manifest, &row));
  FG_TRY(fg_stored_name_path(ctx, folder, scan->path, &row[SCAN]));
  FG_TRY(name_scan(ctx, scan, &row[FOIL]));
  FG_TRY(fg_text_print(ctx, &row[LOT], "%s", lot));
  FG_TRY(fg_text_print(ctx, &row[DIE], "%s", scan->die));
  FG_TRY(fg_text_print(ctx, &row[OPERATOR], "%s", scan->operator_name));
  size_t numbers = fg_manifest_column(&at->manifest, of_scan);
  if (numbers != FG_NO_COLUMN) FG_TRY(list_numbers(ctx, scan, &row[numbers]));
  for (size_t i = 0; i < FG_LOT_MORE; i++) {
    size_t column = fg_manifest_column(&at->manifest, more_names[i]);
    if (column != FG_NO_COLUMN) FG_TRY(fg_text_print(ctx, &row[column], "%s", scan->more[i]));
  }
  return FG_OK;
}

/* Scans by their whole path: the lot's folder may go elsewhere. */
static fg_status make_manifest(fg_context *ctx, export *at, const char *lot) {
  const char *folder = at->station->request->folder;
  bool split = false, more[FG_LOT_MORE] = {false};
  for (size_t i = 0; i < at->content.count; i++) {
    split = split || at->content.scans[i].count < at->content.scans[i].of;
    for (size_t k = 0; k < FG_LOT_MORE; k++)
      more[k] = more[k] || at->content.scans[i].more[k][0];
  }
  char *whole = realpath(folder, NULL);
  if (!whole)
    return fg_fail(ctx, FG_ERR_IO, "%s: the folder cannot be read: %s", folder, strerror(errno));
  fg_status status = name_columns(ctx, &at->manifest, split, more);
  for (size_t i = 0; i < at->content.count && status == FG_OK; i++)
    status = add_row(ctx, at, whole, lot, &at->content.scans[i]);
  free(whole);
  if (status == FG_OK) status = fg_manifest_format(ctx, &at->manifest, &at->manifest_text);
  return status;
}

static fg_status make_head(fg_context *ctx, export *at) {
  at->head =
      (fg_journal_head){.version = FOILGAUGE_VERSION, .shard = {1, 1}, .items = at->manifest.items};
  FG_TRY(fg_lot_settings_format(ctx, &at->settings, false, &at->recipe_text));
  fg_sha256_text(at->manifest_text, at->head.manifest_sha256);
  fg_sha256_text(at->recipe_text, at->head.recipe_sha256);
  return fg_lot_sum_settings(ctx, &at->settings, at->head.measured_with);
}

/* All foils of a scan, of this lot and of others. */
typedef struct scan_foils {
  const fg_foil *foils;
  size_t count;
  const char *date; /* of the scan */
} scan_foils;

/* Formats the record of the lot's foils alone. */
static fg_status format_foils(fg_context *ctx, const export *at, size_t item, const scan_foils *all,
                              char **line, size_t *length) {
  const fg_lot_scan *scan = &at->content.scans[item];
  fg_measurement own = {0};
  fg_record record = {.scan = (char *)(uintptr_t)fg_manifest_scan(&at->manifest, item)};
  void *block;
  strcpy(record.sha256, scan->sha256);
  strcpy(record.measured_with, at->head.measured_with);
  strcpy(record.date, all->date);
  FG_TRY(fg_memory_allocate(ctx, scan->count, sizeof *own.foils, &block));
  own.foils = block;
  for (size_t i = 0; i < all->count; i++)
    for (size_t k = 0; k < scan->count; k++)
      if (all->foils[i].number == scan->numbers[k]) own.foils[own.foil_count++] = all->foils[i];
  fg_status status = fg_record_format(ctx, &record, &own, line, length);
  free(own.foils);
  return status;
}

/* Formats a record without a sum: --resume measures the scan again. */
static fg_status format_lost(fg_context *ctx, export *at, size_t item, const char *why, char **line,
                             size_t *length) {
  fg_record record = {.scan = (char *)(uintptr_t)fg_manifest_scan(&at->manifest, item)};
  fg_status status = fg_text_print(ctx, &record.error,
                                   "the record is of another setup or program, and the scan cannot "
                                   "be measured again: %.500s",
                                   why);
  strcpy(record.measured_with, at->head.measured_with);
  at->exported->lost++;
  if (status == FG_OK) status = fg_record_format(ctx, &record, NULL, line, length);
  free(record.error);
  return status;
}

/* Measures an unchanged scan again, as its record is of another setup than the lot's. */
static fg_status measure_again(fg_context *ctx, export *at, size_t item, char **line,
                               size_t *length) {
  const fg_lot_scan *scan = &at->content.scans[item];
  const fg_measure_options options = {.dpi = at->settings.dpi,
                                      .allow_lossy = at->settings.allow_lossy,
                                      .threads = 1,
                                      .only_file = true,
                                      .without_plain = !fg_scanner_model_has_level(at->model)};
  fg_context inner = {.message = ""};
  fg_measurement measurement;
  char date[11];
  const char *path = fg_manifest_scan(&at->manifest, item);
  fg_date_of_file(path, date);
  fg_status status = fg_measure_scan(&inner, path, &at->settings.design, &options, &measurement);
  if (status == FG_OK) status = fg_station_correct(&inner, at->model, 1, &measurement);
  if (status == FG_ERR_MEMORY) return fg_fail(ctx, status, "%s", inner.message);
  if (status != FG_OK) return format_lost(ctx, at, item, inner.message, line, length);
  if (strcmp(measurement.sha256, scan->sha256) != 0)
    status = format_lost(ctx, at, item, "the file holds another scan now", line, length);
  else if (measurement.foil_count != scan->of)
    status = format_lost(ctx, at, item, "other foils are found in it now", line, length);
  else
    status =
        format_foils(ctx, at, item, &(scan_foils){measurement.foils, measurement.foil_count, date},
                     line, length);
  at->exported->again++;
  fg_measurement_free(&measurement);
  return status;
}

static fg_status read_record(fg_context *ctx, const export *at, int64_t scan, fg_record *record) {
  fg_query query;
  fg_context inner;
  fg_station_database *database = &at->station->database;
  *record = (fg_record){0};
  pthread_mutex_lock(&database->reading);
  fg_query_begin(database->reader, "SELECT record FROM scans WHERE id = ?", &query);
  fg_query_integer(&query, scan);
  fg_status status = FG_OK;
  /* One of another program may have other quantities: it is as if there were none. */
  if (fg_query_row(&query)) status = fg_record_parse(&inner, fg_query_get_text(&query, 0), record);
  fg_status ended = fg_query_end(ctx, &query, "reading a record");
  pthread_mutex_unlock(&database->reading);
  if (status == FG_ERR_MEMORY) return fg_fail(ctx, status, "%s", inner.message);
  return ended;
}

static fg_status write_record(fg_context *ctx, void *user, size_t item, char **line,
                              size_t *length) {
  export *at = user;
  fg_record record;
  FG_TRY(read_record(ctx, at, at->content.scans[item].id, &record));
  bool valid = record.scan && !strcmp(record.measured_with, at->head.measured_with);
  fg_status status =
      valid
          ? format_foils(ctx, at, item, &(scan_foils){record.foils, record.foil_count, record.date},
                         line, length)
          : measure_again(ctx, at, item, line, length);
  fg_record_free(&record);
  return status;
}

static fg_status write_report(fg_context *ctx, export *at) {
  fg_lot lot = {.manifest = at->manifest, .decimal_comma = at->station->request->decimal_comma};
  at->manifest = (fg_manifest){0};
  fg_lot_settings_default(&lot.settings); /* as `lot` and `merge` read them */
  fg_status status = fg_lot_settings_parse(ctx, "recipe.json", at->recipe_text, &lot.settings);
  if (status == FG_OK) status = fg_lot_load(ctx, at->folder, &lot);
  if (status == FG_OK) status = fg_lot_write_report(ctx, at->folder, &lot, &at->exported->outcome);
  fg_lot_free(&lot);
  return status;
}

static fg_status write_folder(fg_context *ctx, export *at) {
  char *results;
  FG_TRY(fg_folder_lock(ctx, at->folder, &at->lock));
  FG_TRY(fg_lot_remove_report(ctx, at->folder));
  FG_TRY(fg_lot_write_text(ctx, at->folder, "recipe.json", at->recipe_text));
  FG_TRY(fg_lot_write_text(ctx, at->folder, "manifest.csv", at->manifest_text));
  FG_TRY(fg_lot_write_model(ctx, at->folder, at->model_text));
  FG_TRY(fg_lot_path(ctx, at->folder, "results.jsonl", &results));
  fg_status status = fg_journal_write(ctx, results, &at->head, write_record, at);
  free(results);
  FG_TRY(status);
  return write_report(ctx, at);
}

static void append_count(char *words, size_t size, size_t count, const char *one,
                         const char *many) {
  size_t length = strlen(words);
  if (count)
    fg_text_clip(words + length, size - length, "; %zu %s", count, count == 1 ? one : many);
}

static void find_words(fg_exported_lot *exported) {
  const fg_lot_outcome *outcome = &exported->outcome;
  const size_t *by = outcome->foils.by_verdict, size = sizeof exported->words;
  char *words = exported->words;
  fg_text_clip(words, size, "%zu foil%s of %zu scan%s: %zu pass, %zu fail, %zu cannot be told",
               outcome->foils.count, fg_plural(outcome->foils.count), outcome->scans.count,
               fg_plural(outcome->scans.count), by[FG_VERDICT_PASS], by[FG_VERDICT_FAIL],
               by[FG_VERDICT_UNDECIDED]);
  append_count(words, size, by[FG_VERDICT_NONE], "without tolerances", "without tolerances");
  append_count(words, size, by[FG_VERDICT_NOT_MEASURED], "foil not measured", "foils not measured");
  append_count(words, size, exported->replaced, "foil counts with its later scan",
               "foils count with their later scans");
  append_count(words, size, exported->withheld,
               "verdict does not hold: the scanner's check was due",
               "verdicts do not hold: the scanner's check was due");
  append_count(words, size, exported->again, "scan was measured again with the lot's newest setup",
               "scans were measured again with the lot's newest setup");
  append_count(words, size, exported->lost,
               "scan is of another setup and cannot be measured again: not measured",
               "scans are of another setup and cannot be measured again: not measured");
}

static fg_status export_lot(fg_context *ctx, export *at, const char *lot) {
  char *recipe = NULL;
  fg_status status = read_database(ctx, at, lot, &recipe);
  if (status == FG_OK) status = make_manifest(ctx, at, lot);
  if (status == FG_OK) status = use_setup(ctx, at, lot, recipe);
  free(recipe);
  FG_TRY(status);
  at->exported->replaced = at->content.replaced;
  at->exported->withheld = at->content.withheld;
  strcpy(at->exported->state, at->content.state);
  fg_context ignored; /* more groups than are compared: the lot goes without */
  if (fg_lot_check_columns(&ignored, &at->settings, &at->manifest) != FG_OK)
    at->settings.group_column[0] = '\0';
  FG_TRY(make_head(ctx, at));
  FG_TRY(write_folder(ctx, at));
  find_words(at->exported);
  return FG_OK;
}

fg_status fg_station_export_lot(fg_context *ctx, fg_inspection *station, const char *lot,
                                const char *folder, fg_exported_lot *exported) {
  export at = {.station = station, .folder = folder, .exported = exported, .lock = -1};
  *exported = (fg_exported_lot){.outcome.judged.verdict = FG_VERDICT_NONE};
  fg_status status = export_lot(ctx, &at, lot);
  if (at.lock >= 0) close(at.lock);
  if (at.model) fg_scanner_model_free(at.model);
  fg_lot_content_free(&at.content);
  fg_manifest_free(&at.manifest);
  free(at.recipe_text);
  free(at.manifest_text);
  free(at.model_text);
  return status;
}
