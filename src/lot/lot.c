/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs a lot: records that hold are kept, missing scans are measured, then the report is written.
 */
#include <errno.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "core/date.h"
#include "core/file.h"
#include "core/folder.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "core/sha256.h"
#include "core/text.h"
#include "foilgauge/measure.h"
#include "foilgauge/scan_loop.h"
#include "lot/input/recipe.h"
#include "lot/run/folder_lock.h"
#include "lot/run/guard.h"
#include "lot/run/lot.h"
#include "report/lot/files.h"
#include "report/lot/foil_pages.h"

/* State of an item before it is measured. */
typedef struct item_state {
  fg_journal_entry entry; /* its record; length 0: it must be measured */
  char sha256[65];        /* of its scan as recorded */
  bool mine;              /* belongs to this shard */
  bool wanted;            /* its scan is to have a page */
  bool redrawn;           /* the record holds, but the page is missing */
} item_state;

typedef struct lot_run {
  const fg_lot_request *request;
  fg_manifest manifest;
  fg_manifest_index index;
  char *manifest_text, *recipe_text, *results_path;
  char *model_text;        /* text of the scanner's model; NULL: none */
  fg_scanner_model *model; /* the parsed model */
  fg_journal_head head;
  item_state *items;
  fg_record *records; /* by item, while all that the report needs is recorded; NULL: not kept */
  size_t *todo, todo_count, done;
  fg_journal journal;
  fg_lot_outcome *outcome;
  double start;
  pthread_mutex_t listening;
  atomic_bool stop;
  int lock;
} lot_run;

static fg_status check_shard_number(fg_context *ctx, fg_lot_shard shard) {
  if (shard.index >= 1 && shard.index <= shard.count) return FG_OK;
  return fg_fail(ctx, FG_ERR_USAGE, "shard %zu/%zu: give i/n with i from 1 to n", shard.index,
                 shard.count);
}

/* The kept recipe names the model's copy in the lot's folder, so the model's origin does not
 * matter. */
static fg_status read_scanner_model(fg_context *ctx, lot_run *run, fg_lot_settings *kept) {
  if (!kept->model[0]) return FG_OK;
  FG_TRY(fg_file_read_text(ctx, kept->model, FG_LOT_MODEL_BYTES_MAX, &run->model_text));
  FG_TRY(fg_scanner_model_parse(ctx, kept->model, run->model_text, &run->model));
  if (strcmp(fg_scanner_model_sha256(run->model), kept->model_sha256) != 0)
    return fg_fail(ctx, FG_ERR_DATA, "%.500s: the model has changed; run again", kept->model);
  strcpy(kept->model, FG_LOT_MODEL_FILE);
  return FG_OK;
}

/* Returns the path that is the lot's own manifest, or NULL. */
static const char *find_own_manifest(const fg_lot_request *request) {
  for (size_t i = 0; i < request->path_count; i++)
    if (fg_lot_is_own_copy(request, request->paths[i], "manifest.csv")) return request->paths[i];
  return NULL;
}

