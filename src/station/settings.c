/* A recipe's member `station`. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "core/file.h"
#include "foilgauge/station.h"
#include "station/naming.h"

enum { RECIPE_BYTES_MAX = 1 << 20 };

static fg_status read_text(fg_context *ctx, const cJSON *value, char *text, size_t size) {
  if (!cJSON_IsString(value))
    return fg_fail(ctx, FG_ERR_DATA, "%.60s must be a text in quotes", value->string);
  if (strlen(value->valuestring) >= size)
    return fg_fail(ctx, FG_ERR_DATA, "%.60s is too long; at most %zu bytes", value->string,
                   size - 1);
  strcpy(text, value->valuestring);
  return FG_OK;
}

static fg_status read_number(fg_context *ctx, const cJSON *value, double highest, double *number) {
  double given = cJSON_IsNumber(value) ? value->valuedouble : NAN;
  if (!(given >= 0 && given <= highest))
    return fg_fail(ctx, FG_ERR_DATA, "%.60s must be a number from 0 to %g", value->string, highest);
  *number = given;
  return FG_OK;
}

static fg_status read_check_member(fg_context *ctx, const cJSON *value, fg_station_check *check) {
  if (!strcmp(value->string, "design"))
    return read_text(ctx, value, check->design, sizeof check->design);
  if (!strcmp(value->string, "file_name"))
    return read_text(ctx, value, check->file_name, sizeof check->file_name);
  if (!strcmp(value->string, "every_h")) return read_number(ctx, value, 1e5, &check->every_h);
  if (!strcmp(value->string, "scale_max_ppm"))
    return read_number(ctx, value, 1e6, &check->scale_max_ppm);
  if (strcmp(value->string, "withhold") != 0)
    return fg_fail(
        ctx, FG_ERR_DATA,
        "unknown member '%.60s'; there are design, file_name, every_h, scale_max_ppm, withhold",
        value->string);
  if (!cJSON_IsBool(value)) return fg_fail(ctx, FG_ERR_DATA, "withhold must be true or false");
  check->withhold = cJSON_IsTrue(value);
  return FG_OK;
}

static fg_status read_check(fg_context *ctx, const cJSON *object, fg_station_check *check) {
  const cJSON *value;
  if (!cJSON_IsObject(object)) return fg_fail(ctx, FG_ERR_DATA, "check must be an object");
  cJSON_ArrayForEach(value, object) FG_TRY(read_check_member(ctx, value, check));
  if (!check->design[0])
    return fg_fail(ctx, FG_ERR_DATA, "check needs the design of the plate or ring (form discs)");
  return fg_naming_check(ctx, check->file_name);
}

static fg_status read_station(fg_context *ctx, const cJSON *object, fg_station_settings *settings) {
  const cJSON *value;
  if (!cJSON_IsObject(object)) return fg_fail(ctx, FG_ERR_DATA, "station must be an object");
  cJSON_ArrayForEach(value, object) {
    if (!strcmp(value->string, "file_name"))
      FG_TRY(read_text(ctx, value, settings->file_name, sizeof settings->file_name));
    else if (!strcmp(value->string, "scan_command"))
      FG_TRY(read_text(ctx, value, settings->scan_command, sizeof settings->scan_command));
    else if (!strcmp(value->string, "check"))
      FG_TRY(read_check(ctx, value, &settings->check));
    else
      return fg_fail(ctx, FG_ERR_DATA,
                     "unknown member '%.60s'; there are file_name, scan_command, check",
                     value->string);
  }
  if (settings->scan_command[0] && !strstr(settings->scan_command, "{file}"))
    return fg_fail(ctx, FG_ERR_DATA, "scan_command: {file}, the scan to write, is not in it");
  return fg_naming_check(ctx, settings->file_name);
}

/* Relative to the recipe, as all of its paths. */
static fg_status place_check(fg_context *ctx, const char *recipe, fg_station_check *check) {
  char whole[sizeof check->design];
  const char *slash = strrchr(recipe, '/');
  if (!check->design[0] || check->design[0] == '/' || !slash) return FG_OK;
  if (snprintf(whole, sizeof whole, "%.*s%s", (int)(slash - recipe + 1), recipe, check->design) >=
      (int)sizeof whole)
    return fg_fail(ctx, FG_ERR_DATA, "%.200s: check: the design's path is too long", recipe);
  strcpy(check->design, whole);
  return FG_OK;
}

static fg_status load_station(fg_context *ctx, const char *recipe, fg_station_settings *settings) {
  char *text;
  fg_context inner = {.message = ""};
  FG_TRY(fg_file_read_text(ctx, recipe, RECIPE_BYTES_MAX, &text));
  cJSON *root = cJSON_Parse(text); /* the lot's settings have been read of it: it is JSON */
  const cJSON *station = cJSON_GetObjectItemCaseSensitive(root, "station");
  fg_status status = station ? read_station(&inner, station, settings) : FG_OK;
  cJSON_Delete(root);
  free(text);
  if (status != FG_OK)
    return fg_fail(ctx, status, "%.200s: station: %.700s", recipe, inner.message);
  return place_check(ctx, recipe, &settings->check);
}

fg_status fg_station_settings_load(fg_context *ctx, const char *recipe, const char *design,
                                   fg_station_settings *settings) {
  *settings = (fg_station_settings){.file_name = "{serial}",
                                    .check = {.file_name = "check*", .scale_max_ppm = 500}};
  fg_lot_settings_default(&settings->lot);
  if (recipe) FG_TRY(fg_lot_settings_load(ctx, recipe, &settings->lot));
  if (recipe) FG_TRY(load_station(ctx, recipe, settings));
  if (!design) return FG_OK;
  FG_TRY(fg_lot_settings_take_design(ctx, design, &settings->lot));
  return fg_lot_settings_check(ctx, &settings->lot);
}
