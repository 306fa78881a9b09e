/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Truth of a render: its effects, and the lines of a colour sensor. */
#include <math.h>

#include "render/spec.h"
#include "render/truth.h"

enum { PROFILE_POINTS = 201 }; /* of a colour line, along y */

const double *fg_truth_pair(double *pair, size_t *count, double first, double second) {
  pair[0] = first;
  pair[1] = second;
  *count = 2;
  return pair;
}

/* Effects, and lost rows, stitches and seams behind them: the subject's index tells them apart. */
bool fg_truth_effect_at(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_render_effect_list *all = &((const fg_render_spec *)list->whole)->effects;
  if (i < all->count)
    element->object = &all->effects[i];
  else
    element->object = &all->jumps.each[i - all->count];
  return i < all->count + all->jumps.count;
}

static bool is_jump(const fg_subject *s) {
  return s->index >= ((const fg_render_spec *)s->whole)->effects.count;
}

static bool is_no_jump(const fg_subject *s) {
  return !is_jump(s);
}

static const char *find_effect_id(const fg_subject *s, char *buffer) {
  (void)buffer;
  if (!is_jump(s)) return ((const fg_render_effect *)s->object)->row->id;
  return ((const fg_render_jump *)s->object)->axis ? "scan.row_step" : "scan.column_step";
}

/* Parameters have names of their effect: the subject's index is the parameter's. */
static bool find_parameter(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_render_effect *effect = list->object;
  element->object = effect;
  return i < FG_RENDER_EFFECT_PARAMETERS_MAX && effect->row->parameters[i].name;
}

static const char *parameter_name(const fg_subject *s) {
  return ((const fg_render_effect *)s->object)->row->parameters[s->index].name;
}

static const char *parameter_choice(size_t i) {
  for (const fg_render_effect_row *row = fg_render_effect_rows(); row->id; row++)
    for (size_t k = 0; k < FG_RENDER_EFFECT_PARAMETERS_MAX && row->parameters[k].name; k++)
      if (i-- == 0) return row->parameters[k].name;
  return NULL;
}

FG_TRUE_VALUE(find_parameter_value, fg_render_effect, o->p[s->index])

static const fg_member parameter_rows[] = {{FG_NUMBER_BY(NULL, find_parameter_value)}};
static const fg_members parameter_members = FG_MEMBERS(parameter_rows);

static const char *const move_words[] = {"x", "y", NULL},
                         *const edge_words[] = {"together", "apart", NULL},
                         *const lift_words[] = {"crown", "whole", NULL};

static int find_moves(const fg_subject *s) {
  const fg_render_effect *effect = s->object;
  bool field = effect->row->curve && effect->row->target == FG_RENDER_EFFECT_SCANNER;
  return field ? effect->moves : -1;
}

static int find_edges(const fg_subject *s) {
  const fg_render_effect *effect = s->object;
  return effect->row->curve && effect->row->target == FG_RENDER_EFFECT_EDGE ? effect->apart : -1;
}

static int find_lift(const fg_subject *s) {
  const fg_render_effect *effect = s->object;
  return effect->target == FG_RENDER_EFFECT_LIFT ? effect->lift.whole : -1;
}

FG_TRUE_CASE(has_curve, fg_render_effect, o->row->curve != NULL)
FG_TRUE_CASE(is_lift, fg_render_effect, o->target == FG_RENDER_EFFECT_LIFT)

static const double *list_lifts(const fg_subject *s, double *buffer, size_t *count) {
  (void)buffer;
  *count = (size_t)fg_scene_max_bumps(s->whole);
  return ((const fg_render_effect *)s->object)->lift.um;
}

static const double *list_knot(const fg_subject *s, double *pair, size_t *count) {
  const fg_curve *curve = s->object;
  return fg_truth_pair(pair, count, curve->at[s->index], curve->value_um[s->index]);
}

static const fg_member knot_rows[] = FG_TRUTH_PAIR(list_knot);
static const fg_members knot_members = FG_MEMBERS(knot_rows);

