/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/design/calibration_json.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "core/date.h"
#include "core/text.h"

/* A certificate states U with a factor from 1 (68 %) to 4; beyond it is a slip. */
static const double k_min = 1, k_max = 4;

static fg_status fail_at_member(fg_context *ctx, const char *place, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static fg_status fail_at_member(fg_context *ctx, const char *place, const char *format, ...) {
  char words[400];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(words, sizeof words, format, arguments);
  va_end(arguments);
  return fg_fail(ctx, FG_ERR_DATA, "%.120s: %s", place, words);
}

static void join_place(char *full, size_t size, const char *place, const char *name) {
  fg_text_clip(full, size, "%.80s.%.40s", place, name);
}

/* Every member is one of the list, and there once. */
static fg_status check_members(fg_context *ctx, const char *place, const cJSON *object,
                               const char *const *names) {
  char full[128], list[200] = "";
  if (!cJSON_IsObject(object)) return fail_at_member(ctx, place, "must be an object");
  for (size_t i = 0; names[i]; i++)
    fg_text_clip(list + strlen(list), sizeof list - strlen(list), "%s%s", i ? ", " : "", names[i]);
  for (const cJSON *item = object->child; item; item = item->next) {
    size_t i = 0;
    join_place(full, sizeof full, place, item->string);
    while (names[i] && strcmp(names[i], item->string) != 0)
      i++;
    if (!names[i]) return fail_at_member(ctx, full, "is not known; there are %s", list);
    if (cJSON_GetObjectItemCaseSensitive(object, item->string) != item)
      return fail_at_member(ctx, full, "is given twice");
  }
  return FG_OK;
}

/* NaN: it is not there. */
static fg_status read_calibration_number(fg_context *ctx, const char *place, const cJSON *object,
                                         const char *name, double *value) {
  char full[128];
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
  *value = NAN;
  if (!item) return FG_OK;
  join_place(full, sizeof full, place, name);
  if (!cJSON_IsNumber(item)) return fail_at_member(ctx, full, "must be a number");
  if (!isfinite(item->valuedouble)) return fail_at_member(ctx, full, "the number is too large");
  *value = item->valuedouble;
  return FG_OK;
}

/* Members of an object: a value or NULL, and u or U with its k. */
typedef struct stated {
  const char *value, *u, *expanded;
} stated;

static const stated scale_names = {NULL, "u_rel", "U_rel"};
static const stated temperature_names = {"value_C", "u_K", "U_K"};
static const stated expansion_names = {"value_per_K", "u_per_K", "U_per_K"};

static fg_status read_u(fg_context *ctx, const char *place, const cJSON *object, const stated *s,
                        double *u) {
  double expanded, k;
  FG_TRY(read_calibration_number(ctx, place, object, s->u, u));
  FG_TRY(read_calibration_number(ctx, place, object, s->expanded, &expanded));
  FG_TRY(read_calibration_number(ctx, place, object, "k", &k));
  if (isnan(*u) == isnan(expanded))
    return fail_at_member(ctx, place, "needs either %s, a standard uncertainty, or %s with its k",
                          s->u, s->expanded);
  if (isnan(expanded) && !isnan(k))
    return fail_at_member(ctx, place, "k belongs to %s; %s is a standard uncertainty", s->expanded,
                          s->u);
  if (isnan(expanded)) return FG_OK;
  if (isnan(k))
    return fail_at_member(ctx, place, "%s needs its factor k, as the certificate says",
                          s->expanded);
  if (!(k >= k_min && k <= k_max))
    return fail_at_member(ctx, place, "k is %g; it must be from %g to %g", k, k_min, k_max);
  *u = expanded / k;
  return FG_OK;
}

static fg_status read_stated(fg_context *ctx, const char *place, const cJSON *object,
                             const stated *s, double *value, double *u) {
  const char *const names[] = {s->u, s->expanded, "k", s->value, NULL};
  FG_TRY(check_members(ctx, place, object, names));
  if (s->value) FG_TRY(read_calibration_number(ctx, place, object, s->value, value));
  if (s->value && isnan(*value)) return fail_at_member(ctx, place, "%s is missing", s->value);
  return read_u(ctx, place, object, s, u);
}

static fg_status read_scale(fg_context *ctx, const cJSON *item, fg_calibration *c) {
  static const char *const place = "calibration.scale", *const axes[] = {"x", "y", NULL};
  c->per_axis = cJSON_GetObjectItemCaseSensitive(item, "x") != NULL ||
                cJSON_GetObjectItemCaseSensitive(item, "y") != NULL;
  if (!c->per_axis) {
    FG_TRY(read_stated(ctx, place, item, &scale_names, NULL, &c->u_scale[0]));
    c->u_scale[1] = c->u_scale[0];
    return FG_OK;
  }
  FG_TRY(check_members(ctx, place, item, axes));
  for (int axis = 0; axis < 2; axis++) {
    char full[128];
    const cJSON *own = cJSON_GetObjectItemCaseSensitive(item, axes[axis]);
    if (!own)
      return fail_at_member(ctx, place, "%s is missing; with one axis comes the other", axes[axis]);
    join_place(full, sizeof full, place, axes[axis]);
    FG_TRY(read_stated(ctx, full, own, &scale_names, NULL, &c->u_scale[axis]));
  }
  return FG_OK;
}

static fg_status read_heat(fg_context *ctx, const cJSON *item, fg_calibration *c) {
  const cJSON *temperature = cJSON_GetObjectItemCaseSensitive(item, "temperature");
  const cJSON *expansion = cJSON_GetObjectItemCaseSensitive(item, "expansion");
  c->has_temperature = temperature || expansion;
  if (!c->has_temperature) return FG_OK;
  if (!temperature || !expansion)
    return fail_at_member(ctx, "calibration",
                          "%s is missing; temperature and expansion go together",
                          temperature ? "expansion" : "temperature");
  FG_TRY(read_stated(ctx, "calibration.temperature", temperature, &temperature_names,
                     &c->temperature_c, &c->u_temperature_k));
  return read_stated(ctx, "calibration.expansion", expansion, &expansion_names, &c->expansion_per_k,
                     &c->u_expansion_per_k);
}

static fg_status read_calibration_text(fg_context *ctx, const cJSON *object, const char *name,
                                       char *text, size_t size) {
  char full[128];
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
  if (!item) return FG_OK;
  join_place(full, sizeof full, "calibration", name);
  if (!cJSON_IsString(item)) return fail_at_member(ctx, full, "must be a text in quotes");
  if (strlen(item->valuestring) >= size)
    return fail_at_member(ctx, full, "is too long; at most %zu bytes", size - 1);
  for (const char *c = item->valuestring; *c; c++)
    if ((unsigned char)*c < ' ' || *c == 0x7f)
      return fail_at_member(ctx, full, "holds a control character");
  strcpy(text, item->valuestring);
  return FG_OK;
}

fg_status fg_calibration_read(fg_context *ctx, const cJSON *item, fg_calibration *calibration) {
  static const char *const names[] = {"certificate", "date",      "scale",
                                      "temperature", "expansion", NULL};
  fg_calibration c = {.stated = true};
  if (cJSON_IsNull(item)) {
    *calibration = (fg_calibration){.stated = false};
    return FG_OK;
  }
  FG_TRY(check_members(ctx, "calibration", item, names));
  FG_TRY(read_calibration_text(ctx, item, "certificate", c.certificate, sizeof c.certificate));
  FG_TRY(read_calibration_text(ctx, item, "date", c.date, sizeof c.date));
  if (c.date[0] && (strlen(c.date) != 10 || isnan(fg_date_days(c.date))))
    return fail_at_member(ctx, "calibration.date", "'%s' is no date; write it as 2026-03-14",
                          c.date);
  if (!cJSON_GetObjectItemCaseSensitive(item, "scale"))
    return fail_at_member(ctx, "calibration",
                          "scale is missing: how well the pixel's pitch is known");
  FG_TRY(read_scale(ctx, cJSON_GetObjectItemCaseSensitive(item, "scale"), &c));
  FG_TRY(read_heat(ctx, item, &c));
  FG_TRY(fg_calibration_check(ctx, &c));
  *calibration = c;
  return FG_OK;
}

static void write_stated_value(fg_json *json, const char *name, const stated *s, double value,
                               double u) {
  fg_json_object(json, name);
  fg_json_line(json);
  if (s->value) fg_json_number(json, s->value, value);
  fg_json_number(json, s->u, u);
  fg_json_object_end(json);
  fg_json_line_end(json);
}

static void write_members(fg_json *json, const fg_calibration *c) {
  bool exact = json->exact;
  json->exact = true; /* a file that is read again must measure the same */
  if (c->certificate[0]) fg_json_string(json, "certificate", c->certificate);
  if (c->date[0]) fg_json_string(json, "date", c->date);
  if (c->per_axis) {
    fg_json_object(json, "scale");
    write_stated_value(json, "x", &scale_names, 0, c->u_scale[0]);
    write_stated_value(json, "y", &scale_names, 0, c->u_scale[1]);
    fg_json_object_end(json);
  } else {
    write_stated_value(json, "scale", &scale_names, 0, c->u_scale[0]);
  }
  if (c->has_temperature) {
    write_stated_value(json, "temperature", &temperature_names, c->temperature_c,
                       c->u_temperature_k);
    write_stated_value(json, "expansion", &expansion_names, c->expansion_per_k,
                       c->u_expansion_per_k);
  }
  json->exact = exact;
}

void fg_json_calibration(fg_json *json, const char *name, const fg_calibration *calibration) {
  if (!calibration->stated) {
    fg_json_string(json, name, NULL);
    return;
  }
  fg_json_object(json, name);
  write_members(json, calibration);
  fg_json_object_end(json);
}

void fg_json_calibration_members(fg_json *json, const fg_calibration *calibration) {
  fg_calibration_budget terms = fg_calibration_terms(calibration);
  write_members(json, calibration);
  fg_json_number(json, "reference_C", FG_REFERENCE_TEMPERATURE_C);
  fg_json_number(json, "length_factor", fg_calibration_factor(calibration));
  fg_json_object(json, "u_rel");
  fg_json_numbers(json, "scale", terms.scale, 2);
  fg_json_number(json, "temperature", terms.temperature);
  fg_json_number(json, "expansion", terms.expansion);
  fg_json_numbers(json, "length", terms.length, 2);
  fg_json_object_end(json);
}

void fg_json_calibration_used(fg_json *json, const char *name, const fg_calibration *calibration) {
  if (!calibration->stated) {
    fg_json_string(json, name, NULL);
    return;
  }
  fg_json_object(json, name);
  fg_json_calibration_members(json, calibration);
  fg_json_object_end(json);
}
