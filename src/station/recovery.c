/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/recovery.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/text.h"
#include "lot/run/folder_lock.h"
#include "station/news.h"
#include "station/part_recipes.h"

void fg_station_set_recovery(fg_inspection *station, const char *words) {
  fg_recovery *recovery = &station->recovery;
  const fg_station_request *request = station->request;
  pthread_mutex_lock(&recovery->mutex);
  bool changed = strncmp(recovery->words, words, sizeof recovery->words - 1) != 0;
  if (changed) fg_text_clip(recovery->words, sizeof recovery->words, "%s", words);
  pthread_mutex_unlock(&recovery->mutex);
  if (!changed) return;
  if (request->looked_at)
    request->looked_at(request->user, *words ? words : "the station goes on:",
                       *words ? "(it is tried again)" : "what was in its way is over");
  fg_station_notify(station);
}

void fg_station_set_backup_failure(fg_inspection *station, const char *words) {
  fg_recovery *recovery = &station->recovery;
  const fg_station_request *request = station->request;
  pthread_mutex_lock(&recovery->mutex);
  bool changed = strncmp(recovery->backup, words, sizeof recovery->backup - 1) != 0;
  if (changed) fg_text_clip(recovery->backup, sizeof recovery->backup, "%s", words);
  pthread_mutex_unlock(&recovery->mutex);
  if (!changed) return;
  if (request->looked_at)
    request->looked_at(request->user, "backup:", *words ? words : "is made again");
  fg_station_notify(station);
}

void fg_station_note_files(fg_inspection *station, size_t files, double seconds) {
  fg_recovery *recovery = &station->recovery;
  const fg_station_request *request = station->request;
  char words[sizeof recovery->crowd] = "";
  if (files > FG_STATION_FILES)
    fg_text_clip(
        words, sizeof words,
        "The folder holds %zu files; looking through them takes %.1f s each time. Move old "
        "ones elsewhere: what was measured stays in the database.",
        files, seconds);
  pthread_mutex_lock(&recovery->mutex);
  bool changed = !recovery->crowd[0] != !words[0];
  strcpy(recovery->crowd, words);
  pthread_mutex_unlock(&recovery->mutex);
  if (changed && request->looked_at)
    request->looked_at(request->user, request->folder,
                       words[0] ? words : "The folder does not hold too many files any more.");
  if (changed) fg_station_notify(station);
}

static bool has_lock(const fg_inspection *station) {
  char *path;
  struct stat file, own;
  if (fg_text_print(NULL, &path, "%s/.lock", station->request->folder) != FG_OK) return true;
  bool same = stat(path, &file) == 0 && fstat(station->lock, &own) == 0 &&
              file.st_dev == own.st_dev && file.st_ino == own.st_ino;
  free(path);
  return same;
}

/* The old lock is given back last: its folder is not another station's before this one has left. */
static fg_status acquire_lock(fg_context *ctx, fg_inspection *station) {
  int lock;
  FG_TRY(fg_folder_lock(ctx, station->request->folder, &lock));
  close(station->lock);
  station->lock = lock;
  return FG_OK;
}

fg_status fg_station_ensure_folder(fg_context *ctx, fg_inspection *station) {
  struct stat info;
  const char *folder = station->request->folder;
  fg_station_database *database = &station->database;
  if (stat(folder, &info) != 0 || !S_ISDIR(info.st_mode))
    return fg_fail(ctx, FG_ERR_IO, "%s: the folder is gone", folder);
  if (!has_lock(station)) FG_TRY(acquire_lock(ctx, station));
  if (fg_station_database_is_there(database)) return FG_OK;
  FG_TRY(fg_station_database_reopen(ctx, folder, database));
  return fg_part_recipes_keep_setups(ctx, station);
}
