#include "report/measure/foil_parts.h"

fg_foil_parts fg_foil_parts_of(const fg_design *design, const fg_foil *foil) {
  if (design->form == FG_FORM_CANTILEVER)
    return (fg_foil_parts){.owner = FG_QUANTITY_OF_BEAM,
                           .name = "beam",
                           .plural = "beams",
                           .objects = (const char *)foil->beams,
                           .count = foil->beam_count,
                           .size = sizeof *foil->beams,
                           .stated = design->beam_count};
  return (fg_foil_parts){.owner = FG_QUANTITY_OF_BUMP,
                         .name = "bump",
                         .plural = "bumps",
                         .objects = (const char *)foil->bumps,
                         .count = foil->bump_count,
                         .size = sizeof *foil->bumps,
                         .stated = design->bump_count};
}

const void *fg_foil_part_at(const fg_foil_parts *parts, size_t i) {
  return parts->objects + i * parts->size;
}

int fg_foil_part_number(const fg_foil_parts *parts, size_t i) {
  if (parts->owner == FG_QUANTITY_OF_BEAM)
    return ((const fg_beam *)fg_foil_part_at(parts, i))->number;
  return ((const fg_bump *)fg_foil_part_at(parts, i))->number;
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
  if (parts->owner == FG_QUANTITY_OF_BEAM) {
    const fg_beam *beam = fg_foil_part_at(parts, i);
    if (beam->flags & FG_BEAM_TORN_TIP) return "torn";
    return beam->flags & FG_BEAM_NOT_FITTED ? "not fitted" : "no value";
  }
  const fg_bump *bump = fg_foil_part_at(parts, i);
  return bump->flags & FG_BUMP_NOT_FITTED ? "not fitted" : "no value";
}

const char *fg_foil_part_word(const fg_quantity *row) {
  if (fg_quantity_find(FG_QUANTITY_OF_BEAM, row->name) == row) return "beam";
  return fg_quantity_find(FG_QUANTITY_OF_BUMP, row->name) == row ? "bump" : "";
}
