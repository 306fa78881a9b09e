#include "quantity/parts.h"

fg_quantity_owner fg_form_parts(fg_form form) {
  (void)form;
  return FG_QUANTITY_OF_BUMP;
}

bool fg_owner_is_part(fg_quantity_owner owner) {
  return owner == FG_QUANTITY_OF_BUMP;
}

const char *fg_part_word(fg_quantity_owner owner) {
  (void)owner;
  return "bump";
}

size_t fg_part_count(const fg_foil *foil, fg_quantity_owner owner) {
  return owner == FG_QUANTITY_OF_BUMP ? foil->bump_count : 0;
}

fg_part fg_part_at(const fg_foil *foil, fg_quantity_owner owner, size_t i) {
  (void)owner;
  const fg_bump *bump = &foil->bumps[i];
  return (fg_part){bump->number, bump->flags, bump, &bump->calibrated};
}
