/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of a recipe that have a file of their own. */
#ifndef FG_LOT_INPUT_RECIPE_PARTS_H
#define FG_LOT_INPUT_RECIPE_PARTS_H

#include <cjson/cJSON.h>

#include "core/json_writer.h"
#include "foilgauge/lot.h"

/* "calibration", over that of the design wherever it stands; null leaves the design's. */
fg_status fg_recipe_read_calibration(fg_context *ctx, const cJSON *root, fg_lot_settings *settings);
void fg_recipe_write_calibration(fg_json *json, const fg_lot_settings *settings);

#endif
