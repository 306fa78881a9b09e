/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A recipe's member `station`. */
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_read.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/station.h"
#include "language/language.h"
#include "station/naming.h"
#include "station/outbox/transport.h"
#include "station/settings.h"

enum { RECIPE_BYTES_MAX = 1 << 20 };

static fg_status read_check(const fg_reading *reading, const fg_member *member, const cJSON *value,
                            void *object);

static const fg_member check_rows[] = {
    {FG_TEXT("design", fg_station_settings, check.design), .options = FG_MEMBER_ANY_TEXT,
     .words = "The plate or ring: the path of a design of form \"discs\" with its calibrated "
              "`diameters_mm`, or of a grid with `pitch_mm` and `u_pitch_mm`. Discs of different "
              "sizes make a check sharper: they tell the "
              "scanner's scale from the level at which edges are taken, and so show a tone curve."},
    {FG_TEXT("file_name", fg_station_settings, check.file_name),
     .words = "How scans of it are called, as above."},
    {FG_NUMBER("every_h", fg_station_settings, check.every_h), .lowest = 0, .highest = 1e5,
     .words = "Hours from check to check; 0: at any time."},
    {FG_NUMBER("scale_max_ppm", fg_station_settings, check.scale_max_ppm), .lowest = 0,
     .highest = 1e6,
     .words = "A scale (ppm) or shear (µrad) that is further off, its 2 u counted, fails."},
    {FG_FLAG("withhold", fg_station_settings, check.withhold),
     .words = "true: without a check that is in time and passed, foils are measured but get no "
              "verdict. Nor where the newest check shows another tone, sharpening or blur than its "
              "baseline. A clock that was set back makes a check due."},
};
static const fg_members check_members = FG_MEMBERS(check_rows);

static const char *const format_words[] = {"json", "csv", "bumps_csv", "dfq", "qif", NULL};

static const fg_member destination_rows[] = {
    {FG_TEXT("to", fg_station_destination, to), .options = FG_MEMBER_REQUIRED | FG_MEMBER_ANY_TEXT,
     .words = "A folder, in which a file appears for each part; an address (`http://`, `https://`) "
              "that it is posted to; a topic (`mqtt://HOST:PORT/TOPIC`, `mqtt://USER@HOST/TOPIC`) "
              "of a broker."},
    {FG_WORD("format", fg_station_destination, format, format_words),
     .words = "json: all of the part; csv: a line of the foil; bumps_csv: a line per bump or beam; "
              "dfq (Q-DAS), qif (QIF 3.0)."},
    {FG_TEXT("token_file", fg_station_destination, token_file), .options = FG_MEMBER_ANY_TEXT,
     .words = "A file whose first line is sent as `Authorization: Bearer`, or as the broker's "
              "password."},
};
static const fg_members destination_members = FG_MEMBERS(destination_rows);

static const fg_member backup_rows[] = {
    {FG_TEXT("folder", fg_station_settings, backup.folder), .options = FG_MEMBER_ANY_TEXT,
     .words = "Where backups go, best on another disk: `foilgauge-DATE-TIME.sqlite`."},
    {FG_NUMBER("every_h", fg_station_settings, backup.every_h), .lowest = 0.01, .highest = 1e4,
     .words = "Hours from one to the next."},
    {FG_NUMBER("keep_days", fg_station_settings, backup.keep_days), .lowest = 0, .highest = 1e5,
     .words = "Older ones are removed, but never the newest; 0: none is."},
};
static const fg_members backup_members = FG_MEMBERS(backup_rows);

static const fg_member part_rows[] = {
    {FG_TEXT("part", fg_station_part, part), .options = FG_MEMBER_REQUIRED | FG_MEMBER_ANY_TEXT,
     .words = "As orders name it."},
    {FG_TEXT("recipe", fg_station_part, recipe), .options = FG_MEMBER_REQUIRED | FG_MEMBER_ANY_TEXT,
     .words = "Path of its recipe: design, tolerances, calibration and model are taken from it."},
};
static const fg_members part_members = FG_MEMBERS(part_rows);

