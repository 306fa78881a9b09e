/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "station/backup.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "core/date.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/file.h"
#include "lot/run/folder_lock.h"
#include "station/recovery.h"

enum { TURN_S = 60, HOUR_S = 3600, DAY_S = 86400 };

static const char name_before[] = "foilgauge-", name_after[] = ".sqlite";

/* ---- one backup ---- */

static fg_status vacuum_into(fg_context *ctx, const char *database, const char *path) {
  sqlite3 *connection;
  fg_query query;
  FG_TRY(fg_sql_open(ctx, database, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX, &connection));
  fg_query_begin(connection, "VACUUM INTO ?", &query);
  fg_query_text(&query, path);
  fg_query_row(&query);
  fg_status status = fg_query_end(ctx, &query, path);
  fg_sql_close(connection);
  return status;
}

static fg_status sync_file(fg_context *ctx, const char *path, int flags) {
  int file = open(path, flags | O_CLOEXEC);
  bool done = file >= 0 && fsync(file) == 0;
  int error = errno;
  if (file >= 0) close(file);
  return done ? FG_OK : fg_output_fail(ctx, path, error);
}

/* Gives a hidden file its name, durably. */
static fg_status publish_file(fg_context *ctx, const char *hidden, const char *path) {
  FG_TRY(sync_file(ctx, hidden, O_RDWR));
  if (rename(hidden, path) != 0) return fg_output_fail(ctx, path, errno);
  char *folder = strdup(path), *slash = folder ? strrchr(folder, '/') : NULL;
  if (slash) slash[slash == folder] = '\0';
  fg_status status = sync_file(ctx, slash ? folder : ".", O_RDONLY | O_DIRECTORY);
  free(folder);
  return status;
}

static fg_status hide_name(fg_context *ctx, const char *path, char **hidden) {
  const char *slash = strrchr(path, '/');
  int length = slash ? (int)(slash - path) + 1 : 0;
  return fg_text_print(ctx, hidden, "%.*s.%s.part", length, path, path + length);
}

fg_status fg_backup_write(fg_context *ctx, const char *folder, const char *path) {
  char *database = NULL, *hidden = NULL;
  if (access(path, F_OK) == 0)
    return fg_fail(ctx, FG_ERR_USAGE,
                   "%.800s: exists, and a backup overwrites nothing: name another file", path);
  FG_TRY(fg_text_print(ctx, &database, "%s/%s", folder, FG_STATION_DATABASE));
  fg_status status = fg_station_database_check(ctx, database);
  if (status == FG_OK) status = hide_name(ctx, path, &hidden);
  if (status == FG_OK) {
    unlink(hidden); /* of a backup that was interrupted */
    status = vacuum_into(ctx, database, hidden);
    if (status == FG_OK) status = publish_file(ctx, hidden, path);
    if (status != FG_OK) unlink(hidden);
  }
  free(hidden);
  free(database);
  return status;
}

/* ---- back ---- */

static fg_status check_sound(fg_context *ctx, const char *path) {
  sqlite3 *reader;
  fg_query query;
  FG_TRY(fg_station_database_check(ctx, path));
  FG_TRY(fg_station_database_open_reader(ctx, path, &reader));
  fg_query_begin(reader, "PRAGMA integrity_check(1)", &query);
  bool sound = fg_query_row(&query) && !strcmp(fg_query_get_text(&query, 0), "ok");
  fg_status status = fg_query_end(ctx, &query, path);
  fg_sql_close(reader);
  if (status != FG_OK || sound) return status;
  return fg_fail(ctx, FG_ERR_DATA, "%.800s: the backup is damaged: take an older one", path);
}

/* Event numbers after the backup come again: receivers must not take them for those they have. */
static fg_status renew_identity(fg_context *ctx, const char *path) {
  sqlite3 *writer;
  fg_status status = fg_sql_open(ctx, path, SQLITE_OPEN_READWRITE, &writer);
  if (status == FG_OK)
    status = fg_sql_run(ctx, writer,
                        "PRAGMA journal_mode = DELETE;"
                        "UPDATE identity SET id = lower(hex(randomblob(16)))");
  fg_sql_close(writer);
  return status;
}

/* The database that is there, with its journals, gets another name. */
static fg_status move_away(fg_context *ctx, const char *database) {
  static const char *const endings[] = {"-wal", "-shm", ""};
  char stamp[FG_DATE_STAMP];
  fg_date_format_stamp(time(NULL), stamp);
  for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
    char *from = NULL, *to = NULL;
    fg_status status = fg_text_print(ctx, &from, "%s%s", database, endings[i]);
    if (status == FG_OK)
      status = fg_text_print(ctx, &to, "%s.before-%s%s", database, stamp, endings[i]);
    if (status == FG_OK && rename(from, to) != 0 && errno != ENOENT)
      status = fg_output_fail(ctx, to, errno);
    free(from);
    free(to);
    FG_TRY(status);
  }
  return FG_OK;
}

static fg_status replace_database(fg_context *ctx, const char *folder, const char *path) {
  char *database = NULL, *hidden = NULL;
  FG_TRY(fg_text_print(ctx, &database, "%s/%s", folder, FG_STATION_DATABASE));
  fg_status status = hide_name(ctx, database, &hidden);
  if (status == FG_OK) {
    unlink(hidden);
    status = vacuum_into(ctx, path, hidden);
  }
  if (status == FG_OK) status = renew_identity(ctx, hidden);
  if (status == FG_OK) status = move_away(ctx, database);
  if (status == FG_OK) status = publish_file(ctx, hidden, database);
  if (status != FG_OK && hidden) unlink(hidden);
  free(hidden);
  free(database);
  return status;
}