static fg_status prepare_run(fg_context *ctx, lot_run *run) {
  const fg_lot_request *request = run->request;
  fg_lot_settings kept = *request->settings;
  void *block;
  FG_TRY(check_shard_number(ctx, request->shard));
  FG_TRY(fg_lot_settings_check(ctx, request->settings));
  FG_TRY(read_scanner_model(ctx, run, &kept));
  FG_TRY(fg_manifest_collect(ctx, request->paths, request->path_count, request->folder,
                             find_own_manifest(request), &run->manifest));
  FG_TRY(fg_lot_check_inputs(ctx, request, &run->manifest));
  FG_TRY(fg_lot_check_columns(ctx, request->settings, &run->manifest));
  run->outcome->notes.named_again = run->manifest.named_again;
  run->outcome->notes.empty_folders = run->manifest.empty_folders;
  FG_TRY(fg_manifest_index_build(ctx, &run->manifest, &run->index));
  FG_TRY(fg_manifest_format(ctx, &run->manifest, &run->manifest_text));
  FG_TRY(fg_lot_settings_format(ctx, &kept, false, &run->recipe_text));
  FG_TRY(fg_lot_path(ctx, request->folder, "results.jsonl", &run->results_path));
  run->head = (fg_journal_head){
      .version = FOILGAUGE_VERSION, .shard = request->shard, .items = run->manifest.items};
  fg_sha256_text(run->manifest_text, run->head.manifest_sha256);
  fg_sha256_text(run->recipe_text, run->head.recipe_sha256);
  FG_TRY(fg_lot_sum_settings(ctx, request->settings, run->head.measured_with));
  FG_TRY(fg_memory_allocate(ctx, run->manifest.items, sizeof *run->items, &block));
  run->items = block;
  for (size_t i = 0; i < run->manifest.items; i++)
    run->items[i].mine = i % request->shard.count == request->shard.index - 1;
  return FG_OK;
}

static fg_status accept_record(fg_context *ctx, void *user, fg_record *record,
                               fg_journal_entry entry) {
  lot_run *run = user;
  size_t item = fg_manifest_index_find(&run->index, &run->manifest, record->scan);
  if (item == run->manifest.items || !run->items[item].mine || !record->sha256[0] ||
      strcmp(record->measured_with, run->head.measured_with) != 0)
    return FG_OK;
  run->items[item].entry = entry;
  strcpy(run->items[item].sha256, record->sha256);
  FG_TRY(fg_lot_page_is_wanted(ctx, run->request->pages, &run->request->settings->design,
                               record->foils, record->foil_count, &run->items[item].wanted));
  if (!run->records) return FG_OK;
  fg_record_free(&run->records[item]);
  run->records[item] = *record;
  *record = (fg_record){0};
  return FG_OK;
}

/* Records that the report takes as they were read: those of a whole lot. */
static fg_status make_room_for_records(fg_context *ctx, lot_run *run) {
  void *block = NULL;
  if (run->request->shard.count == 1 && !run->request->dry_run)
    FG_TRY(fg_memory_allocate(ctx, run->manifest.items, sizeof *run->records, &block));
  run->records = block;
  return FG_OK;
}

static void drop_records(lot_run *run) {
  for (size_t i = 0; run->records && i < run->manifest.items; i++)
    fg_record_free(&run->records[i]);
  free(run->records);
  run->records = NULL;
}

static fg_status name_page(fg_context *ctx, const lot_run *run, size_t item, const char *sha256,
                           char **name) {
  fg_record record = {0};
  strcpy(record.sha256, sha256);
  strcpy(record.measured_with, run->head.measured_with);
  return fg_lot_page_name(ctx, &run->request->settings->design, &run->manifest, item, &record,
                          name);
}

/* A record holds while its scan is unchanged. A scan that is gone keeps its record and page. */
static fg_status check_scan(fg_context *ctx, void *shared, size_t i) {
  lot_run *run = shared;
  item_state *item = &run->items[i];
  const char *scan = fg_manifest_scan(&run->manifest, i);
  char sum[65];
  if (!item->entry.length || (access(scan, F_OK) != 0 && errno == ENOENT)) return FG_OK;
  fg_context inner;
  if (fg_sha256_file(&inner, scan, sum) != FG_OK || strcmp(sum, item->sha256) != 0)
    item->entry.length = 0;
  if (!item->entry.length || !item->wanted) return FG_OK;
  char *page;
  FG_TRY(name_page(ctx, run, i, sum, &page));
  item->redrawn = !fg_lot_page_exists(run->request->folder, page);
  free(page);
  return FG_OK;
}