static const fg_member settings_rows[] = {
    {FG_TEXT("file_name", fg_station_settings, file_name),
     .words = "What a file's name says, without its ending: text, `*` for anything, `{serial}`, "
              "`{lot}`, `{die}`, `{operator}`, `{coil}`, `{oven}`, `{scanner}`; such as "
              "`{lot}_{die}_{serial}`. A name of another form "
              "is a serial number as a whole."},
    {FG_TEXT("scan_command", fg_station_settings, scan_command), .options = FG_MEMBER_ANY_TEXT,
     .words =
         "Puts a Scan button on the page: a command of the shell that writes the scan `{file}`. It "
         "runs in the folder, as the user of the station. What a driver does to a picture unless "
         "it is told not to moves edges: foilgauge-scanning(7) says which options it needs, "
         "samples/station/scan.sh sets them on any scanner that SANE knows. The station names "
         "options that are known to spoil a scan, at its start and on the page."},
    {FG_NUMBER("receive_s", fg_station_settings, receive_s), .lowest = 0, .highest = 3600,
     .words =
         "Seconds that a scan which is not whole may pause: the page says RECEIVING until nothing "
         "has come for so long, and then what is missing. Scanners wait for their carriage, "
         "networks for lost packets."},
    {FG_TEXT("reasons", fg_station_settings, reasons), .options = FG_MEMBER_ANY_TEXT,
     .words = "Reason codes for the disposition of foils that did not pass, between commas: "
              "\"S1 scratch, B2 burr, C3 crushed\"."},
    {FG_ARRAY("pass_on", fg_station_settings, pass_on, pass_on_count, &destination_members),
     .highest = FG_STATION_DESTINATIONS,
     .words = "Receivers of every part as it is measured, corrected or disposed, up to 8: objects "
              "with the members that follow (PASSING ON in foilgauge-station(1))."},
    {FG_ARRAY("parts", fg_station_settings, parts, part_count, &part_members),
     .highest = FG_STATION_PARTS,
     .words =
         "Parts with a recipe of their own, up to 16: while an order of the part is open, scans "
         "are measured and judged by it; all others by this recipe."},
    {FG_TEXT("language", fg_station_settings, language),
     .words = "Language of the pages: `en` or `de`. Without it each browser gets the one that it "
              "prefers."},
    {FG_GROUP("backup", &backup_members),
     .words = "An object with the members that follow: copies of the database, made while the "
              "station runs."},
    {FG_GROUP("check", &check_members), .read = read_check,
     .words = "An object with the members that follow: when the scanner has to prove itself by "
              "known diameters. With a `scan_command` the Scanner tab has a button for it."},
};
static const fg_members settings_members = FG_MEMBERS(settings_rows);

static fg_status read_check(const fg_reading *reading, const fg_member *member, const cJSON *value,
                            void *object) {
  fg_station_settings *settings = object;
  const fg_reading inside = fg_reading_inside(reading, member->name);
  FG_TRY(fg_object_read(&inside, &check_members, value, settings));
  if (!settings->check.design[0])
    return fg_reading_fail(&inside, NULL, "needs the design of the plate or ring (form discs)");
  return fg_naming_check(reading->ctx, settings->check.file_name);
}

static fg_status read_station(fg_context *ctx, const cJSON *object, fg_station_settings *settings) {
  const fg_reading reading = {.ctx = ctx, .between = " "};
  FG_TRY(fg_object_read(&reading, &settings_members, object, settings));
  if (settings->scan_command[0] && !strstr(settings->scan_command, "{file}"))
    return fg_fail(ctx, FG_ERR_DATA, "scan_command: {file}, the scan to write, is not in it");
  for (size_t i = 0; i < settings->pass_on_count; i++)
    FG_TRY(fg_transport_check(ctx, settings->pass_on[i].to));
  if (settings->language[0] && !fg_language_is_known(settings->language))
    return fg_fail(ctx, FG_ERR_DATA, "language: there are no pages in \"%s\"", settings->language);
  return fg_naming_check(ctx, settings->file_name);
}

enum { PATH_BYTES = 1024 };

/* Makes a path relative to the recipe one of the working folder. */
static fg_status place_path(fg_context *ctx, const char *recipe, const char *member,
                            char path[PATH_BYTES]) {
  char whole[PATH_BYTES];
  const char *slash = strrchr(recipe, '/');
  if (!path[0] || path[0] == '/' || !slash) return FG_OK;
  if (snprintf(whole, sizeof whole, "%.*s%s", (int)(slash - recipe + 1), recipe, path) >=
      (int)sizeof whole)
    return fg_fail(ctx, FG_ERR_DATA, "%.200s: %s: the path is too long", recipe, member);
  strcpy(path, whole);
  return FG_OK;
}

static fg_status place_paths(fg_context *ctx, const char *recipe, fg_station_settings *settings) {
  FG_TRY(place_path(ctx, recipe, "check", settings->check.design));
  FG_TRY(place_path(ctx, recipe, "backup", settings->backup.folder));
  for (size_t i = 0; i < settings->part_count; i++)
    FG_TRY(place_path(ctx, recipe, "parts", settings->parts[i].recipe));
  for (size_t i = 0; i < settings->pass_on_count; i++) {
    fg_station_destination *destination = &settings->pass_on[i];
    if (!strstr(destination->to, "://"))
      FG_TRY(place_path(ctx, recipe, "pass_on", destination->to));
    FG_TRY(place_path(ctx, recipe, "pass_on", destination->token_file));
  }
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
  return place_paths(ctx, recipe, settings);
}

static void set_usual(fg_station_settings *settings) {
  *settings = (fg_station_settings){.file_name = "{serial}",
                                    .receive_s = 20,
                                    .backup = {.every_h = 24, .keep_days = 14},
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

static const void *find_usual_settings(void) {
  static fg_station_settings usual;
  set_usual(&usual);
  return &usual;
}

const fg_document fg_station_settings_document = {
    .file = "station_settings",
    .title = "foilgauge station settings",
    .description = "The member `station` of a recipe (foilgauge-station(1)).",
    .made_by = "a recipe",
    .members = &settings_members,
    .is_read = true,
    .find_usual = find_usual_settings,
    .inside = "station.",
};
