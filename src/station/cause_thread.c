/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/cause_thread.h"

#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/text.h"
#include "station/cause_keep.h"
#include "station/news.h"

enum { SEARCH_NICENESS = 5 }; /* nice value: a third of the share of a measurement */

static fg_status search_data(fg_context *ctx, const fg_station_request *request, sqlite3 *reader,
                             const fg_trend_choice *choice, fg_cause_report *report) {
  fg_station_contexts contexts;
  fg_cause_data data = {0};
  fg_cause *accepted = NULL;
  size_t count = 0;
  FG_TRY(fg_station_contexts_load(ctx, request, &contexts));
  fg_status status = fg_cause_data_read(ctx, reader, &contexts, choice, &data);
  if (status == FG_OK) status = fg_causes_read(ctx, reader, choice, &accepted, &count);
  if (status == FG_OK) status = fg_cause_search(ctx, &data, accepted, count, report);
  fg_causes_free(accepted, count);
  fg_cause_data_free(&data);
  fg_station_contexts_free(&contexts);
  return status;
}

fg_status fg_cause_search_database(fg_context *ctx, const fg_station_request *request,
                                   const char *database, const fg_trend_choice *choice,
                                   fg_cause_report *report) {
  sqlite3 *reader;
  FG_TRY(fg_station_database_open_reader(ctx, database, &reader));
  fg_status status = search_data(ctx, request, reader, choice, report);
  fg_sql_close(reader);
  return status;
}

/* Lowers the priority of this thread, and of those that it starts. It is not the lowest: on a busy
 * machine the answer would never come. */
static void lower_priority(void) {
  setpriority(PRIO_PROCESS, (id_t)gettid(), SEARCH_NICENESS);
}

static void *run_search(void *user) {
  fg_inspection *station = user;
  fg_cause_thread *search = station->cause_thread;
  fg_context ctx = {.message = ""};
  fg_cause_report report = {0};
  lower_priority();
  fg_status status = fg_cause_search_database(&ctx, station->request, station->database.path,
                                              &search->choice, &report);
  pthread_mutex_lock(&search->mutex);
  fg_text_clip(search->error, sizeof search->error, "%s", status == FG_OK ? "" : ctx.message);
  fg_cause_report_free(&search->report);
  if (status == FG_OK) search->report = report;
  search->at = fg_station_now();
  search->running = false;
  pthread_mutex_unlock(&search->mutex);
  fg_station_notify(station);
  return NULL;
}

/* The caller holds the mutex. */
static fg_status start_search(fg_context *ctx, fg_inspection *station,
                              const fg_trend_choice *choice) {
  fg_cause_thread *search = station->cause_thread;
  if (search->running)
    return fg_fail(ctx, FG_ERR_DATA, "Another search for causes is running: wait until it ends.");
  if (search->started) pthread_join(search->thread, NULL);
  search->choice = *choice;
  search->running = true;
  search->started = pthread_create(&search->thread, NULL, run_search, station) == 0;
  if (search->started) return FG_OK;
  search->running = false;
  return fg_fail(ctx, FG_ERR_MEMORY, "There is no thread for it now: try again.");
}

fg_status fg_cause_thread_start(fg_context *ctx, fg_inspection *station) {
  FG_TRY(
      fg_memory_allocate(ctx, 1, sizeof *station->cause_thread, (void **)&station->cause_thread));
  pthread_mutex_init(&station->cause_thread->mutex, NULL);
  return FG_OK;
}

void fg_cause_thread_stop(fg_inspection *station) {
  if (!station->cause_thread) return;
  if (station->cause_thread->started) pthread_join(station->cause_thread->thread, NULL);
  fg_cause_report_free(&station->cause_thread->report);
  free(station->cause_thread);
  station->cause_thread = NULL;
}

static void go_to_choice(const char *page, const fg_trend_choice *choice, fg_answer *answer) {
  char *text = NULL;
  size_t size;
  FILE *out = fg_stream_open(&text, &size);
  if (!out) return;
  fg_trend_write_query(out, page, choice);
  const char *location = fg_stream_keep(out, &text) ? text : "/trends";
  fg_text_clip(answer->location, sizeof answer->location, "%s", location);
  free(text);
}