static fg_status read_earlier(fg_context *ctx, lot_run *run) {
  fg_journal_damage damage;
  if (access(run->results_path, F_OK) != 0) return FG_OK;
  if (!run->request->resume)
    return fg_fail(ctx, FG_ERR_USAGE,
                   "%s: the folder holds results; --resume goes on with them, or choose another "
                   "folder",
                   run->request->folder);
  FG_TRY(make_room_for_records(ctx, run));
  const fg_journal_visitor by = {
      .visit = accept_record, .user = run, .threads = run->request->settings->jobs};
  FG_TRY(fg_journal_salvage(ctx, run->results_path, &damage, &by));
  fg_lot_notes *notes = &run->outcome->notes;
  notes->damaged_lines = damage.lines;
  notes->first_damaged_line = damage.first;
  notes->earlier_version = damage.earlier;
  return fg_parallel_run(ctx, run->request->settings->jobs, run->manifest.items, check_scan, run);
}

/* A missing scan gets a record with its error, too. */
static void note_missing(const char *scan, fg_lot_finding *missing) {
  if (access(scan, F_OK) == 0) return;
  if (missing->count++ == 0) fg_text_clip(missing->first, sizeof missing->first, "%s", scan);
}

static fg_status list_todo(fg_context *ctx, lot_run *run) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, run->manifest.items, sizeof *run->todo, &block));
  run->todo = block;
  fg_lot_scans *scans = &run->outcome->scans;
  for (size_t i = 0; i < run->manifest.items; i++) {
    if (!run->items[i].mine) continue;
    scans->count++;
    bool kept = run->items[i].entry.length > 0, redrawn = run->items[i].redrawn;
    scans->kept += kept;
    scans->redrawn += redrawn;
    if (!kept || redrawn) run->todo[run->todo_count++] = i;
    if (!kept) note_missing(fg_manifest_scan(&run->manifest, i), &scans->missing);
  }
  scans->to_measure = run->todo_count - scans->redrawn - scans->missing.count;
  return FG_OK;
}

/* Listeners are called one at a time. The rate of the first tenth of a second is too uncertain to
 * extrapolate. */
static void report_progress(lot_run *run, size_t item, const char *error, bool beyond) {
  pthread_mutex_lock(&run->listening);
  fg_lot_outcome *outcome = run->outcome;
  bool kept = run->items[item].redrawn;
  outcome->notes.beyond_model += beyond && !kept;
  outcome->scans.measured += !error && !kept;
  outcome->scans.failed += error && !kept;
  size_t done = ++run->done;
  double seconds = fg_clock_seconds() - run->start;
  const fg_lot_progress progress = {
      .done = done,
      .total = run->todo_count,
      .failed = outcome->scans.failed,
      .kept = outcome->scans.kept,
      .seconds = seconds,
      .seconds_left =
          seconds > 0.1 ? seconds * (double)(run->todo_count - done) / (double)done : NAN,
      .scan = fg_manifest_scan(&run->manifest, item),
      .error = error};
  if (run->request->listener) run->request->listener(run->request->user, &progress);
  pthread_mutex_unlock(&run->listening);
}

static fg_status append_record(fg_context *ctx, lot_run *run, size_t item, const fg_record *record,
                               const fg_measurement *measurement) {
  char *line;
  size_t length;
  FG_TRY(fg_record_format(ctx, record, measurement, &line, &length));
  fg_status status = fg_journal_append(ctx, &run->journal, line, length, &run->items[item].entry);
  free(line);
  return status;
}

/* Applies the scanner's model and adds the calibration's uncertainty. A scan that the model does
 * not fit counts as not measured. */
static fg_status correct_measurement(fg_context *ctx, const lot_run *run,
                                     fg_measurement *measurement, bool *beyond) {
  char warning[200];
  fg_status status = FG_OK;
  warning[0] = '\0';
  if (run->model) status = fg_scanner_model_apply(ctx, run->model, measurement, 1, warning);
  if (status == FG_OK) status = fg_measurement_calibrate(ctx, 1, measurement);
  if (status != FG_OK) fg_measurement_free(measurement);
  *beyond = status == FG_OK && warning[0];
  return status;
}

