/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Report of `forming` as a declared model: its prediction of each bump. */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/sha256.h"
#include "core/text.h"
#include "foilgauge/forming.h"
#include "quantity/quantity_rows.h"

enum { BYTES_MAX = 64 << 20 };

/* Quantities that the report lacks stay unknown. */
static fg_status read_bump(fg_context *ctx, const cJSON *item, fg_bump *bump) {
  size_t count;
  const fg_quantity *rows = fg_quantities(FG_QUANTITY_OF_BUMP, &count);
  const cJSON *number = cJSON_GetObjectItemCaseSensitive(item, "number");
  if (!cJSON_IsNumber(number) || number->valuedouble != floor(number->valuedouble) ||
      fabs(number->valuedouble) > 1e6)
    return fg_fail(ctx, FG_ERR_DATA, "a member of bumps has no whole number `number`");
  *bump = (fg_bump){.number = (int)number->valuedouble};
  for (size_t i = 0; i < count; i++) {
    const cJSON *value = cJSON_GetObjectItemCaseSensitive(item, rows[i].name);
    double numbers[FG_QUANTITY_NUMBERS_MAX] = {NAN, NAN, NAN, NAN};
    if (rows[i].kind == FG_QUANTITY_COUNT) continue;
    if (cJSON_IsNumber(value)) numbers[0] = value->valuedouble;
    fg_quantity_restore(&rows[i], bump, numbers);
  }
  if (bump->radius_mm > 0 && bump->bump_angle_deg > 0) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "bump %d has no fitted circle: this forming says nothing that a measured bump "
                 "could be held against",
                 bump->number);
}

static fg_status read_prediction_root(fg_context *ctx, const cJSON *root,
                                      fg_forming_prediction *prediction) {
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema"), *bump;
  if (!cJSON_IsString(schema) || strcmp(schema->valuestring, "foilgauge/form/1") != 0)
    return fg_fail(ctx, FG_ERR_DATA, "not a report of `foilgauge forming -o`");
  cJSON_ArrayForEach(bump, cJSON_GetObjectItemCaseSensitive(root, "bumps")) {
    if (prediction->count == FG_FORMING_BUMPS_MAX)
      return fg_fail(ctx, FG_ERR_DATA, "bumps has more than %d members", FG_FORMING_BUMPS_MAX);
    FG_TRY(read_bump(ctx, bump, &prediction->bump[prediction->count]));
    prediction->count++;
  }
  return prediction->count
             ? FG_OK
             : fg_fail(ctx, FG_ERR_DATA, "bumps is missing or empty: form a design with bumps");
}

fg_status fg_forming_prediction_load(fg_context *ctx, const char *path,
                                     fg_forming_prediction *prediction) {
  char *text = NULL;
  fg_context words = {0};
  *prediction = (fg_forming_prediction){0};
  FG_TRY(fg_file_read_text(ctx, path, BYTES_MAX, &text));
  fg_text_clip(prediction->path, sizeof prediction->path, "%s", path);
  fg_sha256_text(text, prediction->sha256);
  cJSON *root;
  fg_status status = fg_json_read(ctx, path, text, &root);
  free(text);
  FG_TRY(status);
  status = read_prediction_root(&words, root, prediction);
  cJSON_Delete(root);
  return status == FG_OK ? FG_OK : fg_fail(ctx, status, "%s: %.*s", path, 700, words.message);
}

fg_status fg_forming_predict(fg_context *ctx, const fg_forming_prediction *prediction, int number,
                             const char *quantity, double *value) {
  const fg_quantity *row = fg_quantity_find(FG_QUANTITY_OF_BUMP, quantity);
  if (!row && !strncmp(quantity, "bump_", 5))
    row = fg_quantity_find(FG_QUANTITY_OF_BUMP, quantity + 5); /* bump_radius_mm */
  if (!row || row->kind != FG_QUANTITY_NUMBER)
    return fg_fail(ctx, FG_ERR_DATA, "%s: it predicts quantities of a bump, and '%s' is none",
                   prediction->path, quantity);
  for (size_t i = 0; i < prediction->count; i++) {
    if (prediction->bump[i].number != number) continue;
    *value = fg_quantity_value(row, &prediction->bump[i]);
    if (isfinite(*value)) return FG_OK;
    return fg_fail(ctx, FG_ERR_DATA, "%s: it says nothing of %s of bump %d", prediction->path,
                   quantity, number);
  }
  return fg_fail(ctx, FG_ERR_DATA, "%s: it has no bump %d; form a strip of that many bumps",
                 prediction->path, number);
}
