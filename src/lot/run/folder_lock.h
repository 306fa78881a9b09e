/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lock that lets one process at a time work in a folder of results. */
#ifndef FG_LOT_RUN_FOLDER_LOCK_H
#define FG_LOT_RUN_FOLDER_LOCK_H

#include "foilgauge/status.h"

/* Locks the folder for this process until the descriptor is closed or the process ends, and removes
 * temporary files that a killed run has left. FG_ERR_IO when another run holds it. */
fg_status fg_folder_lock(fg_context *ctx, const char *folder, int *lock);

#endif
