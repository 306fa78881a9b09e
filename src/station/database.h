/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The station's database: one file in the folder, in WAL mode, with a version.
 *
 * One connection writes (under a lock, in transactions), another reads; both belong to the
 * process that holds the folder's lock. Times are milliseconds since 1970, UTC, by the clock of
 * then; the order is that of `id`, which no clock turns back. */
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
  dev_t device; /* identity of the file: another one may take its name */
  ino_t inode;
  int64_t in_file; /* the writer's changes that have reached the file itself, beyond its journal */
  double in_file_at; /* time of that (fg_clock_seconds) */
} fg_station_database;

/* Opens or makes folder/FG_STATION_DATABASE and brings it up to date. FG_ERR_DATA: damaged, no
 * database, or of a later program. */
fg_status fg_station_database_open(fg_context *ctx, const char *folder,
                                   fg_station_database *database);
/* FG_ERR_DATA or FG_ERR_IO unless there is a database of this program's version: a reader brings
 * none up to date. */
fg_status fg_station_database_check(fg_context *ctx, const char *path);

/* Opens another connection that reads, for work that must not keep the pages waiting; the caller
 * closes it. */
fg_status fg_station_database_open_reader(fg_context *ctx, const char *path, sqlite3 **reader);
/* Closes it; all data is then in the file itself, unless another program is reading it. An
 * all-zero one is accepted. */
void fg_station_database_close(fg_station_database *database);

/* Moves the journal into the file from time to time: a copy of the file alone misses seconds at
 * most. */
void fg_station_database_keep_up(fg_station_database *database);

/* Returns true when the open file still has its name. */
bool fg_station_database_is_there(const fg_station_database *database);

/* Replaces the open database by the one in the folder now; on failure the open one stays. Any
 * thread, with neither lock. */
fg_status fg_station_database_reopen(fg_context *ctx, const char *folder,
                                     fg_station_database *database);

/* Begin and end a transaction: between them the caller has the writer alone. It does not begin
 * in a file that is no longer in the folder (FG_ERR_IO): its data would be lost. The end commits
 * when `status` is FG_OK, else rolls back, and returns `status`, or the failure to commit. */
fg_status fg_station_database_begin(fg_context *ctx, fg_station_database *database);
fg_status fg_station_database_end(fg_context *ctx, fg_station_database *database, fg_status status);

/* Returns the present time, as times are kept. */
int64_t fg_station_now(void);

/* SQL: a row of `foils` is the newest scan of its foil, of those that measured it. Foils without a
 * serial number are scanned once. */
#define FG_NEWEST_SCAN_OF_FOIL                                                                     \
  " (foils.serial = '' OR NOT EXISTS (SELECT 1 FROM foils AS later INDEXED BY foils_by_serial"     \
  " WHERE later.serial = foils.serial AND later.lot = foils.lot AND later.id > foils.id AND"       \
  " later.verdict <> 'not_measured'))"

#endif
