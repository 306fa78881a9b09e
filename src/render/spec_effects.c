#include "render/spec_effects.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* Parameters arrive in the unit of their name: um are turned into mm here. */

static void scale_y(const double *p, double x, double y, double d[2]) {
  (void)x;
  d[1] += p[0] * y;
}

static void shear(const double *p, double x, double y, double d[2]) {
  (void)x;
  d[0] += p[0] * y;
}

static void carriage_ripple(const double *p, double x, double y, double d[2]) {
  (void)x;
  d[1] += 1e-3 * p[0] * sin(2 * pi * y / p[1] + p[2] * pi / 180);
}

static void row_step(const double *p, double x, double y, double d[2]) {
  (void)x;
  if (y > p[1]) d[1] += 1e-3 * p[0];
}

static void column_step(const double *p, double x, double y, double d[2]) {
  (void)y;
  if (x > p[1]) d[0] += 1e-3 * p[0];
}

static void optical_quadratic(const double *p, double x, double y, double d[2]) {
  (void)y;
  double u = (x - p[1]) / p[2];
  d[0] += 1e-3 * p[0] * u * u;
}

static void optical_cubic(const double *p, double x, double y, double d[2]) {
  (void)y;
  double u = (x - p[1]) / p[2];
  d[0] += 1e-3 * p[0] * u * u * u;
}

static void carriage_quadratic(const double *p, double x, double y, double d[2]) {
  (void)x;
  double u = (y - p[1]) / p[2];
  d[1] += 1e-3 * p[0] * u * u;
}

static void carriage_start(const double *p, double x, double y, double d[2]) {
  (void)x;
  d[1] += 1e-3 * p[0] * exp(-y / p[1]);
}

static double ovality(const double *p, double psi, double half_span) {
  (void)half_span;
  return 1e-3 * p[0] * cos(2 * (psi - p[1] * pi / 180));
}

static double spiral(const double *p, double psi, double half_span) {
  double u = psi / half_span;
  return 1e-3 * p[0] * u * u * u;
}

/* Flat with zero slope at |u| = 1, so that arc and fillet stay joined. */
static double bump_crown(const double *p, double u, double unused) {
  (void)unused;
  double v = 1 - u * u;
  return 1e-3 * p[0] * v * v;
}

/* The same times u, scaled so that its largest value, at u = 1/sqrt(5), is the amplitude. */
static double bump_skew(const double *p, double u, double unused) {
  (void)unused;
  double v = 1 - u * u;
  return 1e-3 * p[0] * u * v * v * sqrt(5.0) * 25 / 16;
}

static double lip_decay(const double *p, double index, double count) {
  (void)count;
  return 1 + p[0] * exp(-(index - 1) / p[1]);
}

static double stretch(const double *p, double beyond_mm, double unused) {
  (void)unused;
  return 1 + p[0] + p[1] * beyond_mm;
}

/* Where a picture's place is looked for at its true position takes fields that change slowly. */
static const fg_curve_axis along_mm = {"mm", -1000, 1000, 0, 100};
static const fg_curve_axis unit_axis = {"u", -1, 1, 0, 0};
static const fg_curve_axis direction = {"deg", 0, 360, 360, 0};

