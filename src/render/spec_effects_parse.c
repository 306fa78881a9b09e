/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects of a spec: from JSON to a list of rows with their numbers. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "render/spec_effects.h"

static fg_status parse_direction(const fg_place *place, const cJSON *object,
                                 fg_render_effect *effect) {
  int normal = 0;
  if (effect->row->target != FG_RENDER_EFFECT_PART) return FG_OK;
  FG_TRY(
      fg_member_choice(place, object, "along", (const char *const[]){"radius", "normal"}, &normal));
  if (normal) effect->target = FG_RENDER_EFFECT_NORMAL;
  return FG_OK;
}

static fg_status parse_curve(const fg_place *place, const cJSON *object, fg_render_effect *effect) {
  static const fg_spec_row scan[] = {{"id", FG_SPEC_OTHER, 0, 0, 0},
                                     {"knots", FG_SPEC_OTHER, 0, 0, 0},
                                     {"moves", FG_SPEC_OTHER, 0, 0, 0},
                                     {0}};
  static const fg_spec_row edge[] = {{"id", FG_SPEC_OTHER, 0, 0, 0},
                                     {"knots", FG_SPEC_OTHER, 0, 0, 0},
                                     {"edges", FG_SPEC_OTHER, 0, 0, 0},
                                     {0}};
  static const fg_spec_row part[] = {{"id", FG_SPEC_OTHER, 0, 0, 0},
                                     {"knots", FG_SPEC_OTHER, 0, 0, 0},
                                     {"along", FG_SPEC_OTHER, 0, 0, 0},
                                     {0}};
  static const fg_spec_row bump[] = {
      {"id", FG_SPEC_OTHER, 0, 0, 0}, {"knots", FG_SPEC_OTHER, 0, 0, 0}, {0}};
  fg_render_effect_target target = effect->row->target;
  FG_TRY(fg_members_read(place, object,
                         target == FG_RENDER_EFFECT_SCANNER ? scan
                         : target == FG_RENDER_EFFECT_EDGE  ? edge
                         : target == FG_RENDER_EFFECT_PART  ? part
                                                            : bump,
                         effect));
  int apart = 0;
  effect->moves = effect->row->axis;
  FG_TRY(fg_member_choice(place, object, "moves", (const char *const[]){"x", "y"}, &effect->moves));
  FG_TRY(
      fg_member_choice(place, object, "edges", (const char *const[]){"together", "apart"}, &apart));
  effect->apart = apart == 1;
  return fg_curve_parse(place, cJSON_GetObjectItemCaseSensitive(object, "knots"),
                        effect->row->curve, &effect->curve);
}

static fg_status parse_parameters(const fg_place *place, const cJSON *object,
                                  fg_render_effect *effect) {
  fg_spec_row table[FG_RENDER_EFFECT_PARAMETERS_MAX + 3] = {{"id", FG_SPEC_OTHER, 0, 0, 0}};
  size_t used = 1;
  for (int i = 0; i < FG_RENDER_EFFECT_PARAMETERS_MAX && effect->row->parameters[i].name; i++) {
    const fg_render_effect_parameter *parameter = &effect->row->parameters[i];
    effect->p[i] = parameter->fallback;
    table[used++] = (fg_spec_row){parameter->name, FG_SPEC_NUMBER,
                                  offsetof(fg_render_effect, p) + (size_t)i * sizeof effect->p[0],
                                  parameter->low, parameter->high};
  }
  if (effect->row->target == FG_RENDER_EFFECT_PART)
    table[used++] = (fg_spec_row){"along", FG_SPEC_OTHER, 0, 0, 0};
  FG_TRY(fg_members_read(place, object, table, effect));
  for (int i = 0; i < FG_RENDER_EFFECT_PARAMETERS_MAX && effect->row->parameters[i].name; i++)
    if (isnan(effect->p[i]))
      return fg_member_fail(place, effect->row->parameters[i].name, NULL, "the effect needs it");
  return FG_OK;
}

static fg_status parse_members(const fg_place *place, const cJSON *item, fg_render_effect *effect) {
  if (effect->row->target == FG_RENDER_EFFECT_LIFT)
    return fg_lift_parse(place, item, &effect->lift);
  FG_TRY((effect->row->curve ? parse_curve : parse_parameters)(place, item, effect));
  return parse_direction(place, item, effect);
}

fg_status fg_render_effects_parse(const fg_place *place, const cJSON *array,
                                  fg_render_effect_list *list) {
  list->count = 0;
  if (!array) return FG_OK;
  if (!cJSON_IsArray(array) || cJSON_GetArraySize(array) > FG_RENDER_EFFECTS_MAX)
    return fg_member_fail(place, "effects", array, "must be an array of at most 16 effects");
  const cJSON *item;
  cJSON_ArrayForEach(item, array) {
    fg_place inner = fg_place_item(place, "effects", (int)list->count);
    const cJSON *id = cJSON_GetObjectItemCaseSensitive(item, "id");
    const fg_render_effect_row *row = fg_render_effect_rows();
    while (row->id && !(cJSON_IsString(id) && !strcmp(row->id, id->valuestring)))
      row++;
    if (!row->id)
      return fg_member_fail(&inner, "id", id, "must be the name of an effect such as scan.scale_y");
    list->effects[list->count] = (fg_render_effect){.row = row, .target = row->target};
    FG_TRY(parse_members(&inner, item, &list->effects[list->count]));
    list->count++;
  }
  return FG_OK;
}
