/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/quantity_members.h"

#include <string.h>

#include "quantity/quantity_rows.h"

fg_member fg_quantity_member(const fg_quantity *quantity) {
  static const fg_member_kind kinds[] = {
      [FG_QUANTITY_NUMBER] = FG_MEMBER_NUMBER,
      [FG_QUANTITY_PAIR] = FG_MEMBER_PAIR,
      [FG_QUANTITY_COUNT] = FG_MEMBER_COUNT,
  };
  const char *group = strchr(quantity->name, '.');
  return (fg_member){.name = group ? group + 1 : quantity->name,
                     .kind = kinds[quantity->kind],
                     .offset = quantity->offset,
                     .u_offset = fg_quantity_has_u(quantity) ? quantity->u_offset : 0,
                     .words = quantity->words,
                     .heading = quantity->symbol};
}

/* Finds row `i` of those whose names begin with the group, or have none where it is empty. */
static bool find_group_row(fg_quantity_owner owner, const char *group, size_t i, fg_member *row) {
  size_t count, prefix = strlen(group);
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t k = 0; k < count; k++) {
    const char *name = rows[k].name;
    if (prefix ? strncmp(name, group, prefix) != 0 : strchr(name, '.') != NULL) continue;
    if (i-- > 0) continue;
    *row = fg_quantity_member(&rows[k]);
    return true;
  }
  return false;
}

#define QUANTITY_AT(function, owner, group)                                                        \
  bool function(size_t i, fg_member *row) {                                                        \
    return find_group_row(owner, group, i, row);                                                   \
  }
QUANTITY_AT(fg_foil_quantity_at, FG_QUANTITY_OF_FOIL, "")
QUANTITY_AT(fg_overall_quantity_at, FG_QUANTITY_OF_FOIL, "overall.")
QUANTITY_AT(fg_arc_quantity_at, FG_QUANTITY_OF_FOIL, "arc.")
QUANTITY_AT(fg_bump_quantity_at, FG_QUANTITY_OF_BUMP, "")
QUANTITY_AT(fg_beam_quantity_at, FG_QUANTITY_OF_BEAM, "")
QUANTITY_AT(fg_disc_quantity_at, FG_QUANTITY_OF_DISC, "")
QUANTITY_AT(fg_strip_quantity_at, FG_QUANTITY_OF_STRIP, "")
QUANTITY_AT(fg_bearing_quantity_at, FG_QUANTITY_OF_BEARING, "")

bool fg_correction_quantity_at(size_t i, fg_member *row) {
  if (!find_group_row(FG_QUANTITY_OF_FOIL, "correction.", i, row)) return false;
  row->offset -= offsetof(fg_foil, correction);
  row->u_offset -= offsetof(fg_foil, correction);
  return true;
}

bool fg_flat_foil_quantity_at(size_t i, fg_member *row) {
  size_t count;
  const fg_quantity *rows = fg_quantities(FG_QUANTITY_OF_FOIL, &count);
  for (size_t k = 0; k < count; k++) {
    if (!(rows[k].uses & FG_QUANTITY_OF_FLAT) || i-- > 0) continue;
    *row = fg_quantity_member(&rows[k]);
    return true;
  }
  return false;
}
