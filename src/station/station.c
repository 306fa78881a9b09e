/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A station from its start to its end. */
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

#include "core/file.h"
#include "foilgauge/file.h"
#include "foilgauge/foil_kind.h"
#include "lot/run/folder_lock.h"
#include "station/access.h"
#include "station/answer.h"
#include "station/backup.h"
#include "station/cause_thread.h"
#include "station/close.h"
#include "station/digest.h"
#include "station/export.h"
#include "station/keep.h"
#include "station/outbox/outbox.h"
#include "station/part_recipes.h"
#include "station/scan_options.h"
#include "station/server.h"
#include "station/watch.h"

static fg_status load_model(fg_context *ctx, fg_inspection *station) {
  const char *path = station->settings->lot.model;
  if (!path[0]) return FG_OK;
  return fg_scanner_model_load(ctx, path, &station->model);
}

static fg_status load_check(fg_context *ctx, fg_inspection *station) {
  const char *path = station->settings->check.design;
  if (!path[0]) return FG_OK;
  fg_design_default(&station->check_design);
  FG_TRY(fg_design_load(ctx, path, &station->check_design));
  const fg_design *design = &station->check_design;
  const fg_foil_traits *kind = fg_foil_traits_of(design->kind);
  bool grid = kind->is_grid && design->grid.u_pitch_mm > 0;
  bool discs = !kind->is_foil && !kind->is_grid && design->discs.count;
  if (!grid && !discs)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%.300s: a check needs a design of the form \"discs\" with diameters_mm, or "
                   "\"grid\" with pitch_mm and u_pitch_mm",
                   path);
  station->check_design_known = true;
  return FG_OK;
}

static fg_status make_csrf_token(fg_context *ctx, fg_inspection *station) {
  unsigned char bytes[(FG_CSRF_TOKEN - 1) / 2];
  if (getrandom(bytes, sizeof bytes, 0) != (ssize_t)sizeof bytes)
    return fg_fail(ctx, FG_ERR_IO, "the system gives no random numbers");
  for (size_t i = 0; i < sizeof bytes; i++)
    snprintf(station->csrf_token + 2 * i, 3, "%02x", bytes[i]);
  return FG_OK;
}

/* Said once, and on the page beside the button. */
static void inspect_scan_command(fg_inspection *station) {
  const fg_station_request *request = station->request;
  char *warning = station->scan_warning;
  if (fg_scan_options_inspect(station->settings->scan_command, warning,
                              sizeof station->scan_warning) &&
      request->looked_at)
    request->looked_at(request->user, "scan_command:", warning);
}

static fg_status run_tasks(fg_context *ctx, fg_inspection *station) {
  const fg_station_request *request = station->request;
  FG_TRY(fg_users_load(ctx, request->users, &station->users));
  FG_TRY(load_model(ctx, station));
  FG_TRY(load_check(ctx, station));
  FG_TRY(fg_part_recipes_open(ctx, station));
  FG_TRY(fg_folder_lock(ctx, request->folder, &station->lock));
  FG_TRY(fg_station_database_open(ctx, request->folder, &station->database));
  if (request->export_path) return fg_station_export(ctx, station, request->export_path);
  FG_TRY(fg_part_recipes_keep_setups(ctx, station));
  FG_TRY(fg_outbox_open(ctx, station));
  if (request->once) {
    FG_TRY(fg_station_watch(ctx, station, true));
    fg_outbox_flush(station);
    return FG_OK;
  }
  FG_TRY(make_csrf_token(ctx, station));
  FG_TRY(fg_languages_open(ctx, &station->languages));
  FG_TRY(fg_cause_thread_start(ctx, station));
  inspect_scan_command(station);
  FG_TRY(fg_outbox_begin(ctx, station));
  FG_TRY(fg_backup_begin(ctx, station));
  FG_TRY(fg_station_server_start(ctx, station));
  fg_status status = fg_station_watch(ctx, station, false);
  fg_station_server_stop(station);
  return status;
}

