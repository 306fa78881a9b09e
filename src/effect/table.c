/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effect/rows_of_effects.h"

#include <string.h>

static const fg_effect *const tables[] = {fg_effects_scanner, fg_effects_part, fg_effects_curves};
enum { TABLES = sizeof tables / sizeof *tables };

const fg_effect *fg_effect_first(void) {
  return tables[0];
}

const fg_effect *fg_effect_next(const fg_effect *effect) {
  if (effect[1].id) return effect + 1;
  for (size_t t = 0; t + 1 < TABLES; t++)
    for (const fg_effect *row = tables[t]; row->id; row++)
      if (row == effect) return tables[t + 1];
  return NULL;
}

const fg_effect *fg_effect_find(const char *id) {
  for (const fg_effect *effect = fg_effect_first(); effect; effect = fg_effect_next(effect))
    if (!strcmp(effect->id, id)) return effect;
  return NULL;
}

const fg_effect *fg_effect_find_polynomial(fg_effect_polynomial polynomial, int axis) {
  for (const fg_effect *effect = fg_effect_first(); effect; effect = fg_effect_next(effect))
    if (effect->polynomial == polynomial && effect->axis == axis) return effect;
  return NULL;
}

fg_field fg_effect_field(const fg_effect *effect) {
  return (fg_field){.id = effect->id,
                    .basis = effect->glass,
                    .columns = effect->columns,
                    .shapes = effect->shapes};
}

bool fg_effect_same(const fg_effect *a, const fg_effect *b) {
  return a == b || !strcmp(a->id, b->id);
}

const char *fg_effect_coordinate_name(fg_effect_coordinate coordinate) {
  static const char *const names[FG_EFFECT_COORDINATES] = {"scan.x",   "scan.y",     "foil.s",
                                                           "bump.phi", "bump.index", "edge.normal"};
  return names[coordinate];
}

const char *fg_effect_coordinate_title(fg_effect_coordinate coordinate) {
  static const char *const titles[FG_EFFECT_COORDINATES] = {
      "scan.x: across the glass, mm",
      "scan.y: the carriage's way, mm",
      "foil.s: along the foil, mm",
      "bump.phi: place in the bump's arc, −1 to 1",
      "bump.index: number of the bump, and the place in its arc",
      "edge.normal: direction of the edge's outward normal, °"};
  return titles[coordinate];
}