fg_status fg_backup_restore(fg_context *ctx, const char *folder, const char *path) {
  int lock;
  FG_TRY(check_sound(ctx, path));
  FG_TRY(fg_folder_lock(ctx, folder, &lock));
  fg_status status = replace_database(ctx, folder, path);
  close(lock);
  return status;
}

/* ---- by the recipe ---- */

struct fg_backup {
  pthread_mutex_t mutex;
  pthread_cond_t woken;
  pthread_t thread;
  bool started, closing;
};

/* Name of a backup of this station's kind: foilgauge-20260301-140233.sqlite. */
static bool is_backup(const char *name) {
  size_t length = strlen(name), before = sizeof name_before - 1, after = sizeof name_after - 1;
  return length == before + 15 + after && !strncmp(name, name_before, before) &&
         !strcmp(name + length - after, name_after) && strspn(name + before, "0123456789-") == 15;
}

/* Returns the time in the name, by this machine's clock: that of a NAS may differ. */
static time_t time_of_backup(const char *name) {
  struct tm at = {.tm_isdst = -1};
  if (sscanf(name + sizeof name_before - 1, "%4d%2d%2d-%2d%2d%2d", &at.tm_year, &at.tm_mon,
             &at.tm_mday, &at.tm_hour, &at.tm_min, &at.tm_sec) != 6)
    return 0;
  at.tm_year -= 1900;
  at.tm_mon--;
  return mktime(&at);
}

/* Finds the time of the newest backup (0: none) and removes those that are too old, but not the
 * newest. One of the future was made before the clock was set back: its age is unknown. */
static time_t inspect_folder(const fg_station_backup *settings) {
  time_t newest = 0, now = time(NULL);
  for (int pass = 0; pass < 2; pass++) {
    DIR *folder = opendir(settings->folder);
    if (!folder) return newest;
    for (struct dirent *entry; (entry = readdir(folder));) {
      if (!is_backup(entry->d_name)) continue;
      time_t made = time_of_backup(entry->d_name);
      if (made > newest && difftime(made, now) < HOUR_S) newest = made;
      if (pass && settings->keep_days > 0 && made < newest &&
          difftime(now, made) > settings->keep_days * DAY_S)
        unlinkat(dirfd(folder), entry->d_name, 0);
    }
    closedir(folder);
  }
  return newest;
}

static fg_status write_scheduled(fg_context *ctx, const fg_inspection *station) {
  char stamp[FG_DATE_STAMP], *path = NULL;
  const fg_station_backup *settings = &station->settings->backup;
  if (mkdir(settings->folder, 0755) != 0 && errno != EEXIST)
    return fg_output_fail(ctx, settings->folder, errno);
  fg_date_format_stamp(time(NULL), stamp);
  FG_TRY(fg_text_print(ctx, &path, "%s/%s%s%s", settings->folder, name_before, stamp, name_after));
  fg_status status = fg_backup_write(ctx, station->request->folder, path);
  free(path);
  return status;
}

/* A failure is told in the log and on the pages, and tried again. */
static void back_up_when_due(fg_inspection *station) {
  const fg_station_backup *settings = &station->settings->backup;
  fg_context inner = {.message = ""};
  if (difftime(time(NULL), inspect_folder(settings)) < settings->every_h * HOUR_S) return;
  fg_status status = write_scheduled(&inner, station);
  if (status == FG_OK) inspect_folder(settings);
  fg_station_set_backup_failure(station, status == FG_OK ? "" : inner.message);
}

static void *run_backups(void *user) {
  fg_inspection *station = user;
  struct fg_backup *backup = station->backup;
  pthread_mutex_lock(&backup->mutex);
  while (!backup->closing) {
    pthread_mutex_unlock(&backup->mutex);
    back_up_when_due(station);
    struct timespec end;
    clock_gettime(CLOCK_REALTIME, &end);
    end.tv_sec += TURN_S;
    pthread_mutex_lock(&backup->mutex);
    if (!backup->closing) pthread_cond_timedwait(&backup->woken, &backup->mutex, &end);
  }
  pthread_mutex_unlock(&backup->mutex);
  return NULL;
}

fg_status fg_backup_begin(fg_context *ctx, fg_inspection *station) {
  void *block;
  if (!station->settings->backup.folder[0]) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof(struct fg_backup), &block));
  struct fg_backup *backup = station->backup = block;
  *backup = (struct fg_backup){.started = false};
  pthread_mutex_init(&backup->mutex, NULL);
  pthread_cond_init(&backup->woken, NULL);
  backup->started = pthread_create(&backup->thread, NULL, run_backups, station) == 0;
  return backup->started ? FG_OK : fg_fail(ctx, FG_ERR_MEMORY, "no thread for backups");
}

void fg_backup_end(fg_inspection *station) {
  struct fg_backup *backup = station->backup;
  if (!backup) return;
  pthread_mutex_lock(&backup->mutex);
  backup->closing = true;
  pthread_cond_signal(&backup->woken);
  pthread_mutex_unlock(&backup->mutex);
  if (backup->started) pthread_join(backup->thread, NULL);
  free(backup);
  station->backup = NULL;
}
