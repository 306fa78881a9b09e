#include "render/effects.h"

#include <math.h>
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

static const fg_effect_row rows[] = {
    {"scan.scale_y", FG_EFFECT_SCANNER, {{"value", NAN, -0.1, 0.1}}, scale_y, NULL, 0},
    {"scan.shear", FG_EFFECT_SCANNER, {{"value", NAN, -0.1, 0.1}}, shear, NULL, 0},
    {"scan.carriage_ripple",
     FG_EFFECT_SCANNER,
     {{"amplitude_um", NAN, -200, 200},
      {"period_mm", NAN, 0.05, 1000},
      {"phase_deg", 0, -360, 360}},
     carriage_ripple,
     NULL,
     0},
    {"scan.row_step",
     FG_EFFECT_STEP,
     {{"amplitude_um", NAN, -500, 500}, {"y_mm", INFINITY, -1000, 1000}},
     row_step,
     NULL,
     1},
    {"scan.optical_quadratic",
     FG_EFFECT_SCANNER,
     {{"amplitude_um", NAN, -500, 500},
      {"centre_mm", INFINITY, -1000, 1000},
      {"half_width_mm", 18, 0.1, 1000}},
     optical_quadratic,
     NULL,
     0},
    {"scan.optical_cubic",
     FG_EFFECT_SCANNER,
     {{"amplitude_um", NAN, -500, 500},
      {"centre_mm", INFINITY, -1000, 1000},
      {"half_width_mm", 18, 0.1, 1000}},
     optical_cubic,
     NULL,
     0},
    {"scan.carriage_quadratic",
     FG_EFFECT_SCANNER,
     {{"amplitude_um", NAN, -500, 500},
      {"centre_mm", INFINITY, -1000, 1000},
      {"half_width_mm", 18, 0.1, 1000}},
     carriage_quadratic,
     NULL,
     1},
    {"part.ovality",
     FG_EFFECT_PART,
     {{"amplitude_um", NAN, -1000, 1000}, {"phase_deg", 0, -360, 360}},
     NULL,
     ovality,
     0},
    {"part.spiral", FG_EFFECT_PART, {{"amplitude_um", NAN, -1000, 1000}}, NULL, spiral, 0},
    {"part.bump_crown", FG_EFFECT_BUMP, {{"amplitude_um", NAN, -50, 50}}, NULL, bump_crown, 0},
    {"part.bump_skew", FG_EFFECT_BUMP, {{"amplitude_um", NAN, -50, 50}}, NULL, bump_skew, 0},
    {"part.lip_decay",
     FG_EFFECT_TABLE,
     {{"amplitude_rel", NAN, -0.5, 0.5}, {"decay_bumps", 2, 0.1, 100}},
     NULL,
     lip_decay,
     0},
    {0},
};

static fg_status parse_parameters(const fg_place *place, const cJSON *object, fg_effect *effect) {
  fg_member table[FG_EFFECT_PARAMETERS_MAX + 2] = {{"id", FG_MEMBER_OTHER, 0, 0, 0}};
  size_t used = 1;
  for (int i = 0; i < FG_EFFECT_PARAMETERS_MAX && effect->row->parameters[i].name; i++) {
    const fg_effect_parameter *parameter = &effect->row->parameters[i];
    effect->p[i] = parameter->fallback;
    table[used++] = (fg_member){parameter->name, FG_MEMBER_NUMBER,
                                offsetof(fg_effect, p) + (size_t)i * sizeof effect->p[0],
                                parameter->low, parameter->high};
  }
  FG_TRY(fg_members_read(place, object, table, effect));
  for (int i = 0; i < FG_EFFECT_PARAMETERS_MAX && effect->row->parameters[i].name; i++)
    if (isnan(effect->p[i]))
      return fg_member_fail(place, effect->row->parameters[i].name, NULL, "the effect needs it");
  return FG_OK;
}

fg_status fg_effects_parse(const fg_place *place, const cJSON *array, fg_effect_list *list) {
  list->count = 0;
  if (!array) return FG_OK;
  if (!cJSON_IsArray(array) || cJSON_GetArraySize(array) > FG_EFFECTS_MAX)
    return fg_member_fail(place, "effects", array, "must be an array of at most 16 effects");
  const cJSON *item;
  cJSON_ArrayForEach(item, array) {
    fg_place inner = fg_place_item(place, "effects", (int)list->count);
    const cJSON *id = cJSON_GetObjectItemCaseSensitive(item, "id");
    const fg_effect_row *row = rows;
    while (row->id && !(cJSON_IsString(id) && !strcmp(row->id, id->valuestring)))
      row++;
    if (!row->id)
      return fg_member_fail(&inner, "id", id, "must be the name of an effect such as scan.scale_y");
    list->effects[list->count] = (fg_effect){.row = row};
    FG_TRY(parse_parameters(&inner, item, &list->effects[list->count]));
    list->count++;
  }
  return FG_OK;
}

void fg_effects_resolve(fg_effect_list *list, double width_mm, double height_mm) {
  for (size_t i = 0; i < list->count; i++)
    for (int k = 0; k < FG_EFFECT_PARAMETERS_MAX; k++)
      if (isinf(list->effects[i].p[k]))
        list->effects[i].p[k] = 0.5 * (list->effects[i].row->middle_axis ? height_mm : width_mm);
}

bool fg_effects_have(const fg_effect_list *list, fg_effect_frame frame) {
  for (size_t i = 0; i < list->count; i++)
    if (list->effects[i].row->frame == frame) return true;
  return false;
}

void fg_effects_field(const fg_effect_list *list, double x_mm, double y_mm, double row_y_mm,
                      double d_mm[2]) {
  d_mm[0] = d_mm[1] = 0;
  for (size_t i = 0; i < list->count; i++) {
    const fg_effect *effect = &list->effects[i];
    if (effect->row->frame == FG_EFFECT_SCANNER) effect->row->field(effect->p, x_mm, y_mm, d_mm);
    if (effect->row->frame == FG_EFFECT_STEP) effect->row->field(effect->p, x_mm, row_y_mm, d_mm);
  }
}

double fg_effects_next_step(const fg_effect_list *list, double low_mm, double high_mm) {
  double next = NAN;
  for (size_t i = 0; i < list->count; i++) {
    double at = list->effects[i].p[1];
    if (list->effects[i].row->frame != FG_EFFECT_STEP || !(at >= low_mm && at < high_mm)) continue;
    next = fmin(next, at); /* fmin prefers the number to NaN */
  }
  return next;
}

double fg_effects_shape(const fg_effect_list *list, fg_effect_frame frame, double coordinate,
                        double extent) {
  double result = frame == FG_EFFECT_TABLE ? 1 : 0;
  for (size_t i = 0; i < list->count; i++) {
    const fg_effect *effect = &list->effects[i];
    if (effect->row->frame != frame) continue;
    double value = effect->row->shape(effect->p, coordinate, extent);
    result = frame == FG_EFFECT_TABLE ? result * value : result + value;
  }
  return result;
}
