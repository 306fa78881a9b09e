/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "quantity/parts.h"

#include <math.h>

#include "core/select.h"
#include "foilgauge/foil_kind.h"

fg_quantity_owner fg_foil_kind_parts(fg_foil_kind kind) {
  return fg_foil_traits_of(kind)->part;
}

bool fg_owner_is_part(fg_quantity_owner owner) {
  return owner == FG_QUANTITY_OF_BUMP || owner == FG_QUANTITY_OF_BEAM;
}

const char *fg_part_word(fg_quantity_owner owner) {
  return owner == FG_QUANTITY_OF_BEAM ? "beam" : "bump";
}

size_t fg_part_count(const fg_foil *foil, fg_quantity_owner owner) {
  if (owner == FG_QUANTITY_OF_BEAM) return foil->beam_count;
  return owner == FG_QUANTITY_OF_BUMP ? foil->bump_count : 0;
}

fg_foil_part fg_part_at(const fg_foil *foil, fg_quantity_owner owner, size_t i) {
  if (owner == FG_QUANTITY_OF_BEAM) {
    const fg_beam *beam = &foil->beams[i];
    return (fg_foil_part){beam->number, beam->flags, beam, &beam->calibrated};
  }
  const fg_bump *bump = &foil->bumps[i];
  return (fg_foil_part){bump->number, bump->flags, bump, &bump->calibrated};
}

/* Radii of a foil's bumps that are sorted in place; a foil has fewer. */
enum { RADII_MAX = 512 };

double fg_bump_radius_median(const fg_bump *bumps, size_t count) {
  double radii[RADII_MAX];
  size_t known = 0;
  for (size_t i = 0; i < count && known < RADII_MAX; i++)
    if (!(bumps[i].flags & FG_BUMP_NOT_FITTED) && isfinite(bumps[i].radius_mm))
      radii[known++] = bumps[i].radius_mm;
  if (!known) return NAN;
  fg_sort(radii, known);
  return (radii[(known - 1) / 2] + radii[known / 2]) / 2;
}
