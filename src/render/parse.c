/* From JSON to requests. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/memory.h"
#include "render/spec.h"

#define NUMBER(type, member, low, high)                                                            \
  { #member, FG_MEMBER_NUMBER, offsetof(type, member), low, high }
#define INTEGER(type, member, low, high)                                                           \
  { #member, FG_MEMBER_INTEGER, offsetof(type, member), low, high }
#define OTHER(name)                                                                                \
  { name, FG_MEMBER_OTHER, 0, 0, 0 }
#define END                                                                                        \
  { NULL, FG_MEMBER_END, 0, 0, 0 }

static const cJSON *get(const cJSON *object, const char *name) {
  return cJSON_GetObjectItemCaseSensitive(object, name);
}

static fg_status read_design(const fg_place *place, const cJSON *object, fg_render_design *design) {
  static const fg_member table[] = {
      INTEGER(fg_render_design, bump_count, 1, FG_RENDER_BUMPS_MAX),
      NUMBER(fg_render_design, bump_radius_mm, 0.01, 1000),
      NUMBER(fg_render_design, bump_angle_deg, 0.1, 179),
      NUMBER(fg_render_design, overall_radius_mm, 0.1, 10000),
      NUMBER(fg_render_design, sleeve_radius_mm, 0.1, 10000),
      NUMBER(fg_render_design, pitch_deg, 0.1, 180),
      NUMBER(fg_render_design, fillet_radius_mm, 0.001, 100),
      NUMBER(fg_render_design, thickness_mm, 0.001, 10),
      NUMBER(fg_render_design, rotor_diameter_mm, 0.01, 10000),
      OTHER("schema"),
      OTHER("name"),
      OTHER("form"),
      OTHER("datum"),
      OTHER("tolerances"),
      END,
  };
  design->sleeve_radius_mm = NAN;
  FG_TRY(fg_members_read(place, object, table, design));
  if (isnan(design->sleeve_radius_mm)) design->sleeve_radius_mm = design->overall_radius_mm;
  return FG_OK;
}

static fg_status read_lip(const fg_place *place, const cJSON *lip, fg_foil_request *request) {
  static const fg_member table[] = {
      NUMBER(fg_render_lip, length_mm, 0.01, 100),
      NUMBER(fg_render_lip, bend_radius_mm, 0.01, 100),
      OTHER("side"),
      END,
  };
  if (!lip) return FG_OK;
  request->has_lip = !cJSON_IsNull(lip);
  if (!request->has_lip) return FG_OK;
  fg_place inner = fg_place_inside(place, "lip");
  FG_TRY(fg_members_read(&inner, lip, table, &request->lip));
  const cJSON *side = get(lip, "side");
  if (!side) return FG_OK;
  if (!cJSON_IsString(side) ||
      (strcmp(side->valuestring, "outwards") && strcmp(side->valuestring, "inwards")))
    return fg_member_fail(&inner, "side", side, "must be \"outwards\" or \"inwards\"");
  request->lip.outwards = !strcmp(side->valuestring, "outwards");
  return FG_OK;
}

static fg_status read_missing(const fg_place *place, const cJSON *array, fg_foil_request *request) {
  double numbers[FG_RENDER_BUMPS_MAX];
  int count = 0;
  if (!array) return FG_OK;
  FG_TRY(fg_member_numbers(place, "missing", array, 1, request->design.bump_count, 0,
                           FG_RENDER_BUMPS_MAX, numbers, &count));
  for (int i = 0; i < count; i++)
    request->missing[(int)numbers[i] - 1] = true;
  return FG_OK;
}

typedef struct crush {
  int bump;
  double height_factor;
} crush;

static fg_status read_crushed(const fg_place *place, const cJSON *array, fg_foil_request *request) {
  const fg_member table[] = {
      INTEGER(crush, bump, 1, request->design.bump_count),
      NUMBER(crush, height_factor, 0.05, 1.5),
      END,
  };
  if (!array) return FG_OK;
  if (!cJSON_IsArray(array))
    return fg_member_fail(place, "crushed", array, "must be an array of {bump, height_factor}");
  int index = 0;
  const cJSON *item;
  cJSON_ArrayForEach(item, array) {
    fg_place inner = fg_place_item(place, "crushed", index++);
    crush one = {0, 0.5};
    FG_TRY(fg_members_read(&inner, item, table, &one));
    if (one.bump == 0) return fg_member_fail(&inner, "bump", NULL, "say which bump, from 1");
    request->height_factor[one.bump - 1] = one.height_factor;
  }
  return FG_OK;
}

/* A list with one number per bump. */
static fg_status read_list(const fg_place *place, const cJSON *foil, const char *name, double low,
                           double high, int bumps, double *values) {
  int count;
  const cJSON *array = get(foil, name);
  return array ? fg_member_numbers(place, name, array, low, high, bumps, bumps, values, &count)
               : FG_OK;
}

