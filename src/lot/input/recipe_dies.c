/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dies of a recipe. Their numbers are kept in the recipe, so that a lot can be reported again
 * without the files of `foilgauge die`. */
#include "core/json_read.h"
#include "core/sha256.h"
#include "lot/input/recipe.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/text.h"
#include "foilgauge/words.h"
#include "lot/input/recipe_members.h"

enum { DIE_BYTES_MAX = 64 << 20, CONTEXT_WORDS = 800 };

static fg_status read_min_number(fg_context *ctx, const cJSON *object, const char *name, double min,
                                 double *value) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
  if (!cJSON_IsNumber(item) || !isfinite(item->valuedouble) || item->valuedouble < min)
    return fg_fail(ctx, FG_ERR_DATA, "%s must be a number from %g", name, min);
  *value = item->valuedouble;
  return FG_OK;
}

static fg_status read_die_datum(fg_context *ctx, const cJSON *object, fg_datum *datum) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, "datum");
  for (int d = FG_DATUM_MID; d <= FG_DATUM_OUTER; d++)
    if (cJSON_IsString(item) && !strcmp(item->valuestring, fg_datum_word((fg_datum)d))) {
      *datum = (fg_datum)d;
      return FG_OK;
    }
  return fg_fail(ctx, FG_ERR_DATA, "datum must be mid, inner or outer");
}

static fg_status add_die_bump(fg_context *ctx, double number, double radius_mm, double u_mm,
                              fg_lot_die *die) {
  if (die->bump_count == FG_LOT_DIE_BUMPS_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "more than %d bumps", FG_LOT_DIE_BUMPS_MAX);
  if (number != floor(number) || fabs(number) > 1e6 || !(radius_mm > 0) || !(u_mm >= 0))
    return fg_fail(ctx, FG_ERR_DATA, "a bump needs a number, a radius above 0 and its u");
  die->bump[die->bump_count++] = (fg_lot_die_bump){(int)number, radius_mm, u_mm};
  return FG_OK;
}

