/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A die that was measured, from the report of `foilgauge die`. */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/sha256.h"
#include "core/text.h"
#include "forming/strip.h"

enum { BYTES_MAX = 64 << 20 };

static fg_status read_die_number(fg_context *ctx, const cJSON *object, const char *name, double low,
                                 double high, double *value) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
  if (!cJSON_IsNumber(item) || !(item->valuedouble > low && item->valuedouble < high))
    return fg_fail(ctx, FG_ERR_DATA, "%s must be a number between %g and %g", name, low, high);
  *value = item->valuedouble;
  return FG_OK;
}

static fg_status read_bump(fg_context *ctx, const cJSON *item, fg_forming_die *die) {
  double number = 0;
  if (die->count == FG_FORMING_BUMPS_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "the die has more than %d bumps, the most that can be formed",
                   FG_FORMING_BUMPS_MAX);
  FG_TRY(read_die_number(ctx, item, "number", 0, 1e6, &number));
  FG_TRY(read_die_number(ctx, item, "radius_mm", 0, 1e4, &die->bump[die->count].radius_mm));
  FG_TRY(
      read_die_number(ctx, item, "bump_angle_deg", 0, 180, &die->bump[die->count].bump_angle_deg));
  die->bump[die->count++].number = (int)number;
  return FG_OK;
}

/* Lengths are of the datum line; the strip is bent about its midline. */
static fg_status check_design(fg_context *ctx, const cJSON *of, const fg_design *design) {
  const cJSON *datum = cJSON_GetObjectItemCaseSensitive(of, "datum");
  double thickness = 0;
  FG_TRY(read_die_number(ctx, of, "thickness_mm", 0, 1e4, &thickness));
  if (fabs(thickness - design->thickness_mm) > 1e-9)
    return fg_fail(ctx, FG_ERR_DATA,
                   "the die was measured for a strip of %g mm, not %g: measure it with this design",
                   thickness, design->thickness_mm);
  static const char *const words[] = {"mid", "inner", "outer"};
  if (!cJSON_IsString(datum) || strcmp(datum->valuestring, words[design->datum]) != 0)
    return fg_fail(ctx, FG_ERR_DATA,
                   "the die's datum is not the design's, %s: measure it with this design",
                   words[design->datum]);
  return FG_OK;
}

static fg_status read_die_root(fg_context *ctx, const cJSON *root, const fg_design *design,
                               fg_forming_die *die) {
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema"), *bump;
  const cJSON *whole = cJSON_GetObjectItemCaseSensitive(root, "die");
  const cJSON *mean = cJSON_GetObjectItemCaseSensitive(whole, "mean");
  const cJSON *overall = cJSON_GetObjectItemCaseSensitive(whole, "overall");
  if (!cJSON_IsString(schema) || strcmp(schema->valuestring, "foilgauge/die/1") != 0)
    return fg_fail(ctx, FG_ERR_DATA, "not a report of `foilgauge die -o`");
  FG_TRY(check_design(ctx, cJSON_GetObjectItemCaseSensitive(root, "design"), design));
  FG_TRY(read_die_number(ctx, overall, "radius_mm", 0, 1e4, &die->overall_radius_mm));
  FG_TRY(read_die_number(ctx, mean, "radius_mm", 0, 1e4, &die->mean_radius_mm));
  FG_TRY(read_die_number(ctx, mean, "bump_angle_deg", 0, 180, &die->mean_angle_deg));
  cJSON_ArrayForEach(bump, cJSON_GetObjectItemCaseSensitive(whole, "bumps"))
      FG_TRY(read_bump(ctx, bump, die));
  return FG_OK;
}

fg_status fg_forming_die_load(fg_context *ctx, const char *path, const fg_design *design,
                              fg_forming_die *die) {
  char *text = NULL;
  fg_context words = {0};
  *die = (fg_forming_die){0};
  FG_TRY(fg_file_read_text(ctx, path, BYTES_MAX, &text));
  cJSON *root;
  fg_text_clip(die->file.path, sizeof die->file.path, "%s", path);
  fg_sha256_text(text, die->file.sha256);
  fg_status status = fg_json_read(ctx, path, text, &root);
  free(text);
  FG_TRY(status);
  status = read_die_root(&words, root, design, die);
  cJSON_Delete(root);
  return status == FG_OK ? FG_OK : fg_fail(ctx, status, "%s: %.*s", path, 700, words.message);
}
