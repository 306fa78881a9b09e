/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recipe files: every setting of a lot is a row of one table. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/control.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/lot.h"
#include "foilgauge/scan_loop.h"
#include "foilgauge/stiffness.h"
#include "lot/input/recipe.h"
#include "lot/input/recipe_members.h"
#include "lot/input/reference_curve.h"
#include "report/design/calibration_json.h"
#include "report/design/json.h"
#include "report/design/members.h"

enum { RECIPE_BYTES_MAX = 1 << 20 };

static const fg_bandwidth_rule bandwidths[] = {FG_BANDWIDTH_SILVERMAN, FG_BANDWIDTH_SCOTT,
                                               FG_BANDWIDTH_SHEATHER_JONES};

static fg_status check_number(fg_context *ctx, const fg_recipe_member *row, double value) {
  bool whole = row->kind == FG_RECIPE_REAL || value == floor(value);
  if (value >= row->lowest && value <= row->highest && whole) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "%s is %g; it must be a %snumber from %g to %g", row->name,
                 value, row->kind == FG_RECIPE_REAL ? "" : "whole ", row->lowest, row->highest);
}

static fg_status check_layout(fg_context *ctx, const fg_bearing_layout *layout) {
  size_t bumps = layout->pads * layout->bumps_per_pad;
  if (bumps > FG_BEARING_BUMPS_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "pads %zu × bumps_per_pad %zu: a bearing has at most %d bumps",
                   layout->pads, layout->bumps_per_pad, FG_BEARING_BUMPS_MAX);
  if ((double)bumps * layout->pitch_deg > 360 * (1 + 1e-6))
    return fg_fail(ctx, FG_ERR_DATA,
                   "bump_pitch_deg is %g: pads %zu × bumps_per_pad %zu at this pitch exceed 360 "
                   "degrees",
                   layout->pitch_deg, layout->pads, layout->bumps_per_pad);
  return FG_OK;
}

fg_status fg_lot_settings_check(fg_context *ctx, const fg_lot_settings *settings) {
  for (size_t i = 0; i < fg_recipe_values.count; i++)
    if (fg_recipe_values.rows[i].kind <= FG_RECIPE_UNSIGNED &&
        !fg_recipe_is_open(&fg_recipe_values.rows[i],
                           fg_recipe_number(&fg_recipe_values.rows[i], settings)))
      FG_TRY(check_number(ctx, &fg_recipe_values.rows[i],
                          fg_recipe_number(&fg_recipe_values.rows[i], settings)));
  for (size_t i = 0; i < fg_recipe_assembly.count; i++)
    FG_TRY(check_number(ctx, &fg_recipe_assembly.rows[i],
                        fg_recipe_number(&fg_recipe_assembly.rows[i], settings)));
  FG_TRY(check_layout(ctx, &settings->layout));
  const fg_foil_traits *kind = fg_foil_traits_of(settings->design.kind);
  if (!kind->is_foil)
    return fg_fail(ctx, FG_ERR_DATA, "design.form is %s; a lot is made of foils", kind->name);
  FG_TRY(fg_design_check(ctx, &settings->design));
  FG_TRY(fg_lot_dies_check(ctx, settings));
  FG_TRY(fg_reference_curve_check(ctx, settings));
  return fg_report_check_tolerances(ctx, &settings->design);
}

static fg_status read_setting_text(fg_context *ctx, const fg_recipe_member *row, const cJSON *value,
                                   char *text) {
  if (!cJSON_IsString(value))
    return fg_fail(ctx, FG_ERR_DATA, "%s must be a text in quotes", row->name);
  if (strlen(value->valuestring) >= row->size)
    return fg_fail(ctx, FG_ERR_DATA, "%s is too long; at most %zu bytes", row->name, row->size - 1);
  strcpy(text, value->valuestring);
  return FG_OK;
}

static fg_status read_bandwidth(fg_context *ctx, const cJSON *value, fg_bandwidth_rule *rule) {
  for (size_t i = 0; i < sizeof bandwidths / sizeof *bandwidths; i++) {
    if (!cJSON_IsString(value) || strcmp(value->valuestring, fg_bandwidth_word(bandwidths[i])) != 0)
      continue;
    *rule = bandwidths[i];
    return FG_OK;
  }
  return fg_fail(ctx, FG_ERR_DATA,
                 "bandwidth must be \"silverman\", \"scott\" or \"sheather_jones\"");
}

