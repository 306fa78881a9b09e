/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/outbox/outbox.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/date.h"
#include "core/memory.h"
#include "core/text.h"
#include "station/news.h"
#include "station/outbox/lane.h"

enum { LANES = FG_STATION_DESTINATIONS + 1 };
static const double retry_first_s = 1, retry_max_s = 300, idle_s = 30;

struct fg_outbox {
  pthread_mutex_t mutex;
  pthread_cond_t woken;
  unsigned long turns; /* how often somebody has woken it */
  atomic_bool closing;
  char station_name[FG_PART_NAME];
  fg_station_destination hub;
  fg_lane lanes[LANES];
  size_t count;
};

static void add_lane(fg_outbox *outbox, fg_inspection *station,
                     const fg_station_destination *destination, bool from_start) {
  outbox->lanes[outbox->count++] = (fg_lane){.station = station,
                                             .destination = destination,
                                             .station_name = outbox->station_name,
                                             .from_start = from_start,
                                             .closing = &outbox->closing};
}

/* A hub is a receiver that gets all parts of the database. */
static void add_hub(fg_outbox *outbox, fg_inspection *station) {
  const fg_station_request *request = station->request;
  size_t length = strlen(request->hub);
  while (length && request->hub[length - 1] == '/')
    length--;
  fg_text_clip(outbox->hub.to, sizeof outbox->hub.to, "%.*s/api/parts", (int)length, request->hub);
  fg_text_clip(outbox->hub.token_file, sizeof outbox->hub.token_file, "%s",
               request->hub_token_file ? request->hub_token_file : "");
  add_lane(outbox, station, &outbox->hub, true);
}

static fg_status make_outbox(fg_context *ctx, fg_inspection *station) {
  void *block;
  const fg_station_settings *settings = station->settings;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof(fg_outbox), &block));
  fg_outbox *outbox = station->outbox = block;
  *outbox = (fg_outbox){.count = 0};
  pthread_condattr_t clock;
  pthread_condattr_init(&clock);
  pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
  pthread_cond_init(&outbox->woken, &clock);
  pthread_condattr_destroy(&clock);
  pthread_mutex_init(&outbox->mutex, NULL);
  atomic_init(&outbox->closing, false);
  fg_part_station_name(station->request, outbox->station_name);
  for (size_t i = 0; i < settings->pass_on_count; i++)
    add_lane(outbox, station, &settings->pass_on[i], false);
  if (station->request->hub) add_hub(outbox, station);
  for (size_t i = 0; i < outbox->count; i++)
    FG_TRY(fg_lane_begin(ctx, &outbox->lanes[i]));
  return FG_OK;
}

static double wait_after(size_t attempts) {
  double wait = retry_first_s;
  for (size_t i = 1; i < attempts && wait < retry_max_s; i++)
    wait *= 2;
  return wait < retry_max_s ? wait : retry_max_s;
}

/* Notes the result of an attempt. Pages hear of it where trouble begins or is over. */
static void note_result(fg_outbox *outbox, fg_lane *lane, fg_status status, const char *words) {
  pthread_mutex_lock(&outbox->mutex);
  bool changed = !lane->error[0] != (status == FG_OK);
  fg_text_clip(lane->error, sizeof lane->error, "%s", status == FG_OK ? "" : words);
  lane->attempts = status == FG_OK ? 0 : lane->attempts + 1;
  lane->retry_at = status == FG_OK ? 0 : fg_clock_seconds() + wait_after(lane->attempts);
  pthread_mutex_unlock(&outbox->mutex);
  if (!changed || atomic_load(&outbox->closing)) return;
  const fg_station_request *request = lane->station->request;
  if (request->looked_at)
    request->looked_at(request->user, lane->destination->to,
                       status == FG_OK ? "gets parts again" : words);
  fg_station_notify(lane->station);
}

static struct timespec monotonic_time(double seconds) {
  struct timespec at = {.tv_sec = (time_t)seconds};
  at.tv_nsec = (long)((seconds - floor(seconds)) * 1e9);
  return at;
}

/* Waits until `until`, until the outbox ends or, where the lane is idle, until it is woken. */
static void wait_until(fg_outbox *outbox, double until, bool idle, unsigned long seen) {
  const struct timespec end = monotonic_time(until);
  pthread_mutex_lock(&outbox->mutex);
  while (!atomic_load(&outbox->closing) && !(idle && outbox->turns != seen) &&
         fg_clock_seconds() < until)
    pthread_cond_timedwait(&outbox->woken, &outbox->mutex, &end);
  pthread_mutex_unlock(&outbox->mutex);
}

static unsigned long count_turns(fg_outbox *outbox) {
  pthread_mutex_lock(&outbox->mutex);
  unsigned long turns = outbox->turns;
  pthread_mutex_unlock(&outbox->mutex);
  return turns;
}

