/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of foils in pages: those of the newest are kept, others are drawn on request. */
#ifndef FG_STATION_PICTURE_H
#define FG_STATION_PICTURE_H

#include "foilgauge/foil.h"
#include "station/database.h"

fg_status fg_station_keep_pictures(fg_context *ctx, fg_station_database *database, int64_t scan,
                                   const fg_measurement *measurement);

#endif
