/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Several recipes at one station: the open order's part chooses the one by which a scan is measured
 * and judged. Scans without an order, and parts without a recipe of their own, take the station's.
 */
#ifndef FG_STATION_PART_RECIPES_H
#define FG_STATION_PART_RECIPES_H

#include "station/orders.h"

/* Recipe of a part, its scanner's model, and its setup in the database. */
typedef struct fg_part_recipe {
  const char *part; /* NULL: the station's own */
  const fg_lot_settings *lot;
  const fg_scanner_model *model; /* NULL: none */
  int64_t setup;
} fg_part_recipe;

/* Reads the recipes that the station's recipe names, and their models. */
fg_status fg_part_recipes_open(fg_context *ctx, fg_inspection *station);
void fg_part_recipes_close(fg_inspection *station);

/* Keeps the setup of every recipe, the station's too: at the start, and in a new database. */
fg_status fg_part_recipes_keep_setups(fg_context *ctx, fg_inspection *station);

fg_part_recipe fg_part_recipe_of(const fg_inspection *station, const fg_order *order);
/* Finds the recipe of a setup of this run; another one's is the station's own. */
fg_part_recipe fg_part_recipe_of_setup(const fg_inspection *station, int64_t setup);

#endif