/* A digest in memory, its text and its page. */
typedef struct written_digest {
  char *text, *page;
  size_t text_size, page_size;
} written_digest;

static fg_status write_digest(fg_context *ctx, const fg_station_request *request,
                              written_digest *digest) {
  FILE *text = fg_stream_open(&digest->text, &digest->text_size);
  FILE *page = fg_stream_open(&digest->page, &digest->page_size);
  fg_status status = text && page ? fg_station_digest(ctx, request, text, page)
                                  : fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a digest");
  bool has_text = fg_stream_keep(text, &digest->text);
  bool has_page = fg_stream_keep(page, &digest->page);
  return !(has_text && has_page) && status == FG_OK
             ? fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a digest")
             : status;
}

/* A line of the text is a text without markup. */
static void put_digest_text(const fg_language *language, char *text, FILE *out) {
  for (char *line = text, *next; line; line = next) {
    next = strchr(line, '\n');
    if (next) *next++ = '\0';
    if (language)
      fg_language_write_text(language, line, out, NULL);
    else
      fputs(line, out);
    if (next) fputc('\n', out);
  }
}

static fg_status put_digest_page(fg_context *ctx, const char *path, const fg_language *language,
                                 const written_digest *digest) {
  fg_output page;
  FG_TRY(fg_output_open(ctx, path, &page));
  if (language)
    fg_language_write_html(language, digest->page, digest->page_size, page.stream, NULL);
  else
    fwrite(digest->page, 1, digest->page_size, page.stream);
  return fg_output_end(ctx, &page, FG_OK);
}

/* The digest is in the recipe's language, else in English. */
static fg_status put_digest(fg_context *ctx, const fg_station_request *request, FILE *text) {
  written_digest digest = {.text = NULL};
  fg_languages *languages = NULL;
  fg_status status = fg_languages_open(ctx, &languages);
  if (status == FG_OK) status = write_digest(ctx, request, &digest);
  const fg_language *language = fg_languages_choose(languages, request->settings->language, NULL);
  if (status == FG_OK) put_digest_text(language, digest.text, text);
  if (status == FG_OK && request->digest_page)
    status = put_digest_page(ctx, request->digest_page, language, &digest);
  fg_languages_close(languages);
  free(digest.text);
  free(digest.page);
  return status;
}

static fg_status write_digest_files(fg_context *ctx, const fg_station_request *request) {
  fg_output text;
  FG_TRY(fg_output_open(ctx, NULL, &text));
  return fg_output_end(ctx, &text, put_digest(ctx, request, text.stream));
}

fg_status fg_station_run(fg_context *ctx, const fg_station_request *request,
                         fg_station_outcome *outcome) {
  *outcome = (fg_station_outcome){.judged = {.verdict = FG_VERDICT_NONE}};
  if (request->backup_path) return fg_backup_write(ctx, request->folder, request->backup_path);
  if (request->restore_path) return fg_backup_restore(ctx, request->folder, request->restore_path);
  if (request->digest) return write_digest_files(ctx, request);
  fg_inspection *station = calloc(1, sizeof *station);
  if (!station) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a station");
  station->request = request;
  station->settings = request->settings;
  station->outcome = outcome;
  station->lock = -1;
  station->answer = fg_station_answer;
  pthread_mutex_init(&station->closing.mutex, NULL);
  pthread_mutex_init(&station->recovery.mutex, NULL);
  pthread_mutex_init(&station->arriving.mutex, NULL);
  atomic_init(&station->news, fg_station_now());
  fg_status status = run_tasks(ctx, station);
  fg_closing_end(&station->closing);
  fg_cause_thread_stop(station);
  fg_outbox_end(station);
  fg_backup_end(station);
  fg_station_database_close(&station->database);
  fg_languages_close(station->languages);
  fg_part_recipes_close(station);
  if (station->model) fg_scanner_model_free(station->model);
  if (station->lock >= 0) close(station->lock);
  free(station->users.list);
  free(station);
  return status;
}
