/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effect/effect.h"

#include <math.h>
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

double fg_effect_from_jump_mm(const fg_effect *effect, const double *shape, double along_mm) {
  double from = along_mm - shape[0];
  return fabs(effect->shapes > 1 ? remainder(from, shape[1]) : from);
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
  if (fg_effect_is_listed(edge_fit->left_out, effect)) return false;
  return edge_fit->discs ? shows_on_discs(edge_fit, effect) : !effect->off_foils;
}

bool fg_effect_is_listed(const char *ids, const fg_effect *effect) {
  size_t length = strlen(effect->id);
  for (const char *at = ids; at; at = strchr(at, ',')) {
    at += *at == ',';
    if (!strncmp(at, effect->id, length) && (at[length] == ',' || !at[length])) return true;
  }
  return false;
}

fg_status fg_effect_check_list(fg_context *ctx, const char *ids) {
  for (const char *at = ids; at; at = strchr(at, ',')) {
    at += *at == ',';
    bool known = false;
    for (const fg_effect *effect = fg_effect_first(); effect; effect = fg_effect_next(effect))
      known = known || (!fg_effect_is_free(effect) && !strncmp(at, effect->id, strcspn(at, ",")) &&
                        strcspn(at, ",") == strlen(effect->id));
    if (!known)
      return fg_fail(ctx, FG_ERR_USAGE, "no effect is called \"%.*s\"; one is, for example, %s",
                     (int)strcspn(at, ","), at, fg_effect_first()->id);
  }
  return FG_OK;
}
