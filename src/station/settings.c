/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A recipe's member `station`. */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/text.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/station.h"
#include "station/naming.h"

enum { RECIPE_BYTES_MAX = 1 << 20 };

typedef enum member_kind { WORDS, NUMBER, YES } member_kind;

typedef struct member {
  const char *name;
  member_kind kind;
  size_t offset, size; /* in the settings; of a text */
  double highest;
  const char *meaning; /* foilgauge-recipe(5) */
} member;

#define AT(place) offsetof(fg_station_settings, place)
#define TEXT(name, place, meaning)                                                                 \
  { name, WORDS, AT(place), sizeof(((fg_station_settings *)0)->place), 0, meaning }

static const member members[] = {
    TEXT("file_name", file_name,
         "What a file's name says, without its ending: text, `*` for anything, `{serial}`, "
         "`{lot}`, `{die}`, `{operator}`; such as `{lot}_{die}_{serial}`. A name of another form "
         "is a serial number as a whole."),
    TEXT(
        "scan_command", scan_command,
        "Puts a Scan button on the page: a command of the shell that writes the scan `{file}`. It "
        "runs in the folder, as the user of the station. What a driver does to a picture unless it "
        "is told not to moves edges: foilgauge-scanning(7) says which options it needs, "
        "samples/station/scan.sh sets them on any scanner that SANE knows. The station names "
        "options that are known to spoil a scan, at its start and on the page."),
    {"receive_s", NUMBER, AT(receive_s), 0, 3600,
     "Seconds that a scan which is not whole may pause: the page says RECEIVING until nothing has "
     "come for so long, and then what is missing. Scanners wait for their carriage, networks for "
     "lost packets."},
};

static const member check_members[] = {
    TEXT("design", check.design,
         "The plate or ring: the path of a design of form \"discs\" with its calibrated "
         "`diameters_mm`. Discs of different sizes make a check sharper: they tell the scanner's "
         "scale from the level at which edges are taken, and so show a tone curve."),
    TEXT("file_name", check.file_name, "How scans of it are called, as above."),
    {"every_h", NUMBER, AT(check.every_h), 0, 1e5, "Hours from check to check; 0: at any time."},
    {"scale_max_ppm", NUMBER, AT(check.scale_max_ppm), 0, 1e6,
     "A scale (ppm) or shear (µrad) that is further off, its 2 u counted, fails."},
    {"withhold", YES, AT(check.withhold), 0, 0,
     "true: without a check that is in time and passed, foils are measured but get no verdict. Nor "
     "where the newest check shows another tone, sharpening or blur than its baseline. A clock "
     "that "
     "was set back makes a check due."},
};

enum { MEMBERS = sizeof members / sizeof *members };
enum { CHECK_MEMBERS = sizeof check_members / sizeof *check_members };

static const char check_name[] = "check";
static const char check_meaning[] =
    "An object with the members that follow: when the scanner has to prove itself by known "
    "diameters. With a `scan_command` the Scanner tab has a button for it.";

static fg_status read_setting_text(fg_context *ctx, const cJSON *value, char *text, size_t size) {
  if (!cJSON_IsString(value))
    return fg_fail(ctx, FG_ERR_DATA, "%.60s must be a text in quotes", value->string);
  if (strlen(value->valuestring) >= size)
    return fg_fail(ctx, FG_ERR_DATA, "%.60s is too long; at most %zu bytes", value->string,
                   size - 1);
  strcpy(text, value->valuestring);
  return FG_OK;
}

static fg_status read_setting_number(fg_context *ctx, const cJSON *value, double highest,
                                     double *number) {
  double given = cJSON_IsNumber(value) ? value->valuedouble : NAN;
  if (!(given >= 0 && given <= highest))
    return fg_fail(ctx, FG_ERR_DATA, "%.60s must be a number from 0 to %g", value->string, highest);
  *number = given;
  return FG_OK;
}

static fg_status read_setting_member(fg_context *ctx, const cJSON *value, const member *rows,
                                     size_t count, fg_station_settings *settings) {
  char known[300] = "";
  for (size_t i = 0; i < count; i++) {
    const member *row = &rows[i];
    void *place = (char *)settings + row->offset;
    fg_text_clip(known + strlen(known), sizeof known - strlen(known), "%s%s", i ? ", " : "",
                 row->name);
    if (strcmp(value->string, row->name) != 0) continue;
    if (row->kind == WORDS) return read_setting_text(ctx, value, place, row->size);
    if (row->kind == NUMBER) return read_setting_number(ctx, value, row->highest, place);
    if (!cJSON_IsBool(value))
      return fg_fail(ctx, FG_ERR_DATA, "%s must be true or false", row->name);
    *(bool *)place = cJSON_IsTrue(value);
    return FG_OK;
  }
  return fg_fail(ctx, FG_ERR_DATA, "unknown member '%.60s'; there are %s%s", value->string, known,
                 rows == members ? ", check" : "");
}

