/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts of what is kept, for those who are inside a transaction. */
#ifndef FG_STATION_KEEP_PARTS_H
#define FG_STATION_KEEP_PARTS_H

#include "station/keep.h"

fg_status fg_station_insert_card(fg_context *ctx, fg_station_database *database,
                                 const fg_station_file *file, fg_card card, const char *message,
                                 int64_t scan);

#endif
