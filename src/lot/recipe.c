/* Recipe files: every setting of a lot is a row of one table. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "core/file.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/control.h"
#include "foilgauge/lot.h"
#include "foilgauge/stiffness.h"
#include "lot/dies.h"
#include "lot/recipe_parts.h"
#include "lot/reference_curve.h"
#include "report/measure/measure_json.h"

enum { RECIPE_BYTES_MAX = 1 << 20 };

typedef enum member_kind { REAL, COUNT, SEED, UNSIGNED, WORDS, RULE, RUN_RULES } member_kind;

typedef struct member {
  const char *name;
  member_kind kind;
  size_t offset, size; /* size: of a text */
  double lowest, highest;
  bool jobs; /* says how the work is done, not what comes out */
  bool open; /* null, kept as 0: what the design says */
} member;

#define AT(place) offsetof(fg_lot_settings, place)
#define TEXT(name, place)                                                                          \
  { name, WORDS, AT(place), sizeof(((fg_lot_settings *)0)->place), 0, 0, false, false }

static const member members[] = {
    TEXT("name", name),
    TEXT("model", model),
    TEXT("model_sha256", model_sha256),
    {"dpi", REAL, AT(dpi), 0, 0, 1e6, false, false},
    {"jobs", UNSIGNED, AT(jobs), 0, 0, 1024, true, false},
    {"trim_pct", REAL, AT(trim_pct), 0, 0, 49, false, false},
    {"confidence", REAL, AT(confidence), 0, 0.5, 0.9999, false, false},
    {"bandwidth", RULE, AT(bandwidth), 0, 0, 0, false, false},
    {"resamples", COUNT, AT(resamples), 0, 0, 1e7, false, false},
    {"seed", SEED, AT(seed), 0, 0, 9007199254740992.0, false, false},
    {"run_rules", RUN_RULES, AT(run_rules), 0, 1, FG_RUN_RULES, false, false},
    TEXT("group_column", group_column),
    TEXT("part_column", part_column),
    TEXT("operator_column", operator_column),
    TEXT("bearing_column", bearing_column),
    TEXT("pad_column", pad_column),
    TEXT("die_column", die_column),
    {"pads", COUNT, AT(layout.pads), 0, 1, FG_BEARING_BUMPS_MAX, false, true},
    {"bumps_per_pad", COUNT, AT(layout.bumps_per_pad), 0, 1, FG_BEARING_BUMPS_MAX, false, true},
    {"first_bump", COUNT, AT(layout.first_bump), 0, 1, 1000, false, false},
    {"bump_pitch_deg", REAL, AT(layout.pitch_deg), 0, 0.1, 360, false, true},
    {"youngs_modulus_gpa", REAL, AT(material.youngs_modulus_gpa), 0, 1e-3, 1e4, false, false},
    {"poisson_ratio", REAL, AT(material.poisson_ratio), 0, 0, 0.499, false, false},
    {"friction", REAL, AT(material.friction), 0, 0, 10, false, false},
};

enum { MEMBERS = sizeof members / sizeof members[0] };

/* Of the object "assembly". A hundred thousand draws take seconds, and tell shares to 0.3 %. */
static const member assembly_members[] = {
    {"bearings", COUNT, AT(assembly.bearings), 0, 0, 100000, false, false},
    {"seed", SEED, AT(assembly.seed), 0, 0, 9007199254740992.0, false, false},
    {"design_deviation_pct", REAL, AT(assembly.design_deviation_pct), 0, 0, 100, false, false},
};

enum { ASSEMBLY_MEMBERS = sizeof assembly_members / sizeof assembly_members[0] };

static const fg_bandwidth_rule bandwidths[] = {FG_BANDWIDTH_SILVERMAN, FG_BANDWIDTH_SCOTT,
                                               FG_BANDWIDTH_SHEATHER_JONES};

void fg_lot_settings_default(fg_lot_settings *settings) {
  *settings = (fg_lot_settings){
      .name = "lot",
      .trim_pct = 5,
      .confidence = 0.95,
      .bandwidth = FG_BANDWIDTH_SILVERMAN,
      .resamples = 100000,
      .seed = 1,
      .run_rules = 0xF,
      .part_column = "foil",
      .operator_column = "operator",
      .bearing_column = "bearing",
      .pad_column = "pad",
      .die_column = "die",
      .layout = {.first_bump = 1},
      .material = fg_arch_material_default(),
      /* Thesis chapter 5: ± 7 % of the clearance, 4.6 of 65.5 um. */
      .assembly = {.bearings = 1000, .seed = 1, .design_deviation_pct = 7},
  };
  fg_design_default(&settings->design);
}

static void *place_of(const member *row, const fg_lot_settings *settings) {
  return (char *)(uintptr_t)settings + row->offset;
}

static double number_of(const member *row, const fg_lot_settings *settings) {
  const void *place = place_of(row, settings);
  switch (row->kind) {
  case REAL:
    return *(const double *)place;
  case COUNT:
    return (double)*(const size_t *)place;
  case SEED:
    return (double)*(const uint64_t *)place;
  case UNSIGNED:
    return *(const unsigned *)place;
  default:
    return NAN;
  }
}

