/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names of lots' folders, and the folder for those of closed lots. */
#ifndef FG_STATION_LOT_FOLDER_H
#define FG_STATION_LOT_FOLDER_H

#include <stdbool.h>

#include "foilgauge/status.h"

#define FG_LOTS_FOLDER "lots" /* below the station's folder */
enum { FG_LOT_FOLDER_NAME = 240 };

/* Makes a name that every file system accepts, that is one path component and never "..", and
 * that no other lot has: special bytes become %2F and the like. "" is "without_lot". */
void fg_lot_folder_name(const char *lot, char name[FG_LOT_FOLDER_NAME]);

/* Returns FOLDER/lots/NAME; the caller frees. With `make` the folders are made. FG_ERR_IO: one
 * of them is no folder (a link might lead elsewhere), or cannot be made. */
fg_status fg_lot_folder_find(fg_context *ctx, const char *folder, const char *lot, bool make,
                             char **path);

/* A lot is written into a folder of its own, FOLDER/lots/.closing/NAME, and its files are moved to
 * FOLDER/lots/NAME once all are there: a report that cannot be written (a full disk, a killed
 * station) leaves that of before. */

/* Makes the folder, empty; the caller frees the path. */
fg_status fg_lot_folder_stage(fg_context *ctx, const char *folder, const char *lot, char **path);
/* Moves the files of `staged` in the place of those of `folder`. */
fg_status fg_lot_folder_publish(fg_context *ctx, const char *staged, const char *folder);
/* Removes the folder and its files. */
void fg_lot_folder_unstage(const char *staged);

#endif
