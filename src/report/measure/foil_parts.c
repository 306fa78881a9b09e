/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/measure/foil_parts.h"

#include "foilgauge/foil_kind.h"
#include "quantity/parts.h"

fg_foil_parts fg_foil_parts_of(const fg_design *design, const fg_foil *foil) {
  fg_quantity_owner owner = fg_foil_kind_parts(design->kind);
  bool beams = owner == FG_QUANTITY_OF_BEAM;
  return (fg_foil_parts){.owner = owner,
                         .name = fg_part_word(owner),
                         .plural = beams ? "beams" : "bumps",
                         .foil = foil,
                         .count = fg_part_count(foil, owner),
                         .stated = fg_design_stated_parts(design)};
}

static fg_foil_part part_at(const fg_foil_parts *parts, size_t i) {
  return fg_part_at(parts->foil, parts->owner, i);
}

const void *fg_foil_part_at(const fg_foil_parts *parts, size_t i) {
  return part_at(parts, i).object;
}

int fg_foil_part_number(const fg_foil_parts *parts, size_t i) {
  return part_at(parts, i).number;
}

int fg_foil_parts_last(const fg_foil_parts *parts) {
  int last = parts->stated > 1 ? (int)parts->stated : 1;
  for (size_t i = 0; i < parts->count; i++)
    if (fg_foil_part_number(parts, i) > last) last = fg_foil_part_number(parts, i);
  return last;
}

bool fg_foil_parts_have(const fg_foil_parts *parts, int number) {
  for (size_t i = 0; i < parts->count; i++)
    if (fg_foil_part_number(parts, i) == number) return true;
  return false;
}

const char *fg_foil_part_lack(const fg_foil_parts *parts, size_t i) {
  unsigned flags = part_at(parts, i).flags;
  if (parts->owner == FG_QUANTITY_OF_BEAM) {
    if (flags & FG_BEAM_TORN_TIP) return "torn";
    return flags & FG_BEAM_NOT_FITTED ? "not fitted" : "no value";
  }
  return flags & FG_BUMP_NOT_FITTED ? "not fitted" : "no value";
}

const char *fg_foil_part_word(const fg_quantity *row) {
  static const fg_quantity_owner owners[] = {FG_QUANTITY_OF_BEAM, FG_QUANTITY_OF_BUMP};
  for (size_t k = 0; k < sizeof owners / sizeof *owners; k++)
    if (fg_quantity_find(owners[k], row->name) == row) return fg_part_word(owners[k]);
  return "";
}
