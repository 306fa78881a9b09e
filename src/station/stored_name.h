/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names of files as the database holds them: UTF-8 on one line, whatever bytes the name has.
 *
 * A file's name is any bytes but '/' and NUL. Bytes that are no UTF-8 and control characters are
 * stored as '/' and two hexadecimal digits ("a/FF.png" is the byte 0xFF between "a" and ".png").
 * All other names are stored as they are, and no two names are stored alike. */
#ifndef FG_STATION_STORED_NAME_H
#define FG_STATION_STORED_NAME_H

#include "foilgauge/status.h"

/* Convert a name to its stored form and back; the caller frees both. A stored name stays the
 * same. */
fg_status fg_stored_name(fg_context *ctx, const char *name, char **stored);

/* Returns the path of a file by its stored name: folder/name. */
fg_status fg_stored_name_path(fg_context *ctx, const char *folder, const char *stored, char **path);

#endif
