/* SPDX-License-Identifier: GPL-3.0-or-later */
/* JSON from text, with an error for exhausted memory apart from that for bad text: cJSON returns
 * NULL for both. */
#ifndef FG_CORE_JSON_READ_H
#define FG_CORE_JSON_READ_H

#include <cjson/cJSON.h>

#include "foilgauge/status.h"

/* Parses the whole text; white space around it is allowed. FG_ERR_DATA names `path`, line, column
 * and the text found there; FG_ERR_MEMORY. The caller deletes `root`, which is NULL after an error.
 */
fg_status fg_json_read(fg_context *ctx, const char *path, const char *text, cJSON **root);

#endif
