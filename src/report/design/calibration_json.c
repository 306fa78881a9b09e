/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Members of a calibration. A certificate states an expanded uncertainty with its factor; a report
 * writes the standard uncertainty. */
#include <math.h>
#include <string.h>

#include "core/date.h"
#include "foilgauge/calibration.h"
#include "report/design/members.h"

/* A certificate states U with a factor from 1 (68 %) to 4; beyond it is a slip. */
static const double k_min = 1, k_max = 4;

/* A value with its uncertainty, as stated: u, or U with its k. NaN: absent. */
typedef struct stated {
  double value, u, expanded, k;
} stated;

static const stated nothing = {NAN, NAN, NAN, NAN};

#define STATED(name, field)                                                                        \
  { FG_NUMBER(name, stated, field), .options = FG_MEMBER_LEFT_OUT }
static const fg_member scale_rows[] = {
    STATED("u_rel", u),
    STATED("U_rel", expanded),
    STATED("k", k),
};
static const fg_members scale_members = FG_MEMBERS(scale_rows);

static const fg_member temperature_rows[] = {
    {FG_NUMBER("value_C", stated, value), .options = FG_MEMBER_REQUIRED},
    STATED("u_K", u),
    STATED("U_K", expanded),
    STATED("k", k),
};
static const fg_members temperature_members = FG_MEMBERS(temperature_rows);

static const fg_member expansion_rows[] = {
    {FG_NUMBER("value_per_K", stated, value), .options = FG_MEMBER_REQUIRED},
    STATED("u_per_K", u),
    STATED("U_per_K", expanded),
    STATED("k", k),
};
static const fg_members expansion_members = FG_MEMBERS(expansion_rows);
#undef STATED

typedef struct axes {
  stated x, y;
} axes;

static const fg_member axes_rows[] = {
    {FG_OBJECT("x", axes, x, &scale_members), .options = FG_MEMBER_ON_LINE | FG_MEMBER_REQUIRED},
    {FG_OBJECT("y", axes, y, &scale_members), .options = FG_MEMBER_ON_LINE | FG_MEMBER_REQUIRED},
};
static const fg_members axes_members = FG_MEMBERS(axes_rows);

/* Standard uncertainty as stated; the last rows of the members are u, U and k. */
static fg_status find_u(const fg_reading *reading, const fg_members *members, const stated *from,
                        double *u) {
  const char *u_name = members->rows[members->count - 3].name;
  const char *expanded = members->rows[members->count - 2].name;
  *u = from->u;
  if (isnan(from->u) == isnan(from->expanded))
    return fg_reading_fail(reading, NULL,
                           "needs either %s, a standard uncertainty, or %s with its k", u_name,
                           expanded);
  if (isnan(from->expanded) && !isnan(from->k))
    return fg_reading_fail(reading, NULL, "k belongs to %s; %s is a standard uncertainty", expanded,
                           u_name);
  if (isnan(from->expanded)) return FG_OK;
  if (isnan(from->k))
    return fg_reading_fail(reading, NULL, "%s needs its factor k, as the certificate says",
                           expanded);
  if (!(from->k >= k_min && from->k <= k_max))
    return fg_reading_fail(reading, NULL, "k is %g; it must be from %g to %g", from->k, k_min,
                           k_max);
  *u = from->expanded / from->k;
  return FG_OK;
}

static fg_status read_stated(const fg_reading *reading, const char *name, const fg_members *members,
                             const cJSON *item, double *value, double *u) {
  const fg_reading inside = fg_reading_inside(reading, name);
  stated from = nothing;
  FG_TRY(fg_object_read(&inside, members, item, &from));
  if (value) *value = from.value;
  return find_u(&inside, members, &from, u);
}

static fg_status read_scale(const fg_reading *reading, const fg_member *member, const cJSON *item,
                            void *object) {
  fg_calibration *c = object;
  axes both = {nothing, nothing};
  c->per_axis = cJSON_GetObjectItemCaseSensitive(item, "x") != NULL ||
                cJSON_GetObjectItemCaseSensitive(item, "y") != NULL;
  if (!c->per_axis) {
    FG_TRY(read_stated(reading, member->name, &scale_members, item, NULL, &c->u_scale[0]));
    c->u_scale[1] = c->u_scale[0];
    return FG_OK;
  }
  const fg_reading inside = fg_reading_inside(reading, member->name);
  FG_TRY(fg_object_read(&inside, &axes_members, item, &both));
  const fg_reading x = fg_reading_inside(&inside, "x"), y = fg_reading_inside(&inside, "y");
  FG_TRY(find_u(&x, &scale_members, &both.x, &c->u_scale[0]));
  return find_u(&y, &scale_members, &both.y, &c->u_scale[1]);
}

