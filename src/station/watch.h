/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Watch of the folder: finds new files, and when they are no longer written to. */
#ifndef FG_STATION_WATCH_H
#define FG_STATION_WATCH_H

#include "station/state.h"

/* Inspects every file of the folder, oldest first, then returns (`once`) or goes on with new
 * files. While the folder is gone it waits for it to come back. */
fg_status fg_station_watch(fg_context *ctx, fg_inspection *station, bool once);

#endif
