/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The members of a recipe. */
#ifndef FG_LOT_INPUT_RECIPE_MEMBERS_H
#define FG_LOT_INPUT_RECIPE_MEMBERS_H

#include "core/member_read.h"
#include "foilgauge/lot.h"

/* A recipe as it is written. */
typedef struct fg_recipe_text {
  fg_lot_settings settings; /* first: the members are its */
  bool with_jobs; /* every setting, to edit; else those that the results of a lot depend on */
} fg_recipe_text;

/* Of fg_lot_settings. They are written with an fg_recipe_text as the whole; a reading has the
 * recipe's path as `user`. */
extern const fg_members fg_recipe_members;

extern const fg_document fg_recipe_document;

#endif
