/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The recipe's scan_command: one at a time, beside the pages. */
#ifndef FG_STATION_SCAN_COMMAND_H
#define FG_STATION_SCAN_COMMAND_H

#include "station/state.h"

/* Begins a scan, unless one is running: of foils, or of the plate. */
fg_status fg_station_scan_begin(fg_context *ctx, fg_inspection *station, bool check);

/* Ends a running command and waits for it. */
void fg_station_scan_stop(fg_inspection *station);

/* Returns true for a file that the command wrote, by its name. */
bool fg_station_is_scanned(const char *name);
bool fg_station_is_scanned_check(const char *name); /* of the plate */

#endif