fg_status fg_action_why(fg_context *ctx, fg_inspection *station, const fg_request *request,
                        fg_answer *answer) {
  fg_trend_choice choice;
  FG_TRY(fg_trend_choose(ctx, station, request, &choice));
  pthread_mutex_lock(&station->cause_thread->mutex);
  fg_status status = start_search(ctx, station, &choice);
  pthread_mutex_unlock(&station->cause_thread->mutex);
  go_to_choice("/why", &choice, answer);
  return status;
}

static bool is_same_choice(const fg_trend_choice *one, const fg_trend_choice *other) {
  return one->row == other->row && one->owner == other->owner && one->bump == other->bump &&
         !strcmp(one->lot, other->lot) && !strcmp(one->die, other->die);
}

/* A copy of a found cause, while the mutex is held. */
static fg_status copy_cause(fg_context *ctx, const fg_cause_thread *search,
                            const fg_trend_choice *choice, const fg_request *request,
                            fg_cause *cause) {
  char *end;
  const char *number = fg_request_get(request, "cause");
  size_t k = strtoul(number, &end, 10);
  bool there = *number && !*end && !search->running && is_same_choice(&search->choice, choice) &&
               k < search->report.causes &&
               !strcmp(search->report.cause[k].words_of, fg_request_get(request, "words"));
  if (!there)
    return fg_fail(ctx, FG_ERR_DATA,
                   "The search has been made again since this page was loaded: go back and load it "
                   "again.");
  *cause = search->report.cause[k];
  size_t bytes = cause->points * sizeof *cause->point;
  FG_TRY(fg_memory_allocate(ctx, cause->points, sizeof *cause->point, (void **)&cause->point));
  memcpy(cause->point, search->report.cause[k].point, bytes);
  return FG_OK;
}

static fg_status check_who(fg_context *ctx, const char *by) {
  if (by[strspn(by, " ")]) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "Who says so? Go back and fill in the name.");
}

fg_status fg_action_accept(fg_context *ctx, fg_inspection *station, const fg_request *request,
                           fg_answer *answer) {
  fg_trend_choice choice;
  fg_cause cause = {0};
  const char *by = fg_request_get(request, "by");
  FG_TRY(check_who(ctx, by));
  FG_TRY(fg_trend_choose(ctx, station, request, &choice));
  pthread_mutex_lock(&station->cause_thread->mutex);
  fg_status status = copy_cause(ctx, station->cause_thread, &choice, request, &cause);
  pthread_mutex_unlock(&station->cause_thread->mutex);
  FG_TRY(status);
  status =
      fg_cause_keep(ctx, &station->database, &choice, &cause, by, fg_request_get(request, "note"));
  free(cause.point);
  FG_TRY(status);
  fg_station_notify(station);
  go_to_choice("/trends", &choice, answer);
  return FG_OK;
}

fg_status fg_action_withdraw(fg_context *ctx, fg_inspection *station, const fg_request *request,
                             fg_answer *answer) {
  fg_query query;
  fg_trend_choice choice;
  sqlite3 *writer = station->database.writer;
  const char *by = fg_request_get(request, "by");
  FG_TRY(check_who(ctx, by));
  FG_TRY(fg_trend_choose(ctx, station, request, &choice));
  FG_TRY(fg_station_database_begin(ctx, &station->database));
  writer = station->database.writer;
  fg_query_begin(writer,
                 "UPDATE causes SET withdrawn_by = ?, withdrawn_at = ? WHERE id = ? AND"
                 " withdrawn_at = 0",
                 &query);
  fg_query_text(&query, by);
  fg_query_integer(&query, fg_station_now());
  fg_query_integer(&query, strtoll(fg_request_get(request, "cause"), NULL, 10));
  fg_query_row(&query);
  FG_TRY(fg_station_database_end(ctx, &station->database,
                                 fg_query_end(ctx, &query, "withdrawing a cause")));
  fg_station_notify(station);
  go_to_choice("/trends", &choice, answer);
  return FG_OK;
}
