#include "effect/effect.h"

static size_t clean_count(const fg_points *points) {
  size_t count = 0;
  for (size_t v = 0; v < points->view_count; v++)
    count += !(points->views[v].disc->flags & FG_BUMP_POOR_FIT);
  return count;
}

static bool shows_on_discs(const fg_points *points, const fg_effect *effect) {
  switch (effect->on_discs) {
  case FG_EFFECT_NOT_ON_DISCS:
    return false;
  case FG_EFFECT_ON_DISCS:
    return true;
  case FG_EFFECT_ON_ONE_DISC:
    return points->part_count == 1;
  case FG_EFFECT_ON_KNOWN_DISCS:
    return points->known_count > 0;
  case FG_EFFECT_ON_CLEAN_DISCS:
    return clean_count(points) >= effect->discs_min;
  }
  return false;
}

bool fg_effect_shows(const fg_points *points, const fg_effect *effect) {
  if (effect->sought == FG_EFFECT_OF_WIDTH) return false;
  return points->discs ? shows_on_discs(points, effect) : !effect->off_foils;
}