static fg_status read_temperature(const fg_reading *reading, const fg_member *member,
                                  const cJSON *item, void *object) {
  fg_calibration *c = object;
  c->has_temperature = true;
  return read_stated(reading, member->name, &temperature_members, item, &c->temperature_c,
                     &c->u_temperature_k);
}

static fg_status read_expansion(const fg_reading *reading, const fg_member *member,
                                const cJSON *item, void *object) {
  fg_calibration *c = object;
  return read_stated(reading, member->name, &expansion_members, item, &c->expansion_per_k,
                     &c->u_expansion_per_k);
}

static void write_stated(fg_json *json, const char *name, const fg_members *members, double value,
                         double u) {
  const stated of = {value, u, NAN, NAN};
  const fg_member row = {
      .name = name, .kind = FG_MEMBER_OBJECT, .options = FG_MEMBER_ON_LINE, .members = members};
  fg_member_json(json, &row, &(fg_subject){.object = &of});
}

static void write_scale(fg_json *json, const char *name, const fg_subject *subject) {
  const fg_calibration *c = subject->object;
  const axes both = {{NAN, c->u_scale[0], NAN, NAN}, {NAN, c->u_scale[1], NAN, NAN}};
  const fg_member row = {.name = name, .kind = FG_MEMBER_OBJECT, .members = &axes_members};
  if (c->per_axis)
    fg_member_json(json, &row, &(fg_subject){.object = &both});
  else
    write_stated(json, name, &scale_members, NAN, c->u_scale[0]);
}

static void write_temperature(fg_json *json, const char *name, const fg_subject *subject) {
  const fg_calibration *c = subject->object;
  write_stated(json, name, &temperature_members, c->temperature_c, c->u_temperature_k);
}

static void write_expansion(fg_json *json, const char *name, const fg_subject *subject) {
  const fg_calibration *c = subject->object;
  write_stated(json, name, &expansion_members, c->expansion_per_k, c->u_expansion_per_k);
}

static bool has_scale(const fg_subject *subject) {
  return fg_calibration_has_scale(subject->object);
}

static bool has_temperature(const fg_subject *subject) {
  return ((const fg_calibration *)subject->object)->has_temperature;
}

/* Schemas: u alone, or U with its k; `value` is the first property, with its comma. */
#define POSITIVE "{\"type\": \"number\", \"minimum\": 0}"
#define WITH_U(value, required, u, expanded, max)                                                  \
  "\"type\": \"object\", \"properties\": {" value "\"" u                                           \
  "\": {\"type\": \"number\", \"minimum\": 0, \"maximum\": " max "}, \"" expanded "\": " POSITIVE  \
  ", \"k\": {\"type\": \"number\", \"minimum\": 1, \"maximum\": 4}}, " required                    \
  "\"oneOf\": [{\"required\": [\"" u                                                               \
  "\"], \"not\": {\"anyOf\": [{\"required\": [\"k\"]}, {\"required\": [\"" expanded                \
  "\"]}]}}, {\"required\": [\"" expanded "\", \"k\"], \"not\": {\"required\": [\"" u               \
  "\"]}}], \"additionalProperties\": false"
#define SCALE_OF_AXIS "{" WITH_U("", "", "u_rel", "U_rel", "0.05") "}"
#define SCALE_SCHEMA                                                                               \
  "{\"oneOf\": [" SCALE_OF_AXIS ", {\"type\": \"object\", \"properties\": {\"x\": " SCALE_OF_AXIS  \
  ", \"y\": " SCALE_OF_AXIS "}, \"required\": [\"x\", \"y\"], \"additionalProperties\": false}]}"
#define TEMPERATURE_SCHEMA                                                                         \
  "{" WITH_U("\"value_C\": {\"type\": \"number\", \"minimum\": 0, \"maximum\": 60}, ",             \
             "\"required\": [\"value_C\"], ", "u_K", "U_K", "20") "}"
#define EXPANSION_SCHEMA                                                                           \
  "{" WITH_U("\"value_per_K\": {\"type\": \"number\", \"minimum\": -1e-4, \"maximum\": 1e-4}, ",   \
             "\"required\": [\"value_per_K\"], ", "u_per_K", "U_per_K", "1e-4") "}"

