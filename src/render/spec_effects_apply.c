/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values of a list's effects at a place. */
#include <math.h>

#include "render/spec_effects.h"

static const double pi = 3.14159265358979323846;

void fg_render_effects_resolve(fg_render_effect_list *list, double width_mm, double height_mm) {
  for (size_t i = 0; i < list->count; i++)
    for (int k = 0; k < FG_RENDER_EFFECT_PARAMETERS_MAX; k++)
      if (isinf(list->effects[i].p[k])) {
        bool in_y = list->effects[i].p[k] < 0 || list->effects[i].row->axis;
        list->effects[i].p[k] = 0.5 * (in_y ? height_mm : width_mm);
      }
}

bool fg_render_effects_have(const fg_render_effect_list *list, fg_render_effect_target target) {
  for (size_t i = 0; i < list->count; i++)
    if (list->effects[i].target == target) return true;
  return false;
}

/* Value of a radius about O, a bump's circle or an edge: in mm. */
static double effect_shape(const fg_render_effect *effect, double coordinate, double extent) {
  if (effect->row->curve) return 1e-3 * fg_curve_value_um(&effect->curve, coordinate / extent);
  return effect->row->shape(effect->p, coordinate, extent);
}

void fg_render_effects_field(const fg_render_effect_list *list, double x_mm, double y_mm,
                             const double side_mm[2], double d_mm[2]) {
  d_mm[0] = d_mm[1] = 0;
  for (size_t i = 0; i < list->count; i++) {
    const fg_render_effect *effect = &list->effects[i];
    if (effect->target == FG_RENDER_EFFECT_SCANNER && effect->row->curve)
      d_mm[effect->moves] += effect_shape(effect, effect->row->axis ? y_mm : x_mm, 1);
    else if (effect->target == FG_RENDER_EFFECT_SCANNER)
      effect->row->field(effect->p, x_mm, y_mm, d_mm);
    if (effect->target == FG_RENDER_EFFECT_STEP)
      effect->row->field(effect->p, side_mm[0], side_mm[1], d_mm);
  }
  fg_jumps_field(&list->jumps, side_mm, d_mm);
}

double fg_render_effects_next_step(const fg_render_effect_list *list, int axis, double low_mm,
                                   double high_mm) {
  double next = fg_jumps_next(&list->jumps, axis, low_mm, high_mm);
  for (size_t i = 0; i < list->count; i++) {
    const fg_render_effect *effect = &list->effects[i];
    double at = effect->p[1];
    if (effect->target != FG_RENDER_EFFECT_STEP || effect->row->axis != axis) continue;
    if (effect->row->repeats) at += effect->p[2] * ceil((low_mm - at) / effect->p[2]);
    if (at >= low_mm && at < high_mm) next = fmin(next, at); /* fmin prefers the number to NaN */
  }
  return next;
}

double fg_render_effects_shape(const fg_render_effect_list *list, fg_render_effect_target target,
                               double coordinate, double extent) {
  bool factor = target == FG_RENDER_EFFECT_TABLE || target == FG_RENDER_EFFECT_STRETCH;
  double result = factor ? 1 : 0;
  for (size_t i = 0; i < list->count; i++) {
    const fg_render_effect *effect = &list->effects[i];
    if (effect->target != target) continue;
    double value = effect_shape(effect, coordinate, extent);
    result = factor ? result * value : result + value;
  }
  return result;
}

void fg_render_effects_bump_end(const fg_render_effect_list *list, double u, double *value_mm,
                                double *slope_mm) {
  *value_mm = *slope_mm = 0;
  for (size_t i = 0; i < list->count; i++) {
    const fg_render_effect *effect = &list->effects[i];
    if (effect->target != FG_RENDER_EFFECT_BUMP || !effect->row->curve) continue;
    *value_mm += 1e-3 * fg_curve_value_um(&effect->curve, u);
    *slope_mm += 1e-3 * u * fg_curve_slope_um(&effect->curve, u);
  }
}

double fg_render_effects_lift(const fg_render_effect_list *list, int bump, bool whole) {
  double sum_um = 0;
  for (size_t i = 0; i < list->count; i++)
    if (list->effects[i].target == FG_RENDER_EFFECT_LIFT && list->effects[i].lift.whole == whole)
      sum_um += list->effects[i].lift.um[bump - 1];
  return 1e-3 * sum_um;
}

void fg_render_effects_edges(const fg_render_effect_list *list, double nx, double ny,
                             double shift_mm[2]) {
  double direction_deg = atan2(ny, nx) * 180 / pi;
  shift_mm[0] = shift_mm[1] = 0;
  for (size_t i = 0; i < list->count; i++) {
    const fg_render_effect *effect = &list->effects[i];
    if (effect->target != FG_RENDER_EFFECT_EDGE) continue;
    double shift = effect_shape(effect, direction_deg, 1);
    shift_mm[0] += shift;
    shift_mm[1] += effect->apart ? -shift : shift;
  }
}

/* Returns a bound: the listed shapes never exceed their amplitude by much inside the foil's span; a
 * fillet that fades a bump's curve out overshoots it by less than as much again. */
double fg_render_effects_reach(const fg_render_effect_list *list) {
  double reach = 0;
  for (size_t i = 0; i < list->count; i++) {
    const fg_render_effect *effect = &list->effects[i];
    fg_render_effect_target target = effect->target;
    if (target != FG_RENDER_EFFECT_PART && target != FG_RENDER_EFFECT_NORMAL &&
        target != FG_RENDER_EFFECT_WIDTH && target != FG_RENDER_EFFECT_BUMP &&
        target != FG_RENDER_EFFECT_EDGE && target != FG_RENDER_EFFECT_LIFT)
      continue;
    double size = effect->row->curve                ? fg_curve_largest_um(&effect->curve)
                  : target == FG_RENDER_EFFECT_LIFT ? fg_lift_largest_um(&effect->lift)
                                                    : fabs(effect->p[0]);
    reach += 2e-3 * size;
  }
  return reach;
}
