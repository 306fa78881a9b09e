/* SPDX-License-Identifier: GPL-3.0-or-later */
/* News: changes of a page that waits for new results. */
#ifndef FG_STATION_NEWS_H
#define FG_STATION_NEWS_H

#include "station/state.h"

/* Counts a change and wakes who waits for one. After it was kept: who is woken reads it. */
void fg_station_tell(fg_inspection *station);

/* The count. It begins with the station's start, so that a page of an earlier run has another. */
long long fg_station_news(fg_inspection *station);

/* The stage of a file, a name below the folder, on its way to its card. One is shown: that of the
 * first which is received, until it is gone or one is measured. Tells who waits of a change. */
void fg_station_set_stage(fg_inspection *station, fg_stage stage, const char *file);

/* The file has its card, or is none any more. */
void fg_station_end_stage(fg_inspection *station, const char *file);

/* Before and after a look at all files of the folder: one that is gone is received no more. */
void fg_station_begin_round(fg_inspection *station);
void fg_station_end_round(fg_inspection *station);

/* A copy, without its mutex. */
void fg_station_read_stage(fg_inspection *station, fg_arriving *copy);

#endif