static void note_undrawn_page(lot_run *run, const char *why) {
  pthread_mutex_lock(&run->listening);
  fg_lot_finding *pages = &run->outcome->notes.undrawn_pages;
  if (pages->count++ == 0) fg_text_clip(pages->first, sizeof pages->first, "%s", why);
  pthread_mutex_unlock(&run->listening);
}

/* Draws the page before the record is kept, so that every record's page exists. A scan that cannot
 * be read again has no page; only a page that cannot be written is an error. */
static fg_status draw_page(fg_context *ctx, lot_run *run, size_t item,
                           const fg_measurement *measurement) {
  const fg_design *design = &run->request->settings->design;
  char *page, *name = NULL;
  bool wanted;
  fg_context inner = {.message = ""};
  FG_TRY(fg_lot_page_is_wanted(ctx, run->request->pages, design, measurement->foils,
                               measurement->foil_count, &wanted));
  if (!wanted) return FG_OK;
  if (fg_lot_page_draw(&inner, design, &run->manifest, item, measurement, &page) != FG_OK) {
    note_undrawn_page(run, inner.message);
    return FG_OK;
  }
  fg_status status = name_page(ctx, run, item, measurement->sha256, &name);
  if (status == FG_OK) status = fg_lot_pages_make_folder(ctx, run->request->folder);
  if (status == FG_OK) status = fg_lot_write_text(ctx, run->request->folder, name, page);
  free(name);
  free(page);
  return status;
}

/* Every failure of a scan becomes its record; only a record that cannot be kept is an error. A scan
 * that was read but not measured fails again tomorrow, so its checksum is kept. One that could not
 * be read, or for which memory ran out, has no checksum and is tried again. */
static fg_status measure_item(fg_context *ctx, lot_run *run, size_t item) {
  const fg_lot_settings *settings = run->request->settings;
  const fg_measure_options options = {.dpi = settings->dpi,
                                      .allow_lossy = settings->allow_lossy,
                                      .threads = 1,
                                      .only_file = true,
                                      .sum_failed = true,
                                      .without_plain = !fg_scanner_model_has_level(run->model)};
  const char *scan = fg_manifest_scan(&run->manifest, item);
  fg_context inner = {.message = ""};
  fg_measurement measurement;
  fg_record record = {.scan = (char *)(uintptr_t)scan, .error = inner.message};
  memcpy(record.measured_with, run->head.measured_with, sizeof record.measured_with);
  bool beyond = false;
  fg_date_of_file(scan, record.date);
  fg_status failure = fg_measure_scan(&inner, scan, &settings->design, &options, &measurement);
  memcpy(record.sha256, measurement.sha256, sizeof record.sha256);
  if (failure == FG_OK) failure = correct_measurement(&inner, run, &measurement, &beyond);
  if (failure == FG_ERR_MEMORY || failure == FG_ERR_IO) record.sha256[0] = '\0';
  fg_status status = failure == FG_OK ? draw_page(ctx, run, item, &measurement) : FG_OK;
  if (status == FG_OK && !run->items[item].redrawn)
    status = append_record(ctx, run, item, &record, failure == FG_OK ? &measurement : NULL);
  if (failure == FG_OK) fg_measurement_free(&measurement);
  if (status == FG_OK) report_progress(run, item, failure == FG_OK ? NULL : inner.message, beyond);
  return status;
}

static fg_status measure_next(fg_context *ctx, void *shared, size_t i) {
  lot_run *run = shared;
  if (atomic_load(&run->stop)) return FG_OK;
  fg_status status = measure_item(ctx, run, run->todo[i]);
  if (status != FG_OK) atomic_store(&run->stop, true);
  return status;
}

/* Rewrites the journal in the manifest's order, one record per item, so that the file's bytes do
 * not depend on the order of the work. */
