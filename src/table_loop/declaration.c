/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reader of a declared model's file: response, model, group and order of a table, and the design's
 * values for constant arc length. */
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/memory.h"
#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"

enum { DECLARED_BYTES_MAX = 1 << 20 };

struct fg_loop_declaration {
  const char *path; /* not owned */
  cJSON *json;
};

static fg_status take_text(fg_context *ctx, const fg_loop_declaration *declared, const char *name,
                           const char **into) {
  const cJSON *item = cJSON_GetObjectItemCaseSensitive(declared->json, name);
  if (!item || cJSON_IsNull(item) || *into) return FG_OK;
  if (!cJSON_IsString(item))
    return fg_fail(ctx, FG_ERR_DATA, "%s: %s must be a text", declared->path, name);
  *into = item->valuestring;
  return FG_OK;
}

static fg_status take_design(fg_context *ctx, const fg_loop_declaration *declared,
                             fg_design *design) {
  const struct {
    const char *name;
    double *value;
  } members[] = {
      {"bump_radius_mm", &design->bumps.radius_mm},
      {"bump_angle_deg", &design->bumps.angle_deg},
      {"overall_radius_mm", &design->overall_radius_mm},
      {"thickness_mm", &design->thickness_mm},
      {"top_foil_thickness_mm", &design->bumps.top_foil_thickness_mm},
      {"rotor_diameter_mm", &design->bumps.rotor_diameter_mm},
  };
  const size_t count = sizeof members / sizeof *members;
  const cJSON *object = cJSON_GetObjectItemCaseSensitive(declared->json, "design"), *item;
  if (object && !cJSON_IsObject(object))
    return fg_fail(ctx, FG_ERR_DATA, "%s: design must be an object", declared->path);
  cJSON_ArrayForEach(item, object) {
    size_t i = 0;
    while (i < count && strcmp(members[i].name, item->string))
      i++;
    if (i == count)
      return fg_fail(ctx, FG_ERR_DATA,
                     "%s: design.%s is not known here; what is known are bump_radius_mm, "
                     "bump_angle_deg, overall_radius_mm, thickness_mm, top_foil_thickness_mm and "
                     "rotor_diameter_mm",
                     declared->path, item->string);
    if (!cJSON_IsNumber(item))
      return fg_fail(ctx, FG_ERR_DATA, "%s: design.%s must be a number", declared->path,
                     members[i].name);
    *members[i].value = item->valuedouble;
  }
  return FG_OK;
}

static fg_status read_members(fg_context *ctx, const fg_loop_declaration *declared,
                              fg_loop_table_spec *spec, fg_design *design) {
  if (!cJSON_IsObject(declared->json))
    return fg_fail(ctx, FG_ERR_DATA, "%s: not a JSON object", declared->path);
  FG_TRY(take_text(ctx, declared, "response", &spec->response));
  FG_TRY(take_text(ctx, declared, "model", &spec->model));
  FG_TRY(take_text(ctx, declared, "group", &spec->group));
  FG_TRY(take_text(ctx, declared, "order", &spec->order));
  return take_design(ctx, declared, design);
}

fg_status fg_loop_declaration_load(fg_context *ctx, const char *path, fg_loop_table_spec *spec,
                                   fg_design *design, fg_loop_declaration **out) {
  char *text = NULL;
  fg_loop_declaration *declared = NULL;
  *out = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_file_read_text(ctx, path, DECLARED_BYTES_MAX, &text));
  FG_TRY_EXIT(fg_memory_allocate(ctx, 1, sizeof *declared, (void **)&declared));
  declared->path = path;
  FG_TRY_EXIT(fg_json_read(ctx, path, text, &declared->json));
  FG_TRY_EXIT(read_members(ctx, declared, spec, design));
exit:
  free(text);
  if (status == FG_OK)
    *out = declared;
  else
    fg_loop_declaration_free(declared);
  return status;
}

bool fg_loop_declaration_has_design(const fg_loop_declaration *declared) {
  return declared && cJSON_HasObjectItem(declared->json, "design");
}

void fg_loop_declaration_free(fg_loop_declaration *declared) {
  if (!declared) return;
  cJSON_Delete(declared->json);
  free(declared);
}
