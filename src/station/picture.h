/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of foils as they stand in pages: of the newest ones, others are drawn when asked for. */
#ifndef FG_STATION_PICTURE_H
#define FG_STATION_PICTURE_H

#include "foilgauge/foil.h"
#include "station/database.h"

fg_status fg_station_keep_pictures(fg_context *ctx, fg_station_database *database, int64_t scan,
                                   const fg_measurement *measurement);

#endif
