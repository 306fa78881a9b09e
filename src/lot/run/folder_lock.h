/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One process at a time in a folder of results. */
#ifndef FG_LOT_RUN_FOLDER_LOCK_H
#define FG_LOT_RUN_FOLDER_LOCK_H

#include "foilgauge/status.h"

/* Takes the folder for this process until the descriptor is closed (or the process is no more),
 * and removes the temporary files that a killed run has left there. FG_ERR_IO when another run has
 * it. */
fg_status fg_folder_lock(fg_context *ctx, const char *folder, int *lock);

#endif
