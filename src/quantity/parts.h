/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbered parts of a foil of any kind: its bumps, or a cantilever's beams. */
#ifndef FG_QUANTITY_PARTS_H
#define FG_QUANTITY_PARTS_H

#include "foilgauge/quantity.h"

/* One part, for readers of numbers alone. */
typedef struct fg_foil_part {
  int number;
  unsigned flags;
  const void *object; /* of the owner's type */
  const fg_calibrated *calibrated;
} fg_foil_part;

/* Returns the owner type of the parts of a kind. */
fg_quantity_owner fg_foil_kind_parts(fg_foil_kind kind);
bool fg_owner_is_part(fg_quantity_owner owner);

/* "bump", "beam". */
const char *fg_part_word(fg_quantity_owner owner);

size_t fg_part_count(const fg_foil *foil, fg_quantity_owner owner);
fg_foil_part fg_part_at(const fg_foil *foil, fg_quantity_owner owner, size_t i);

/* Median radius of the fitted ones of the bumps, mm; NaN without any. */
double fg_bump_radius_median(const fg_bump *bumps, size_t count);

#endif
