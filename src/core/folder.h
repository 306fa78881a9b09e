/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Folders for results. */
#ifndef FG_CORE_FOLDER_H
#define FG_CORE_FOLDER_H

#include "foilgauge/status.h"

/* Makes the folder and its missing parents. FG_ERR_IO names the one that cannot be made. */
fg_status fg_folder_make(fg_context *ctx, const char *path);

/* FG_ERR_IO with its name when there is no such folder. */
fg_status fg_folder_require(fg_context *ctx, const char *path);

#endif
