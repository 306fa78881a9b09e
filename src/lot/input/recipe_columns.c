/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of the columns that a recipe names against those of a manifest. */
#include <string.h>

#include "core/text.h"
#include "lot/input/recipe.h"

static void list_column_names(const fg_manifest *manifest, char *text, size_t size) {
  size_t used = 0;
  for (size_t i = 0; i < manifest->columns; i++) {
    fg_text_clip(text + used, size - used, "%s%s", i ? ", " : "", manifest->name[i]);
    used = strlen(text);
  }
}

/* A column with its default name `usual` may be missing: nobody has asked for it. */
static fg_status check_named_column(fg_context *ctx, const fg_manifest *manifest,
                                    const char *member, const char *column, const char *usual) {
  char columns[400];
  if (!*column || !strcmp(column, usual)) return FG_OK;
  if (fg_manifest_column(manifest, column) != FG_NO_COLUMN) return FG_OK;
  list_column_names(manifest, columns, sizeof columns);
  return fg_fail(ctx, FG_ERR_DATA, "%s: the manifest has no column '%s'; it has: %s", member,
                 column, columns);
}

static fg_status check_groups(fg_context *ctx, const fg_manifest *manifest, const char *name) {
  const char *group[FG_LOT_GROUPS_MAX];
  size_t column = fg_manifest_column(manifest, name), count = 0;
  for (size_t i = 0; column != FG_NO_COLUMN && i < manifest->items; i++) {
    const char *word = fg_manifest_cell(manifest, i, column);
    size_t at = 0;
    while (at < count && strcmp(group[at], word) != 0)
      at++;
    if (!*word || at < count) continue;
    if (count == FG_LOT_GROUPS_MAX)
      return fg_fail(ctx, FG_ERR_DATA,
                     "group_column '%s' has more than %d groups; at most so many are compared",
                     name, FG_LOT_GROUPS_MAX);
    group[count++] = word;
  }
  return FG_OK;
}

/* Dies need their column, and each of its cells must name one of them or be empty. */
static fg_status check_die_cells(fg_context *ctx, const fg_lot_settings *settings,
                                 const fg_manifest *manifest) {
  char columns[400];
  size_t column = fg_manifest_column(manifest, settings->die_column);
  list_column_names(manifest, columns, sizeof columns);
  if (!settings->die_count) return FG_OK;
  if (column == FG_NO_COLUMN)
    return fg_fail(ctx, FG_ERR_DATA,
                   "dies: the manifest has no column '%s' that says which die a foil is of; it "
                   "has: %s",
                   settings->die_column, columns);
  for (size_t i = 0; i < manifest->items; i++) {
    const char *name = fg_manifest_cell(manifest, i, column);
    if (*name && !fg_lot_dies_find(settings, name))
      return fg_fail(ctx, FG_ERR_DATA,
                     "dies: %.200s was pressed in die '%.60s' as the column '%s' says, of which "
                     "there is no report; name it, or leave the cell empty",
                     fg_manifest_scan(manifest, i), name, settings->die_column);
  }
  return FG_OK;
}

fg_status fg_lot_check_columns(fg_context *ctx, const fg_lot_settings *settings,
                               const fg_manifest *manifest) {
  fg_lot_settings usual;
  fg_lot_settings_default(&usual);
#define CHECK(member) check_named_column(ctx, manifest, #member, settings->member, usual.member)
  FG_TRY(CHECK(group_column));
  FG_TRY(CHECK(part_column));
  FG_TRY(CHECK(operator_column));
  FG_TRY(CHECK(bearing_column));
  FG_TRY(CHECK(pad_column));
  FG_TRY(check_die_cells(ctx, settings, manifest));
#undef CHECK
  return check_groups(ctx, manifest, settings->group_column);
}
