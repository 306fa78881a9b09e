/* News: what changes a page that waits for new results. */
#ifndef FG_STATION_NEWS_H
#define FG_STATION_NEWS_H

#include "station/state.h"

/* Counts a change and wakes who waits for one. After it was kept: who is woken reads it. */
void fg_station_tell(fg_inspection *station);

/* The count. It begins with the station's start, so that a page of an earlier run has another. */
long long fg_station_news(fg_inspection *station);

/* A new stage of what is on its way to a verdict; `file` is a name below the folder. Tells who
 * waits where that is a change. */
void fg_station_set_stage(fg_inspection *station, fg_stage stage, const char *file);

/* The end of that stage of that file; NULL: of any. Another file's stage stays. */
void fg_station_end_stage(fg_inspection *station, const char *file);

/* A copy, without its mutex. */
void fg_station_read_stage(fg_inspection *station, fg_arriving *copy);

#endif
