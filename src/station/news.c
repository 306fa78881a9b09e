#include "station/news.h"

#include <string.h>

#include "core/text.h"

void fg_station_tell(fg_inspection *station) {
  atomic_fetch_add(&station->news, 1);
  if (station->wake) station->wake(station->server);
}

long long fg_station_news(fg_inspection *station) {
  return atomic_load(&station->news);
}

void fg_station_set_stage(fg_inspection *station, fg_stage stage, const char *file) {
  fg_arriving *at = &station->arriving;
  pthread_mutex_lock(&at->mutex);
  bool same_file = !strncmp(at->file, file, sizeof at->file - 1);
  bool changed = at->stage != stage || !same_file;
  if (changed) at->since = fg_station_now();
  at->stage = stage;
  if (!same_file) fg_text_clip(at->file, sizeof at->file, "%s", file);
  pthread_mutex_unlock(&at->mutex);
  if (changed) fg_station_tell(station);
}

void fg_station_end_stage(fg_inspection *station, const char *file) {
  fg_arriving *at = &station->arriving;
  pthread_mutex_lock(&at->mutex);
  bool ends =
      at->stage != FG_STAGE_NONE && (!file || !strncmp(at->file, file, sizeof at->file - 1));
  if (ends) at->stage = FG_STAGE_NONE;
  if (ends) at->file[0] = '\0';
  pthread_mutex_unlock(&at->mutex);
  if (ends) fg_station_tell(station);
}

void fg_station_read_stage(fg_inspection *station, fg_arriving *copy) {
  fg_arriving *at = &station->arriving;
  pthread_mutex_lock(&at->mutex);
  copy->stage = at->stage;
  copy->since = at->since;
  memcpy(copy->file, at->file, sizeof copy->file);
  pthread_mutex_unlock(&at->mutex);
}
