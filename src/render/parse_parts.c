/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foils and discs of a spec. */
#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "render/parse.h"

static fg_status read_design(const fg_place *place, const cJSON *object, fg_render_design *design) {
  static const fg_spec_row table[] = {
      FG_SPEC_INTEGER(fg_render_design, bump_count, 1, FG_RENDER_BUMPS_MAX),
      FG_SPEC_NUMBER(fg_render_design, bump_radius_mm, 0.01, 1000),
      FG_SPEC_NUMBER(fg_render_design, bump_angle_deg, 0.1, 179),
      FG_SPEC_NUMBER(fg_render_design, overall_radius_mm, 0.1, 10000),
      FG_SPEC_NUMBER(fg_render_design, sleeve_radius_mm, 0.1, 10000),
      FG_SPEC_NUMBER(fg_render_design, pitch_deg, 0.1, 180),
      FG_SPEC_NUMBER(fg_render_design, fillet_radius_mm, 0.001, 100),
      FG_SPEC_NUMBER(fg_render_design, thickness_mm, 0.001, 10),
      FG_SPEC_NUMBER(fg_render_design, rotor_diameter_mm, 0.01, 10000),
      FG_SPEC_NUMBER(fg_render_design, subtended_angle_deg, 0.1, 350),
      FG_SPEC_INTEGER(fg_render_design, beam_count, 1, FG_RENDER_BUMPS_MAX),
      FG_SPEC_NUMBER(fg_render_design, beam_length_mm, 0.05, 1000),
      FG_SPEC_NUMBER(fg_render_design, beam_width_mm, 0.01, 1000),
      FG_SPEC_NUMBER(fg_render_design, sagitta_mm, 0.0001, 1000),
      FG_SPEC_NUMBER(fg_render_design, clearance_mm, 0.0001, 1000),
      FG_SPEC_OTHER("elastic_modulus_gpa"),
      FG_SPEC_OTHER("u_thickness_mm"),
      FG_SPEC_OTHER("thickness_measured"),
      FG_SPEC_OTHER("tone"),
      FG_SPEC_OTHER("schema"),
      FG_SPEC_OTHER("name"),
      FG_SPEC_OTHER("form"),
      FG_SPEC_OTHER("datum"),
      FG_SPEC_OTHER("tolerances"),
      FG_SPEC_END,
  };
  design->sleeve_radius_mm = NAN;
  FG_TRY(fg_members_read(place, object, table, design));
  if (isnan(design->sleeve_radius_mm)) design->sleeve_radius_mm = design->overall_radius_mm;
  const cJSON *kind = fg_spec_member(object, "form");
  design->arc = cJSON_IsString(kind) && !strcmp(kind->valuestring, "arc");
  design->cantilever = cJSON_IsString(kind) && !strcmp(kind->valuestring, "cantilever");
  if (design->arc || design->cantilever) design->bump_count = 0;
  return FG_OK;
}

static fg_status read_lip(const fg_place *place, const cJSON *lip, fg_foil_request *request) {
  static const fg_spec_row table[] = {
      FG_SPEC_NUMBER(fg_render_lip, length_mm, 0.01, 100),
      FG_SPEC_NUMBER(fg_render_lip, bend_radius_mm, 0.01, 100),
      FG_SPEC_OTHER("side"),
      FG_SPEC_END,
  };
  if (!lip) return FG_OK;
  request->has_lip = !cJSON_IsNull(lip);
  if (!request->has_lip) return FG_OK;
  fg_place inner = fg_place_inside(place, "lip");
  FG_TRY(fg_members_read(&inner, lip, table, &request->lip));
  const cJSON *side = fg_spec_member(lip, "side");
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
  FG_TRY(fg_member_numbers(place, "missing", array,
                           (fg_array_limits){1, request->design.bump_count, 0, FG_RENDER_BUMPS_MAX},
                           numbers, &count));
  for (int i = 0; i < count; i++)
    request->missing[(int)numbers[i] - 1] = true;
  return FG_OK;
}

typedef struct crush {
  int bump;
  double height_factor;
} crush;

