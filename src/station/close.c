/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/close.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/text.h"
#include "foilgauge/words.h"
#include "station/disposition.h"
#include "station/export.h"
#include "station/lot_folder.h"
#include "station/news.h"
#include "station/pages.h"

/* The answer waits WAITS times WAIT_MS for a lot to be closed, then states that it goes on. */
enum { WAITS = 40, WAIT_MS = 25 };

static fg_status insert_lot(fg_context *ctx, sqlite3 *writer, const fg_closing *closing,
                            const fg_exported_lot *exported) {
  fg_query query;
  char name[FG_LOT_FOLDER_NAME];
  fg_lot_folder_name(closing->lot, name);
  fg_query_begin(writer,
                 "INSERT INTO lots (name, closed_at, by, folder, verdict, withheld, summary, state)"
                 " VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
                 &query);
  fg_query_text(&query, closing->lot);
  fg_query_integer(&query, fg_station_now());
  fg_query_text(&query, closing->by);
  fg_query_text(&query, name);
  fg_query_text(&query, fg_verdict_word(exported->outcome.judged.verdict));
  fg_query_integer(&query, (int64_t)exported->withheld);
  fg_query_text(&query, exported->words);
  fg_query_text(&query, exported->state);
  fg_query_row(&query);
  return fg_query_end(ctx, &query, "keeping a lot");
}

static fg_status keep_lot(fg_context *ctx, fg_station_database *database, const fg_closing *closing,
                          const fg_exported_lot *exported) {
  FG_TRY(fg_station_database_begin(ctx, database));
  return fg_station_database_end(ctx, database,
                                 insert_lot(ctx, database->writer, closing, exported));
}

static fg_status close_lot(fg_context *ctx, fg_inspection *station) {
  char *folder, *staged = NULL;
  fg_exported_lot exported;
  const fg_closing *closing = &station->closing;
  const char *below = station->request->folder;
  FG_TRY(fg_lot_folder_find(ctx, below, closing->lot, true, &folder));
  fg_status status = fg_lot_folder_stage(ctx, below, closing->lot, &staged);
  if (status == FG_OK)
    status = fg_station_export_lot(ctx, station, closing->lot, staged, &exported);
  if (status == FG_OK) status = fg_lot_folder_publish(ctx, staged, folder);
  if (staged) fg_lot_folder_unstage(staged);
  free(staged);
  free(folder);
  FG_TRY(status);
  return keep_lot(ctx, &station->database, closing, &exported);
}

static void *run_closing(void *user) {
  fg_inspection *station = user;
  fg_closing *closing = &station->closing;
  fg_context ctx = {.message = ""};
  fg_status status = close_lot(&ctx, station);
  pthread_mutex_lock(&closing->mutex);
  fg_text_clip(closing->error, sizeof closing->error, "%s", status == FG_OK ? "" : ctx.message);
  closing->running = false;
  pthread_mutex_unlock(&closing->mutex);
  fg_station_notify(station);
  return NULL;
}

static bool is_running(fg_closing *closing) {
  pthread_mutex_lock(&closing->mutex);
  bool running = closing->running;
  pthread_mutex_unlock(&closing->mutex);
  return running;
}

void fg_closing_end(fg_closing *closing) {
  if (closing->started) pthread_join(closing->thread, NULL);
  closing->started = false;
}

/* The caller holds the mutex: of several requests at once one begins. A thread that no longer runs
 * has given the mutex back, so that it can be waited for here. */
static fg_status begin(fg_context *ctx, fg_inspection *station, const char *lot, const char *by) {
  fg_closing *closing = &station->closing;
  if (closing->running)
    return fg_fail(ctx, FG_ERR_DATA, "The lot '%.127s' is being closed: wait until that is done.",
                   closing->lot);
  fg_closing_end(closing);
  fg_text_clip(closing->lot, sizeof closing->lot, "%s", lot);
  fg_text_clip(closing->by, sizeof closing->by, "%s", by);
  closing->error[0] = '\0';
  closing->running = true;
  closing->started = pthread_create(&closing->thread, NULL, run_closing, station) == 0;
  if (closing->started) return FG_OK;
  closing->running = false;
  return fg_fail(ctx, FG_ERR_MEMORY, "There is no thread for it now: try again.");
}

static fg_status start_closing(fg_context *ctx, fg_inspection *station, const char *lot,
                               const char *by) {
  pthread_mutex_lock(&station->closing.mutex);
  fg_status status = begin(ctx, station, lot, by);
  pthread_mutex_unlock(&station->closing.mutex);
  return status;
}

/* A lot with foils whose fate nobody has said is closed only by who says so. */
static fg_status check_open(fg_context *ctx, fg_inspection *station, const fg_request *request) {
  int64_t open;
  fg_station_database *database = &station->database;
  pthread_mutex_lock(&database->reading);
  fg_status status =
      fg_disposition_count_open(ctx, database->reader, fg_request_get(request, "lot"), &open);
  pthread_mutex_unlock(&database->reading);
  FG_TRY(status);
  if (!open || strtoll(fg_request_get(request, "open"), NULL, 10) >= open) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%lld foil%s of the lot without disposition: go back, and say their fate, or tick "
                 "that the lot is closed with them.",
                 (long long)open, fg_plural((size_t)open));
}

static fg_status check_lot(fg_context *ctx, fg_inspection *station, const char *lot) {
  fg_query query;
  fg_station_database *database = &station->database;
  pthread_mutex_lock(&database->reading);
  fg_query_begin(database->reader, "SELECT 1 FROM foils WHERE lot = ? LIMIT 1", &query);
  fg_query_text(&query, lot);
  bool there = fg_query_row(&query);
  fg_status status = fg_query_end(ctx, &query, "reading the lots");
  pthread_mutex_unlock(&database->reading);
  if (status == FG_OK && !there)
    status = fg_fail(ctx, FG_ERR_USAGE, "There is no foil of the lot '%.127s'.", lot);
  return status;
}

fg_status fg_action_close(fg_context *ctx, fg_inspection *station, const fg_request *request,
                          fg_answer *answer) {
  const char *lot = fg_request_get(request, "lot"), *by = fg_request_get(request, "by");
  const struct timespec pause = {.tv_nsec = WAIT_MS * 1000000L};
  if (!by[strspn(by, " ")])
    return fg_fail(ctx, FG_ERR_DATA, "Who closes the lot? Go back and fill in the name.");
  FG_TRY(check_lot(ctx, station, lot));
  FG_TRY(check_open(ctx, station, request));
  FG_TRY(start_closing(ctx, station, lot, by));
  for (int i = 0; i < WAITS && is_running(&station->closing); i++)
    nanosleep(&pause, NULL);
  strcpy(answer->location, "/lots");
  return FG_OK;
}
