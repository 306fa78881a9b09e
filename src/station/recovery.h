/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recovery of a running station: from a folder that goes and comes back, from a full disk. */
#ifndef FG_STATION_RECOVERY_H
#define FG_STATION_RECOVERY_H

#include "station/state.h"

/* Sets the words of a failure; "": it is over. Reports a change to the request's `looked_at`
 * too. */
void fg_station_set_recovery(fg_inspection *station, const char *words);

/* Sets the words of a failed backup; "": it is over. Told as above. */
void fg_station_set_backup_failure(fg_inspection *station, const char *words);

/* Largest number of files that a folder holds without a warning, and of new ones listed at once. */
enum { FG_STATION_FILES = 100000 };

/* Notes the size of the folder and the time to list it. The log gets one warning of a very large
 * folder, the pages show it as long as it lasts. */
void fg_station_note_files(fg_inspection *station, size_t files, double seconds);

/* Ensures that lock and database are those in the folder: they are opened again where another
 * folder has taken its place, or one of them was removed. FG_ERR_IO: the folder is gone, or
 * another station runs in it. */
fg_status fg_station_ensure_folder(fg_context *ctx, fg_inspection *station);

#endif