static const fg_render_effect_row rows[] = {
    {"scan.scale_y", FG_RENDER_EFFECT_SCANNER, {{"value", NAN, -0.1, 0.1}}, scale_y, NULL, 0, NULL},
    {"scan.shear", FG_RENDER_EFFECT_SCANNER, {{"value", NAN, -0.1, 0.1}}, shear, NULL, 0, NULL},
    {"scan.carriage_ripple",
     FG_RENDER_EFFECT_SCANNER,
     {{"amplitude_um", NAN, -200, 200},
      {"period_mm", NAN, 0.05, 1000},
      {"phase_deg", 0, -360, 360}},
     carriage_ripple,
     NULL,
     0,
     NULL},
    {"scan.row_step",
     FG_RENDER_EFFECT_STEP,
     {{"amplitude_um", NAN, -500, 500}, {"y_mm", INFINITY, -1000, 1000}},
     row_step,
     NULL,
     1,
     NULL},
    {"scan.column_step",
     FG_RENDER_EFFECT_STEP,
     {{"amplitude_um", NAN, -500, 500}, {"x_mm", INFINITY, -1000, 1000}},
     column_step,
     NULL,
     0,
     NULL},
    {"scan.optical_quadratic",
     FG_RENDER_EFFECT_SCANNER,
     {{"amplitude_um", NAN, -500, 500},
      {"centre_mm", INFINITY, -1000, 1000},
      {"half_width_mm", 18, 0.1, 1000}},
     optical_quadratic,
     NULL,
     0,
     NULL},
    {"scan.optical_cubic",
     FG_RENDER_EFFECT_SCANNER,
     {{"amplitude_um", NAN, -500, 500},
      {"centre_mm", INFINITY, -1000, 1000},
      {"half_width_mm", 18, 0.1, 1000}},
     optical_cubic,
     NULL,
     0,
     NULL},
    {"scan.carriage_quadratic",
     FG_RENDER_EFFECT_SCANNER,
     {{"amplitude_um", NAN, -500, 500},
      {"centre_mm", INFINITY, -1000, 1000},
      {"half_width_mm", 18, 0.1, 1000}},
     carriage_quadratic,
     NULL,
     1,
     NULL},
    {"scan.carriage_start",
     FG_RENDER_EFFECT_SCANNER,
     {{"amplitude_um", NAN, -500, 500}, {"length_mm", NAN, 0.5, 1000}},
     carriage_start,
     NULL,
     1,
     NULL},
    {"part.ovality",
     FG_RENDER_EFFECT_PART,
     {{"amplitude_um", NAN, -1000, 1000}, {"phase_deg", 0, -360, 360}},
     NULL,
     ovality,
     0,
     NULL},
    {"part.spiral",
     FG_RENDER_EFFECT_PART,
     {{"amplitude_um", NAN, -1000, 1000}},
     NULL,
     spiral,
     0,
     NULL},
    {"part.bump_crown",
     FG_RENDER_EFFECT_BUMP,
     {{"amplitude_um", NAN, -50, 50}},
     NULL,
     bump_crown,
     0,
     NULL},
    {"part.bump_skew",
     FG_RENDER_EFFECT_BUMP,
     {{"amplitude_um", NAN, -50, 50}},
     NULL,
     bump_skew,
     0,
     NULL},
    {"part.lip_decay",
     FG_RENDER_EFFECT_TABLE,
     {{"amplitude_rel", NAN, -0.5, 0.5}, {"decay_bumps", 2, 0.1, 100}},
     NULL,
     lip_decay,
     0,
     NULL},
    {"part.stretch",
     FG_RENDER_EFFECT_STRETCH,
     {{"value_rel", NAN, -0.3, 0.3}, {"slope_rel_per_mm", 0, -2, 2}},
     NULL,
     stretch,
     0,
     NULL},
    {"free.scan.x", FG_RENDER_EFFECT_SCANNER, {{0}}, NULL, NULL, 0, &along_mm},
    {"free.scan.y", FG_RENDER_EFFECT_SCANNER, {{0}}, NULL, NULL, 1, &along_mm},
    {"free.foil.s", FG_RENDER_EFFECT_PART, {{0}}, NULL, NULL, 0, &unit_axis},
    {"free.bump.phi", FG_RENDER_EFFECT_BUMP, {{0}}, NULL, NULL, 0, &unit_axis},
    {"free.edge.normal", FG_RENDER_EFFECT_EDGE, {{0}}, NULL, NULL, 0, &direction},
    {0},
};

/* One of two words; absent: the first. */
static fg_status parse_choice(const fg_place *place, const cJSON *object, const char *name,
                              const char *const words[2], int *choice) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
  if (!item) return FG_OK;
  for (int i = 0; i < 2; i++)
    if (cJSON_IsString(item) && !strcmp(item->valuestring, words[i])) {
      *choice = i;
      return FG_OK;
    }
  char what[64];
  snprintf(what, sizeof what, "must be \"%s\" or \"%s\"", words[0], words[1]);
  return fg_member_fail(place, name, item, what);
}

static fg_status parse_direction(const fg_place *place, const cJSON *object,
                                 fg_render_effect *effect) {
  int normal = 0;
  if (effect->row->frame != FG_RENDER_EFFECT_PART) return FG_OK;
  FG_TRY(parse_choice(place, object, "along", (const char *const[]){"radius", "normal"}, &normal));
  if (normal) effect->frame = FG_RENDER_EFFECT_NORMAL;
  return FG_OK;
}