static fg_status read_run_rules(fg_context *ctx, const fg_recipe_member *row, const cJSON *value,
                                unsigned *rules) {
  const cJSON *number;
  *rules = 0;
  if (!cJSON_IsArray(value))
    return fg_fail(ctx, FG_ERR_DATA, "run_rules must be a list of numbers, as in [1, 2, 3, 4]");
  cJSON_ArrayForEach(number, value) {
    double rule = cJSON_IsNumber(number) ? number->valuedouble : NAN;
    FG_TRY(check_number(ctx, row, rule));
    *rules |= 1u << ((unsigned)rule - 1);
  }
  return FG_OK;
}

static fg_status read_switch(fg_context *ctx, const fg_recipe_member *row, const cJSON *value,
                             bool *on) {
  if (!cJSON_IsBool(value)) return fg_fail(ctx, FG_ERR_DATA, "%s must be true or false", row->name);
  *on = cJSON_IsTrue(value);
  return FG_OK;
}

static void store_number(const fg_recipe_member *row, void *place, double value) {
  if (row->kind == FG_RECIPE_REAL) *(double *)place = value;
  if (row->kind == FG_RECIPE_COUNT) *(size_t *)place = (size_t)value;
  if (row->kind == FG_RECIPE_SEED) *(uint64_t *)place = (uint64_t)value;
  if (row->kind == FG_RECIPE_UNSIGNED) *(unsigned *)place = (unsigned)value;
}

static fg_status read_setting(fg_context *ctx, const fg_recipe_member *row, const cJSON *value,
                              fg_lot_settings *settings) {
  void *place = fg_recipe_place(row, settings);
  if (row->kind == FG_RECIPE_WORDS) return read_setting_text(ctx, row, value, place);
  if (row->kind == FG_RECIPE_SWITCH) return read_switch(ctx, row, value, place);
  if (row->kind == FG_RECIPE_RULE) return read_bandwidth(ctx, value, place);
  if (row->kind == FG_RECIPE_RUN_RULES) return read_run_rules(ctx, row, value, place);
  if (row->open && cJSON_IsNull(value)) {
    store_number(row, place, 0);
    return FG_OK;
  }
  if (!cJSON_IsNumber(value)) return fg_fail(ctx, FG_ERR_DATA, "%s must be a number", row->name);
  FG_TRY(check_number(ctx, row, value->valuedouble));
  store_number(row, place, value->valuedouble);
  return FG_OK;
}

/* Reads "design": an object, or the path of a file beside the recipe. */
static fg_status read_recipe_design(fg_context *ctx, const char *path, const cJSON *value,
                                    fg_design *design) {
  if (cJSON_IsString(value)) {
    char file[4096];
    fg_recipe_find_file(path, value->valuestring, file, sizeof file);
    return fg_design_load(ctx, file, design);
  }
  if (!cJSON_IsObject(value))
    return fg_fail(ctx, FG_ERR_DATA, "design must be an object or the path of a design file");
  char *text = cJSON_Print(value);
  if (!text) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the design of a recipe");
  fg_status status = fg_design_parse(ctx, "design", text, design);
  free(text);
  return status;
}

/* Reads "assembly": {"bearings": 1000, ...}. Absent members keep their value. */
static fg_status read_assembly(fg_context *ctx, const cJSON *object, fg_lot_settings *settings) {
  fg_context inner = {.message = ""};
  const cJSON *value;
  if (!cJSON_IsObject(object))
    return fg_fail(ctx, FG_ERR_DATA, "assembly must be an object, as in {\"bearings\": 1000}");
  cJSON_ArrayForEach(value, object) {
    size_t i = 0;
    while (i < fg_recipe_assembly.count &&
           strcmp(fg_recipe_assembly.rows[i].name, value->string) != 0)
      i++;
    if (i == fg_recipe_assembly.count)
      return fg_fail(ctx, FG_ERR_DATA,
                     "unknown member 'assembly.%.60s'; there are bearings, seed and "
                     "design_deviation_pct",
                     value->string);
    if (cJSON_GetObjectItemCaseSensitive(object, value->string) != value)
      return fg_fail(ctx, FG_ERR_DATA, "assembly.%s is there twice", value->string);
    fg_status status = read_setting(&inner, &fg_recipe_assembly.rows[i], value, settings);
    if (status != FG_OK) return fg_fail(ctx, status, "assembly.%.300s", inner.message);
  }
  return FG_OK;
}

static fg_status read_design_part(fg_context *ctx, const char *path, const cJSON *value,
                                  fg_lot_settings *settings) {
  return read_recipe_design(ctx, path, value, &settings->design);
}

static fg_status read_assembly_part(fg_context *ctx, const char *path, const cJSON *value,
                                    fg_lot_settings *settings) {
  (void)path;
  return read_assembly(ctx, value, settings);
}

