/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Columns that a recipe names, against a manifest. */
#ifndef FG_LOT_INPUT_RECIPE_H
#define FG_LOT_INPUT_RECIPE_H

#include "foilgauge/lot.h"
#include "lot/input/manifest.h"
#include "lot/input/recipe_dies.h"

/* More groups than these are not compared. */
enum { FG_LOT_GROUPS_MAX = 12 };

/* FG_ERR_DATA where a column that the settings name is not there (the default ones may be missing),
 * or where there are too many groups. To be called before anything is measured. */
fg_status fg_lot_check_columns(fg_context *ctx, const fg_lot_settings *settings,
                               const fg_manifest *manifest);

#endif
