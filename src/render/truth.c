/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The truth of a render as JSON, with the names of a report. */
#include <math.h>
#include <stdlib.h>

#include "core/json_writer.h"
#include "render/spec.h"

enum { PROFILE_POINTS = 201 }; /* of a colour line, along y */

static void write_true_pair(fg_json *json, const char *name, double first, double second) {
  const double pair[2] = {first, second};
  fg_json_numbers(json, name, pair, 2);
}

static void write_true_bumps(fg_json *json, const fg_render_foil *truth) {
  fg_json_array(json, "bumps");
  for (size_t i = 0; i < truth->bump_count; i++) {
    const fg_render_bump *bump = &truth->bumps[i];
    fg_json_object(json, NULL);
    fg_json_number(json, "index", bump->index);
    fg_json_number(json, "radius_mm", bump->radius_mm);
    fg_json_number(json, "bump_angle_deg", bump->bump_angle_deg);
    fg_json_number(json, "intersection_angle_deg", bump->intersection_angle_deg);
    fg_json_number(json, "centre_to_centre_mm", bump->centre_to_centre_mm);
    fg_json_number(json, "height_mm", bump->height_mm);
    write_true_pair(json, "centre_px", bump->centre_px.x, bump->centre_px.y);
    if (bump->crushed) fg_json_bool(json, "crushed", true);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

static void put_design(fg_json *json, const fg_render_design *design) {
  fg_json_object(json, "design");
  fg_json_number(json, "bump_radius_mm", design->bump_radius_mm);
  fg_json_number(json, "bump_angle_deg", design->bump_angle_deg);
  fg_json_number(json, "bump_count", design->bump_count);
  fg_json_number(json, "overall_radius_mm", design->overall_radius_mm);
  fg_json_number(json, "sleeve_radius_mm", design->sleeve_radius_mm);
  fg_json_number(json, "pitch_deg", design->pitch_deg);
  fg_json_number(json, "thickness_mm", design->thickness_mm);
  fg_json_number(json, "fillet_radius_mm", design->fillet_radius_mm);
  fg_json_number(json, "rotor_diameter_mm", design->rotor_diameter_mm);
  fg_json_object_end(json);
  fg_render_bump nominal = fg_outline_nominal(design);
  fg_json_object(json, "nominal");
  double height = design->bump_radius_mm - (nominal.centre_to_centre_mm - design->sleeve_radius_mm);
  fg_json_number(json, "centre_to_centre_mm", nominal.centre_to_centre_mm);
  fg_json_number(json, "height_mm", height);
  fg_json_number(json, "clearance_mm",
                 design->sleeve_radius_mm - height - design->rotor_diameter_mm / 2 -
                     design->thickness_mm);
  fg_json_object_end(json);
}

static void put_arc_design(fg_json *json, const fg_render_design *design) {
  fg_json_object(json, "design");
  fg_json_string(json, "form", "arc");
  fg_json_number(json, "overall_radius_mm", design->overall_radius_mm);
  fg_json_number(json, "subtended_angle_deg", design->subtended_angle_deg);
  fg_json_number(json, "thickness_mm", design->thickness_mm);
  fg_json_object_end(json);
}

/* Writes a stated sagitta or clearance. */
static void put_stated(fg_json *json, const char *name, double value) {
  if (isfinite(value)) fg_json_number(json, name, value);
}

static void put_cantilever_design(fg_json *json, const fg_render_design *design) {
  fg_json_object(json, "design");
  fg_json_string(json, "form", "cantilever");
  fg_json_number(json, "beam_count", design->beam_count);
  fg_json_number(json, "beam_length_mm", design->beam_length_mm);
  fg_json_number(json, "beam_width_mm", design->beam_width_mm);
  fg_json_number(json, "thickness_mm", design->thickness_mm);
  put_stated(json, "sagitta_mm", design->sagitta_mm);
  put_stated(json, "clearance_mm", design->clearance_mm);
  fg_json_object_end(json);
}

/* Writes compliance and sagitta errors: S goes with L³ / w (eq 5.10), s with L². */
static void put_consequences(fg_json *json, const fg_render_beam *beam,
                             const fg_render_design *design) {
  double length = beam->length_mm / design->beam_length_mm;
  double width = beam->width_mm / design->beam_width_mm;
  double change_mm = design->sagitta_mm * (1 - length * length);
  fg_json_number(json, "compliance_error_pct", 100 * (length * length * length / width - 1));
  fg_json_number(json, "sagitta_error_pct", 100 * (length * length - 1));
  put_stated(json, "sagitta_mm", design->sagitta_mm * length * length);
  put_stated(json, "clearance_change_mm", change_mm);
  put_stated(json, "clearance_change_pct", 100 * change_mm / design->clearance_mm);
}

static void put_beams(fg_json *json, const fg_render_foil *truth, const fg_render_design *design) {
  fg_json_array(json, "beams");
  for (size_t i = 0; i < truth->beam_count; i++) {
    const fg_render_beam *beam = &truth->beams[i];
    fg_json_object(json, NULL);
    fg_json_number(json, "number", beam->number);
    fg_json_number(json, "length_mm", beam->length_mm);
    fg_json_number(json, "width_mm", beam->width_mm);
    put_consequences(json, beam, design);
    fg_json_number(json, "taper_um", beam->taper_um);
    write_true_pair(json, "root_px", beam->root_px.x, beam->root_px.y);
    write_true_pair(json, "tip_px", beam->tip_px.x, beam->tip_px.y);
    if (beam->torn) fg_json_bool(json, "torn", true);
    if (beam->bent_deg != 0) fg_json_number(json, "bent_deg", beam->bent_deg);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

static void put_cantilever(fg_json *json, const fg_render_foil *truth,
                           const fg_render_design *design) {
  write_true_pair(json, "root_centre_px", truth->overall_centre_px.x, truth->overall_centre_px.y);
  fg_json_number(json, "thickness_mm", truth->thickness_mm);
  fg_json_number(json, "rotate_deg", truth->rotate_deg);
  fg_json_bool(json, "mirror", truth->mirror);
  put_cantilever_design(json, design);
  put_beams(json, truth, design);
}

static void write_true_foil(fg_json *json, const fg_render_foil *truth,
                            const fg_render_design *design) {
  if (design->cantilever) {
    put_cantilever(json, truth, design);
    return;
  }
  fg_json_number(json, "overall_radius_mm", truth->overall_radius_mm);
  write_true_pair(json, "overall_centre_px", truth->overall_centre_px.x,
                  truth->overall_centre_px.y);
  fg_json_number(json, "thickness_mm", truth->thickness_mm);
  if (design->arc) {
    fg_json_number(json, "subtended_angle_deg", truth->subtended_angle_deg);
    fg_json_number(json, "length_mm",
                   truth->overall_radius_mm * truth->subtended_angle_deg * 3.14159265358979323846 /
                       180);
  }
  fg_json_number(json, "rotate_deg", truth->rotate_deg);
  fg_json_bool(json, "mirror", truth->mirror);
  if (design->arc) {
    put_arc_design(json, design);
    return;
  }
  put_design(json, design);
  write_true_bumps(json, truth);
}

/* Writes one number where both axes agree. */
static void put_axes(fg_json *json, const char *name, const double value[2]) {
  if (value[0] == value[1])
    fg_json_number(json, name, value[0]);
  else
    fg_json_numbers(json, name, value, 2);
}

static void put_shadow(fg_json *json, const fg_shadow *shadow) {
  if (shadow->amplitude == 0) return;
  fg_json_object(json, "shadow");
  fg_json_number(json, "amplitude", shadow->amplitude);
  fg_json_number(json, "direction_deg", shadow->direction_deg);
  fg_json_number(json, "width_deg", shadow->width_deg);
  fg_json_number(json, "length_px", shadow->length_px);
  fg_json_number(json, "gap_px", shadow->gap_px);
  fg_json_object_end(json);
}

static void put_resampling(fg_json *json, const fg_scanner *scanner) {
  if (isnan(scanner->sensor_dpi[0])) return;
  put_axes(json, "resampled_from_dpi", scanner->sensor_dpi);
  fg_json_string(json, "resampled_by", scanner->bicubic ? "bicubic" : "bilinear");
}

static void write_true_scan(fg_json *json, const fg_render_spec *spec) {
  const fg_scanner *scanner = &spec->scanner;
  fg_json_object(json, "scan");
  put_axes(json, "dpi", scanner->dpi);
  put_resampling(json, scanner);
  fg_json_number(json, "width", (double)spec->truth.width_px);
  fg_json_number(json, "height", (double)spec->truth.height_px);
  fg_json_number(json, "bits", scanner->bits);
  put_axes(json, "blur_px", scanner->blur_px);
  if (scanner->blur_angle_deg != 0) fg_json_number(json, "blur_angle_deg", scanner->blur_angle_deg);
  fg_json_number(json, "motion_blur_px", scanner->motion_blur_px);
  fg_json_number(json, "background", scanner->background);
  fg_json_number(json, "contrast", scanner->contrast);
  fg_json_number(json, "gamma", scanner->gamma);
  fg_json_number(json, "noise", scanner->noise);
  fg_json_number(json, "noise_correlation", scanner->noise_correlation);
  fg_json_number(json, "one_sided_blur_px", scanner->one_sided_blur_px);
  fg_json_string(json, "one_sided_way", scanner->one_sided_way < 0 ? "-y" : "+y");
  fg_json_number(json, "edge_roughness_um", scanner->edge_roughness_um);
  fg_json_number(json, "edge_common_um", scanner->edge_common_um);
  fg_json_number(json, "correlation_um", scanner->edge_correlation_um);
  fg_json_string(json, "correlation_form", scanner->edge_exponential ? "exponential" : "gaussian");
  fg_json_number(json, "halo_fraction", scanner->halo_fraction);
  fg_json_number(json, "side_wall_amplitude", scanner->wall_amplitude);
  put_shadow(json, &scanner->shadow);
  fg_driver_put_truth(json, &scanner->driver);
  fg_json_number(json, "seed", (double)spec->seed);
  fg_json_object_end(json);
}

static void write_true_curve(fg_json *json, const fg_render_effect *effect) {
  if (effect->row->target == FG_RENDER_EFFECT_SCANNER)
    fg_json_string(json, "moves", effect->moves ? "y" : "x");
  if (effect->row->target == FG_RENDER_EFFECT_EDGE)
    fg_json_string(json, "edges", effect->apart ? "apart" : "together");
  fg_json_array(json, "knots");
  for (size_t i = 0; i < effect->curve.count; i++)
    write_true_pair(json, NULL, effect->curve.at[i], effect->curve.value_um[i]);
  fg_json_array_end(json);
}

/* Writes lost rows, stitches and seams as effects under the names of reports. */
static void put_jump(fg_json *json, const fg_render_jump *jump) {
  fg_json_object(json, NULL);
  double along = jump->repeats * jump->d_mm[jump->axis];
  fg_json_string(json, "id", jump->axis ? "scan.row_step" : "scan.column_step");
  fg_json_number(json, "amplitude_um", 1e3 * along);
  fg_json_number(json, jump->axis ? "y_mm" : "x_mm", jump->at_mm);
  if (jump->axis) fg_json_number(json, "rows", round(along / jump->every_mm));
  if (!jump->axis && jump->d_mm[1] != 0)
    fg_json_number(json, "amplitude_y_um", 1e3 * jump->d_mm[1]);
  if (jump->axis && jump->d_mm[0] != 0) fg_json_number(json, "amplitude_x_um", 1e3 * jump->d_mm[0]);
  fg_json_object_end(json);
}

static void put_lift(fg_json *json, const fg_render_effect *effect, int bumps) {
  fg_json_string(json, "form", effect->lift.whole ? "whole" : "crown");
  fg_json_numbers(json, "values_um", effect->lift.um, (size_t)bumps);
}

static void put_effects(fg_json *json, const fg_render_spec *spec) {
  const fg_render_effect_list *list = &spec->effects;
  fg_json_array(json, "effects");
  for (size_t i = 0; i < list->count; i++) {
    const fg_render_effect *effect = &list->effects[i];
    fg_json_object(json, NULL);
    fg_json_string(json, "id", effect->row->id);
    for (int k = 0; k < FG_RENDER_EFFECT_PARAMETERS_MAX && effect->row->parameters[k].name; k++)
      fg_json_number(json, effect->row->parameters[k].name, effect->p[k]);
    if (effect->row->curve) write_true_curve(json, effect);
    if (effect->target == FG_RENDER_EFFECT_LIFT) put_lift(json, effect, fg_scene_max_bumps(spec));
    fg_json_object_end(json);
  }
  for (size_t i = 0; i < list->jumps.count; i++)
    put_jump(json, &list->jumps.each[i]);
  fg_json_array_end(json);
}

static void write_true_discs(fg_json *json, const fg_render_spec *spec) {
  if (spec->truth.disc_count == 0) return;
  fg_json_array(json, "discs");
  for (size_t i = 0; i < spec->truth.disc_count; i++) {
    fg_json_object(json, NULL);
    write_true_pair(json, "centre_px", spec->truth.discs[i].centre_px.x,
                    spec->truth.discs[i].centre_px.y);
    fg_json_number(json, "radius_mm", spec->truth.discs[i].radius_mm);
    fg_json_bool(json, "hole", spec->truth.discs[i].hole);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

static const fg_render_design *design_of(const fg_render_spec *spec, size_t foil) {
  size_t i = 0;
  while (foil >= (size_t)spec->requests[i].repeat)
    foil -= (size_t)spec->requests[i++].repeat;
  return &spec->requests[i].design;
}

static void put_foils(fg_json *json, const fg_render_spec *spec) {
  if (spec->truth.foil_count == 1) write_true_foil(json, &spec->truth.foils[0], design_of(spec, 0));
  if (spec->truth.foil_count < 2) return;
  fg_json_array(json, "foils");
  for (size_t i = 0; i < spec->truth.foil_count; i++) {
    fg_json_object(json, NULL);
    write_true_foil(json, &spec->truth.foils[i], design_of(spec, i));
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

/* The carriage's error along y when a line reads row y, in the middle of the picture, mm. */
static double carriage_mm(const fg_render_spec *spec, const fg_colour_line *line, double y_mm) {
  double at[2] = {0.5 * (double)spec->sensor.width_px * spec->sensor.pixel_mm[0],
                  y_mm + line->gap_px * spec->sensor.pixel_mm[1]};
  double d[2];
  fg_render_effects_field(&spec->effects, at[0], at[1], at, d);
  return d[1];
}

/* true = nominal + d: the picture moves up by d. */
static void put_colour_profile(fg_json *json, const fg_render_spec *spec, int i) {
  const fg_colour_line *line = &spec->scanner.colour.line[i],
                       *green = &spec->scanner.colour.line[1];
  double height_mm = (double)spec->sensor.height_px * spec->sensor.pixel_mm[1];
  double shift_mm = (line->shift_px[1] - green->shift_px[1]) * spec->sensor.pixel_mm[1];
  fg_json_array(json, "course");
  for (int k = 0; k < PROFILE_POINTS; k++) {
    double y = height_mm * k / (PROFILE_POINTS - 1);
    double um = 1e3 * (shift_mm - carriage_mm(spec, line, y) + carriage_mm(spec, green, y));
    fg_json_numbers(json, NULL, (const double[]){y, um}, 2);
  }
  fg_json_array_end(json);
}

static void put_colour_line(fg_json *json, const fg_render_spec *spec, int i) {
  const fg_colour_line *line = &spec->scanner.colour.line[i],
                       *green = &spec->scanner.colour.line[1];
  double dx = line->shift_px[0] - green->shift_px[0], dy = line->shift_px[1] - green->shift_px[1];
  fg_json_object(json, fg_colour_line_words[i]);
  fg_json_number(json, "gap_px", line->gap_px - green->gap_px);
  fg_json_number(json, "dx_px", dx * spec->sensor.pixel_mm[0] / spec->pixel_mm[0]);
  fg_json_number(json, "dy_px", dy * spec->sensor.pixel_mm[1] / spec->pixel_mm[1]);
  fg_json_number(json, "dx_um", 1e3 * dx * spec->sensor.pixel_mm[0]);
  fg_json_number(json, "dy_um", 1e3 * dy * spec->sensor.pixel_mm[1]);
  fg_json_number(json, "magnification_ppm", line->magnification_ppm - green->magnification_ppm);
  put_colour_profile(json, spec, i);
  fg_json_object_end(json);
}

static void put_colour_lines(fg_json *json, const fg_render_spec *spec) {
  if (!spec->scanner.colour.stated) return;
  fg_json_object(json, "colour_lines");
  fg_json_string(json, "against", fg_colour_line_words[1]);
  fg_json_number(json, "middle_x_mm",
                 0.5 * (double)(spec->sensor.width_px - 1) * spec->sensor.pixel_mm[0]);
  put_colour_line(json, spec, 0);
  put_colour_line(json, spec, 2);
  fg_json_object_end(json);
}

static void write_truth(const fg_render_spec *spec, FILE *out) {
  fg_json json;
  fg_json_begin(&json, out);
  json.exact = true;
  fg_json_object(&json, NULL);
  fg_json_string(&json, "schema", "foilgauge/truth/1");
  put_foils(&json, spec);
  write_true_discs(&json, spec);
  write_true_scan(&json, spec);
  put_effects(&json, spec);
  put_colour_lines(&json, spec);
  fg_json_object_end(&json);
}

/* The stream in memory reports a failed allocation only at its end. */
fg_status fg_render_truth_json(fg_context *ctx, const fg_render_spec *spec, char **json) {
  size_t length;
  *json = NULL;
  FILE *out = open_memstream(json, &length);
  if (!out) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the truth");
  write_truth(spec, out);
  bool broken = ferror(out) != 0;
  if (fclose(out) == 0 && !broken) return FG_OK;
  free(*json);
  *json = NULL;
  return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the truth");
}
