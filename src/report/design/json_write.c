/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A design and its nominal values as JSON; json.c reads a design again. */
#include "report/design/json.h"

#include <math.h>

#include "foilgauge/words.h"
#include "report/design/calibration_json.h"
#include "report/measure/foil_view.h"
#include "report/measure/gauge_report.h"

static void write_limit(fg_json *json, const char *name, double limit) {
  if (isfinite(limit)) fg_json_number(json, name, limit);
}

static void write_tolerances(fg_json *json, const fg_design *design) {
  fg_json_object(json, "tolerances");
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const fg_tolerance *tolerance = &design->tolerances[i];
    fg_json_object(json, tolerance->quantity);
    fg_json_line(json);
    write_limit(json, "min", tolerance->lower);
    write_limit(json, "max", tolerance->upper);
    fg_json_object_end(json);
    fg_json_line_end(json);
  }
  fg_json_object_end(json);
}

/* Writes a number; nothing for 0, which means "not stated". */
static void write_stated(fg_json *json, const char *name, double value) {
  if (value != 0) fg_json_number(json, name, value);
}

void fg_design_json_of_beams(fg_json *json, const fg_design *design) {
  fg_json_integer(json, "beam_count", (int64_t)design->beams.count);
  fg_json_number(json, "beam_length_mm", design->beams.length_mm);
  fg_json_number(json, "beam_width_mm", design->beams.width_mm);
  fg_json_number(json, "thickness_mm", design->thickness_mm);
  write_stated(json, "u_thickness_mm", design->beams.u_thickness_mm);
  write_stated(json, "sagitta_mm", design->beams.sagitta_mm);
  write_stated(json, "elastic_modulus_gpa", design->beams.elastic_modulus_gpa);
  write_stated(json, "clearance_mm", design->beams.clearance_mm);
}

void fg_design_json_of_discs(fg_json *json, const fg_design *design) {
  fg_json_numbers(json, "diameters_mm", design->discs.diameters_mm, design->discs.count);
  write_stated(json, "u_diameters_mm", design->discs.u_diameters_mm);
}

void fg_design_json_of_bumps(fg_json *json, const fg_design *design) {
  fg_json_string(json, "datum", fg_datum_word(design->datum));
  fg_json_integer(json, "bump_count", (int64_t)design->bumps.count);
  fg_json_number(json, "bump_radius_mm", design->bumps.radius_mm);
  fg_json_number(json, "bump_angle_deg", design->bumps.angle_deg);
  fg_json_number(json, "overall_radius_mm", design->overall_radius_mm);
  fg_json_number(json, "sleeve_radius_mm", design->bumps.sleeve_radius_mm);
  fg_json_number(json, "pitch_deg", design->bumps.pitch_deg);
  fg_json_number(json, "fillet_radius_mm", design->bumps.fillet_radius_mm);
  fg_json_number(json, "thickness_mm", design->thickness_mm);
  if (design->bumps.top_foil_thickness_mm > 0)
    fg_json_number(json, "top_foil_thickness_mm", design->bumps.top_foil_thickness_mm);
  fg_json_number(json, "rotor_diameter_mm", design->bumps.rotor_diameter_mm);
}

static void write_known(fg_json *json, const fg_design *design) {
  if (design->tone == FG_TONE_LINEAR) fg_json_string(json, "tone", "linear");
  if (!(design->thickness_measured_mm > 0)) return;
  fg_json_object(json, "thickness_measured");
  fg_json_number(json, "value_mm", design->thickness_measured_mm);
  fg_json_number(json, "u_mm", design->u_thickness_measured_mm);
  fg_json_object_end(json);
}

void fg_json_design(fg_json *json, const char *name, const fg_design *design) {
  fg_json_object(json, name);
  fg_json_string(json, "schema", "foilgauge/design/1");
  fg_json_string(json, "name", design->name);
  fg_json_string(json, "form", fg_foil_kind_word(design->kind));
  fg_foil_view_of(design->kind)->design_json(json, design);
  write_known(json, design);
  write_tolerances(json, design);
  if (design->calibration.stated) fg_json_calibration(json, "calibration", &design->calibration);
  if (design->gauge_count) fg_json_gauges_stated(json, design);
  fg_json_object_end(json);
}

void fg_json_nominal(fg_json *json, const char *name, const fg_nominal *nominal) {
  fg_json_object(json, name);
  fg_json_number(json, "centre_to_centre_mm", nominal->centre_to_centre_mm);
  fg_json_number(json, "half_chord_mm", nominal->half_chord_mm);
  fg_json_number(json, "arc_length_mm", nominal->arc_length_mm);
  fg_json_number(json, "intersection_angle_deg", nominal->intersection_angle_deg);
  fg_json_number(json, "height_mm", nominal->height_mm);
  fg_json_number(json, "die_height_mm", nominal->die_height_mm);
  fg_json_number(json, "clearance_mm", nominal->clearance_mm);
  fg_json_object_end(json);
}