static bool is_open(const member *row, double value) {
  return row->open && value == 0;
}

static fg_status check_number(fg_context *ctx, const member *row, double value) {
  bool whole = row->kind == REAL || value == floor(value);
  if (value >= row->lowest && value <= row->highest && whole) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "%s is %g; it must be a %snumber from %g to %g", row->name,
                 value, row->kind == REAL ? "" : "whole ", row->lowest, row->highest);
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
  for (size_t i = 0; i < MEMBERS; i++)
    if (members[i].kind <= UNSIGNED && !is_open(&members[i], number_of(&members[i], settings)))
      FG_TRY(check_number(ctx, &members[i], number_of(&members[i], settings)));
  for (size_t i = 0; i < ASSEMBLY_MEMBERS; i++)
    FG_TRY(check_number(ctx, &assembly_members[i], number_of(&assembly_members[i], settings)));
  FG_TRY(check_layout(ctx, &settings->layout));
  if (settings->design.form == FG_FORM_DISCS)
    return fg_fail(ctx, FG_ERR_DATA, "design.form is discs; a lot is made of foils");
  FG_TRY(fg_design_check(ctx, &settings->design));
  FG_TRY(fg_lot_dies_check(ctx, settings));
  FG_TRY(fg_reference_curve_check(ctx, settings));
  return fg_report_check_tolerances(ctx, &settings->design);
}