static bool find_knot(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_render_effect *effect = list->object;
  element->object = &effect->curve;
  return i < effect->curve.count;
}

static const fg_member basis_rows[] = {
    {FG_MAP_BY(NULL, find_parameter, parameter_name, &parameter_members),
     .choice_at = parameter_choice, .options = FG_MEMBER_LEFT_OUT},
    {FG_WORD_BY("moves", find_moves, move_words), .options = FG_MEMBER_LEFT_OUT,
     .words = "axis that a curve of the scanner displaces"},
    {FG_WORD_BY("edges", find_edges, edge_words), .options = FG_MEMBER_LEFT_OUT,
     .words = "move so by a curve of the edges"},
    {FG_LIST_BY("knots", find_knot, &knot_members), .present = has_curve,
     .words = "coordinate, µm"},
    {FG_WORD_BY("form", find_lift, lift_words), .options = FG_MEMBER_LEFT_OUT,
     .words = "of single bumps that deviate"},
    {FG_NUMBERS_BY("values_um", list_lifts), .present = is_lift, .options = FG_MEMBER_NEVER_NULL,
     .words = "of bump 1, 2, …"},
};
static const fg_members basis_members = FG_MEMBERS(basis_rows);

static double shift_along(const fg_render_jump *jump) {
  return jump->repeats * jump->d_mm[jump->axis];
}

FG_TRUE_VALUE(find_amplitude, fg_render_jump, 1e3 * shift_along(o))
FG_TRUE_VALUE(find_rows, fg_render_jump, o->axis ? round(shift_along(o) / o->every_mm) : NAN)
FG_TRUE_VALUE(find_amplitude_across, fg_render_jump, 1e3 * o->d_mm[1 - o->axis])
FG_TRUE_CASE(is_along_y, fg_render_jump, o->axis == 1)
FG_TRUE_CASE(is_along_x, fg_render_jump, o->axis == 0)
FG_TRUE_CASE(is_seam_skew, fg_render_jump, o->axis == 0 && o->d_mm[1] != 0)
FG_TRUE_CASE(is_row_skew, fg_render_jump, o->axis == 1 && o->d_mm[0] != 0)

static const fg_member jump_rows[] = {
    {FG_NUMBER_BY("amplitude_um", find_amplitude), .words = "across it, all its repeats"},
    {FG_NUMBER("y_mm", fg_render_jump, at_mm), .present = is_along_y, .words = "its place"},
    {FG_NUMBER("x_mm", fg_render_jump, at_mm), .present = is_along_x, .words = "its place"},
    {FG_NUMBER_BY("rows", find_rows), .options = FG_MEMBER_LEFT_OUT,
     .words = "lost; negative: read again"},
    {FG_NUMBER_BY("amplitude_y_um", find_amplitude_across), .present = is_seam_skew},
    {FG_NUMBER_BY("amplitude_x_um", find_amplitude_across), .present = is_row_skew},
};
static const fg_members jump_members = FG_MEMBERS(jump_rows);

static const fg_member effect_rows[] = {
    {FG_TEXT_BY("id", find_effect_id), .options = FG_MEMBER_NEVER_NULL,
     .words = "as a spec and the loop name it"},
    {FG_SAME(&basis_members), .present = is_no_jump},
    {FG_SAME(&jump_members), .present = is_jump},
};
const fg_members fg_truth_effect_members = FG_MEMBERS(effect_rows);

/* Colour lines, each against green. */
static const fg_colour_line *line_of(const fg_render_spec *spec, size_t i) {
  return &spec->scanner.colour.line[i];
}

/* The carriage's error along y when a line reads row y, in the middle of the picture, mm. */
static double carriage_mm(const fg_render_spec *spec, const fg_colour_line *line, double y_mm) {
  double at[2] = {0.5 * (double)spec->sensor.width_px * spec->sensor.pixel_mm[0],
                  y_mm + line->gap_px * spec->sensor.pixel_mm[1]};
  double d[2];
  fg_render_effects_field(&spec->effects, at[0], at[1], at, d);
  return d[1];
}