static fg_status read_crushed(const fg_place *place, const cJSON *array, fg_foil_request *request) {
  const fg_spec_row table[] = {
      FG_SPEC_INTEGER(crush, bump, 1, request->design.bump_count),
      FG_SPEC_NUMBER(crush, height_factor, 0.05, 1.5),
      FG_SPEC_END,
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
  const cJSON *array = fg_spec_member(foil, name);
  return array ? fg_member_numbers(place, name, array, (fg_array_limits){low, high, bumps, bumps},
                                   values, &count)
               : FG_OK;
}

static fg_status read_springback(const fg_place *place, const cJSON *object,
                                 fg_foil_request *request) {
  static const fg_spec_row table[] = {
      {"mean", FG_SPEC_NUMBER, offsetof(fg_foil_request, springback_mean), -0.5, 1},
      {"sd", FG_SPEC_NUMBER, offsetof(fg_foil_request, springback_sd), 0, 0.1},
      FG_SPEC_END,
  };
  if (!object) return FG_OK;
  fg_place inner = fg_place_inside(place, "radius_springback");
  return fg_members_read(&inner, object, table, request);
}

fg_foil_request fg_spec_default_foil(void) {
  fg_foil_request request = {
      .design = {.bump_count = 9,
                 .bump_radius_mm = 3.32,
                 .bump_angle_deg = 63.15,
                 .overall_radius_mm = 20.73,
                 .sleeve_radius_mm = 20.73,
                 .pitch_deg = 40.0 / 3,
                 .fillet_radius_mm = 0.35,
                 .thickness_mm = 0.1,
                 .rotor_diameter_mm = 40,
                 .subtended_angle_deg = 110,
                 .beam_count = 8,
                 .beam_length_mm = 9,
                 .beam_width_mm = 3,
                 .sagitta_mm = NAN,
                 .clearance_mm = NAN},
      .overall_radius_mm = NAN,
      .subtended_angle_deg = NAN,
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
  static const fg_spec_row table[] = {
      FG_SPEC_NUMBER(fg_foil_request, overall_radius_mm, 0.1, 10000),
      FG_SPEC_NUMBER(fg_foil_request, subtended_angle_deg, 0.1, 350),
      FG_SPEC_NUMBER(fg_foil_request, first_land_mm, 0, 1000),
      FG_SPEC_NUMBER(fg_foil_request, last_land_mm, 0, 1000),
      FG_SPEC_NUMBER(fg_foil_request, rotate_deg, -3600, 3600),
      FG_SPEC_NUMBER(fg_foil_request, rotate_step_deg, -3600, 3600),
      {"mirror", FG_SPEC_BOOL, offsetof(fg_foil_request, mirror), 0, 0},
      FG_SPEC_INTEGER(fg_foil_request, repeat, 1, FG_RENDER_FOILS_MAX),
      FG_SPEC_OTHER("design"),
      FG_SPEC_OTHER("lip"),
      FG_SPEC_OTHER("missing"),
      FG_SPEC_OTHER("crushed"),
      FG_SPEC_OTHER("radius_mm"),
      FG_SPEC_OTHER("bump_angle_deg"),
      FG_SPEC_OTHER("radius_springback"),
      FG_SPEC_OTHER("centre_mm"),
      FG_SPEC_OTHER("beams"),
      FG_SPEC_END,
  };
  *request = fg_spec_default_foil();
  FG_TRY(fg_members_read(place, foil, table, request));
  const cJSON *design = fg_spec_member(foil, "design");
  fg_place inside = fg_place_inside(place, "design");
  if (design) FG_TRY(read_design(&inside, design, &request->design));
  const cJSON *kind = fg_spec_member(design, "form");
  if (cJSON_IsString(kind) && !strcmp(kind->valuestring, "sinusoidal")) request->has_lip = false;
  if (request->design.arc) request->has_lip = false;
  FG_TRY(fg_spec_read_beams(place, foil, request));
  FG_TRY(read_lip(place, fg_spec_member(foil, "lip"), request));
  FG_TRY(read_missing(place, fg_spec_member(foil, "missing"), request));
  FG_TRY(read_crushed(place, fg_spec_member(foil, "crushed"), request));
  FG_TRY(read_springback(place, fg_spec_member(foil, "radius_springback"), request));
  int bumps = request->design.bump_count;
  FG_TRY(read_list(place, foil, "radius_mm", 0.01, 1000, bumps, request->radius_mm));
  FG_TRY(read_list(place, foil, "bump_angle_deg", 0.1, 179, bumps, request->bump_angle_deg));
  int count;
  const cJSON *centre = fg_spec_member(foil, "centre_mm");
  if (centre)
    FG_TRY(fg_member_numbers(place, "centre_mm", centre, (fg_array_limits){-1e4, 1e4, 2, 2},
                             request->centre_mm, &count));
  if (isnan(request->overall_radius_mm))
    request->overall_radius_mm = request->design.overall_radius_mm;
  if (!request->design.arc && !isnan(request->subtended_angle_deg))
    return fg_member_fail(place, "subtended_angle_deg", NULL, "belongs to form \"arc\" only");
  if (isnan(request->subtended_angle_deg))
    request->subtended_angle_deg = request->design.subtended_angle_deg *
                                   request->design.overall_radius_mm / request->overall_radius_mm;
  return FG_OK;
}

fg_status fg_spec_read_foils(const fg_place *place, const cJSON *array, fg_render_spec *spec) {
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
  static const fg_spec_row table[] = {
      FG_SPEC_NUMBER(fg_disc_request, radius_mm, 0.001, 1000),
      {"hole", FG_SPEC_BOOL, offsetof(fg_disc_request, hole), 0, 0},
      FG_SPEC_INTEGER(fg_disc_request, lobes, 0, 500),
      FG_SPEC_NUMBER(fg_disc_request, lobe_um, -1000, 1000),
      FG_SPEC_NUMBER(fg_disc_request, lobe_phase_deg, -360, 360),
      FG_SPEC_OTHER("centre_mm"),
      FG_SPEC_END,
  };
  *request = (fg_disc_request){.radius_mm = NAN};
  FG_TRY(fg_members_read(place, disc, table, request));
  int count;
  FG_TRY(fg_member_numbers(place, "centre_mm", fg_spec_member(disc, "centre_mm"),
                           (fg_array_limits){-1e4, 1e4, 2, 2}, request->centre_mm, &count));
  if (isnan(request->radius_mm)) return fg_member_fail(place, "radius_mm", NULL, "a disc needs it");
  return FG_OK;
}

fg_status fg_spec_read_discs(const fg_place *place, const cJSON *array, fg_render_spec *spec) {
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
