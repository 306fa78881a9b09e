/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The station's database: one file in the folder, in WAL mode, with a version.
 *
 * One connection writes (under a lock, in transactions), another reads; both belong to the
 * process that holds the folder's lock. Times are milliseconds since 1970, UTC, as the clock was:
 * what came after what is told by `id`, which no clock turns back. */
#ifndef FG_STATION_DATABASE_H
#define FG_STATION_DATABASE_H

#include <pthread.h>
#include <stdbool.h>
#include <sys/types.h>

#include "station/sql.h"

typedef struct fg_station_database {
  sqlite3 *writer, *reader;
  pthread_mutex_t writing, reading;
  char *path;
  dev_t device; /* which file it is: another one may come under its name */
  ino_t inode;
  int64_t in_file;   /* the writer's changes that are in the file itself, not in its journal only */
  double in_file_at; /* when that was so (fg_clock_seconds) */
} fg_station_database;

/* Opens or makes folder/FG_STATION_DATABASE and brings it up to date. FG_ERR_DATA: damaged, no
 * database, or of a later program. */
fg_status fg_station_database_open(fg_context *ctx, const char *folder,
                                   fg_station_database *database);
/* Everything is in the file itself then, unless another program reads it at the time. Of an
 * all-zero one, too. */
void fg_station_database_close(fg_station_database *database);

/* Now and then, where something was written, moves the journal into the file: whoever copies the
 * file alone misses seconds. */
void fg_station_database_keep_up(fg_station_database *database);

/* Whether the file that is open still lies under its name. */
bool fg_station_database_is_there(const fg_station_database *database);

/* What lies in the folder now takes the place of what is open, which is left as it is where that
 * fails. Any thread, with neither lock. */
fg_status fg_station_database_reopen(fg_context *ctx, const char *folder,
                                     fg_station_database *database);

/* A transaction: between the two the caller has the writer alone. It does not begin in a file that
 * no longer lies in the folder (FG_ERR_IO): what it keeps would be lost. Commits when `status` is
 * FG_OK, else takes everything back, and returns `status`, or why it could not be committed. */
fg_status fg_station_database_begin(fg_context *ctx, fg_station_database *database);
fg_status fg_station_database_end(fg_context *ctx, fg_station_database *database, fg_status status);

/* Now, as times are kept. */
int64_t fg_station_now(void);

#endif