/* Reads a report of `foilgauge die`, "foilgauge/die/1". */
static fg_status read_die_report(fg_context *ctx, const cJSON *root, fg_lot_die *die) {
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema"), *bump;
  const cJSON *design = cJSON_GetObjectItemCaseSensitive(root, "design");
  const cJSON *whole = cJSON_GetObjectItemCaseSensitive(root, "die");
  const cJSON *mean = cJSON_GetObjectItemCaseSensitive(whole, "mean");
  if (!cJSON_IsString(schema) || strcmp(schema->valuestring, "foilgauge/die/1") != 0)
    return fg_fail(ctx, FG_ERR_DATA, "not a report of `foilgauge die -o`");
  FG_TRY(read_die_datum(ctx, design, &die->datum));
  FG_TRY(read_min_number(ctx, design, "thickness_mm", 0, &die->thickness_mm));
  FG_TRY(read_min_number(ctx, mean, "radius_mm", 1e-6, &die->radius_mm));
  FG_TRY(read_min_number(ctx, mean, "u_radius_mm", 0, &die->u_radius_mm));
  cJSON_ArrayForEach(bump, cJSON_GetObjectItemCaseSensitive(whole, "bumps")) {
    double number = 0, radius = 0, u = 0;
    FG_TRY(read_min_number(ctx, bump, "number", -1e6, &number));
    FG_TRY(read_min_number(ctx, bump, "radius_mm", 1e-6, &radius));
    FG_TRY(read_min_number(ctx, bump, "u_radius_mm", 0, &u));
    FG_TRY(add_die_bump(ctx, number, radius, u, die));
  }
  return FG_OK;
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

/* Reads the numbers that fg_lot_dies_write keeps in a recipe. */
static fg_status read_kept_die(fg_context *ctx, const cJSON *value, fg_lot_die *die) {
  const cJSON *sum = cJSON_GetObjectItemCaseSensitive(value, "sha256"), *bump;
  if (cJSON_IsString(sum)) fg_text_clip(die->sha256, sizeof die->sha256, "%s", sum->valuestring);
  FG_TRY(read_die_datum(ctx, value, &die->datum));
  FG_TRY(read_min_number(ctx, value, "thickness_mm", 0, &die->thickness_mm));
  FG_TRY(read_min_number(ctx, value, "radius_mm", 1e-6, &die->radius_mm));
  FG_TRY(read_min_number(ctx, value, "u_radius_mm", 0, &die->u_radius_mm));
  cJSON_ArrayForEach(bump, cJSON_GetObjectItemCaseSensitive(value, "bumps")) {
    double numbers[3] = {NAN, NAN, NAN};
    for (int i = 0; i < 3; i++) {
      const cJSON *item = cJSON_GetArrayItem(bump, i);
      if (cJSON_IsNumber(item)) numbers[i] = item->valuedouble;
    }
    FG_TRY(add_die_bump(ctx, numbers[0], numbers[1], numbers[2], die));
  }
  return FG_OK;
}

static fg_status append_die(fg_context *ctx, const char *name, fg_lot_settings *settings,
                            fg_lot_die **die) {
  if (!*name || strlen(name) >= sizeof(*die)->name)
    return fg_fail(ctx, FG_ERR_DATA, "dies: a name must have 1 to %zu bytes",
                   sizeof(*die)->name - 1);
  if (fg_lot_dies_find(settings, name))
    return fg_fail(ctx, FG_ERR_DATA, "dies: '%s' is there twice", name);
  if (settings->die_count == FG_LOT_DIES_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "dies: more than %d", FG_LOT_DIES_MAX);
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

fg_status fg_lot_dies_read(fg_context *ctx, const char *path, const cJSON *value,
                           fg_lot_settings *settings) {
  const cJSON *item;
  if (!cJSON_IsObject(value))
    return fg_fail(ctx, FG_ERR_DATA, "dies must be an object: {\"A\": \"die_a.json\"}");
  settings->die_count = 0;
  cJSON_ArrayForEach(item, value) {
    if (cJSON_IsString(item)) {
      char file[4096];
      fg_recipe_find_file(path, item->valuestring, file, sizeof file);
      FG_TRY(fg_lot_settings_add_die(ctx, item->string, file, settings));
      continue;
    }
    fg_lot_die *die = NULL;
    fg_context inner = {.message = ""};
    FG_TRY(append_die(ctx, item->string, settings, &die));
    if (read_kept_die(&inner, item, die) != FG_OK)
      return fg_fail(ctx, FG_ERR_DATA, "dies: '%.60s': %.*s", item->string, CONTEXT_WORDS,
                     inner.message);
  }
  return FG_OK;
}

static void write_die(fg_json *json, const fg_lot_die *die) {
  fg_json_object(json, die->name);
  fg_json_string(json, "sha256", die->sha256);
  fg_json_string(json, "datum", fg_datum_word(die->datum));
  fg_json_number(json, "thickness_mm", die->thickness_mm);
  fg_json_number(json, "radius_mm", die->radius_mm);
  fg_json_number(json, "u_radius_mm", die->u_radius_mm);
  fg_json_array(json, "bumps");
  for (size_t i = 0; i < die->bump_count; i++) {
    const fg_lot_die_bump *bump = &die->bump[i];
    const double numbers[] = {bump->number, bump->radius_mm, bump->u_radius_mm};
    fg_json_numbers(json, NULL, numbers, 3);
  }
  fg_json_array_end(json);
  fg_json_object_end(json);
}

void fg_lot_dies_write(fg_json *json, const fg_lot_settings *settings) {
  if (!settings->die_count) return;
  json->exact = true; /* ten digits would change the report of a lot that is read again */
  fg_json_object(json, "dies");
  for (size_t i = 0; i < settings->die_count; i++)
    write_die(json, &settings->dies[i]);
  fg_json_object_end(json);
  json->exact = false;
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