/* Members that are more than one value. */
static const struct {
  const char *name;
  fg_status (*read)(fg_context *ctx, const char *path, const cJSON *value,
                    fg_lot_settings *settings); /* NULL: read elsewhere, or meant for people only */
  const char *meaning;
} parts[] = {
    {"schema", NULL, "Must be \"foilgauge/recipe/1\"."},
    {"version", NULL, "Of the program that wrote it; not read."},
    {"design", read_design_part,
     "An object as in `foilgauge-design`(5), or the path of such a file beside the recipe."},
    {"dies", fg_lot_dies_read,
     "An object of names and paths of what `foilgauge die -o` wrote, as in {\"A\": "
     "\"die_a.json\"}: the reference of springback of foils whose `die_column` names the die."},
    {"reference_curve", fg_reference_curve_read,
     "The path of a CSV file beside the recipe, with the columns bump, radius_error_pct and "
     "intersection_angle_error_pct: drawn over the errors per bump."},
    {"assembly", read_assembly_part, "An object with the members that follow."},
    {"calibration", NULL,
     "As in `foilgauge-design`(5), over that of the recipe's design."}, /* read last */
    {"station", NULL,
     "An object with the settings of `foilgauge-station`(1), below; a lot does "
     "not read it."},
};

enum { PARTS = sizeof parts / sizeof *parts };

static const fg_recipe_member *find_member(const char *name) {
  for (size_t i = 0; i < fg_recipe_values.count; i++)
    if (!strcmp(fg_recipe_values.rows[i].name, name)) return &fg_recipe_values.rows[i];
  return NULL;
}

static fg_status read_recipe_part(fg_context *ctx, const char *path, const cJSON *value,
                                  fg_lot_settings *settings) {
  for (size_t i = 0; i < PARTS; i++)
    if (!strcmp(value->string, parts[i].name))
      return parts[i].read ? parts[i].read(ctx, path, value, settings) : FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "unknown member '%.60s'; `foilgauge lot --print-recipe` shows them all",
                 value->string);
}

static void overrule_calibration(fg_lot_settings *settings) {
  if (settings->calibration.stated) settings->design.calibration = settings->calibration;
}

static fg_status read_calibration(fg_context *ctx, const cJSON *root, fg_lot_settings *settings) {
  const cJSON *value = cJSON_GetObjectItemCaseSensitive(root, "calibration");
  const fg_reading reading = {.ctx = ctx, .between = ": "};
  const fg_member row = {.name = "calibration"};
  if (value) FG_TRY(fg_calibration_read(&reading, &row, value, &settings->calibration));
  overrule_calibration(settings);
  return FG_OK;
}

static fg_status read_recipe(fg_context *ctx, const char *path, const cJSON *root,
                             fg_lot_settings *settings) {
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema"), *value;
  if (!cJSON_IsObject(root) || !cJSON_IsString(schema) ||
      strcmp(schema->valuestring, "foilgauge/recipe/1") != 0)
    return fg_fail(ctx, FG_ERR_DATA,
                   "not a recipe: it must hold \"schema\": \"foilgauge/recipe/1\"");
  cJSON_ArrayForEach(value, root) {
    const fg_recipe_member *row = find_member(value->string);
    if (cJSON_GetObjectItemCaseSensitive(root, value->string) != value)
      return fg_fail(ctx, FG_ERR_DATA, "%s is there twice", value->string);
    if (row)
      FG_TRY(read_setting(ctx, row, value, settings));
    else
      FG_TRY(read_recipe_part(ctx, path, value, settings));
  }
  FG_TRY(read_calibration(ctx, root, settings));
  return fg_lot_settings_check(ctx, settings);
}

fg_status fg_lot_settings_parse(fg_context *ctx, const char *path, const char *json,
                                fg_lot_settings *settings) {
  fg_context inner = {.message = ""};
  fg_lot_settings copy = *settings;
  cJSON *root;
  FG_TRY(fg_json_read(ctx, path, json, &root));
  fg_status status = read_recipe(&inner, path, root, &copy);
  cJSON_Delete(root);
  if (status != FG_OK) return fg_fail(ctx, status, "%.200s: %.800s", path, inner.message);
  *settings = copy;
  return FG_OK;
}

fg_status fg_lot_settings_load_design(fg_context *ctx, const char *path,
                                      fg_lot_settings *settings) {
  fg_design design;
  fg_design_default(&design);
  FG_TRY(fg_design_load(ctx, path, &design));
  settings->design = design;
  overrule_calibration(settings);
  return FG_OK;
}

