/* The truth of a render as JSON: what was drawn, with the names of a report. */
#include <math.h>
#include <stdlib.h>

#include <cjson/cJSON.h>

#include "render/spec.h"

static void put(cJSON *object, const char *name, double value) {
  cJSON_AddNumberToObject(object, name, value);
}

static void put_point(cJSON *object, const char *name, fg_point point) {
  double pair[2] = {point.x, point.y};
  cJSON_AddItemToObject(object, name, cJSON_CreateDoubleArray(pair, 2));
}

static void put_bumps(cJSON *foil, const fg_render_foil *truth) {
  cJSON *bumps = cJSON_AddArrayToObject(foil, "bumps");
  for (size_t i = 0; i < truth->bump_count; i++) {
    const fg_render_bump *bump = &truth->bumps[i];
    cJSON *entry = cJSON_CreateObject();
    put(entry, "index", bump->index);
    put(entry, "radius_mm", bump->radius_mm);
    put(entry, "bump_angle_deg", bump->bump_angle_deg);
    put(entry, "intersection_angle_deg", bump->intersection_angle_deg);
    put(entry, "centre_to_centre_mm", bump->centre_to_centre_mm);
    put(entry, "height_mm", bump->height_mm);
    put_point(entry, "centre_px", bump->centre_px);
    if (bump->crushed) cJSON_AddTrueToObject(entry, "crushed");
    cJSON_AddItemToArray(bumps, entry);
  }
}

static void put_design(cJSON *foil, const fg_render_design *design) {
  cJSON *object = cJSON_AddObjectToObject(foil, "design");
  put(object, "bump_radius_mm", design->bump_radius_mm);
  put(object, "bump_angle_deg", design->bump_angle_deg);
  put(object, "bump_count", design->bump_count);
  put(object, "overall_radius_mm", design->overall_radius_mm);
  put(object, "sleeve_radius_mm", design->sleeve_radius_mm);
  put(object, "pitch_deg", design->pitch_deg);
  put(object, "thickness_mm", design->thickness_mm);
  put(object, "fillet_radius_mm", design->fillet_radius_mm);
  put(object, "rotor_diameter_mm", design->rotor_diameter_mm);
  fg_render_bump nominal = fg_outline_nominal(design);
  cJSON *derived = cJSON_AddObjectToObject(foil, "nominal");
  double height = design->bump_radius_mm - (nominal.centre_to_centre_mm - design->sleeve_radius_mm);
  put(derived, "centre_to_centre_mm", nominal.centre_to_centre_mm);
  put(derived, "height_mm", height);
  put(derived, "clearance_mm",
      design->sleeve_radius_mm - height - design->rotor_diameter_mm / 2 - design->thickness_mm);
}

static void put_arc_design(cJSON *foil, const fg_render_design *design) {
  cJSON *object = cJSON_AddObjectToObject(foil, "design");
  cJSON_AddStringToObject(object, "form", "arc");
  put(object, "overall_radius_mm", design->overall_radius_mm);
  put(object, "subtended_angle_deg", design->subtended_angle_deg);
  put(object, "thickness_mm", design->thickness_mm);
}

/* What is stated of sagitta and clearance. */
static void put_stated(cJSON *object, const char *name, double value) {
  if (isfinite(value)) put(object, name, value);
}

static void put_cantilever_design(cJSON *foil, const fg_render_design *design) {
  cJSON *object = cJSON_AddObjectToObject(foil, "design");
  cJSON_AddStringToObject(object, "form", "cantilever");
  put(object, "beam_count", design->beam_count);
  put(object, "beam_length_mm", design->beam_length_mm);
  put(object, "beam_width_mm", design->beam_width_mm);
  put(object, "thickness_mm", design->thickness_mm);
  put_stated(object, "sagitta_mm", design->sagitta_mm);
  put_stated(object, "clearance_mm", design->clearance_mm);
}

/* S goes with L³ / w (eq 5.10), s with L². */
static void put_consequences(cJSON *entry, const fg_render_beam *beam,
                             const fg_render_design *design) {
  double length = beam->length_mm / design->beam_length_mm;
  double width = beam->width_mm / design->beam_width_mm;
  double change_mm = design->sagitta_mm * (1 - length * length);
  put(entry, "compliance_error_pct", 100 * (length * length * length / width - 1));
  put(entry, "sagitta_error_pct", 100 * (length * length - 1));
  put_stated(entry, "sagitta_mm", design->sagitta_mm * length * length);
  put_stated(entry, "clearance_change_mm", change_mm);
  put_stated(entry, "clearance_change_pct", 100 * change_mm / design->clearance_mm);
}