static fg_status rewrite_journal(fg_context *ctx, lot_run *run) {
  void *block;
  const char *from[] = {run->results_path};
  FG_TRY(fg_memory_allocate(ctx, run->manifest.items, sizeof(fg_journal_entry), &block));
  fg_journal_entry *entries = block;
  for (size_t i = 0; i < run->manifest.items; i++)
    entries[i] = run->items[i].entry;
  fg_status status = fg_journal_rewrite(ctx, run->results_path, &run->head, from, NULL, entries,
                                        run->manifest.items);
  for (size_t i = 0; i < run->manifest.items; i++)
    run->items[i].entry = entries[i];
  free(entries);
  return status;
}

static fg_status measure_missing(fg_context *ctx, lot_run *run) {
  const fg_lot_request *request = run->request;
  if (run->todo_count) FG_TRY(fg_lot_remove_report(ctx, request->folder));
  FG_TRY(fg_lot_write_text(ctx, request->folder, "recipe.json", run->recipe_text));
  FG_TRY(fg_lot_write_text(ctx, request->folder, "manifest.csv", run->manifest_text));
  FG_TRY(fg_lot_write_model(ctx, request->folder, run->model_text));
  FG_TRY(rewrite_journal(ctx, run));
  if (!run->todo_count) return FG_OK;
  FG_TRY(fg_journal_open(ctx, run->results_path, &run->journal));
  run->start = fg_clock_seconds();
  fg_status status =
      fg_parallel_run(ctx, request->settings->jobs, run->todo_count, measure_next, run);
  fg_context inner;
  fg_status closed = fg_journal_close(&inner, &run->journal);
  if (status == FG_OK && closed != FG_OK) return fg_fail(ctx, closed, "%s", inner.message);
  return status;
}

static fg_status write_report(fg_context *ctx, lot_run *run) {
  fg_lot lot = {.manifest = run->manifest,
                .head = run->head,
                .records = run->records,
                .decimal_comma = run->request->decimal_comma,
                .threads = run->request->settings->jobs};
  run->records = NULL;
  fg_lot_settings_default(
      &lot.settings); /* from the text, as a merge reads them: a recipe has ten digits */
  run->manifest = (fg_manifest){0};
  fg_status status = fg_lot_settings_parse(ctx, "recipe.json", run->recipe_text, &lot.settings);
  if (status == FG_OK) status = fg_lot_load(ctx, run->request->folder, &lot);
  if (status == FG_OK) status = fg_lot_write_report(ctx, run->request->folder, &lot, run->outcome);
  fg_lot_free(&lot);
  return status;
}

static fg_status measure_lot(fg_context *ctx, lot_run *run) {
  FG_TRY(prepare_run(ctx, run));
  if (!run->request->dry_run) {
    FG_TRY(fg_folder_make(ctx, run->request->folder));
    FG_TRY(fg_folder_lock(ctx, run->request->folder, &run->lock));
  }
  FG_TRY(read_earlier(ctx, run));
  FG_TRY(list_todo(ctx, run));
  if (run->request->dry_run) return FG_OK;
  if (run->todo_count) drop_records(run);
  FG_TRY(measure_missing(ctx, run));
  if (run->todo_count) FG_TRY(rewrite_journal(ctx, run));
  return run->request->shard.count == 1 ? write_report(ctx, run) : FG_OK;
}

fg_status fg_lot_run(fg_context *ctx, const fg_lot_request *request, fg_lot_outcome *outcome) {
  lot_run run = {.request = request, .outcome = outcome, .lock = -1};
  *outcome = (fg_lot_outcome){.judged = {.verdict = FG_VERDICT_NONE}};
  pthread_mutex_init(&run.listening, NULL);
  fg_status status = measure_lot(ctx, &run);
  pthread_mutex_destroy(&run.listening);
  if (run.lock >= 0) close(run.lock);
  drop_records(&run);
  fg_manifest_index_free(&run.index);
  fg_manifest_free(&run.manifest);
  free(run.manifest_text);
  free(run.recipe_text);
  free(run.model_text);
  if (run.model) fg_scanner_model_free(run.model);
  free(run.results_path);
  free(run.items);
  free(run.todo);
  return status;
}
