/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dies of a recipe. Their numbers are kept in the recipe, so that a lot can be reported again
 * without the files of `foilgauge die`. */
#include "lot/input/recipe_dies.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/sha256.h"
#include "core/text.h"
#include "foilgauge/words.h"

enum { DIE_BYTES_MAX = 64 << 20, CONTEXT_WORDS = 800 };

static const char *datum_choice(size_t i) {
  return i <= FG_DATUM_OUTER ? fg_datum_word((fg_datum)i) : NULL;
}

static fg_status add_die_bump(fg_context *ctx, const double numbers[3], fg_lot_die *die) {
  if (die->bump_count == FG_LOT_DIE_BUMPS_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "more than %d bumps", FG_LOT_DIE_BUMPS_MAX);
  if (numbers[0] != floor(numbers[0]) || fabs(numbers[0]) > 1e6 || !(numbers[1] > 0) ||
      !(numbers[2] >= 0))
    return fg_fail(ctx, FG_ERR_DATA, "a bump needs a number, a radius above 0 and its u");
  die->bump[die->bump_count++] = (fg_lot_die_bump){(int)numbers[0], numbers[1], numbers[2]};
  return FG_OK;
}

/* A bump is kept as three numbers. */
static const double *list_kept_bump(const fg_subject *subject, double *values, size_t *count) {
  const fg_lot_die_bump *bump = subject->object;
  const double numbers[] = {bump->number, bump->radius_mm, bump->u_radius_mm};
  *count = 3;
  return memcpy(values, numbers, sizeof numbers);
}

static fg_status read_kept_bumps(const fg_reading *reading, const fg_member *member,
                                 const cJSON *value, void *object) {
  const cJSON *bump;
  (void)member;
  cJSON_ArrayForEach(bump, value) {
    double numbers[3] = {NAN, NAN, NAN};
    for (int i = 0; i < 3; i++) {
      const cJSON *item = cJSON_GetArrayItem(bump, i);
      if (cJSON_IsNumber(item)) numbers[i] = item->valuedouble;
    }
    FG_TRY(add_die_bump(reading->ctx, numbers, object));
  }
  return FG_OK;
}

/* Lengths of a die, mm. */
#define REQUIRED_LENGTH .options = FG_MEMBER_REQUIRED, .lowest = 0, .highest = 1e6
#define REQUIRED_RADIUS .options = FG_MEMBER_REQUIRED, .lowest = 1e-6, .highest = 1e6
#define DATUM                                                                                      \
  {                                                                                                \
    FG_WORD("datum", fg_lot_die, datum, NULL), .choice_at = datum_choice,                          \
                                               .options = FG_MEMBER_REQUIRED                       \
  }
#define THICKNESS                                                                                  \
  { FG_NUMBER("thickness_mm", fg_lot_die, thickness_mm), REQUIRED_LENGTH }
#define RADIUS                                                                                     \
  { FG_NUMBER("radius_mm", fg_lot_die, radius_mm), REQUIRED_RADIUS }
#define U_RADIUS                                                                                   \
  { FG_NUMBER("u_radius_mm", fg_lot_die, u_radius_mm), REQUIRED_LENGTH }

static const fg_member kept_bump_rows[] = {
    {FG_NUMBERS_BY(NULL, list_kept_bump), .lowest = 3, .highest = 3}};
static const fg_members kept_bump_members = FG_MEMBERS(kept_bump_rows);

static const fg_member kept_rows[] = {
    {FG_TEXT("sha256", fg_lot_die, sha256)},
    DATUM,
    THICKNESS,
    RADIUS,
    U_RADIUS,
    {FG_ARRAY("bumps", fg_lot_die, bump, bump_count, &kept_bump_members), .read = read_kept_bumps},
};
const fg_members fg_lot_die_members = FG_MEMBERS(kept_rows);

/* Members of a report of `foilgauge die`, "foilgauge/die/1"; a lot skips its others. */
static const fg_member report_design_rows[] = {DATUM, THICKNESS};
static const fg_members report_design_members = FG_MEMBERS(report_design_rows);

static const fg_member report_mean_rows[] = {RADIUS, U_RADIUS};
static const fg_members report_mean_members = FG_MEMBERS(report_mean_rows);

static const fg_member report_bump_rows[] = {
    {FG_INTEGER("number", fg_lot_die_bump, number), .options = FG_MEMBER_REQUIRED},
    {FG_NUMBER("radius_mm", fg_lot_die_bump, radius_mm), REQUIRED_RADIUS},
    {FG_NUMBER("u_radius_mm", fg_lot_die_bump, u_radius_mm), REQUIRED_LENGTH},
};
static const fg_members report_bump_members = FG_MEMBERS(report_bump_rows);

static const fg_member report_die_rows[] = {
    {FG_GROUP("mean", &report_mean_members), .options = FG_MEMBER_REQUIRED},
    {FG_ARRAY("bumps", fg_lot_die, bump, bump_count, &report_bump_members),
     .highest = FG_LOT_DIE_BUMPS_MAX},
};
static const fg_members report_die_members = FG_MEMBERS(report_die_rows);

