/* SPDX-License-Identifier: GPL-3.0-or-later */
/* News: changes of a page that waits for new results. */
#ifndef FG_STATION_NEWS_H
#define FG_STATION_NEWS_H

#include "station/state.h"

/* Counts a change and wakes the waiting pages. Call it after the change was kept: they read it. */
void fg_station_notify(fg_inspection *station);

/* Returns the count. It begins with the time of the station's start, so that a page of an
 * earlier run has another. */
long long fg_station_news(fg_inspection *station);

/* Sets the stage of a file, a name below the folder, before its card. Pages show one: the first
 * file that is received, until it is gone or one is measured. Wakes the waiting pages on a
 * change. */
void fg_station_set_stage(fg_inspection *station, fg_stage stage, const char *file);

/* Ends the stage of a file: it has its card, or is gone. */
void fg_station_end_stage(fg_inspection *station, const char *file);

/* Enclose a pass over all files of the folder; they end the stage of a file that is gone. */
void fg_station_begin_round(fg_inspection *station);
void fg_station_end_round(fg_inspection *station);

/* Copies the stage, without its mutex. */
void fg_station_read_stage(fg_inspection *station, fg_arriving *copy);

#endif