static fg_status parse_curve(const fg_place *place, const cJSON *object, fg_render_effect *effect) {
  static const fg_member scan[] = {{"id", FG_MEMBER_OTHER, 0, 0, 0},
                                   {"knots", FG_MEMBER_OTHER, 0, 0, 0},
                                   {"moves", FG_MEMBER_OTHER, 0, 0, 0},
                                   {0}};
  static const fg_member edge[] = {{"id", FG_MEMBER_OTHER, 0, 0, 0},
                                   {"knots", FG_MEMBER_OTHER, 0, 0, 0},
                                   {"edges", FG_MEMBER_OTHER, 0, 0, 0},
                                   {0}};
  static const fg_member part[] = {{"id", FG_MEMBER_OTHER, 0, 0, 0},
                                   {"knots", FG_MEMBER_OTHER, 0, 0, 0},
                                   {"along", FG_MEMBER_OTHER, 0, 0, 0},
                                   {0}};
  static const fg_member bump[] = {
      {"id", FG_MEMBER_OTHER, 0, 0, 0}, {"knots", FG_MEMBER_OTHER, 0, 0, 0}, {0}};
  fg_render_effect_frame frame = effect->row->frame;
  FG_TRY(fg_members_read(place, object,
                         frame == FG_RENDER_EFFECT_SCANNER ? scan
                         : frame == FG_RENDER_EFFECT_EDGE  ? edge
                         : frame == FG_RENDER_EFFECT_PART  ? part
                                                           : bump,
                         effect));
  int apart = 0;
  effect->moves = effect->row->axis;
  FG_TRY(parse_choice(place, object, "moves", (const char *const[]){"x", "y"}, &effect->moves));
  FG_TRY(parse_choice(place, object, "edges", (const char *const[]){"together", "apart"}, &apart));
  effect->apart = apart == 1;
  return fg_curve_parse(place, cJSON_GetObjectItemCaseSensitive(object, "knots"),
                        effect->row->curve, &effect->curve);
}

static fg_status parse_parameters(const fg_place *place, const cJSON *object,
                                  fg_render_effect *effect) {
  fg_member table[FG_RENDER_EFFECT_PARAMETERS_MAX + 3] = {{"id", FG_MEMBER_OTHER, 0, 0, 0}};
  size_t used = 1;
  for (int i = 0; i < FG_RENDER_EFFECT_PARAMETERS_MAX && effect->row->parameters[i].name; i++) {
    const fg_render_effect_parameter *parameter = &effect->row->parameters[i];
    effect->p[i] = parameter->fallback;
    table[used++] = (fg_member){parameter->name, FG_MEMBER_NUMBER,
                                offsetof(fg_render_effect, p) + (size_t)i * sizeof effect->p[0],
                                parameter->low, parameter->high};
  }
  if (effect->row->frame == FG_RENDER_EFFECT_PART)
    table[used++] = (fg_member){"along", FG_MEMBER_OTHER, 0, 0, 0};
  FG_TRY(fg_members_read(place, object, table, effect));
  for (int i = 0; i < FG_RENDER_EFFECT_PARAMETERS_MAX && effect->row->parameters[i].name; i++)
    if (isnan(effect->p[i]))
      return fg_member_fail(place, effect->row->parameters[i].name, NULL, "the effect needs it");
  return FG_OK;
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
    const fg_render_effect_row *row = rows;
    while (row->id && !(cJSON_IsString(id) && !strcmp(row->id, id->valuestring)))
      row++;
    if (!row->id)
      return fg_member_fail(&inner, "id", id, "must be the name of an effect such as scan.scale_y");
    list->effects[list->count] = (fg_render_effect){.row = row, .frame = row->frame};
    FG_TRY(
        (row->curve ? parse_curve : parse_parameters)(&inner, item, &list->effects[list->count]));
    FG_TRY(parse_direction(&inner, item, &list->effects[list->count]));
    list->count++;
  }
  return FG_OK;
}

void fg_render_effects_resolve(fg_render_effect_list *list, double width_mm, double height_mm) {
  for (size_t i = 0; i < list->count; i++)
    for (int k = 0; k < FG_RENDER_EFFECT_PARAMETERS_MAX; k++)
      if (isinf(list->effects[i].p[k]))
        list->effects[i].p[k] = 0.5 * (list->effects[i].row->axis ? height_mm : width_mm);
}

