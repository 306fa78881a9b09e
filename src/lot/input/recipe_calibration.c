/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A design of its own, and a recipe's calibration over it. */
#include "foilgauge/lot.h"
#include "lot/input/recipe_parts.h"
#include "report/design/calibration_json.h"

static void overrule(fg_lot_settings *settings) {
  if (settings->calibration.stated) settings->design.calibration = settings->calibration;
}

fg_status fg_lot_settings_take_design(fg_context *ctx, const char *path,
                                      fg_lot_settings *settings) {
  fg_design design;
  fg_design_default(&design);
  FG_TRY(fg_design_load(ctx, path, &design));
  settings->design = design;
  overrule(settings);
  return FG_OK;
}

fg_status fg_recipe_read_calibration(fg_context *ctx, const cJSON *root,
                                     fg_lot_settings *settings) {
  const cJSON *value = cJSON_GetObjectItemCaseSensitive(root, "calibration");
  if (value) FG_TRY(fg_calibration_read(ctx, value, &settings->calibration));
  overrule(settings);
  return FG_OK;
}

void fg_recipe_write_calibration(fg_json *json, const fg_lot_settings *settings) {
  fg_json_calibration(json, "calibration", &settings->calibration);
}