fg_status fg_lot_settings_load_model(fg_context *ctx, const char *path, const char *scanner,
                                     fg_lot_settings *settings) {
  fg_scanner_model *model;
  char *whole =
      realpath(path, NULL); /* absolute: the settings may be printed, and read elsewhere */
  const char *name = whole ? whole : path;
  fg_status status = fg_scanner_model_load(ctx, path, &model);
  if (status == FG_OK && strlen(name) >= sizeof settings->model)
    status = fg_fail(ctx, FG_ERR_USAGE, "%.200s ...: the path is too long; at most %zu bytes", name,
                     sizeof settings->model - 1);
  if (status == FG_OK) {
    status = fg_scanner_model_check_scanner(ctx, model, path, scanner);
    strcpy(settings->model, name);
    strcpy(settings->model_sha256, fg_scanner_model_sha256(model));
  }
  if (model) fg_scanner_model_free(model);
  free(whole);
  return status;
}

static fg_status find_model(fg_context *ctx, const char *path, fg_lot_settings *settings) {
  char file[4096], stated[65];
  strcpy(stated, settings->model_sha256);
  fg_recipe_find_file(path, settings->model, file, sizeof file);
  FG_TRY(fg_lot_settings_load_model(ctx, file, NULL, settings));
  if (!stated[0] || !strcmp(stated, settings->model_sha256)) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%.300s: not the model that %.300s was written with (model_sha256 differs)", file,
                 path);
}

fg_status fg_lot_settings_load(fg_context *ctx, const char *path, fg_lot_settings *settings) {
  char *text;
  FG_TRY(fg_file_read_text(ctx, path, RECIPE_BYTES_MAX, &text));
  fg_lot_settings copy = *settings;
  fg_status status = fg_lot_settings_parse(ctx, path, text, &copy);
  free(text);
  if (status == FG_OK && copy.model[0]) status = find_model(ctx, path, &copy);
  if (status == FG_OK) *settings = copy;
  return status;
}

/* A recipe is silent about a model, dies and loss that its lot does not have. */
static bool is_left_unsaid(const fg_recipe_member *row, const fg_lot_settings *settings) {
  bool model = row->offset == offsetof(fg_lot_settings, model) ||
               row->offset == offsetof(fg_lot_settings, model_sha256);
  if (row->offset == offsetof(fg_lot_settings, die_column)) return !settings->die_count;
  if (row->offset == offsetof(fg_lot_settings, allow_lossy)) return !settings->allow_lossy;
  return model && !*(const char *)fg_recipe_place(row, settings);
}

fg_status fg_lot_settings_format(fg_context *ctx, const fg_lot_settings *settings, bool with_jobs,
                                 char **json) {
  size_t size;
  fg_json writer;
  *json = NULL;
  FILE *out = open_memstream(json, &size);
  if (!out) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a recipe");
  fg_json_begin(&writer, out);
  fg_json_object(&writer, NULL);
  fg_json_head(&writer, "foilgauge/recipe/1");
  for (size_t i = 0; i < fg_recipe_values.count; i++)
    if (with_jobs ||
        !(fg_recipe_values.rows[i].jobs || is_left_unsaid(&fg_recipe_values.rows[i], settings)))
      fg_recipe_write(&writer, &fg_recipe_values.rows[i], settings);
  fg_lot_dies_write(&writer, settings);
  writer.exact = true; /* ten digits would change the report of a lot that is read again */
  fg_reference_curve_write(&writer, "reference_curve", settings);
  writer.exact = false;
  fg_json_object(&writer, "assembly");
  fg_json_line(&writer);
  for (size_t i = 0; i < fg_recipe_assembly.count; i++)
    fg_recipe_write(&writer, &fg_recipe_assembly.rows[i], settings);
  fg_json_object_end(&writer);
  fg_json_line_end(&writer);
  if (with_jobs)
    fg_json_calibration(&writer, "calibration",
                        &settings->calibration); /* else the design's calibration says the same */
  fg_json_design(&writer, "design", &settings->design);
  fg_json_object_end(&writer);
  fg_json_end(&writer);
  bool broken = ferror(out) != 0;
  if (fclose(out) == 0 && !broken) return FG_OK;
  free(*json);
  *json = NULL;
  return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a recipe");
}

size_t fg_recipe_members(fg_member_words *list, size_t max) {
  size_t count = 0;
  for (size_t i = 0; i < fg_recipe_values.count; i++, count++)
    if (count < max) fg_recipe_describe("", &fg_recipe_values.rows[i], &list[count]);
  for (size_t i = 0; i < PARTS; i++, count++) {
    if (count >= max) continue;
    list[count] = (fg_member_words){.meaning = parts[i].meaning};
    fg_text_clip(list[count].name, sizeof list[count].name, "%s", parts[i].name);
  }
  for (size_t i = 0; i < fg_recipe_assembly.count; i++, count++)
    if (count < max) fg_recipe_describe("assembly.", &fg_recipe_assembly.rows[i], &list[count]);
  return count;
}