static fg_status read_springback(const fg_place *place, const cJSON *object,
                                 fg_foil_request *request) {
  static const fg_member table[] = {
      {"mean", FG_MEMBER_NUMBER, offsetof(fg_foil_request, springback_mean), -0.5, 1},
      {"sd", FG_MEMBER_NUMBER, offsetof(fg_foil_request, springback_sd), 0, 0.1},
      END,
  };
  if (!object) return FG_OK;
  fg_place inner = fg_place_inside(place, "radius_springback");
  return fg_members_read(&inner, object, table, request);
}

/* The Gen II design of thesis table 5.6, with the lip and end lands of the fixture. */
static fg_foil_request foil_default(void) {
  fg_foil_request request = {
      .design = {9, 3.32, 63.15, 20.73, 20.73, 40.0 / 3, 0.35, 0.1, 40},
      .overall_radius_mm = NAN,
      .has_lip = true,
      .lip = {2.0, 0.4, true},
      .first_land_mm = 1.8,
      .last_land_mm = 1.3,
      .centre_mm = {NAN, NAN},
      .rotate_deg = -90,
      .repeat = 1,
  };
  for (int i = 0; i < FG_RENDER_BUMPS_MAX; i++) {
    request.radius_mm[i] = request.bump_angle_deg[i] = NAN;
    request.height_factor[i] = 1;
  }
  return request;
}

static fg_status read_foil(const fg_place *place, const cJSON *foil, fg_foil_request *request) {
  static const fg_member table[] = {
      NUMBER(fg_foil_request, overall_radius_mm, 0.1, 10000),
      NUMBER(fg_foil_request, first_land_mm, 0, 1000),
      NUMBER(fg_foil_request, last_land_mm, 0, 1000),
      NUMBER(fg_foil_request, rotate_deg, -3600, 3600),
      NUMBER(fg_foil_request, rotate_step_deg, -3600, 3600),
      {"mirror", FG_MEMBER_BOOL, offsetof(fg_foil_request, mirror), 0, 0},
      INTEGER(fg_foil_request, repeat, 1, FG_RENDER_FOILS_MAX),
      OTHER("design"),
      OTHER("lip"),
      OTHER("missing"),
      OTHER("crushed"),
      OTHER("radius_mm"),
      OTHER("bump_angle_deg"),
      OTHER("radius_springback"),
      OTHER("centre_mm"),
      END,
  };
  *request = foil_default();
  FG_TRY(fg_members_read(place, foil, table, request));
  const cJSON *design = get(foil, "design");
  fg_place inside = fg_place_inside(place, "design");
  if (design) FG_TRY(read_design(&inside, design, &request->design));
  const cJSON *form = get(design, "form");
  if (cJSON_IsString(form) && !strcmp(form->valuestring, "sinusoidal")) request->has_lip = false;
  FG_TRY(read_lip(place, get(foil, "lip"), request));
  FG_TRY(read_missing(place, get(foil, "missing"), request));
  FG_TRY(read_crushed(place, get(foil, "crushed"), request));
  FG_TRY(read_springback(place, get(foil, "radius_springback"), request));
  int bumps = request->design.bump_count;
  FG_TRY(read_list(place, foil, "radius_mm", 0.01, 1000, bumps, request->radius_mm));
  FG_TRY(read_list(place, foil, "bump_angle_deg", 0.1, 179, bumps, request->bump_angle_deg));
  int count;
  const cJSON *centre = get(foil, "centre_mm");
  if (centre)
    FG_TRY(
        fg_member_numbers(place, "centre_mm", centre, -1e4, 1e4, 2, 2, request->centre_mm, &count));
  if (isnan(request->overall_radius_mm))
    request->overall_radius_mm = request->design.overall_radius_mm;
  return FG_OK;
}