static void *run_lane(void *user) {
  fg_lane *lane = user;
  fg_outbox *outbox = lane->station->outbox;
  while (!atomic_load(&outbox->closing)) {
    bool idle;
    fg_context inner = {.message = ""};
    unsigned long seen = count_turns(outbox);
    fg_status status = fg_lane_deliver(&inner, lane, &idle);
    note_result(outbox, lane, status, inner.message);
    if (status != FG_OK)
      wait_until(outbox, lane->retry_at, false, seen);
    else if (idle)
      wait_until(outbox, fg_clock_seconds() + idle_s, true, seen);
  }
  return NULL;
}

fg_status fg_outbox_open(fg_context *ctx, fg_inspection *station) {
  bool needed = station->settings->pass_on_count || station->request->hub;
  return needed ? make_outbox(ctx, station) : FG_OK;
}

static void wake_lanes(fg_inspection *station) {
  fg_outbox *outbox = station->outbox;
  pthread_mutex_lock(&outbox->mutex);
  outbox->turns++;
  pthread_cond_broadcast(&outbox->woken);
  pthread_mutex_unlock(&outbox->mutex);
}

fg_status fg_outbox_begin(fg_context *ctx, fg_inspection *station) {
  fg_outbox *outbox = station->outbox;
  if (!outbox) return FG_OK;
  station->pass_on = wake_lanes;
  for (size_t i = 0; i < outbox->count; i++) {
    fg_lane *lane = &outbox->lanes[i];
    lane->started = pthread_create(&lane->thread, NULL, run_lane, lane) == 0;
    if (!lane->started) return fg_fail(ctx, FG_ERR_MEMORY, "no thread to pass parts on");
  }
  return FG_OK;
}

static void flush_lane(fg_outbox *outbox, fg_lane *lane) {
  fg_context inner = {.message = ""};
  bool idle = false;
  fg_status status = FG_OK;
  while (status == FG_OK && !idle)
    status = fg_lane_deliver(&inner, lane, &idle);
  note_result(outbox, lane, status, inner.message);
}

void fg_outbox_flush(fg_inspection *station) {
  fg_outbox *outbox = station->outbox;
  for (size_t i = 0; outbox && i < outbox->count; i++)
    flush_lane(outbox, &outbox->lanes[i]);
}

void fg_outbox_end(fg_inspection *station) {
  fg_outbox *outbox = station->outbox;
  if (!outbox) return;
  atomic_store(&outbox->closing, true);
  wake_lanes(station);
  for (size_t i = 0; i < outbox->count; i++) {
    if (outbox->lanes[i].started) pthread_join(outbox->lanes[i].thread, NULL);
    fg_lane_end(&outbox->lanes[i]);
  }
  station->outbox = NULL;
  station->pass_on = NULL;
  free(outbox);
}

static void read_row(sqlite3 *reader, const fg_lane *lane, fg_outbox_receiver *state) {
  fg_query query;
  fg_query_begin(reader,
                 "SELECT count, (SELECT count(*) FROM events WHERE id > passed),"
                 " CASE WHEN passed_at THEN strftime('%Y-%m-%dT%H:%M:%SZ', passed_at / 1000,"
                 " 'unixepoch') ELSE '' END FROM destinations WHERE name = ?",
                 &query);
  fg_query_text(&query, lane->name);
  if (fg_query_row(&query)) {
    state->passed = (size_t)fg_query_get_integer(&query, 0);
    state->waiting = (size_t)fg_query_get_integer(&query, 1);
    fg_text_clip(state->passed_at, sizeof state->passed_at, "%s", fg_query_get_text(&query, 2));
  }
  fg_query_end(NULL, &query, "reading the outbox");
}

bool fg_outbox_read(fg_inspection *station, sqlite3 *reader, size_t i, fg_outbox_receiver *state) {
  fg_outbox *outbox = station->outbox;
  if (!outbox || i >= outbox->count) return false;
  const fg_lane *lane = &outbox->lanes[i];
  *state = (fg_outbox_receiver){.retry_s = NAN};
  fg_text_clip(state->to, sizeof state->to, "%s", lane->destination->to);
  state->format = fg_part_format_ending(lane->destination->format) + 1;
  pthread_mutex_lock(&outbox->mutex);
  fg_text_clip(state->error, sizeof state->error, "%s", lane->error);
  state->attempts = lane->attempts;
  double wait = lane->retry_at - fg_clock_seconds();
  if (lane->retry_at > 0) state->retry_s = wait > 0 ? wait : 0;
  pthread_mutex_unlock(&outbox->mutex);
  read_row(reader, lane, state);
  return true;
}
