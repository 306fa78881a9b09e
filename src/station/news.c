/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/news.h"

#include <string.h>

#include "core/text.h"

void fg_station_notify(fg_inspection *station) {
  atomic_fetch_add(&station->news, 1);
  if (station->wake) station->wake(station->server);
  if (station->pass_on) station->pass_on(station);
}

long long fg_station_news(fg_inspection *station) {
  return atomic_load(&station->news);
}

static bool is_of(const fg_arriving *at, const char *file) {
  return at->stage != FG_STAGE_NONE && !strncmp(at->file, file, sizeof at->file - 1);
}

void fg_station_set_stage(fg_inspection *station, fg_stage stage, const char *file) {
  fg_arriving *at = &station->arriving;
  bool changed = false;
  pthread_mutex_lock(&at->mutex);
  bool same_file = is_of(at, file);
  if (same_file || at->stage == FG_STAGE_NONE || stage == FG_STAGE_MEASURING) {
    changed = at->stage != stage || !same_file;
    if (!same_file) at->since = fg_station_now();
    if (!same_file) fg_text_clip(at->file, sizeof at->file, "%s", file);
    at->stage = stage;
    at->seen = true;
  }
  pthread_mutex_unlock(&at->mutex);
  if (changed) fg_station_notify(station);
}

static void end_if(fg_inspection *station, bool ends) {
  if (ends) station->arriving.stage = FG_STAGE_NONE;
  pthread_mutex_unlock(&station->arriving.mutex);
  if (ends) fg_station_notify(station);
}

void fg_station_end_stage(fg_inspection *station, const char *file) {
  pthread_mutex_lock(&station->arriving.mutex);
  end_if(station, is_of(&station->arriving, file));
}

void fg_station_begin_round(fg_inspection *station) {
  pthread_mutex_lock(&station->arriving.mutex);
  station->arriving.seen = false;
  pthread_mutex_unlock(&station->arriving.mutex);
}

void fg_station_end_round(fg_inspection *station) {
  pthread_mutex_lock(&station->arriving.mutex);
  end_if(station, station->arriving.stage != FG_STAGE_NONE && !station->arriving.seen);
}

void fg_station_read_stage(fg_inspection *station, fg_arriving *copy) {
  fg_arriving *at = &station->arriving;
  pthread_mutex_lock(&at->mutex);
  copy->stage = at->stage;
  copy->since = at->since;
  memcpy(copy->file, at->file, sizeof copy->file);
  pthread_mutex_unlock(&at->mutex);
}