static fg_status read_foils(const fg_place *place, const cJSON *array, fg_render_spec *spec) {
  if (array && !cJSON_IsArray(array))
    return fg_member_fail(place, "foils", array, "must be an array of foils");
  size_t count = array ? (size_t)cJSON_GetArraySize(array) : 0;
  FG_TRY(fg_memory_allocate(place->ctx, count, sizeof *spec->requests, (void **)&spec->requests));
  const cJSON *item;
  cJSON_ArrayForEach(item, array) {
    fg_place inner = fg_place_item(place, "foils", (int)spec->request_count);
    FG_TRY(read_foil(&inner, item, &spec->requests[spec->request_count]));
    spec->request_count++;
  }
  return FG_OK;
}

static fg_status read_disc(const fg_place *place, const cJSON *disc, fg_disc_request *request) {
  static const fg_member table[] = {
      NUMBER(fg_disc_request, radius_mm, 0.001, 1000),
      {"hole", FG_MEMBER_BOOL, offsetof(fg_disc_request, hole), 0, 0},
      INTEGER(fg_disc_request, lobes, 0, 500),
      NUMBER(fg_disc_request, lobe_um, -1000, 1000),
      NUMBER(fg_disc_request, lobe_phase_deg, -360, 360),
      OTHER("centre_mm"),
      END,
  };
  *request = (fg_disc_request){.radius_mm = NAN};
  FG_TRY(fg_members_read(place, disc, table, request));
  int count;
  FG_TRY(fg_member_numbers(place, "centre_mm", get(disc, "centre_mm"), -1e4, 1e4, 2, 2,
                           request->centre_mm, &count));
  if (isnan(request->radius_mm)) return fg_member_fail(place, "radius_mm", NULL, "a disc needs it");
  return FG_OK;
}

static fg_status read_discs(const fg_place *place, const cJSON *array, fg_render_spec *spec) {
  if (!array) return FG_OK;
  if (!cJSON_IsArray(array)) return fg_member_fail(place, "discs", array, "must be an array");
  FG_TRY(fg_memory_allocate(place->ctx, (size_t)cJSON_GetArraySize(array),
                            sizeof *spec->disc_requests, (void **)&spec->disc_requests));
  const cJSON *item;
  cJSON_ArrayForEach(item, array) {
    fg_place inner = fg_place_item(place, "discs", (int)spec->disc_request_count);
    FG_TRY(read_disc(&inner, item, &spec->disc_requests[spec->disc_request_count]));
    spec->disc_request_count++;
  }
  return FG_OK;
}

static fg_status read_litter(const fg_place *place, const cJSON *parent, const char *name,
                             fg_litter *litter) {
  static const fg_member table[] = {
      INTEGER(fg_litter, count, 0, 1000000),
      NUMBER(fg_litter, radius_px, 0.1, 1000),
      NUMBER(fg_litter, length_px, 0, 100000),
      NUMBER(fg_litter, contrast, -255, 255),
      END,
  };
  const cJSON *object = get(parent, name);
  if (!object) return FG_OK;
  fg_place inner = fg_place_inside(place, name);
  return fg_members_read(&inner, object, table, litter);
}

static fg_status read_part(const fg_place *place, const cJSON *parent, const char *name,
                           const fg_member *table, void *base) {
  const cJSON *object = get(parent, name);
  if (!object) return FG_OK;
  fg_place inner = fg_place_inside(place, name);
  return fg_members_read(&inner, object, table, base);
}