static void put_beams(cJSON *foil, const fg_render_foil *truth, const fg_render_design *design) {
  cJSON *beams = cJSON_AddArrayToObject(foil, "beams");
  for (size_t i = 0; i < truth->beam_count; i++) {
    const fg_render_beam *beam = &truth->beams[i];
    cJSON *entry = cJSON_CreateObject();
    put(entry, "number", beam->number);
    put(entry, "length_mm", beam->length_mm);
    put(entry, "width_mm", beam->width_mm);
    put_consequences(entry, beam, design);
    put(entry, "taper_um", beam->taper_um);
    put_point(entry, "root_px", beam->root_px);
    put_point(entry, "tip_px", beam->tip_px);
    if (beam->torn) cJSON_AddTrueToObject(entry, "torn");
    if (beam->bent_deg != 0) put(entry, "bent_deg", beam->bent_deg);
    cJSON_AddItemToArray(beams, entry);
  }
}

static void put_cantilever(cJSON *object, const fg_render_foil *truth,
                           const fg_render_design *design) {
  put_point(object, "root_centre_px", truth->overall_centre_px);
  put(object, "thickness_mm", truth->thickness_mm);
  put(object, "rotate_deg", truth->rotate_deg);
  cJSON_AddBoolToObject(object, "mirror", truth->mirror);
  put_cantilever_design(object, design);
  put_beams(object, truth, design);
}

static void put_foil(cJSON *object, const fg_render_foil *truth, const fg_render_design *design) {
  if (design->cantilever) {
    put_cantilever(object, truth, design);
    return;
  }
  put(object, "overall_radius_mm", truth->overall_radius_mm);
  put_point(object, "overall_centre_px", truth->overall_centre_px);
  put(object, "thickness_mm", truth->thickness_mm);
  if (design->arc) {
    put(object, "subtended_angle_deg", truth->subtended_angle_deg);
    put(object, "length_mm",
        truth->overall_radius_mm * truth->subtended_angle_deg * 3.14159265358979323846 / 180);
  }
  put(object, "rotate_deg", truth->rotate_deg);
  cJSON_AddBoolToObject(object, "mirror", truth->mirror);
  if (design->arc) {
    put_arc_design(object, design);
    return;
  }
  put_design(object, design);
  put_bumps(object, truth);
}

/* One number where both axes agree. */
static void put_axes(cJSON *object, const char *name, const double value[2]) {
  if (value[0] == value[1])
    put(object, name, value[0]);
  else
    cJSON_AddItemToObject(object, name, cJSON_CreateDoubleArray(value, 2));
}

static void put_scan(cJSON *root, const fg_render_spec *spec) {
  const fg_scanner *scanner = &spec->scanner;
  cJSON *scan = cJSON_AddObjectToObject(root, "scan");
  put_axes(scan, "dpi", scanner->dpi);
  put(scan, "width", (double)spec->truth.width_px);
  put(scan, "height", (double)spec->truth.height_px);
  put(scan, "bits", scanner->bits);
  put_axes(scan, "blur_px", scanner->blur_px);
  put(scan, "motion_blur_px", scanner->motion_blur_px);
  put(scan, "background", scanner->background);
  put(scan, "contrast", scanner->contrast);
  put(scan, "gamma", scanner->gamma);
  put(scan, "noise", scanner->noise);
  put(scan, "noise_correlation", scanner->noise_correlation);
  put(scan, "one_sided_blur_px", scanner->one_sided_blur_px);
  cJSON_AddStringToObject(scan, "one_sided_way", scanner->one_sided_way < 0 ? "-y" : "+y");
  put(scan, "edge_roughness_um", scanner->edge_roughness_um);
  put(scan, "edge_common_um", scanner->edge_common_um);
  put(scan, "correlation_um", scanner->edge_correlation_um);
  cJSON_AddStringToObject(scan, "correlation_form",
                          scanner->edge_exponential ? "exponential" : "gaussian");
  put(scan, "halo_fraction", scanner->halo_fraction);
  put(scan, "side_wall_amplitude", scanner->wall_amplitude);
  put(scan, "seed", (double)spec->seed);
}

