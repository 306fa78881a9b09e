/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Backups of the database: by command, by the recipe, and back. */
#ifndef FG_STATION_BACKUP_H
#define FG_STATION_BACKUP_H

#include "station/state.h"

/* Writes a copy of the folder's database, also beside a station that runs: a file that appears once
 * it is whole. FG_ERR_USAGE: `path` exists. */
fg_status fg_backup_write(fg_context *ctx, const char *folder, const char *path);

/* Puts a backup in the place of the folder's database, whose station has ended. The database that
 * was there stays beside it under another name. The station gets a new identity: event numbers come
 * again. FG_ERR_DATA: `path` is no sound database of a station. */
fg_status fg_backup_restore(fg_context *ctx, const char *folder, const char *path);

/* Begins the backups that the recipe asks for, and ends them. */
fg_status fg_backup_begin(fg_context *ctx, fg_inspection *station);
void fg_backup_end(fg_inspection *station);

#endif