static fg_status read_rough(const fg_place *place, const cJSON *rough, fg_scanner *scanner) {
  static const fg_member table[] = {
      NUMBER(fg_scanner, one_sided_blur_px, 0, 10),
      NUMBER(fg_scanner, edge_roughness_um, 0, 20),
      NUMBER(fg_scanner, edge_common_um, 0, 20),
      {"correlation_um", FG_MEMBER_NUMBER, offsetof(fg_scanner, edge_correlation_um), 5, 5000},
      OTHER("halo"),
      OTHER("side_wall"),
      OTHER("jpeg"),
      END,
  };
  static const fg_member halo[] = {
      {"fraction", FG_MEMBER_NUMBER, offsetof(fg_scanner, halo_fraction), 0, 0.5},
      {"length_px", FG_MEMBER_NUMBER, offsetof(fg_scanner, halo_length_px), 4, 60},
      END,
  };
  static const fg_member wall[] = {
      {"amplitude", FG_MEMBER_NUMBER, offsetof(fg_scanner, wall_amplitude), -1, 1},
      {"direction_deg", FG_MEMBER_NUMBER, offsetof(fg_scanner, wall_direction_deg), -360, 360},
      {"length_px", FG_MEMBER_NUMBER, offsetof(fg_scanner, wall_length_px), 1, 30},
      {"gap_px", FG_MEMBER_NUMBER, offsetof(fg_scanner, wall_gap_px), 0, 30},
      END,
  };
  static const fg_member jpeg[] = {
      {"quality", FG_MEMBER_INTEGER, offsetof(fg_scanner, jpeg_quality), 1, 100},
      END,
  };
  if (!rough) return FG_OK;
  FG_TRY(fg_members_read(place, rough, table, scanner));
  FG_TRY(read_part(place, rough, "halo", halo, scanner));
  FG_TRY(read_part(place, rough, "side_wall", wall, scanner));
  return read_part(place, rough, "jpeg", jpeg, scanner);
}

/* One number for both axes, or [x, y]. */
static fg_status read_dpi(const fg_place *place, const cJSON *dpi, double *out) {
  if (!dpi) return FG_OK;
  if (cJSON_IsArray(dpi)) {
    int count;
    return fg_member_numbers(place, "dpi", dpi, 50, 20000, 2, 2, out, &count);
  }
  FG_TRY(fg_member_number(place, "dpi", dpi, 50, 20000, &out[0]));
  out[1] = out[0];
  return FG_OK;
}

static fg_status check_scanner(const fg_place *place, const cJSON *object,
                               const fg_scanner *scanner) {
  if (scanner->bits != 8 && scanner->bits != 16)
    return fg_member_fail(place, "bits", get(object, "bits"), "must be 8 or 16");
  double strip = scanner->background + scanner->contrast;
  if (!(strip >= 0 && strip <= 255) || scanner->contrast == 0)
    return fg_member_fail(place, "contrast", get(object, "contrast"),
                          "background + contrast must lie within 0 and 255, contrast not 0");
  if (scanner->jpeg_quality && scanner->bits != 8)
    return fg_member_fail(place, "bits", get(object, "bits"),
                          "must be 8 where there is rough.jpeg");
  return FG_OK;
}