/* A file that is read again must measure the same: no number loses a digit. */
#define UNLESS_EMPTY .options = FG_MEMBER_LEFT_OUT | FG_MEMBER_EMPTY_IS_NULL
static const fg_member calibration_rows[] = {
    {FG_TEXT("certificate", fg_calibration, certificate), UNLESS_EMPTY,
     .words = "Its name, as reports show it."},
    {FG_TEXT("date", fg_calibration, date), UNLESS_EMPTY, .pattern = "^[0-9.-]{10}$",
     .words = "Of the certificate, as 2026-03-14."},
    {FG_TEXT("artefact", fg_calibration, artefact), UNLESS_EMPTY,
     .words = "The plate or gauge that the certificate is of: reports then say \"plate\"."},
    {FG_TEXT("due", fg_calibration, due), UNLESS_EMPTY, .pattern = "^[0-9.-]{10}$",
     .words = "The last day that the certificate holds: younger scans are refused."},
    {FG_WRITTEN("scale", write_scale, SCALE_SCHEMA), .read = read_scale, .options = FG_MEMBER_EXACT,
     .present = has_scale,
     .words = "How well the pixel's pitch is known, relative: `u_rel`, or `U_rel` with its factor "
              "`k`; of both axes alike, or of `x` and `y` each by itself. Temperature and "
              "expansion may stand without it, where a scanner's model has the scale."},
    {FG_WRITTEN("temperature", write_temperature, TEMPERATURE_SCHEMA), .read = read_temperature,
     .options = FG_MEMBER_EXACT, .present = has_temperature,
     .words = "Of the part while it was scanned: `value_C` with `u_K`, or `U_K` and `k`."},
    {FG_WRITTEN("expansion", write_expansion, EXPANSION_SCHEMA), .read = read_expansion,
     .options = FG_MEMBER_EXACT, .present = has_temperature,
     .words = "Of the foil: `value_per_K` with `u_per_K`, or `U_per_K` and `k`; where the scale "
              "was taken from a reference part at the same temperature, less that part's."},
};
const fg_members fg_calibration_members = {
    .rows = calibration_rows,
    .count = sizeof calibration_rows / sizeof *calibration_rows,
    .definition = "calibration",
    .file = "design",
    .limits = "\"anyOf\": [{\"required\": [\"scale\"]}, {\"required\": [\"temperature\"]}]",
};

static fg_status check_day(const fg_reading *reading, const char *member, const char *day) {
  if (!day[0] || (strlen(day) == 10 && !isnan(fg_date_days(day)))) return FG_OK;
  return fg_reading_fail(reading, member, "'%s' is no date; write it as 2026-03-14", day);
}

static const char flatbed[] = "flatbed", not_needed[] = "not needed";

/* "flatbed", or "not needed: REASON". */
static fg_status read_calibration_word(const fg_reading *reading, const char *word,
                                       fg_calibration *c) {
  size_t length = sizeof not_needed - 1;
  if (!strcmp(word, flatbed)) {
    *c = fg_calibration_of_flatbed();
    return FG_OK;
  }
  *c = (fg_calibration){.stated = false};
  const char *reason = !strncmp(word, not_needed, length) ? word + length : NULL;
  if (!reason || strspn(reason, ": ") == strlen(reason) || reason[0] != ':')
    return fg_reading_fail(reading, NULL,
                           "'%.40s' is neither an object nor \"flatbed\" nor \"not needed\" with "
                           "its reason, as \"not needed: the scan is rendered\"",
                           word);
  reason += strspn(reason, ": ");
  if (strlen(reason) >= sizeof c->not_needed)
    return fg_reading_fail(reading, NULL, "the reason is too long; at most %zu bytes",
                           sizeof c->not_needed - 1);
  strcpy(c->not_needed, reason);
  return FG_OK;
}

void fg_calibration_write(fg_json *json, const char *name, const fg_calibration *c) {
  char word[sizeof not_needed + sizeof c->not_needed + 2];
  const fg_member row = {
      .name = name, .kind = FG_MEMBER_OBJECT, .members = &fg_calibration_members};
  if (!c->not_needed[0]) {
    fg_member_json(json, &row, &(fg_subject){.object = c});
    return;
  }
  snprintf(word, sizeof word, "%s: %s", not_needed, c->not_needed);
  fg_json_string(json, name, word);
}

