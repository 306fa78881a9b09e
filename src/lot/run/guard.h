/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Guard against overwriting: a lot's files must not replace its inputs. */
#ifndef FG_LOT_RUN_GUARD_H
#define FG_LOT_RUN_GUARD_H

#include <stdbool.h>

#include "foilgauge/lot.h"
#include "lot/input/manifest.h"

/* Returns true when `path` is the file `name` of a resumed lot's own folder, unchanged: such a file
 * may be an input. `name` is "manifest.csv", "recipe.json" or FG_LOT_MODEL_FILE. */
bool fg_lot_is_own_copy(const fg_lot_request *request, const char *path, const char *name);

/* FG_ERR_USAGE when the lot would overwrite its recipe, design, model, a manifest or list, or a
 * scan. The lot's own copies may be inputs. */
fg_status fg_lot_check_inputs(fg_context *ctx, const fg_lot_request *request,
                              const fg_manifest *manifest);

/* FG_ERR_USAGE when the merged lot would overwrite a file of a shard. */
fg_status fg_lot_check_shards(fg_context *ctx, const char *folder, const char *const *shards,
                              size_t count);

#endif