static void put_curve(cJSON *entry, const fg_render_effect *effect) {
  if (effect->row->target == FG_RENDER_EFFECT_SCANNER)
    cJSON_AddStringToObject(entry, "moves", effect->moves ? "y" : "x");
  if (effect->row->target == FG_RENDER_EFFECT_EDGE)
    cJSON_AddStringToObject(entry, "edges", effect->apart ? "apart" : "together");
  cJSON *knots = cJSON_AddArrayToObject(entry, "knots");
  for (size_t i = 0; i < effect->curve.count; i++) {
    double pair[2] = {effect->curve.at[i], effect->curve.value_um[i]};
    cJSON_AddItemToArray(knots, cJSON_CreateDoubleArray(pair, 2));
  }
}

/* Lost rows and seams are effects under the names that reports give them. */
static cJSON *jump_entry(const fg_render_jump *jump) {
  cJSON *entry = cJSON_CreateObject();
  double along = jump->repeats * jump->d_mm[jump->axis];
  cJSON_AddStringToObject(entry, "id", jump->axis ? "scan.row_step" : "scan.column_step");
  put(entry, "amplitude_um", 1e3 * along);
  put(entry, jump->axis ? "y_mm" : "x_mm", jump->at_mm);
  if (jump->axis) put(entry, "rows", round(along / jump->every_mm));
  if (!jump->axis && jump->d_mm[1] != 0) put(entry, "amplitude_y_um", 1e3 * jump->d_mm[1]);
  return entry;
}

static void put_lift(cJSON *entry, const fg_render_effect *effect, int bumps) {
  cJSON_AddStringToObject(entry, "form", effect->lift.whole ? "whole" : "crown");
  cJSON_AddItemToObject(entry, "values_um", cJSON_CreateDoubleArray(effect->lift.um, bumps));
}

static void put_effects(cJSON *root, const fg_render_spec *spec) {
  const fg_render_effect_list *list = &spec->effects;
  cJSON *effects = cJSON_AddArrayToObject(root, "effects");
  for (size_t i = 0; i < list->count; i++) {
    const fg_render_effect *effect = &list->effects[i];
    cJSON *entry = cJSON_CreateObject();
    cJSON_AddStringToObject(entry, "id", effect->row->id);
    for (int k = 0; k < FG_RENDER_EFFECT_PARAMETERS_MAX && effect->row->parameters[k].name; k++)
      put(entry, effect->row->parameters[k].name, effect->p[k]);
    if (effect->row->curve) put_curve(entry, effect);
    if (effect->target == FG_RENDER_EFFECT_LIFT) put_lift(entry, effect, fg_scene_most_bumps(spec));
    cJSON_AddItemToArray(effects, entry);
  }
  for (size_t i = 0; i < list->jumps.count; i++)
    cJSON_AddItemToArray(effects, jump_entry(&list->jumps.each[i]));
}

static void put_discs(cJSON *root, const fg_render_spec *spec) {
  if (spec->truth.disc_count == 0) return;
  cJSON *discs = cJSON_AddArrayToObject(root, "discs");
  for (size_t i = 0; i < spec->truth.disc_count; i++) {
    cJSON *entry = cJSON_CreateObject();
    put_point(entry, "centre_px", spec->truth.discs[i].centre_px);
    put(entry, "radius_mm", spec->truth.discs[i].radius_mm);
    cJSON_AddBoolToObject(entry, "hole", spec->truth.discs[i].hole);
    cJSON_AddItemToArray(discs, entry);
  }
}

static const fg_render_design *design_of(const fg_render_spec *spec, size_t foil) {
  size_t i = 0;
  while (foil >= (size_t)spec->requests[i].repeat)
    foil -= (size_t)spec->requests[i++].repeat;
  return &spec->requests[i].design;
}

fg_status fg_render_truth_json(fg_context *ctx, const fg_render_spec *spec, char **json) {
  *json = NULL;
  cJSON *root = cJSON_CreateObject();
  cJSON_AddStringToObject(root, "schema", "foilgauge/truth/1");
  if (spec->truth.foil_count == 1) put_foil(root, &spec->truth.foils[0], design_of(spec, 0));
  if (spec->truth.foil_count > 1) {
    cJSON *foils = cJSON_AddArrayToObject(root, "foils");
    for (size_t i = 0; i < spec->truth.foil_count; i++) {
      cJSON *foil = cJSON_CreateObject();
      put_foil(foil, &spec->truth.foils[i], design_of(spec, i));
      cJSON_AddItemToArray(foils, foil);
    }
  }
  put_discs(root, spec);
  put_scan(root, spec);
  put_effects(root, spec);
  fg_colour_lines_put_truth(root, spec);
  *json = cJSON_Print(root);
  cJSON_Delete(root);
  return *json ? FG_OK : fg_fail(ctx, FG_ERR_MEMORY, "out of memory for the truth");
}
