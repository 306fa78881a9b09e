/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The folder, watched: which files are new, and when nobody writes to them any more. */
#ifndef FG_STATION_WATCH_H
#define FG_STATION_WATCH_H

#include "station/state.h"

/* Takes every file that is there, oldest first, and returns when that is done (`once`), or goes on
 * with what comes. While the folder is gone it waits for it to come back. */
fg_status fg_station_watch(fg_context *ctx, fg_inspection *station, bool once);

#endif