fg_status fg_calibration_read(const fg_reading *reading, const fg_member *member, const cJSON *item,
                              void *object) {
  fg_calibration *calibration = (void *)((char *)object + member->offset);
  fg_calibration c = {.stated = true};
  fg_reading inside = fg_reading_inside(reading, member->name);
  inside.between = ": ";
  fg_context words = {0};
  if (cJSON_IsNull(item)) {
    *calibration = (fg_calibration){.stated = false};
    return FG_OK;
  }
  if (cJSON_IsString(item)) return read_calibration_word(&inside, item->valuestring, calibration);
  FG_TRY(fg_object_read(&inside, &fg_calibration_members, item, &c));
  FG_TRY(check_day(&inside, "date", c.date));
  FG_TRY(check_day(&inside, "due", c.due));
  bool expansion = cJSON_GetObjectItemCaseSensitive(item, "expansion") != NULL;
  if (c.has_temperature != expansion)
    return fg_reading_fail(&inside, NULL, "%s is missing; temperature and expansion go together",
                           expansion ? "temperature" : "expansion");
  c.scale_by_model = cJSON_GetObjectItemCaseSensitive(item, "scale") == NULL;
  if (c.scale_by_model && !c.has_temperature)
    return fg_reading_fail(&inside, NULL,
                           "scale is missing; without it temperature and expansion "
                           "are needed, and a scanner's model has the scale");
  fg_status status = fg_calibration_check(&words, &c);
  if (status != FG_OK)
    return fg_fail(reading->ctx, status, "%s%s%.900s", reading->path ? reading->path : "",
                   reading->path ? ": " : "", words.message);
  *calibration = c;
  return FG_OK;
}

static double find_reference(const fg_subject *subject) {
  (void)subject;
  return FG_REFERENCE_TEMPERATURE_C;
}

static double find_factor(const fg_subject *subject) {
  return fg_calibration_factor(subject->object);
}

static const double *find_u_scale(const fg_subject *subject, double *values, size_t *count) {
  const fg_calibration_budget terms = fg_calibration_terms(subject->object);
  *count = 2;
  return memcpy(values, terms.scale, sizeof terms.scale);
}

static const double *find_u_length(const fg_subject *subject, double *values, size_t *count) {
  const fg_calibration_budget terms = fg_calibration_terms(subject->object);
  *count = 2;
  return memcpy(values, terms.length, sizeof terms.length);
}

static double find_u_by_temperature(const fg_subject *subject) {
  return fg_calibration_terms(subject->object).temperature;
}

static double find_u_by_expansion(const fg_subject *subject) {
  return fg_calibration_terms(subject->object).expansion;
}

static double find_u_by_bed(const fg_subject *subject) {
  return fg_calibration_terms(subject->object).bed;
}

#define AXES_SCHEMA                                                                                \
  "{\"type\": \"array\", \"items\": " POSITIVE ", \"minItems\": 2, \"maxItems\": 2}"
#define KNOWN .options = FG_MEMBER_NEVER_NULL | FG_MEMBER_NOT_NEGATIVE
static const fg_member u_rel_rows[] = {
    {FG_NUMBERS_BY("scale", find_u_scale), .schema = AXES_SCHEMA,
     .words = "by the pixel's pitch, along x and y"},
    {FG_NUMBER_BY("temperature", find_u_by_temperature), KNOWN, .words = "by the part's"},
    {FG_NUMBER_BY("expansion", find_u_by_expansion), KNOWN, .words = "by the part's"},
    {FG_NUMBER_BY("bed", find_u_by_bed), KNOWN,
     .words = "by the scanner's own expansion between the temperatures of its model and the part"},
    {FG_NUMBERS_BY("length", find_u_length), .schema = AXES_SCHEMA,
     .words = "all of them, along x and y"},
};
static const fg_members u_rel_members = FG_MEMBERS(u_rel_rows);

/* Rows of the derived values; a measurement's own member `budget` stands behind them. */
static bool is_never(const fg_subject *subject) {
  (void)subject;
  return false;
}

#define BUDGET_SCHEMA                                                                                \
  "{\"description\": \"u² = u_statistical² + u_calibration² of every quantity of the page, root " \
  "mean squares over all parts; what the calibration leaves is the same error in all of them\", "    \
  "\"type\": \"array\", \"items\": {\"type\": \"object\", \"properties\": {\"quantity\": "           \
  "{\"type\": \"string\"}, \"u_statistical\": " POSITIVE ", \"u_calibration\": " POSITIVE            \
  ", \"u\": " POSITIVE "}, \"required\": [\"quantity\", \"u_statistical\", \"u_calibration\", "      \
  "\"u\"], \"additionalProperties\": false}}"

static const fg_member used_rows[] = {
    {FG_SAME(&fg_calibration_members)},
    {FG_NUMBER_BY("reference_C", find_reference), .schema = "{\"const\": 20}",
     .words = "lengths are those at this temperature"},
    {FG_NUMBER_BY("length_factor", find_factor), .options = FG_MEMBER_NEVER_NULL,
     .words = "length at 20 °C over length as scanned"},
    {FG_GROUP("u_rel", &u_rel_members), .words = "relative standard uncertainties of a length"},
    {FG_WRITTEN("budget", NULL, BUDGET_SCHEMA), .present = is_never},
};
const fg_members fg_calibration_used_members = {
    .rows = used_rows,
    .count = sizeof used_rows / sizeof *used_rows,
    .definition = "calibration_used",
    .file = "design",
    .nullable = true,
};
