/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The settings of a recipe that are one value: a row of a table each. */
#ifndef FG_LOT_INPUT_RECIPE_MEMBERS_H
#define FG_LOT_INPUT_RECIPE_MEMBERS_H

#include <stdbool.h>
#include <stddef.h>

#include "core/json_writer.h"
#include "core/member_words.h"
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
  size_t offset, size; /* size: of a text */
  double lowest, highest;
  bool jobs;           /* says how the work is done, not what comes out */
  bool open;           /* null, kept as 0: what the design says */
  const char *meaning; /* foilgauge-recipe(5) */
} fg_recipe_member;

typedef struct fg_recipe_table {
  const fg_recipe_member *rows;
  size_t count;
} fg_recipe_table;

/* Of the recipe itself, and of its object "assembly". */
extern const fg_recipe_table fg_recipe_values, fg_recipe_assembly;

/* Where the value lies; as a number, NaN for one that is none; whether it is left to the design. */
void *fg_recipe_place(const fg_recipe_member *row, const fg_lot_settings *settings);
double fg_recipe_number(const fg_recipe_member *row, const fg_lot_settings *settings);
bool fg_recipe_is_open(const fg_recipe_member *row, double value);

void fg_recipe_write(fg_json *json, const fg_recipe_member *row, const fg_lot_settings *settings);

/* What there is to say of it; `object` stands before its name ("assembly."). */
void fg_recipe_say(const char *object, const fg_recipe_member *row, fg_member_words *words);

/* Makes `file` the path `name` as the recipe `path` means it: relative to the recipe's folder. */
void fg_recipe_find_file(const char *path, const char *name, char *file, size_t size);

#endif
