/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the folder of a lot is called, and where the station keeps those of lots that are closed. */
#ifndef FG_STATION_LOT_FOLDER_H
#define FG_STATION_LOT_FOLDER_H

#include <stdbool.h>

#include "foilgauge/status.h"

#define FG_LOTS_FOLDER "lots" /* below the station's folder */
enum { FG_LOT_FOLDER_NAME = 240 };

/* A name that every file system takes, that is one step and no way out, and another one for every
 * other lot: bytes that could mean something stand as %2F. "" is "without_lot". */
void fg_lot_folder_name(const char *lot, char name[FG_LOT_FOLDER_NAME]);

/* FOLDER/lots/NAME; the caller frees. With `make` the folders are made. FG_ERR_IO: one of them is
 * no folder (a link might lead elsewhere), or cannot be made. */
fg_status fg_lot_folder_find(fg_context *ctx, const char *folder, const char *lot, bool make,
                             char **path);

#endif
