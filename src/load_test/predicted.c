/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Predicted travel of a rotor in a bearing of a lot's measured foils, in the directions of the
 * tests. The rotor touches without pressing, so the travel compares with the gap, not with the
 * clearance at a threshold. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/sha256.h"
#include "core/text.h"
#include "foilgauge/bearing.h"
#include "load_test/analysis.h"

enum { LOT_BYTES_MAX = 1 << 30 };

/* Places further off the rotor's way than this are not met first by any rotor that has way. */
static const double cosine_min = 0.2;

/* A bearing of the lot. */
typedef struct places {
  size_t count, per_pad, unknown;
  double angle_deg[FG_BEARING_BUMPS_MAX], clearance_mm[FG_BEARING_BUMPS_MAX],
      u_mm[FG_BEARING_BUMPS_MAX];
} places;

static size_t read_place_numbers(const cJSON *object, const char *name, double *numbers) {
  const cJSON *array = cJSON_GetObjectItemCaseSensitive(object, name), *item;
  size_t count = 0;
  cJSON_ArrayForEach(item, array) {
    if (count == FG_BEARING_BUMPS_MAX) break;
    numbers[count++] = cJSON_IsNumber(item) ? item->valuedouble : NAN;
  }
  return count;
}

static void read_bearing_name(const cJSON *bearing, char *text, size_t size) {
  const cJSON *name = cJSON_GetObjectItemCaseSensitive(bearing, "name");
  const cJSON *number = cJSON_GetObjectItemCaseSensitive(bearing, "number");
  if (cJSON_IsString(name))
    fg_text_clip(text, size, "%s", name->valuestring);
  else
    fg_text_clip(text, size, "%.0f", cJSON_IsNumber(number) ? number->valuedouble : 0);
}

/* A clearance of null is a place that was not measured; another value that is no number is no lot's
 * report. */
static const char *check_place(const places *p, size_t i) {
  if (!isfinite(p->angle_deg[i])) return "has no angle_deg";
  if (!isfinite(p->clearance_mm[i])) return NULL;
  if (p->clearance_mm[i] < 0) return "has a negative clearance_mm";
  return p->u_mm[i] >= 0 && isfinite(p->u_mm[i]) ? NULL : "has no u_clearance_mm";
}

static fg_status read_places(fg_context *ctx, const cJSON *bearing, const char *path,
                             const char *name, places *p) {
  *p = (places){0};
  p->count = read_place_numbers(bearing, "angle_deg", p->angle_deg);
  if (!p->count || read_place_numbers(bearing, "clearance_mm", p->clearance_mm) != p->count ||
      read_place_numbers(bearing, "u_clearance_mm", p->u_mm) != p->count)
    return fg_fail(ctx, FG_ERR_DATA, "%s: the bearing '%s' has no clearances", path, name);
  for (size_t i = 0; i < p->count; i++) {
    const char *wrong = check_place(p, i);
    if (wrong)
      return fg_fail(ctx, FG_ERR_DATA, "%s: place %zu of the bearing '%s' %s", path, i + 1, name,
                     wrong);
    if (!isfinite(p->clearance_mm[i])) p->unknown++;
  }
  if (p->unknown == p->count)
    return fg_fail(ctx, FG_ERR_DATA, "%s: no place of the bearing '%s' has a clearance", path,
                   name);
  int pads = cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(bearing, "pads"));
  p->per_pad = pads > 0 ? p->count / (size_t)pads : p->count;
  if (pads > 0 && p->count % (size_t)pads)
    return fg_fail(ctx, FG_ERR_DATA, "%s: the bearing '%s' has %zu places on %d pads", path, name,
                   p->count, pads);
  return FG_OK;
}

/* Returns the place that a rotor moving from the middle towards `deg` touches first: place i allows
 * way = c_i / cos(angle_i - deg), to first order. */
static size_t first_met(const places *p, double deg, double *way, double *u) {
  size_t met = p->count;
  *way = INFINITY;
  for (size_t i = 0; i < p->count; i++) {
    double cosine = cos((p->angle_deg[i] - deg) * M_PI / 180);
    if (!isfinite(p->clearance_mm[i]) || cosine < cosine_min) continue;
    if (p->clearance_mm[i] / cosine >= *way) continue;
    *way = p->clearance_mm[i] / cosine;
    *u = p->u_mm[i] / cosine;
    met = i;
  }
  return met;
}

static void predict_direction(const fg_load_test *test, const places *p, fg_load_direction *d) {
  double way[2], u[2] = {NAN, NAN};
  double deg = d->azimuth_deg - test->options.azimuth_zero_deg;
  size_t push = first_met(p, deg, &way[0], &u[0]), pull = first_met(p, deg + 180, &way[1], &u[1]);
  if (push == p->count || pull == p->count) return;
  double u_both = hypot(u[0], u[1]);
  d->predicted = (fg_load_value){way[0] + way[1], u_both, u_both};
  d->predicted_pad = 1 + (int)((way[0] <= way[1] ? push : pull) / p->per_pad);
  d->difference = (fg_load_value){d->gap.value - d->predicted.value, hypot(d->gap.u, u_both),
                                  hypot(d->gap.u_repeat, u_both)};
}

static fg_status take_bearings(fg_context *ctx, fg_load_test *test, const cJSON *root,
                               const char *path) {
  const cJSON *bearings = cJSON_GetObjectItemCaseSensitive(root, "bearings"), *bearing;
  size_t met = 0;
  cJSON_ArrayForEach(bearing, bearings) {
    char name[128];
    places p;
    read_bearing_name(bearing, name, sizeof name);
    for (size_t i = 0; i < test->bearing_count; i++) {
      if (strcmp(test->bearings[i].name, name) != 0) continue;
      met++;
      FG_TRY(read_places(ctx, bearing, path, name, &p));
      test->bearings[i].in_lot = true;
      test->bearings[i].unknown_places = p.unknown;
      for (size_t k = 0; k < test->direction_count; k++)
        if (test->directions[k].bearing == i) predict_direction(test, &p, &test->directions[k]);
    }
  }
  if (met) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%s: none of its bearings is called as one of the tests (the first test's is "
                 "'%s'); name them alike in the manifest's column and in the column bearing, or by "
                 "--bearing",
                 path, test->bearings[0].name);
}

fg_status fg_load_predict(fg_context *ctx, fg_load_test *test) {
  char *path = NULL, *text = NULL;
  cJSON *root = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_text_print(ctx, &path, "%s/lot.json", test->options.lot));
  FG_TRY_EXIT(fg_file_read_text(ctx, path, LOT_BYTES_MAX, &text));
  fg_sha256_text(text, test->lot_sha256);
  FG_TRY_EXIT(fg_json_read(ctx, path, text, &root));
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema");
  if (!cJSON_IsString(schema) || strcmp(schema->valuestring, "foilgauge/lot/1") != 0)
    FG_TRY_EXIT(fg_fail(ctx, FG_ERR_DATA, "%s: not the report of a lot (foilgauge/lot/1)", path));
  status = take_bearings(ctx, test, root, path);
exit:
  cJSON_Delete(root);
  free(text);
  free(path);
  return status;
}
