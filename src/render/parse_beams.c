/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The beams of a cantilever. */
#include <math.h>
#include <string.h>

#include "render/parse.h"

/* Members of bent foils only. */
static const char *const of_bumps[] = {"overall_radius_mm",
                                       "subtended_angle_deg",
                                       "first_land_mm",
                                       "last_land_mm",
                                       "lip",
                                       "missing",
                                       "crushed",
                                       "radius_mm",
                                       "bump_angle_deg",
                                       "radius_springback",
                                       NULL};

static fg_beams_request default_beams(const fg_render_design *design) {
  fg_beams_request beams = {.pitch_mm = 1.5 * design->beam_width_mm,
                            .base_mm = 4,
                            .shoulder_mm = 2,
                            .kerf_mm = 0.2,
                            .corner_radius_mm = 0.1,
                            .root_radius_mm = 0.3};
  for (int i = 0; i < FG_RENDER_BUMPS_MAX; i++)
    beams.torn[i] = 1;
  return beams;
}

static fg_status read_scatter(const fg_place *place, const cJSON *beams, const char *name,
                              fg_beam_scatter *scatter) {
  static const fg_spec_row table[] = {
      FG_SPEC_NUMBER(fg_beam_scatter, mean_um, -5000, 5000),
      FG_SPEC_NUMBER(fg_beam_scatter, sd_um, 0, 1000),
      FG_SPEC_END,
  };
  const cJSON *object = fg_spec_member(beams, name);
  if (!object) return FG_OK;
  fg_place inner = fg_place_inside(place, name);
  return fg_members_read(&inner, object, table, scatter);
}

/* One number for all beams, or one per beam. */
static fg_status read_each(const fg_place *place, const cJSON *beams, const char *name, int count,
                           double *values) {
  const double limit = 10000;
  const cJSON *item = fg_spec_member(beams, name);
  int given;
  if (!item) return FG_OK;
  if (!cJSON_IsNumber(item))
    return fg_member_numbers(place, name, item, (fg_array_limits){-limit, limit, count, count},
                             values, &given);
  FG_TRY(fg_member_number(place, name, item, -limit, limit, &values[0]));
  for (int i = 1; i < count; i++)
    values[i] = values[0];
  return FG_OK;
}

static fg_status read_missing(const fg_place *place, const cJSON *beams, int count,
                              fg_beams_request *request) {
  double numbers[FG_RENDER_BUMPS_MAX];
  const cJSON *array = fg_spec_member(beams, "missing");
  int given = 0;
  if (!array) return FG_OK;
  FG_TRY(fg_member_numbers(place, "missing", array, (fg_array_limits){1, count, 0, count}, numbers,
                           &given));
  for (int i = 0; i < given; i++)
    request->missing[(int)numbers[i] - 1] = true;
  return FG_OK;
}

/* One beam and a number, in a list of defects. */
typedef struct defect {
  int beam;
  double length_factor, angle_deg;
} defect;

static fg_status read_defects(const fg_place *place, const cJSON *beams, const char *name,
                              const fg_spec_row *table, double *values) {
  const cJSON *array = fg_spec_member(beams, name), *item;
  int index = 0;
  if (!array) return FG_OK;
  if (!cJSON_IsArray(array)) return fg_member_fail(place, name, array, "must be an array");
  cJSON_ArrayForEach(item, array) {
    fg_place inner = fg_place_item(place, name, index++);
    defect one = {0, 0.5, 2};
    FG_TRY(fg_members_read(&inner, item, table, &one));
    if (one.beam == 0) return fg_member_fail(&inner, "beam", NULL, "say which beam, from 1");
    values[one.beam - 1] =
        table[1].offset == offsetof(defect, angle_deg) ? one.angle_deg : one.length_factor;
  }
  return FG_OK;
}

