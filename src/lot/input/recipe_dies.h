/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dies of a recipe. */
#ifndef FG_LOT_INPUT_RECIPE_DIES_H
#define FG_LOT_INPUT_RECIPE_DIES_H

#include "core/member_read.h"
#include "foilgauge/lot.h"

/* Reads "dies": {"A": "die_a.json", "B": {...}}: paths of reports of `foilgauge die` beside the
 * recipe (the reading's `user`), or objects of the members below, as a lot keeps them. */
fg_member_reader fg_lot_dies_read;
extern const fg_members fg_lot_die_members; /* of an fg_lot_die, whose name is its key */

/* Checks that the dies were measured for the lot's datum and thickness. */
fg_status fg_lot_dies_check(fg_context *ctx, const fg_lot_settings *settings);

/* Returns NULL when no die has the name. */
const fg_lot_die *fg_lot_dies_find(const fg_lot_settings *settings, const char *name);

#endif