static const fg_member report_rows[] = {
    {FG_GROUP("design", &report_design_members), .options = FG_MEMBER_REQUIRED},
    {FG_GROUP("die", &report_die_members), .options = FG_MEMBER_REQUIRED},
};
static const fg_members report_members = FG_MEMBERS(report_rows);

static fg_status read_die_report(fg_context *ctx, const cJSON *root, fg_lot_die *die) {
  const fg_reading reading = {.ctx = ctx, .between = ": ", .has_others = true};
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema");
  if (!cJSON_IsString(schema) || strcmp(schema->valuestring, "foilgauge/die/1") != 0)
    return fg_fail(ctx, FG_ERR_DATA, "not a report of `foilgauge die -o`");
  return fg_object_read(&reading, &report_members, root, die);
}

static fg_status load_die_report(fg_context *ctx, const char *file, fg_lot_die *die) {
  char *text;
  cJSON *root;
  FG_TRY(fg_file_read_text(ctx, file, DIE_BYTES_MAX, &text));
  fg_sha256_text(text, die->sha256);
  fg_status status = fg_json_read(ctx, file, text, &root);
  free(text);
  FG_TRY(status);
  fg_context inner = {.message = ""};
  status = read_die_report(&inner, root, die);
  cJSON_Delete(root);
  return status == FG_OK ? FG_OK
                         : fg_fail(ctx, status, "%.200s: %.*s", file, CONTEXT_WORDS, inner.message);
}

static fg_status append_die(fg_context *ctx, const char *name, fg_lot_settings *settings,
                            fg_lot_die **die) {
  if (!*name || strlen(name) >= sizeof(*die)->name)
    return fg_fail(ctx, FG_ERR_DATA, "dies: a name must have 1 to %zu bytes",
                   sizeof(*die)->name - 1);
  if (fg_lot_dies_find(settings, name))
    return fg_fail(ctx, FG_ERR_DATA, "dies: '%s' is there twice", name);
  if (settings->die_count == FG_LOT_DIES_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "dies: at most %d", FG_LOT_DIES_MAX);
  *die = &settings->dies[settings->die_count++];
  **die = (fg_lot_die){.name = ""};
  strcpy((*die)->name, name);
  return FG_OK;
}

fg_status fg_lot_settings_add_die(fg_context *ctx, const char *name, const char *path,
                                  fg_lot_settings *settings) {
  fg_lot_die *die = NULL;
  FG_TRY(append_die(ctx, name, settings, &die));
  return load_die_report(ctx, path, die);
}

fg_status fg_lot_dies_read(const fg_reading *reading, const fg_member *member, const cJSON *value,
                           void *object) {
  fg_lot_settings *settings = object;
  const fg_reading inside = fg_reading_inside(reading, member->name);
  const cJSON *item;
  if (!cJSON_IsObject(value))
    return fg_fail(reading->ctx, FG_ERR_DATA, "dies must be an object: {\"A\": \"die_a.json\"}");
  settings->die_count = 0;
  cJSON_ArrayForEach(item, value) {
    fg_lot_die *die = NULL;
    if (cJSON_IsString(item)) {
      char file[4096];
      fg_file_find_beside(reading->user, item->valuestring, file, sizeof file);
      FG_TRY(fg_lot_settings_add_die(reading->ctx, item->string, file, settings));
      continue;
    }
    const fg_reading part = fg_reading_inside(&inside, item->string);
    FG_TRY(append_die(reading->ctx, item->string, settings, &die));
    FG_TRY(fg_object_read(&part, &fg_lot_die_members, item, die));
  }
  return FG_OK;
}

fg_status fg_lot_dies_check(fg_context *ctx, const fg_lot_settings *settings) {
  for (size_t i = 0; i < settings->die_count; i++) {
    const fg_lot_die *die = &settings->dies[i];
    if (die->datum != settings->design.datum)
      return fg_fail(ctx, FG_ERR_DATA,
                     "dies: '%s' was measured for datum %s, the lot's design has %s: measure it "
                     "with the lot's design",
                     die->name, fg_datum_word(die->datum), fg_datum_word(settings->design.datum));
    if (die->datum == FG_DATUM_MID &&
        fabs(die->thickness_mm - settings->design.thickness_mm) > 1e-9)
      return fg_fail(ctx, FG_ERR_DATA,
                     "dies: '%s' was measured for a strip of %g mm, the lot's design has %g: "
                     "measure it with the lot's design",
                     die->name, die->thickness_mm, settings->design.thickness_mm);
  }
  return FG_OK;
}

const fg_lot_die *fg_lot_dies_find(const fg_lot_settings *settings, const char *name) {
  for (size_t i = 0; i < settings->die_count; i++)
    if (!strcmp(settings->dies[i].name, name)) return &settings->dies[i];
  return NULL;
}
