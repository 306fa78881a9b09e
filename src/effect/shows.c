/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effect/effect.h"

static size_t clean_count(const fg_edge_fit *edge_fit) {
  size_t count = 0;
  for (size_t v = 0; v < edge_fit->view_count; v++)
    count += !(edge_fit->views[v].disc->flags & FG_BUMP_POOR_FIT);
  return count;
}

static bool shows_on_discs(const fg_edge_fit *edge_fit, const fg_effect *effect) {
  switch (effect->on_discs) {
  case FG_EFFECT_NOT_ON_DISCS:
    return false;
  case FG_EFFECT_ON_DISCS:
    return true;
  case FG_EFFECT_ON_ONE_DISC:
    return edge_fit->part_count == 1;
  case FG_EFFECT_ON_KNOWN_DISCS:
    return edge_fit->known_count > 0;
  case FG_EFFECT_ON_CLEAN_DISCS:
    return clean_count(edge_fit) >= effect->discs_min;
  }
  return false;
}

bool fg_effect_shows(const fg_edge_fit *edge_fit, const fg_effect *effect) {
  if (effect->sought == FG_EFFECT_OF_WIDTH) return false;
  return edge_fit->discs ? shows_on_discs(edge_fit, effect) : !effect->off_foils;
}