static fg_status read_check(fg_context *ctx, const cJSON *object, fg_station_settings *settings) {
  const cJSON *value;
  if (!cJSON_IsObject(object)) return fg_fail(ctx, FG_ERR_DATA, "check must be an object");
  cJSON_ArrayForEach(value, object)
      FG_TRY(read_setting_member(ctx, value, check_members, CHECK_MEMBERS, settings));
  if (!settings->check.design[0])
    return fg_fail(ctx, FG_ERR_DATA, "check needs the design of the plate or ring (form discs)");
  return fg_naming_check(ctx, settings->check.file_name);
}

static fg_status read_station(fg_context *ctx, const cJSON *object, fg_station_settings *settings) {
  const cJSON *value;
  if (!cJSON_IsObject(object)) return fg_fail(ctx, FG_ERR_DATA, "station must be an object");
  cJSON_ArrayForEach(value, object) {
    if (!strcmp(value->string, check_name))
      FG_TRY(read_check(ctx, value, settings));
    else
      FG_TRY(read_setting_member(ctx, value, members, MEMBERS, settings));
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
  cJSON *root;
  fg_status status = fg_json_read(ctx, recipe, text, &root);
  free(text);
  FG_TRY(status);
  const cJSON *station = cJSON_GetObjectItemCaseSensitive(root, "station");
  if (station) status = read_station(&inner, station, settings);
  cJSON_Delete(root);
  if (status != FG_OK)
    return fg_fail(ctx, status, "%.200s: station: %.700s", recipe, inner.message);
  return place_check(ctx, recipe, &settings->check);
}

static void set_usual(fg_station_settings *settings) {
  *settings = (fg_station_settings){.file_name = "{serial}",
                                    .receive_s = 20,
                                    .check = {.file_name = "check*", .scale_max_ppm = 500}};
  fg_lot_settings_default(&settings->lot);
}

fg_status fg_station_settings_load(fg_context *ctx, const char *recipe, const char *design,
                                   fg_station_settings *settings) {
  set_usual(settings);
  if (recipe) FG_TRY(fg_lot_settings_load(ctx, recipe, &settings->lot));
  if (recipe) FG_TRY(load_station(ctx, recipe, settings));
  if (design) FG_TRY(fg_lot_settings_load_design(ctx, design, &settings->lot));
  const fg_foil_traits *kind = fg_foil_traits_of(settings->lot.design.kind);
  if (kind->why_no_station)
    return fg_fail(ctx, FG_ERR_DATA, "design.form is %s: %s", kind->name, kind->why_no_station);
  return design ? fg_lot_settings_check(ctx, &settings->lot) : FG_OK;
}

static void describe_member(const char *object, const member *row, const fg_station_settings *usual,
                            fg_member_words *words) {
  const char *place = (const char *)usual + row->offset;
  *words = (fg_member_words){.meaning = row->meaning};
  fg_text_clip(words->name, sizeof words->name, "station.%s%s", object, row->name);
  if (row->kind == WORDS && *place)
    fg_text_clip(words->usual, sizeof words->usual, "\"%s\"", place);
  if (row->kind == NUMBER)
    fg_text_clip(words->usual, sizeof words->usual, "%g", *(const double *)place);
  if (row->kind == NUMBER)
    fg_text_clip(words->limits, sizeof words->limits, "0 to %g", row->highest);
  if (row->kind == YES)
    fg_text_clip(words->usual, sizeof words->usual, "%s", *(const bool *)place ? "true" : "false");
}

size_t fg_station_members(fg_member_words *list, size_t max) {
  static fg_station_settings usual;
  size_t count = 0;
  set_usual(&usual);
  for (size_t i = 0; i < MEMBERS; i++, count++)
    if (count < max) describe_member("", &members[i], &usual, &list[count]);
  if (count < max) {
    list[count] = (fg_member_words){.meaning = check_meaning};
    fg_text_clip(list[count].name, sizeof list[count].name, "station.%s", check_name);
  }
  count++;
  for (size_t i = 0; i < CHECK_MEMBERS; i++, count++)
    if (count < max) describe_member("check.", &check_members[i], &usual, &list[count]);
  return count;
}
