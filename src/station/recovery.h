/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a running station gets over: a folder that goes and comes back, a disk that is full. */
#ifndef FG_STATION_RECOVERY_H
#define FG_STATION_RECOVERY_H

#include "station/state.h"

/* "": it is over. Says a change to the request's `looked_at`, too. */
void fg_station_set_recovery(fg_inspection *station, const char *words);

/* Largest number of files that a folder holds without a warning, and of new ones listed at once. */
enum { FG_STATION_FILES = 100000 };

/* Notes the size of the folder and the time to list it. The log has one warning of a very large
 * folder, the pages have it as long as the folder is so. */
void fg_station_note_files(fg_inspection *station, size_t files, double seconds);

/* Sees that lock and database are those that lie in the folder: where another folder has come in
 * its place, or one of them was taken away, they are opened again. FG_ERR_IO: the folder is gone,
 * or another station is at work in it. */
fg_status fg_station_look_after_folder(fg_context *ctx, fg_inspection *station);

#endif
