/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Columns of tables that hold reported quantities. */
#include <string.h>

#include "core/text.h"
#include "quantity/quantity_rows.h"

enum { NAME_BYTES = 96 };

/* Returns true when a column (dots turned into underscores) has the name of the k-th number of a
 * row, with or without the name of its owner. */
static bool is_called(const fg_quantity *row, const char *part, size_t k, const char *column) {
  char name[NAME_BYTES], text[2 * NAME_BYTES];
  fg_quantity bare = *row;
  const char *dot = strrchr(row->name, '.');
  int length = dot ? (int)(dot - row->name) : (int)strlen(part);
  if (dot) {
    bare.name = dot + 1;
    part = row->name;
  }
  fg_quantity_column(&bare, k, name, sizeof name);
  if (!strcmp(column, name)) return true;
  fg_text_clip(text, sizeof text, "%.*s_%s", length, part, name);
  if (!strcmp(column, text)) return true;
  if (strncmp(name, "u_", 2) != 0) return false;
  fg_text_clip(text, sizeof text, "u_%.*s_%s", length, part, name + 2);
  return !strcmp(column, text);
}

/* Returns true for results; an uncertainty is a result, even of a cause. */
static bool is_result_of(const fg_quantity *row, const char *part, const char *column) {
  size_t values = row->kind == FG_QUANTITY_PAIR ? 2 : 1;
  for (size_t k = row->uses & FG_QUANTITY_IS_CAUSE ? values : 0; k < fg_quantity_width(row); k++)
    if (is_called(row, part, k, column)) return true;
  return false;
}

/* Columns of a lot's tables about foils and bumps that are no quantities. */
static bool is_judgement(const char *column) {
  static const char *const names[] = {"normalised_stiffness", "verdict", "flags", "error"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (!strcmp(column, names[i])) return true;
  return false;
}

bool fg_quantity_is_result(const char *column) {
  static const struct {
    fg_quantity_owner owner;
    const char *word;
  } parts[] = {
      {FG_QUANTITY_OF_BUMP, "bump"}, {FG_QUANTITY_OF_FOIL, "foil"}, {FG_QUANTITY_OF_DISC, "disc"}};
  char plain[NAME_BYTES];
  if (is_judgement(column)) return true;
  if (strlen(column) >= sizeof plain) return false;
  fg_text_clip(plain, sizeof plain, "%s", column);
  for (char *dot = strchr(plain, '.'); dot; dot = strchr(dot, '.'))
    *dot = '_';
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    size_t count;
    const fg_quantity *rows = fg_quantities(parts[i].owner, &count);
    for (size_t r = 0; r < count; r++)
      if (is_result_of(&rows[r], parts[i].word, plain)) return true;
  }
  return false;
}
