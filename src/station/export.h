/* Lots of the database as folders that `foilgauge lot` could have made. */
#ifndef FG_STATION_EXPORT_H
#define FG_STATION_EXPORT_H

#include "station/state.h"

/* Every lot ("" is "without_lot") below `folder`. */
fg_status fg_station_export(fg_context *ctx, fg_inspection *station, const char *folder);

/* One lot into folder, with its report. */
fg_status fg_station_export_lot(fg_context *ctx, fg_inspection *station, const char *lot,
                                const char *folder, fg_lot_outcome *outcome);

#endif
