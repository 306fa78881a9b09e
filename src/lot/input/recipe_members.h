/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The settings of a recipe that are one value: a row of a table each. */
#ifndef FG_LOT_INPUT_RECIPE_MEMBERS_H
#define FG_LOT_INPUT_RECIPE_MEMBERS_H

#include <stdbool.h>
#include <stddef.h>

#include "core/json_read.h"
#include "core/json_writer.h"
#include "foilgauge/lot.h"

typedef enum fg_recipe_kind {
  FG_RECIPE_REAL,
  FG_RECIPE_COUNT,
  FG_RECIPE_SEED,
  FG_RECIPE_UNSIGNED,
  FG_RECIPE_WORDS,
  FG_RECIPE_SWITCH,
  FG_RECIPE_RULE,
  FG_RECIPE_RUN_RULES
} fg_recipe_kind;

typedef struct fg_recipe_member {
  const char *name;
  fg_recipe_kind kind;
  size_t offset, size; /* `size` is that of a text */
  double lowest, highest;
  bool jobs;           /* changes how the work is done, not its results */
  bool open;           /* may be null (kept as 0): the design decides */
  const char *meaning; /* foilgauge-recipe(5) */
} fg_recipe_member;

typedef struct fg_recipe_table {
  const fg_recipe_member *rows;
  size_t count;
} fg_recipe_table;

/* Tables of the recipe itself and of its object "assembly". */
extern const fg_recipe_table fg_recipe_values, fg_recipe_assembly;

/* Address of the value in the settings. The value as a number, NaN for other kinds. True when the
 * value is left to the design. */
void *fg_recipe_place(const fg_recipe_member *row, const fg_lot_settings *settings);
double fg_recipe_number(const fg_recipe_member *row, const fg_lot_settings *settings);
bool fg_recipe_is_open(const fg_recipe_member *row, double value);

void fg_recipe_write(fg_json *json, const fg_recipe_member *row, const fg_lot_settings *settings);

/* Words of the manual about a member; `object` stands before its name ("assembly."). */
void fg_recipe_describe(const char *object, const fg_recipe_member *row, fg_member_words *words);

/* Resolves `name` against the folder of the recipe `path`. */
void fg_recipe_find_file(const char *path, const char *name, char *file, size_t size);

#endif