static fg_status read_scanner(const fg_place *place, const cJSON *object, fg_scanner *scanner) {
  static const fg_member table[] = {
      INTEGER(fg_scanner, bits, 8, 16),
      NUMBER(fg_scanner, background, 0, 255),
      NUMBER(fg_scanner, contrast, -255, 255),
      NUMBER(fg_scanner, gamma, 0.2, 5),
      NUMBER(fg_scanner, blur_px, 0.4, 10),
      NUMBER(fg_scanner, noise, 0, 100),
      NUMBER(fg_scanner, noise_correlation, 0, 0.95),
      NUMBER(fg_scanner, clip_white, 1, 255),
      OTHER("dpi"),
      OTHER("shading"),
      OTHER("dust"),
      OTHER("specks"),
      OTHER("scratches"),
      OTHER("rough"),
      END,
  };
  static const fg_member shading[] = {
      {"x", FG_MEMBER_NUMBER, offsetof(fg_scanner, shading), -0.5, 0.5},
      {"y", FG_MEMBER_NUMBER, offsetof(fg_scanner, shading) + sizeof(double), -0.5, 0.5},
      {"quadratic", FG_MEMBER_NUMBER, offsetof(fg_scanner, shading) + 2 * sizeof(double), -0.5,
       0.5},
      END,
  };
  if (!object) return FG_OK;
  FG_TRY(fg_members_read(place, object, table, scanner));
  FG_TRY(read_dpi(place, get(object, "dpi"), scanner->dpi));
  FG_TRY(read_part(place, object, "shading", shading, scanner));
  FG_TRY(read_litter(place, object, "dust", &scanner->dust));
  FG_TRY(read_litter(place, object, "specks", &scanner->specks));
  FG_TRY(read_litter(place, object, "scratches", &scanner->scratches));
  fg_place rough = fg_place_inside(place, "rough");
  FG_TRY(read_rough(&rough, get(object, "rough"), scanner));
  return check_scanner(place, object, scanner);
}

static fg_scanner scanner_default(void) {
  return (fg_scanner){
      .dpi = {4800, 4800},
      .bits = 8,
      .background = 30,
      .contrast = 175,
      .gamma = 1,
      .blur_px = 1.2,
      .noise = 1,
      .clip_white = NAN,
      .dust = {.radius_px = 4, .contrast = 60},
      .specks = {.radius_px = 12, .contrast = 120},
      .scratches = {.radius_px = 0.8, .length_px = 300, .contrast = 25},
      .edge_correlation_um = 50,
      .halo_length_px = 15,
      .wall_length_px = 15,
  };
}

static fg_status read_spec(const fg_place *place, const cJSON *root, fg_render_spec *spec) {
  static const fg_member table[] = {
      NUMBER(fg_render_spec, width_px, 16, 200000),
      NUMBER(fg_render_spec, height_px, 16, 200000),
      NUMBER(fg_render_spec, margin_px, 0, 100000),
      OTHER("schema"),
      OTHER("seed"),
      OTHER("foils"),
      OTHER("discs"),
      OTHER("scanner"),
      OTHER("effects"),
      OTHER("comment"),
      END,
  };
  FG_TRY(fg_members_read(place, root, table, spec));
  const cJSON *schema = get(root, "schema");
  if (!cJSON_IsString(schema) || strcmp(schema->valuestring, "foilgauge/render/1") != 0)
    return fg_member_fail(place, "schema", schema, "must be \"foilgauge/render/1\"");
  double seed = 0;
  if (get(root, "seed"))
    FG_TRY(fg_member_number(place, "seed", get(root, "seed"), 0, 0x1p53, &seed));
  spec->seed = (uint64_t)seed;
  fg_place scanner = fg_place_inside(place, "scanner");
  FG_TRY(read_scanner(&scanner, get(root, "scanner"), &spec->scanner));
  FG_TRY(fg_render_effects_parse(place, get(root, "effects"), &spec->effects));
  FG_TRY(read_discs(place, get(root, "discs"), spec));
  return read_foils(place, get(root, "foils"), spec);
}

static fg_status default_foil(fg_context *ctx, fg_render_spec *spec) {
  if (spec->request_count || spec->disc_request_count) return FG_OK;
  free(spec->requests);
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *spec->requests, (void **)&spec->requests));
  spec->requests[0] = foil_default();
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
  spec->scanner = scanner_default();
  spec->width_px = spec->height_px = NAN;
  spec->margin_px = 80;
  const char *where = NULL;
  root = cJSON_ParseWithOpts(json, &where, true);
  if (!root) {
    status = fg_fail(ctx, FG_ERR_DATA, "%s: this is not JSON, from character %td: %.30s", path,
                     where ? where - json : 0, where ? where : "");
    goto exit;
  }
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
  fg_scene_free(&spec->scene);
  free(spec);
}

const fg_render_truth *fg_render_get_truth(const fg_render_spec *spec) {
  return &spec->truth;
}
