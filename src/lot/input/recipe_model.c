/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scanner's model that a recipe names. */
#include <stdlib.h>
#include <string.h>

#include "foilgauge/lot.h"
#include "foilgauge/scan_loop.h"

fg_status fg_lot_settings_take_model(fg_context *ctx, const char *path, const char *scanner,
                                     fg_lot_settings *settings) {
  fg_scanner_model *model;
  char *whole = realpath(path, NULL); /* the settings may be printed, and read elsewhere */
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