bool fg_render_effects_have(const fg_render_effect_list *list, fg_render_effect_frame frame) {
  for (size_t i = 0; i < list->count; i++)
    if (list->effects[i].frame == frame) return true;
  return false;
}

/* Of a radius about O, a bump's circle or an edge: in mm. */
static double effect_shape(const fg_render_effect *effect, double coordinate, double extent) {
  if (effect->row->curve) return 1e-3 * fg_curve_value_um(&effect->curve, coordinate / extent);
  return effect->row->shape(effect->p, coordinate, extent);
}

void fg_render_effects_field(const fg_render_effect_list *list, double x_mm, double y_mm,
                             const double side_mm[2], double d_mm[2]) {
  d_mm[0] = d_mm[1] = 0;
  for (size_t i = 0; i < list->count; i++) {
    const fg_render_effect *effect = &list->effects[i];
    if (effect->frame == FG_RENDER_EFFECT_SCANNER && effect->row->curve)
      d_mm[effect->moves] += effect_shape(effect, effect->row->axis ? y_mm : x_mm, 1);
    else if (effect->frame == FG_RENDER_EFFECT_SCANNER)
      effect->row->field(effect->p, x_mm, y_mm, d_mm);
    if (effect->frame == FG_RENDER_EFFECT_STEP)
      effect->row->field(effect->p, side_mm[0], side_mm[1], d_mm);
  }
}

double fg_render_effects_next_step(const fg_render_effect_list *list, int axis, double low_mm,
                                   double high_mm) {
  double next = NAN;
  for (size_t i = 0; i < list->count; i++) {
    const fg_render_effect *effect = &list->effects[i];
    double at = effect->p[1];
    if (effect->frame != FG_RENDER_EFFECT_STEP || effect->row->axis != axis) continue;
    if (at >= low_mm && at < high_mm) next = fmin(next, at); /* fmin prefers the number to NaN */
  }
  return next;
}

double fg_render_effects_shape(const fg_render_effect_list *list, fg_render_effect_frame frame,
                               double coordinate, double extent) {
  bool factor = frame == FG_RENDER_EFFECT_TABLE || frame == FG_RENDER_EFFECT_STRETCH;
  double result = factor ? 1 : 0;
  for (size_t i = 0; i < list->count; i++) {
    const fg_render_effect *effect = &list->effects[i];
    if (effect->frame != frame) continue;
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
    if (effect->frame != FG_RENDER_EFFECT_BUMP || !effect->row->curve) continue;
    *value_mm += 1e-3 * fg_curve_value_um(&effect->curve, u);
    *slope_mm += 1e-3 * u * fg_curve_slope_um(&effect->curve, u);
  }
}

void fg_render_effects_edges(const fg_render_effect_list *list, double nx, double ny,
                             double shift_mm[2]) {
  double direction_deg = atan2(ny, nx) * 180 / pi;
  shift_mm[0] = shift_mm[1] = 0;
  for (size_t i = 0; i < list->count; i++) {
    const fg_render_effect *effect = &list->effects[i];
    if (effect->frame != FG_RENDER_EFFECT_EDGE) continue;
    double shift = effect_shape(effect, direction_deg, 1);
    shift_mm[0] += shift;
    shift_mm[1] += effect->apart ? -shift : shift;
  }
}

/* The listed shapes never exceed their amplitude by much inside the foil's span; a fillet that
 * fades a bump's curve out overshoots it by less than as much again. */
double fg_render_effects_reach(const fg_render_effect_list *list) {
  double reach = 0;
  for (size_t i = 0; i < list->count; i++) {
    const fg_render_effect *effect = &list->effects[i];
    fg_render_effect_frame frame = effect->frame;
    if (frame != FG_RENDER_EFFECT_PART && frame != FG_RENDER_EFFECT_NORMAL &&
        frame != FG_RENDER_EFFECT_WIDTH && frame != FG_RENDER_EFFECT_BUMP &&
        frame != FG_RENDER_EFFECT_EDGE)
      continue;
    double size = effect->row->curve ? fg_curve_largest_um(&effect->curve) : fabs(effect->p[0]);
    reach += 2e-3 * size;
  }
  return reach;
}
