/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Recipe files: read and written by the rows of their members, then checked as a whole. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/text.h"
#include "foilgauge/foil_kind.h"
#include "foilgauge/lot.h"
#include "foilgauge/scan_loop.h"
#include "lot/input/recipe.h"
#include "lot/input/recipe_members.h"
#include "lot/input/reference_curve.h"

enum { RECIPE_BYTES_MAX = 1 << 20 };

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

static fg_status check_film(fg_context *ctx, const fg_lot_settings *settings) {
  if (!(settings->film.load_n > 0)) return FG_OK;
  if (!(settings->film.speed_rpm > 0))
    return fg_fail(ctx, FG_ERR_DATA,
                   "film.speed_rpm is missing: a film needs load_n and speed_rpm");
  if (settings->film.cells_per_bump % 2)
    return fg_fail(ctx, FG_ERR_DATA, "film.cells_per_bump is %zu; it must be even",
                   settings->film.cells_per_bump);
  const fg_foil_traits *kind = fg_foil_traits_of(settings->design.kind);
  if (kind->group != FG_DESIGN_BUMPS)
    return fg_fail(ctx, FG_ERR_DATA, "film: needs foils with bumps; design.form is %s", kind->name);
  return FG_OK;
}

fg_status fg_lot_settings_check(fg_context *ctx, const fg_lot_settings *settings) {
  const fg_reading reading = {.ctx = ctx, .between = " "};
  FG_TRY(fg_object_check(&reading, &fg_recipe_members, settings));
  FG_TRY(check_layout(ctx, &settings->layout));
  const fg_foil_traits *kind = fg_foil_traits_of(settings->design.kind);
  if (!kind->is_foil)
    return fg_fail(ctx, FG_ERR_DATA, "design.form is %s; a lot is made of foils", kind->name);
  FG_TRY(fg_design_check(ctx, &settings->design));
  FG_TRY(check_film(ctx, settings));
  FG_TRY(fg_lot_dies_check(ctx, settings));
  FG_TRY(fg_reference_curve_check(ctx, settings));
  return fg_report_check_tolerances(ctx, &settings->design);
}

static void overrule_calibration(fg_lot_settings *settings) {
  if (settings->calibration.stated || settings->calibration.not_needed[0])
    settings->design.calibration = settings->calibration;
}

static fg_status read_recipe(fg_context *ctx, const char *path, const cJSON *root,
                             fg_lot_settings *settings) {
  const fg_reading reading = {.ctx = ctx, .between = " ", .user = path};
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema");
  if (!cJSON_IsObject(root) || !cJSON_IsString(schema) ||
      strcmp(schema->valuestring, "foilgauge/recipe/1") != 0)
    return fg_fail(ctx, FG_ERR_DATA,
                   "not a recipe: it must hold \"schema\": \"foilgauge/recipe/1\"");
  FG_TRY(fg_object_read(&reading, &fg_recipe_members, root, settings));
  overrule_calibration(settings);
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
  design.model_scale = settings->design.model_scale;
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
    fg_scanner_model_trace(model, &settings->design);
  }
  if (model) fg_scanner_model_free(model);
  free(whole);
  return status;
}

static fg_status find_model(fg_context *ctx, const char *path, fg_lot_settings *settings) {
  char file[4096], stated[65];
  strcpy(stated, settings->model_sha256);
  fg_file_find_beside(path, settings->model, file, sizeof file);
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

fg_status fg_lot_settings_format(fg_context *ctx, const fg_lot_settings *settings, bool with_jobs,
                                 char **json) {
  size_t size;
  const fg_recipe_text text = {.settings = *settings, .with_jobs = with_jobs};
  *json = NULL;
  FILE *out = fg_stream_open(json, &size);
  if (!out) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a recipe");
  fg_document_json(out, &fg_recipe_members, &text);
  if (fg_stream_keep(out, json)) return FG_OK;
  return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: a recipe");
}
