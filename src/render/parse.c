/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parsing of JSON to requests. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_read.h"
#include "core/memory.h"
#include "render/parse.h"

static fg_status read_spec(const fg_place *place, const cJSON *root, fg_render_spec *spec) {
  static const fg_spec_row table[] = {
      FG_SPEC_NUMBER(fg_render_spec, width_px, 16, 200000),
      FG_SPEC_NUMBER(fg_render_spec, height_px, 16, 200000),
      FG_SPEC_NUMBER(fg_render_spec, margin_px, 0, 100000),
      FG_SPEC_OTHER("schema"),
      FG_SPEC_OTHER("seed"),
      FG_SPEC_OTHER("foils"),
      FG_SPEC_OTHER("discs"),
      FG_SPEC_OTHER("grids"),
      FG_SPEC_OTHER("scanner"),
      FG_SPEC_OTHER("effects"),
      FG_SPEC_OTHER("comment"),
      FG_SPEC_END,
  };
  FG_TRY(fg_members_read(place, root, table, spec));
  const cJSON *schema = fg_spec_member(root, "schema");
  if (!cJSON_IsString(schema) || strcmp(schema->valuestring, "foilgauge/render/1") != 0)
    return fg_member_fail(place, "schema", schema, "must be \"foilgauge/render/1\"");
  double seed = 0;
  if (fg_spec_member(root, "seed"))
    FG_TRY(fg_member_number(place, "seed", fg_spec_member(root, "seed"), 0, 0x1p53, &seed));
  spec->seed = (uint64_t)seed;
  fg_place scanner = fg_place_inside(place, "scanner");
  FG_TRY(fg_spec_read_scanner(&scanner, fg_spec_member(root, "scanner"), &spec->scanner));
  FG_TRY(fg_render_effects_parse(place, fg_spec_member(root, "effects"), &spec->effects));
  FG_TRY(fg_spec_read_discs(place, fg_spec_member(root, "discs"), spec));
  FG_TRY(fg_spec_read_grids(place, fg_spec_member(root, "grids"), spec));
  return fg_spec_read_foils(place, fg_spec_member(root, "foils"), spec);
}

static fg_status default_foil(fg_context *ctx, fg_render_spec *spec) {
  if (spec->request_count || spec->disc_request_count || spec->grid_request_count) return FG_OK;
  free(spec->requests);
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *spec->requests, (void **)&spec->requests));
  spec->requests[0] = fg_spec_default_foil();
  spec->requests[0].overall_radius_mm = spec->requests[0].design.overall_radius_mm;
  spec->request_count = 1;
  return FG_OK;
}

fg_status fg_render_parse(fg_context *ctx, const char *path, const char *json,
                          fg_render_spec **out) {
  fg_status status = FG_OK;
  fg_render_spec *spec = NULL;
  cJSON *root = NULL;
  fg_place place = {.ctx = ctx, .path = path};
  *out = NULL;
  FG_TRY_EXIT(fg_memory_allocate(ctx, 1, sizeof *spec, (void **)&spec));
  spec->scanner = fg_spec_default_scanner();
  spec->width_px = spec->height_px = NAN;
  spec->margin_px = 80;
  FG_TRY_EXIT(fg_json_read(ctx, path, json, &root));
  FG_TRY_EXIT(read_spec(&place, root, spec));
  FG_TRY_EXIT(default_foil(ctx, spec));
  FG_TRY_EXIT(fg_scene_build(&place, spec));
  *out = spec;
  spec = NULL;
exit:
  cJSON_Delete(root);
  fg_render_free(spec);
  return status;
}

fg_status fg_render_load(fg_context *ctx, const char *path, fg_render_spec **spec) {
  char *text = NULL;
  *spec = NULL;
  FG_TRY(fg_file_read_text(ctx, path, (size_t)16 << 20, &text));
  fg_status status = fg_render_parse(ctx, path, text, spec);
  free(text);
  return status;
}

void fg_render_free(fg_render_spec *spec) {
  if (!spec) return;
  free(spec->requests);
  free(spec->disc_requests);
  free(spec->grid_requests);
  fg_scene_free(&spec->scene);
  free(spec);
}

const fg_render_truth *fg_render_get_truth(const fg_render_spec *spec) {
  return &spec->truth;
}