static double line_shift_px(const fg_subject *s, int axis) {
  const fg_colour_line *line = s->object;
  return line->shift_px[axis] - line_of(s->whole, 1)->shift_px[axis];
}

/* true = nominal + d: the picture moves up by d. */
static const double *list_profile_point(const fg_subject *s, double *pair, size_t *count) {
  const fg_render_spec *spec = s->whole;
  double height_mm = (double)spec->sensor.height_px * spec->sensor.pixel_mm[1];
  double y = height_mm * (double)s->index / (PROFILE_POINTS - 1);
  double shift_mm = line_shift_px(s, 1) * spec->sensor.pixel_mm[1];
  return fg_truth_pair(
      pair, count, y,
      1e3 * (shift_mm - carriage_mm(spec, s->object, y) + carriage_mm(spec, line_of(spec, 1), y)));
}

static const fg_member profile_rows[] = FG_TRUTH_PAIR(list_profile_point);
static const fg_members profile_members = FG_MEMBERS(profile_rows);

static bool find_profile_point(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = list->object;
  return i < PROFILE_POINTS;
}

static double pixel_ratio(const fg_subject *s, int axis) {
  const fg_render_spec *spec = s->whole;
  return line_shift_px(s, axis) * spec->sensor.pixel_mm[axis] / spec->pixel_mm[axis];
}

static double shift_um(const fg_subject *s, int axis) {
  const fg_render_spec *spec = s->whole;
  return 1e3 * line_shift_px(s, axis) * spec->sensor.pixel_mm[axis];
}

FG_TRUE_VALUE(find_gap, fg_colour_line, o->gap_px - line_of(s->whole, 1)->gap_px)
FG_TRUE_VALUE(find_magnification, fg_colour_line,
              o->magnification_ppm - line_of(s->whole, 1)->magnification_ppm)

#define OF_AXIS(name, function, axis)                                                              \
  static double name(const fg_subject *s) {                                                        \
    return function(s, axis);                                                                      \
  }
OF_AXIS(find_dx_px, pixel_ratio, 0)
OF_AXIS(find_dy_px, pixel_ratio, 1)
OF_AXIS(find_dx_um, shift_um, 0)
OF_AXIS(find_dy_um, shift_um, 1)

static const fg_member line_rows[] = {
    {FG_NUMBER_BY("gap_px", find_gap), .words = "by which it reads a row later"},
    {FG_NUMBER_BY("dx_px", find_dx_px), .words = "its picture's shift to the right"},
    {FG_NUMBER_BY("dy_px", find_dy_px), .words = "its picture's shift down"},
    {FG_NUMBER_BY("dx_um", find_dx_um), .words = "the same"},
    {FG_NUMBER_BY("dy_um", find_dy_um), .words = "the same"},
    {FG_NUMBER_BY("magnification_ppm", find_magnification), .words = "along x"},
    {FG_LIST_BY("course", find_profile_point, &profile_members),
     .words = "y in mm, shift along y in µm with the carriage's unevenness"},
};
static const fg_members line_members = FG_MEMBERS_DEFINED(line_rows, "colour_line");

static const char *const line_words[] = {"red", "blue", NULL};

static bool find_line(const fg_subject *list, size_t i, fg_subject *element) {
  if (i >= 2) return false;
  element->object = line_of(list->whole, 2 * i);
  return true;
}

static const char *line_name(const fg_subject *s) {
  return line_words[s->index];
}

static const char *find_against(const fg_subject *s, char *buffer) {
  (void)s, (void)buffer;
  return fg_colour_line_words[1];
}

FG_TRUE_VALUE(find_middle_x, fg_render_spec,
              0.5 * (double)(o->sensor.width_px - 1) * o->sensor.pixel_mm[0])

static const fg_member colour_rows[] = {
    {FG_TEXT_BY("against", find_against), .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER_BY("middle_x_mm", find_middle_x), .words = "about which magnification counts"},
    {FG_MAP_BY(NULL, find_line, line_name, &line_members), .choices = line_words},
};
const fg_members fg_truth_colour_members = FG_MEMBERS(colour_rows);
