/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A lot's files must not take the place of what the lot is made from. */
#ifndef FG_LOT_RUN_GUARD_H
#define FG_LOT_RUN_GUARD_H

#include <stdbool.h>

#include "foilgauge/lot.h"
#include "lot/input/manifest.h"

/* Whether `path` is the file `name` in the folder of a lot that is resumed, as the lot wrote it: it
 * can be given back. `name`: "manifest.csv", "recipe.json" or FG_LOT_MODEL_FILE. */
bool fg_lot_is_own_copy(const fg_lot_request *request, const char *path, const char *name);

/* FG_ERR_USAGE when the lot would overwrite its recipe, design, model, a manifest or list, or a
 * scan; what the lot wrote itself may be given back. */
fg_status fg_lot_check_inputs(fg_context *ctx, const fg_lot_request *request,
                              const fg_manifest *manifest);

/* The same for shards that are merged. */
fg_status fg_lot_check_shards(fg_context *ctx, const char *folder, const char *const *shards,
                              size_t count);

#endif
