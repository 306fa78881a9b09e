/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of a recipe that have a file of their own, and its columns against a manifest. */
#ifndef FG_LOT_INPUT_RECIPE_H
#define FG_LOT_INPUT_RECIPE_H

#include <cjson/cJSON.h>

#include "core/json_writer.h"
#include "foilgauge/lot.h"
#include "lot/input/manifest.h"

/* Reads "dies": {"A": "die_a.json", "B": {...}}: paths of reports of `foilgauge die` beside the
 * recipe, or the objects that fg_lot_dies_write writes. */
fg_status fg_lot_dies_read(fg_context *ctx, const char *path, const cJSON *value,
                           fg_lot_settings *settings);

/* Writes nothing where the recipe names no die. */
void fg_lot_dies_write(fg_json *json, const fg_lot_settings *settings);

/* Checks that the dies were measured for the lot's datum and thickness. */
fg_status fg_lot_dies_check(fg_context *ctx, const fg_lot_settings *settings);

/* Returns NULL when no die has the name. */
const fg_lot_die *fg_lot_dies_find(const fg_lot_settings *settings, const char *name);

/* More groups than these are not compared. */
enum { FG_LOT_GROUPS_MAX = 12 };

/* FG_ERR_DATA where a column that the settings name is not there (the default ones may be missing),
 * or where there are too many groups. To be called before anything is measured. */
fg_status fg_lot_check_columns(fg_context *ctx, const fg_lot_settings *settings,
                               const fg_manifest *manifest);

#endif
