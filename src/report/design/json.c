/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <cjson/cJSON.h>
#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/text.h"
#include "foilgauge/design.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/report.h"
#include "report/design/calibration_json.h"

enum { DESIGN_BYTES_MAX = 1 << 20, MESSAGE_MAX = 900 };

#define DESIGN_SCHEMA "foilgauge/design/1"

/* Place in the file, for messages. */
typedef struct reader {
  fg_context *ctx;
  const char *path;
} reader;

static fg_status fail(const reader *r, const char *member, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static fg_status fail(const reader *r, const char *member, const char *format, ...) {
  char words[MESSAGE_MAX];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(words, sizeof words, format, arguments);
  va_end(arguments);
  return fg_fail(r->ctx, FG_ERR_DATA, "%s: %.60s: %s", r->path, member, words);
}

typedef fg_status read_value(const reader *r, const char *name, const cJSON *item, void *out);

static fg_status read_number(const reader *r, const char *name, const cJSON *item, void *out) {
  if (!cJSON_IsNumber(item)) return fail(r, name, "must be a number");
  if (!isfinite(item->valuedouble)) return fail(r, name, "the number is too large");
  *(double *)out = item->valuedouble;
  return FG_OK;
}

static fg_status read_count(const reader *r, const char *name, const cJSON *item, void *out) {
  double value = 0;
  FG_TRY(read_number(r, name, item, &value));
  if (value < 0 || value > 100000 || value != floor(value))
    return fail(r, name, "is %g; it must be a whole number from 0 (not stated) to 100000", value);
  *(size_t *)out = (size_t)value;
  return FG_OK;
}

static fg_status read_name(const reader *r, const char *name, const cJSON *item, void *out) {
  size_t room = sizeof((fg_design *)0)->name;
  if (!cJSON_IsString(item)) return fail(r, name, "must be a text");
  size_t length = strlen(item->valuestring);
  if (length >= room) return fail(r, name, "has %zu bytes; at most %zu", length, room - 1);
  for (const char *c = item->valuestring; *c; c++)
    if (iscntrl((unsigned char)*c)) return fail(r, name, "holds a control character");
  memcpy(out, item->valuestring, length + 1);
  return FG_OK;
}

static fg_status read_schema(const reader *r, const char *name, const cJSON *item, void *out) {
  (void)out;
  if (cJSON_IsString(item) && !strcmp(item->valuestring, DESIGN_SCHEMA)) return FG_OK;
  return fail(r, name, "must be \"" DESIGN_SCHEMA "\"");
}

/* The place of a word in a list that ends with NULL. */
static fg_status read_word(const reader *r, const char *name, const cJSON *item,
                           const char *const *words, const char *choices, int *place) {
  for (int i = 0; cJSON_IsString(item) && words[i]; i++)
    if (!strcmp(item->valuestring, words[i])) {
      *place = i;
      return FG_OK;
    }
  return fail(r, name, "must be %s", choices);
}

static fg_status read_kind(const reader *r, const char *name, const cJSON *item, void *out) {
  char choices[200];
  if (cJSON_IsString(item) && fg_foil_kind_find(item->valuestring, out)) return FG_OK;
  fg_foil_kind_list(false, "\"", " or ", choices, sizeof choices);
  return fail(r, name, "must be %s", choices);
}

static fg_status read_datum(const reader *r, const char *name, const cJSON *item, void *out) {
  static const char *const words[] = {"mid", "inner", "outer", NULL};
  int place = 0;
  FG_TRY(read_word(r, name, item, words, "\"mid\", \"inner\" or \"outer\"", &place));
  *(fg_datum *)out = (fg_datum)place;
  return FG_OK;
}

static const cJSON *earlier_duplicate(const cJSON *object, const cJSON *member) {
  for (const cJSON *item = object->child; item != member; item = item->next)
    if (!strcmp(item->string, member->string)) return item;
  return NULL;
}

static fg_status read_limits(const reader *r, const char *name, const cJSON *item,
                             fg_tolerance *tolerance) {
  if (!cJSON_IsObject(item) || !item->child)
    return fail(r, name, "must be an object with \"min\", \"max\" or both");
  for (const cJSON *limit = item->child; limit; limit = limit->next) {
    char full[128];
    snprintf(full, sizeof full, "%.50s.%.20s", name, limit->string);
    if (earlier_duplicate(item, limit)) return fail(r, full, "is given twice");
    if (!strcmp(limit->string, "min"))
      FG_TRY(read_number(r, full, limit, &tolerance->lower));
    else if (!strcmp(limit->string, "max"))
      FG_TRY(read_number(r, full, limit, &tolerance->upper));
    else
      return fail(r, full, "is not known; a tolerance has \"min\" and \"max\"");
  }
  return FG_OK;
}

/* A file's tolerances replace those that were there. */
static fg_status read_tolerances(const reader *r, const char *name, const cJSON *item, void *out) {
  fg_design *design = out;
  if (!cJSON_IsObject(item)) return fail(r, name, "must be an object of quantities");
  design->tolerance_count = 0;
  for (const cJSON *entry = item->child; entry; entry = entry->next) {
    char full[80];
    fg_tolerance tolerance = {.lower = -INFINITY, .upper = INFINITY};
    snprintf(full, sizeof full, "%s.%.50s", name, entry->string);
    if (earlier_duplicate(item, entry)) return fail(r, full, "is given twice");
    if (strlen(entry->string) >= sizeof tolerance.quantity)
      return fail(r, full, "is not the name of a quantity");
    if (design->tolerance_count == FG_TOLERANCES_MAX)
      return fail(r, name, "more than %d entries", FG_TOLERANCES_MAX);
    memcpy(tolerance.quantity, entry->string, strlen(entry->string) + 1);
    FG_TRY(read_limits(r, full, entry, &tolerance));
    design->tolerances[design->tolerance_count++] = tolerance;
  }
  return FG_OK;
}

static fg_status read_diameters(const reader *r, const char *name, const cJSON *item, void *out) {
  fg_design_discs *discs = out;
  if (!cJSON_IsArray(item)) return fail(r, name, "must be an array of numbers");
  discs->count = 0;
  for (const cJSON *entry = item->child; entry; entry = entry->next) {
    char full[48];
    snprintf(full, sizeof full, "%s[%zu]", name, discs->count);
    if (discs->count == FG_DIAMETERS_MAX)
      return fail(r, name, "more than %d values", FG_DIAMETERS_MAX);
    FG_TRY(read_number(r, full, entry, &discs->diameters_mm[discs->count]));
    discs->count++;
  }
  return FG_OK;
}

static fg_status read_tone(const reader *r, const char *name, const cJSON *item, void *out) {
  static const char *const words[] = {"unknown", "linear", NULL};
  int place = 0;
  FG_TRY(read_word(r, name, item, words, "\"unknown\" or \"linear\"", &place));
  *(fg_tone_statement *)out = (fg_tone_statement)place;
  return FG_OK;
}

/* Refuses 0, which would mean "not stated". fg_design_check tests if the values are plausible. */
static fg_status read_thickness_measured(const reader *r, const char *name, const cJSON *item,
                                         void *out) {
  fg_design *design = out;
  const struct {
    const char *name;
    double *value;
  } parts[] = {{"value_mm", &design->thickness_measured_mm},
               {"u_mm", &design->u_thickness_measured_mm}};
  if (!cJSON_IsObject(item)) return fail(r, name, "must be an object with value_mm and u_mm");
  for (const cJSON *part = item->child; part; part = part->next)
    if (strcmp(part->string, parts[0].name) != 0 && strcmp(part->string, parts[1].name) != 0)
      return fail(r, name, "'%.40s' is not known; there are value_mm and u_mm", part->string);
    else if (earlier_duplicate(item, part))
      return fail(r, name, "%s is given twice", part->string);
  for (size_t i = 0; i < 2; i++) {
    char full[48];
    const cJSON *part = cJSON_GetObjectItemCaseSensitive(item, parts[i].name);
    snprintf(full, sizeof full, "%s.%s", name, parts[i].name);
    if (!part) return fail(r, full, "is missing; value_mm and u_mm go together");
    FG_TRY(read_number(r, full, part, parts[i].value));
    if (!(*parts[i].value > 0))
      return fail(r, full, "is %g; it must be above 0, in mm", *parts[i].value);
  }
  return FG_OK;
}

static fg_status read_calibration(const reader *r, const char *name, const cJSON *item, void *out) {
  fg_context words = {0};
  (void)name;
  fg_status status = fg_calibration_read(&words, item, out);
  if (status == FG_OK) return FG_OK;
  return fg_fail(r->ctx, status, "%s: %.*s", r->path, MESSAGE_MAX, words.message);
}

static fg_status read_gauge_kind(const reader *r, const char *name, const cJSON *item,
                                 fg_gauge_kind *kind) {
  static const char *const words[] = {"leaf", "pin", "ring", "hole", NULL};
  int place = 0;
  FG_TRY(read_word(r, name, item, words, "\"leaf\", \"pin\", \"ring\" or \"hole\"", &place));
  *kind = (fg_gauge_kind)place;
  return FG_OK;
}

static fg_status read_gauge(const reader *r, const char *name, const cJSON *item, fg_gauge *gauge) {
  static const char *const members[] = {"kind", "width_mm", "u_mm"};
  unsigned given = 0;
  if (!cJSON_IsObject(item)) return fail(r, name, "must be an object");
  for (const cJSON *member = item->child; member; member = member->next) {
    char full[80];
    snprintf(full, sizeof full, "%.40s.%.30s", name, member->string);
    if (earlier_duplicate(item, member)) return fail(r, full, "is given twice");
    if (!strcmp(member->string, members[0]))
      FG_TRY(read_gauge_kind(r, full, member, &gauge->kind));
    else if (!strcmp(member->string, members[1]))
      FG_TRY(read_number(r, full, member, &gauge->width_mm));
    else if (!strcmp(member->string, members[2]))
      FG_TRY(read_number(r, full, member, &gauge->u_mm));
    else
      return fail(r, full, "is not known; a gauge has \"kind\", \"width_mm\" and \"u_mm\"");
    for (unsigned i = 0; i < 3; i++)
      if (!strcmp(member->string, members[i])) given |= 1u << i;
  }
  for (unsigned i = 0; i < 3; i++)
    if (!(given & 1u << i)) return fail(r, name, "\"%s\" is missing", members[i]);
  return FG_OK;
}

/* A file's gauges replace those that were there. */
static fg_status read_gauges(const reader *r, const char *name, const cJSON *item, void *out) {
  fg_design *design = out;
  if (!cJSON_IsArray(item)) return fail(r, name, "must be an array of gauges");
  design->gauge_count = 0;
  for (const cJSON *entry = item->child; entry; entry = entry->next) {
    char full[48];
    snprintf(full, sizeof full, "%s[%zu]", name, design->gauge_count);
    if (design->gauge_count == FG_GAUGES_MAX)
      return fail(r, name, "more than %d gauges", FG_GAUGES_MAX);
    FG_TRY(read_gauge(r, full, entry, &design->gauges[design->gauge_count]));
    design->gauge_count++;
  }
  return FG_OK;
}

/* One row per member; offset 0 hands the whole design, or its group, to the reader. */
typedef struct member_row {
  const char *name;
  read_value *read;
  fg_design_group group;
  size_t offset;       /* in the design, or in the group */
  const char *meaning; /* foilgauge-design(5) */
} member_row;

#define MEMBER(name, read, meaning)                                                                \
  { #name, read, FG_DESIGN_COMMON, offsetof(fg_design, name), meaning }
#define OF(group, name, type, member, read, meaning)                                               \
  { name, read, group, offsetof(type, member), meaning }
#define BUMPS(name, member, read, meaning)                                                         \
  OF(FG_DESIGN_BUMPS, name, fg_design_bumps, member, read, meaning)
#define BEAMS(name, member, read, meaning)                                                         \
  OF(FG_DESIGN_BEAMS, name, fg_design_beams, member, read, meaning)
static const member_row member_rows[] = {
    {"schema", read_schema, FG_DESIGN_COMMON, 0, "Must be \"foilgauge/design/1\"."},
    MEMBER(name, read_name, "Of the design, as reports show it."),
    {"form", read_kind, FG_DESIGN_COMMON, offsetof(fg_design, kind),
     "\"classical\" (bumps, lands, a lip at one end), \"sinusoidal\" (long fillets, short "
     "lands, no lip), \"arc\" (a plain strip, as a top foil), \"cantilever\" (a flat foil with "
     "beams cut out of it) or \"discs\" (no foil: round gauges)."},
    MEMBER(datum, read_datum,
           "Which line of the strip the lengths belong to: \"mid\", \"inner\" (the shaft's side) "
           "or \"outer\" (the sleeve's)."),
    BUMPS("bump_count", count, read_count, "Bumps of a foil; 0: not stated."),
    BUMPS("bump_radius_mm", radius_mm, read_number, "R, of the circle of a bump."),
    BUMPS("bump_angle_deg", angle_deg, read_number,
          "alpha, at the bump's centre between the crossings with the overall circle."),
    MEMBER(overall_radius_mm, read_number, "R0, of the circle through the lands, or of an arc."),
    BUMPS("sleeve_radius_mm", sleeve_radius_mm, read_number,
          "Of the bore that the foil is pressed into; without it, `overall_radius_mm`."),
    BUMPS("pitch_deg", pitch_deg, read_number, "From bump to bump about the overall centre."),
    BUMPS("fillet_radius_mm", fillet_radius_mm, read_number, "Between a bump and its lands."),
    MEMBER(thickness_mm, read_number, "Of the strip."),
    {"thickness_measured", read_thickness_measured, FG_DESIGN_COMMON, 0,
     "Of the strip by a micrometer, at 20 °C: an object with `value_mm` and its standard "
     "uncertainty `u_mm`. It is the thickness in force, of clearances and stiffness, and the "
     "scan's is held against it."},
    MEMBER(tone, read_tone,
           "\"linear\" says that the scanner's counts are proportional to the light, and you vouch "
           "for it: thickness, diameters and clearances then hold no unknown tone curve. Without "
           "it, \"unknown\"."),
    BUMPS("top_foil_thickness_mm", top_foil_thickness_mm, read_number,
          "Of the plain foil between bumps and rotor, 0 for none: it is taken off every "
          "clearance, that of the design too; one that leaves no clearance is refused."),
    BUMPS("rotor_diameter_mm", rotor_diameter_mm, read_number, "Of the rotor in the bearing."),
    OF(FG_DESIGN_ARC, "subtended_angle_deg", fg_design_arc, subtended_angle_deg, read_number,
       "Of form \"arc\" alone: from end to end, about the centre."),
    BEAMS("beam_count", count, read_count,
          "Of form \"cantilever\" alone, as all up to `clearance_mm`: beams of a foil; 0: not "
          "stated."),
    BEAMS("beam_length_mm", length_mm, read_number, "L, from the root of a beam to its free end."),
    BEAMS("beam_width_mm", width_mm, read_number, "w, of a beam."),
    BEAMS("u_thickness_mm", u_thickness_mm, read_number,
          "Standard uncertainty of `thickness_mm`, which goes into that of the compliance; a scan "
          "does not see the thickness of what lies flat."),
    BEAMS("sagitta_mm", sagitta_mm, read_number,
          "s, by which a beam stands off its sheet once it is bent."),
    BEAMS("elastic_modulus_gpa", elastic_modulus_gpa, read_number,
          "E of the sheet; without it the compliance is told against the design's alone."),
    BEAMS("clearance_mm", clearance_mm, read_number,
          "Of the bearing with beams of this sagitta; its change is then told in percent, too."),
    {"diameters_mm", read_diameters, FG_DESIGN_DISCS, 0,
     "Of form \"discs\" alone: known diameters of the gauges, in any order."},
    OF(FG_DESIGN_DISCS, "u_diameters_mm", fg_design_discs, u_diameters_mm, read_number,
       "Standard uncertainty of each of these diameters; without it 0.0005 where the level of "
       "edges is told from them."),
    {"tolerances", read_tolerances, FG_DESIGN_COMMON, 0,
     "An object of quantities with \"min\", \"max\" or both; below."},
    MEMBER(calibration, read_calibration,
           "What the statistics of a scan cannot know: how long a pixel is, how warm the part was; "
           "below."),
    {"gauges", read_gauges, FG_DESIGN_COMMON, 0,
     "An array of gauges that lie on the glass in the same scan, as {\"kind\": \"leaf\", "
     "\"width_mm\": 0.1, \"u_mm\": 0.0005}: a \"leaf\" of a feeler gauge standing on its edge, a "
     "\"pin\" seen end-on, a \"ring\" of known bore or a \"hole\", with its known width and the "
     "standard uncertainty of that. They tell at which level edges lie."},
};
#undef MEMBER
#undef OF
#undef BUMPS
#undef BEAMS

enum { MEMBER_ROWS = sizeof member_rows / sizeof *member_rows };

static fg_status fail_unknown(const reader *r, const char *name) {
  char known[MESSAGE_MAX] = "";
  for (size_t i = 0; i < MEMBER_ROWS; i++) {
    size_t length = strlen(known);
    snprintf(known + length, sizeof known - length, "%s%s", i ? ", " : "", member_rows[i].name);
  }
  return fail(r, name, "is not a member of a design; there are %s", known);
}

/* A design while it is read: members of every group, as `form` may come last. */
typedef struct stated_design {
  fg_design design;
  fg_design_values groups[FG_DESIGN_GROUPS];
} stated_design;

static fg_status read_member(const reader *r, const cJSON *item, stated_design *stated) {
  for (size_t i = 0; i < MEMBER_ROWS; i++) {
    const member_row *row = &member_rows[i];
    if (strcmp(item->string, row->name) != 0) continue;
    char *place = row->group == FG_DESIGN_COMMON ? (char *)&stated->design
                                                 : (char *)&stated->groups[row->group];
    return row->read(r, item->string, item, place + row->offset);
  }
  return fail_unknown(r, item->string);
}

/* A file that states one of these and leaves another to the default would be measured against a
 * mixture of two designs. */
static fg_status check_complete(const reader *r, const cJSON *root, const fg_design *design) {
  static const char *const together[] = {"bump_radius_mm", "bump_angle_deg", "overall_radius_mm",
                                         "thickness_mm"};
  const char *given = NULL, *missing = NULL;
  for (size_t i = 0; i < sizeof together / sizeof *together; i++) {
    bool has = cJSON_GetObjectItemCaseSensitive(root, together[i]) != NULL;
    if (has && !given) given = together[i];
    if (!has && !missing) missing = together[i];
  }
  if (!fg_foil_kind_has_bumps(design->kind) || !given || !missing) return FG_OK;
  return fail(r, missing, "is missing; a design that states %s must state it too", given);
}

static bool has_member(const cJSON *root, const char *name) {
  return cJSON_GetObjectItemCaseSensitive(root, name) != NULL;
}

/* A kind without defaults: members that it needs, and those of other kinds, which would be ignored.
 */
static fg_status check_kind_members(const reader *r, const cJSON *root,
                                    const fg_foil_traits *kind) {
  for (size_t i = 0; kind->needed[i]; i++)
    if (!has_member(root, kind->needed[i]))
      return fail(r, kind->needed[i], "is missing; %s must state it", kind->noun);
  for (size_t i = 0; kind->foreign[i]; i++)
    if (has_member(root, kind->foreign[i]))
      return fail(r, kind->foreign[i], "belongs to a foil with bumps; form is \"%s\"", kind->name);
  return FG_OK;
}

static fg_status check_members(const reader *r, const cJSON *root, stated_design *stated) {
  fg_design *design = &stated->design;
  const fg_foil_traits *kind = fg_foil_traits_of(design->kind);
  if (kind->needed[0]) {
    FG_TRY(check_kind_members(r, root, kind));
    if (!has_member(root, "name"))
      fg_text_clip(design->name, sizeof design->name, "%s", kind->name);
    return FG_OK;
  }
  FG_TRY(check_complete(r, root, design));
  if (has_member(root, "overall_radius_mm") && !has_member(root, "sleeve_radius_mm"))
    stated->groups[FG_DESIGN_BUMPS].bumps.sleeve_radius_mm = design->overall_radius_mm;
  return FG_OK;
}

static fg_status read_root(const reader *r, const cJSON *root, stated_design *stated) {
  if (!cJSON_IsObject(root)) return fail(r, "the design", "must be a JSON object");
  for (const cJSON *item = root->child; item; item = item->next) {
    if (earlier_duplicate(root, item)) return fail(r, item->string, "is given twice");
    FG_TRY(read_member(r, item, stated));
  }
  if (!has_member(root, "schema"))
    return fail(r, "schema", "is missing; a design has \"schema\": \"" DESIGN_SCHEMA "\"");
  FG_TRY(check_members(r, root, stated));
  stated->design.values = stated->groups[fg_foil_traits_of(stated->design.kind)->group];
  return FG_OK;
}

static fg_status check_design(const reader *r, const stated_design *stated) {
  const fg_design *design = &stated->design;
  fg_context words = {0};
  fg_status status = fg_design_check_common(&words, design);
  for (int group = 0; group < FG_DESIGN_GROUPS && status == FG_OK; group++)
    status = fg_design_check_refused(&words, design->kind, (fg_design_group)group,
                                     &stated->groups[group]);
  if (status == FG_OK) status = fg_design_check(&words, design);
  if (status == FG_OK) status = fg_report_check_tolerances(&words, design);
  if (status == FG_OK) return FG_OK;
  return fg_fail(r->ctx, status, "%s: %.*s", r->path, MESSAGE_MAX, words.message);
}

fg_status fg_design_parse(fg_context *ctx, const char *path, const char *json, fg_design *design) {
  const reader r = {ctx, path};
  stated_design stated = {.design = *design};
  cJSON *root;
  for (int group = 0; group < FG_DESIGN_GROUPS; group++)
    fg_design_group_default((fg_design_group)group, &stated.groups[group]);
  stated.groups[fg_foil_traits_of(design->kind)->group] = design->values;
  FG_TRY(fg_json_read(ctx, path, json, &root));
  fg_status status = read_root(&r, root, &stated);
  cJSON_Delete(root);
  if (status == FG_OK) status = check_design(&r, &stated);
  if (status == FG_OK) *design = stated.design;
  return status;
}

fg_status fg_design_load(fg_context *ctx, const char *path, fg_design *design) {
  char *text = NULL;
  FG_TRY(fg_file_read_text(ctx, path, DESIGN_BYTES_MAX, &text));
  fg_status status = fg_design_parse(ctx, path, text, design);
  free(text);
  return status;
}

/* Defaults are the built-in design's: a file that states nothing is measured with them. */
size_t fg_design_members(fg_member_words *list, size_t max) {
  fg_design usual;
  fg_design_default(&usual);
  for (size_t i = 0; i < MEMBER_ROWS && i < max; i++) {
    const member_row *row = &member_rows[i];
    fg_design_values values;
    fg_design_group_default(row->group, &values);
    const char *from =
        row->group == FG_DESIGN_COMMON ? (const char *)&usual : (const char *)&values;
    const char *place = from + row->offset;
    list[i] = (fg_member_words){.meaning = row->meaning};
    fg_text_clip(list[i].name, sizeof list[i].name, "%s", row->name);
    if (row->read == read_number && *(const double *)place > 0)
      fg_text_clip(list[i].usual, sizeof list[i].usual, "%.10g", *(const double *)place);
    if (row->read == read_count)
      fg_text_clip(list[i].usual, sizeof list[i].usual, "%zu", *(const size_t *)place);
  }
  return MEMBER_ROWS;
}