static fg_status read_beam_values(const fg_place *place, const cJSON *object,
                                  fg_beams_request *beams) {
  static const fg_spec_row table[] = {
      FG_SPEC_NUMBER(fg_beams_request, pitch_mm, 0.01, 1000),
      FG_SPEC_NUMBER(fg_beams_request, base_mm, 0.05, 1000),
      FG_SPEC_NUMBER(fg_beams_request, shoulder_mm, 0.05, 1000),
      FG_SPEC_NUMBER(fg_beams_request, kerf_mm, 0.005, 100),
      FG_SPEC_NUMBER(fg_beams_request, corner_radius_mm, 0.001, 100),
      FG_SPEC_NUMBER(fg_beams_request, root_radius_mm, 0.001, 100),
      FG_SPEC_OTHER("layout"),
      FG_SPEC_OTHER("length"),
      FG_SPEC_OTHER("width"),
      FG_SPEC_OTHER("length_um"),
      FG_SPEC_OTHER("width_um"),
      FG_SPEC_OTHER("taper_um"),
      FG_SPEC_OTHER("missing"),
      FG_SPEC_OTHER("torn"),
      FG_SPEC_OTHER("bent"),
      FG_SPEC_END,
  };
  static const char *const layouts[2] = {"comb", "slits"};
  int layout = 0;
  FG_TRY(fg_members_read(place, object, table, beams));
  FG_TRY(fg_member_choice(place, object, "layout", layouts, &layout));
  beams->slits = layout == 1;
  if (!beams->slits && fg_spec_member(object, "kerf_mm"))
    return fg_member_fail(place, "kerf_mm", NULL, "belongs to layout \"slits\" only");
  if (beams->slits && fg_spec_member(object, "root_radius_mm"))
    return fg_member_fail(place, "root_radius_mm", NULL,
                          "belongs to layout \"comb\" only: the ends of slits are round");
  return FG_OK;
}

static fg_status read_defective(const fg_place *place, const cJSON *object, int count,
                                fg_beams_request *beams) {
  const fg_spec_row torn[] = {
      FG_SPEC_INTEGER(defect, beam, 1, count),
      FG_SPEC_NUMBER(defect, length_factor, 0.1, 1),
      FG_SPEC_END,
  };
  const fg_spec_row bent[] = {
      FG_SPEC_INTEGER(defect, beam, 1, count),
      FG_SPEC_NUMBER(defect, angle_deg, -30, 30),
      FG_SPEC_END,
  };
  FG_TRY(read_missing(place, object, count, beams));
  FG_TRY(read_defects(place, object, "torn", torn, beams->torn));
  return read_defects(place, object, "bent", bent, beams->bent_deg);
}

fg_status fg_spec_read_beams(const fg_place *place, const cJSON *foil, fg_foil_request *request) {
  const cJSON *object = fg_spec_member(foil, "beams");
  if (!request->design.cantilever)
    return object ? fg_member_fail(place, "beams", NULL, "belongs to form \"cantilever\" only")
                  : FG_OK;
  for (size_t i = 0; of_bumps[i]; i++)
    if (fg_spec_member(foil, of_bumps[i]))
      return fg_member_fail(place, of_bumps[i], NULL,
                            "belongs to foils that are bent; a cantilever has \"beams\"");
  fg_beams_request *beams = &request->beams;
  *beams = default_beams(&request->design);
  request->has_lip = false;
  if (!object) return FG_OK;
  int count = request->design.beam_count;
  fg_place inner = fg_place_inside(place, "beams");
  FG_TRY(read_beam_values(&inner, object, beams));
  FG_TRY(read_scatter(&inner, object, "length", &beams->length));
  FG_TRY(read_scatter(&inner, object, "width", &beams->width));
  FG_TRY(read_each(&inner, object, "length_um", count, beams->length_um));
  FG_TRY(read_each(&inner, object, "width_um", count, beams->width_um));
  FG_TRY(read_each(&inner, object, "taper_um", count, beams->taper_um));
  return read_defective(&inner, object, count, beams);
}