static fg_status read_words(fg_context *ctx, const member *row, const cJSON *value, char *text) {
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

static fg_status read_run_rules(fg_context *ctx, const member *row, const cJSON *value,
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

static void store_number(const member *row, void *place, double value) {
  if (row->kind == REAL) *(double *)place = value;
  if (row->kind == COUNT) *(size_t *)place = (size_t)value;
  if (row->kind == SEED) *(uint64_t *)place = (uint64_t)value;
  if (row->kind == UNSIGNED) *(unsigned *)place = (unsigned)value;
}

static fg_status read_member(fg_context *ctx, const member *row, const cJSON *value,
                             fg_lot_settings *settings) {
  void *place = place_of(row, settings);
  if (row->kind == WORDS) return read_words(ctx, row, value, place);
  if (row->kind == RULE) return read_bandwidth(ctx, value, place);
  if (row->kind == RUN_RULES) return read_run_rules(ctx, row, value, place);
  if (row->open && cJSON_IsNull(value)) {
    store_number(row, place, 0);
    return FG_OK;
  }
  if (!cJSON_IsNumber(value)) return fg_fail(ctx, FG_ERR_DATA, "%s must be a number", row->name);
  FG_TRY(check_number(ctx, row, value->valuedouble));
  store_number(row, place, value->valuedouble);
  return FG_OK;
}

static void beside_recipe(const char *path, const char *name, char *file, size_t size) {
  const char *slash = strrchr(path, '/');
  bool beside = slash && name[0] != '/';
  fg_text_clip(file, size, "%.*s%s", beside ? (int)(slash - path) + 1 : 0, path, name);
}

/* "design": an object, or the path of a file beside the recipe. */
static fg_status read_design(fg_context *ctx, const char *path, const cJSON *value,
                             fg_design *design) {
  if (cJSON_IsString(value)) {
    char file[4096];
    beside_recipe(path, value->valuestring, file, sizeof file);
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

/* "assembly": { "bearings": 1000, ... }; members that are absent keep their value. */
static fg_status read_assembly(fg_context *ctx, const cJSON *object, fg_lot_settings *settings) {
  fg_context inner = {.message = ""};
  const cJSON *value;
  if (!cJSON_IsObject(object))
    return fg_fail(ctx, FG_ERR_DATA, "assembly must be an object, as in {\"bearings\": 1000}");
  cJSON_ArrayForEach(value, object) {
    size_t i = 0;
    while (i < ASSEMBLY_MEMBERS && strcmp(assembly_members[i].name, value->string) != 0)
      i++;
    if (i == ASSEMBLY_MEMBERS)
      return fg_fail(ctx, FG_ERR_DATA,
                     "unknown member 'assembly.%.60s'; there are bearings, seed and "
                     "design_deviation_pct",
                     value->string);
    if (cJSON_GetObjectItemCaseSensitive(object, value->string) != value)
      return fg_fail(ctx, FG_ERR_DATA, "assembly.%s is there twice", value->string);
    fg_status status = read_member(&inner, &assembly_members[i], value, settings);
    if (status != FG_OK) return fg_fail(ctx, status, "assembly.%.300s", inner.message);
  }
  return FG_OK;
}

static const member *find_member(const char *name) {
  for (size_t i = 0; i < MEMBERS; i++)
    if (!strcmp(members[i].name, name)) return &members[i];
  return NULL;
}

static fg_status read_object(fg_context *ctx, const char *path, const cJSON *root,
                             fg_lot_settings *settings) {
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema"), *value;
  if (!cJSON_IsObject(root) || !cJSON_IsString(schema) ||
      strcmp(schema->valuestring, "foilgauge/recipe/1") != 0)
    return fg_fail(ctx, FG_ERR_DATA,
                   "not a recipe: it must hold \"schema\": \"foilgauge/recipe/1\"");
  cJSON_ArrayForEach(value, root) {
    const member *row = find_member(value->string);
    if (cJSON_GetObjectItemCaseSensitive(root, value->string) != value)
      return fg_fail(ctx, FG_ERR_DATA, "%s is there twice", value->string);
    if (row)
      FG_TRY(read_member(ctx, row, value, settings));
    else if (!strcmp(value->string, "design"))
      FG_TRY(read_design(ctx, path, value, &settings->design));
    else if (!strcmp(value->string, "dies"))
      FG_TRY(fg_lot_dies_read(ctx, path, value, settings));
    else if (!strcmp(value->string, "reference_curve"))
      FG_TRY(fg_reference_curve_read(ctx, path, value, settings));
    else if (!strcmp(value->string, "assembly"))
      FG_TRY(read_assembly(ctx, value, settings));
    else if (!strcmp(value->string, "calibration"))
      continue; /* below */
    else if (value != schema && strcmp(value->string, "version") != 0 &&
             strcmp(value->string, "station") !=
                 0) /* the inspection station's: station/settings.c */
      return fg_fail(ctx, FG_ERR_DATA,
                     "unknown member '%.60s'; `foilgauge lot --print-recipe` shows them all",
                     value->string);
  }
  FG_TRY(fg_recipe_read_calibration(ctx, root, settings));
  return fg_lot_settings_check(ctx, settings);
}

fg_status fg_lot_settings_parse(fg_context *ctx, const char *path, const char *json,
                                fg_lot_settings *settings) {
  fg_context inner = {.message = ""};
  fg_lot_settings copy = *settings;
  const char *end = NULL;
  cJSON *root = cJSON_ParseWithOpts(json, &end, true);
  if (!root)
    return fg_fail(ctx, FG_ERR_DATA, "%.200s: not JSON at byte %td", path, end ? end - json : 0);
  fg_status status = read_object(&inner, path, root, &copy);
  cJSON_Delete(root);
  if (status != FG_OK) return fg_fail(ctx, status, "%.200s: %.800s", path, inner.message);
  *settings = copy;
  return FG_OK;
}

static fg_status find_model(fg_context *ctx, const char *path, fg_lot_settings *settings) {
  char file[4096], stated[65];
  strcpy(stated, settings->model_sha256);
  beside_recipe(path, settings->model, file, sizeof file);
  FG_TRY(fg_lot_settings_take_model(ctx, file, NULL, settings));
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

static void write_member(fg_json *json, const member *row, const fg_lot_settings *settings) {
  const void *place = place_of(row, settings);
  if (row->kind == WORDS) {
    fg_json_string(json, row->name, place);
  } else if (row->kind == RULE) {
    fg_json_string(json, row->name, fg_bandwidth_word(*(const fg_bandwidth_rule *)place));
  } else if (row->kind == RUN_RULES) {
    fg_json_array(json, row->name);
    fg_json_line(json);
    for (unsigned rule = 1; rule <= FG_RUN_RULES; rule++)
      if (*(const unsigned *)place & (1u << (rule - 1))) fg_json_integer(json, NULL, rule);
    fg_json_array_end(json);
    fg_json_line_end(json);
  } else if (row->kind == REAL || is_open(row, number_of(row, settings))) {
    double value = number_of(row, settings);
    fg_json_number(json, row->name, is_open(row, value) ? NAN : value);
  } else {
    fg_json_integer(json, row->name, (int64_t)number_of(row, settings));
  }
}

/* A lot that knows no model, no dies, has a recipe that does not speak of them. */
static bool is_silent(const member *row, const fg_lot_settings *settings) {
  bool model = row->offset == AT(model) || row->offset == AT(model_sha256);
  if (row->offset == AT(die_column)) return !settings->die_count;
  return model && !*(const char *)place_of(row, settings);
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
  for (size_t i = 0; i < MEMBERS; i++)
    if (with_jobs || !(members[i].jobs || is_silent(&members[i], settings)))
      write_member(&writer, &members[i], settings);
  fg_lot_dies_write(&writer, settings);
  writer.exact = true; /* what is read again gives the same report */
  fg_reference_curve_write(&writer, "reference_curve", settings);
  writer.exact = false;
  fg_json_object(&writer, "assembly");
  fg_json_line(&writer);
  for (size_t i = 0; i < ASSEMBLY_MEMBERS; i++)
    write_member(&writer, &assembly_members[i], settings);
  fg_json_object_end(&writer);
  fg_json_line_end(&writer);
  if (with_jobs) fg_recipe_write_calibration(&writer, settings); /* else as the design's */
  fg_json_design(&writer, "design", &settings->design);
  fg_json_object_end(&writer);
  fg_json_end(&writer);
  bool broken = ferror(out) != 0;
  if (fclose(out) == 0 && !broken) return FG_OK;
  free(*json);
  *json = NULL;
  return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a recipe");
}
