/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bearing as measured: a report of `foilgauge measure`, whose foils are the pads in their order,
 * or one of `foilgauge stiffness`. */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/sha256.h"
#include "core/text.h"
#include "film/bearing.h"

enum { FOILS_BYTES_MAX = 1 << 28 };

static double read_number(const cJSON *object, const char *name) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
  return cJSON_IsNumber(item) ? item->valuedouble : NAN;
}

static const cJSON *find_foil_bump(const cJSON *foil, size_t number) {
  const cJSON *bumps = cJSON_GetObjectItemCaseSensitive(foil, "bumps"), *bump;
  cJSON_ArrayForEach(bump, bumps) {
    if (read_number(bump, "number") == (double)number) return bump;
  }
  return NULL;
}

/* Splits the u of a clearance: the strip's thickness is that of all bumps, the rest a bump's own.
 */
static void take_u(fg_film_report *r, const cJSON *foil, const cJSON *bump, const char *name,
                   size_t at) {
  double u = read_number(bump, name), shared = read_number(foil, "u_thickness_mm");
  if (!(u > 0)) return;
  shared = shared > 0 ? fmin(u, shared) : 0;
  r->u_shared_mm[at] = shared;
  r->u_own_mm[at] = sqrt((u - shared) * (u + shared));
}

static fg_status read_pad(fg_context *ctx, fg_film_report *r, const cJSON *foil, size_t pad,
                          fg_film_bearing *bearing) {
  size_t per_pad = r->options.bumps_per_pad;
  for (size_t k = 0; k < per_pad; k++) {
    size_t number = r->options.first_bump + k, at = pad * per_pad + k;
    const cJSON *bump = find_foil_bump(foil, number);
    double clearance = bump ? read_number(bump, "clearance_fitted_mm") : NAN;
    bool fitted = isfinite(clearance);
    if (!fitted && bump) clearance = read_number(bump, "clearance_mm");
    if (!isfinite(clearance))
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s: bump %zu of foil %zu has no clearance_mm, and a film needs all: measure "
                     "the foil again",
                     r->options.foils, number, pad + 1);
    bearing->clearance_mm[at] = clearance;
    take_u(r, foil, bump, fitted ? "u_clearance_fitted_mm" : "u_clearance_mm", at);
  }
  return FG_OK;
}

static fg_status take_foils(fg_context *ctx, fg_film_report *r, const cJSON *root,
                            fg_film_bearing *bearing) {
  const cJSON *schema = cJSON_GetObjectItemCaseSensitive(root, "schema");
  const cJSON *foils = cJSON_GetObjectItemCaseSensitive(root, "foils");
  size_t pads = r->options.pads ? r->options.pads : 1;
  const char *name = cJSON_IsString(schema) ? schema->valuestring : "";
  if (!strcmp(name, "foilgauge/load_test/1")) return fg_film_read_tested(ctx, r, root, bearing);
  if (strcmp(name, "foilgauge/measure/1") != 0)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: not a report of `foilgauge measure` (foilgauge/measure/1), nor of "
                   "`foilgauge stiffness` (foilgauge/load_test/1)",
                   r->options.foils);
  size_t count = (size_t)cJSON_GetArraySize(foils);
  if (count != pads)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s: %zu foils for a bearing of %zu pads; measure the foils of one bearing "
                   "together, in the order of its pads",
                   r->options.foils, count, pads);
  for (size_t pad = 0; pad < pads; pad++)
    FG_TRY(read_pad(ctx, r, cJSON_GetArrayItem(foils, (int)pad), pad, bearing));
  return FG_OK;
}

fg_status fg_film_read_foils(fg_context *ctx, fg_film_report *r, fg_film_bearing *bearing) {
  char *text = NULL;
  cJSON *root = NULL;
  fg_status status;
  fg_text_clip(r->foils_path, sizeof r->foils_path, "%s", r->options.foils);
  FG_TRY(fg_file_read_text(ctx, r->options.foils, FOILS_BYTES_MAX, &text));
  fg_sha256_text(text, r->foils_sha256);
  status = fg_json_read(ctx, r->options.foils, text, &root);
  if (status == FG_OK) status = take_foils(ctx, r, root, bearing);
  cJSON_Delete(root);
  free(text);
  return status;
}
