/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The truth of a render as JSON, with the names of a report. */
#include "render/truth.h"

#include <math.h>
#include <stdlib.h>

#include "core/file.h"
#include "render/spec.h"

#define PI 3.14159265358979323846

static const fg_render_design *find_true_design(const fg_render_spec *spec, size_t foil) {
  size_t i = 0;
  while (foil >= (size_t)spec->requests[i].repeat)
    foil -= (size_t)spec->requests[i++].repeat;
  return &spec->requests[i].design;
}

/* Design of a foil or of a part of it: the subject's index is the foil's. */
static const fg_render_design *design_of(const fg_subject *s) {
  return find_true_design(s->whole, s->index);
}

static fg_subject find_design_of_foil(const fg_subject *s) {
  return (fg_subject){.object = design_of(s), .whole = s->whole, .index = s->index};
}

static bool has_beams(const fg_subject *s) {
  return design_of(s)->cantilever;
}

static bool has_circle(const fg_subject *s) {
  return !design_of(s)->cantilever;
}

static bool is_plain_arc(const fg_subject *s) {
  return has_circle(s) && design_of(s)->arc;
}

static bool has_bumps(const fg_subject *s) {
  return has_circle(s) && !design_of(s)->arc;
}

/* Design. */
static const char *const kind_words[] = {"arc", "cantilever", NULL};

static int find_kind(const fg_subject *s) {
  return has_beams(s) ? 1 : is_plain_arc(s) ? 0 : -1;
}

FG_TRUE_VALUE(find_beam_count, fg_render_design, o->beam_count)
FG_TRUE_VALUE(find_bump_count, fg_render_design, o->bump_count)

#define DESIGN(name) FG_NUMBER(#name, fg_render_design, name), .options = FG_MEMBER_NEVER_NULL

static const fg_member design_rows[] = {
    {FG_WORD_BY("form", find_kind, kind_words), .options = FG_MEMBER_LEFT_OUT,
     .words = "left out: bumps"},
    {FG_NUMBER_BY("beam_count", find_beam_count), .present = has_beams},
    {DESIGN(beam_length_mm), .present = has_beams},
    {DESIGN(beam_width_mm), .present = has_beams},
    {DESIGN(bump_radius_mm), .present = has_bumps},
    {DESIGN(bump_angle_deg), .present = has_bumps},
    {FG_NUMBER_BY("bump_count", find_bump_count), .present = has_bumps},
    {DESIGN(overall_radius_mm), .present = has_circle},
    {DESIGN(subtended_angle_deg), .present = is_plain_arc},
    {DESIGN(sleeve_radius_mm), .present = has_bumps},
    {DESIGN(pitch_deg), .present = has_bumps},
    {DESIGN(thickness_mm)},
    {FG_NUMBER("sagitta_mm", fg_render_design, sagitta_mm), .options = FG_MEMBER_LEFT_OUT,
     .present = has_beams, .words = "where it is stated"},
    {FG_NUMBER("clearance_mm", fg_render_design, clearance_mm), .options = FG_MEMBER_LEFT_OUT,
     .present = has_beams, .words = "where it is stated"},
    {DESIGN(fillet_radius_mm), .present = has_bumps},
    {DESIGN(rotor_diameter_mm), .present = has_bumps},
};
static const fg_members design_members = FG_MEMBERS_DEFINED(design_rows, "design");

static double nominal_height(const fg_render_design *design) {
  double centre = fg_outline_nominal(design).centre_to_centre_mm;
  return design->bump_radius_mm - (centre - design->sleeve_radius_mm);
}

FG_TRUE_VALUE(find_nominal_centre, fg_render_design, fg_outline_nominal(o).centre_to_centre_mm)
FG_TRUE_VALUE(find_nominal_height, fg_render_design, nominal_height(o))
FG_TRUE_VALUE(find_nominal_clearance, fg_render_design,
              o->sleeve_radius_mm - nominal_height(o) - o->rotor_diameter_mm / 2 - o->thickness_mm)

static const fg_member nominal_rows[] = {
    {FG_NUMBER_BY("centre_to_centre_mm", find_nominal_centre), .words = "X as designed"},
    {FG_NUMBER_BY("height_mm", find_nominal_height), .words = "h as designed"},
    {FG_NUMBER_BY("clearance_mm", find_nominal_clearance), .words = "as designed"},
};
static const fg_members nominal_members = FG_MEMBERS_DEFINED(nominal_rows, "nominal");

/* The measurand: circles through the part as it is. */
#define MEASURAND(json_name, field) FG_NUMBER(json_name, fg_render_measurand, field)
#define MEASURAND_CENTRE            FG_RANGE("centre_px", fg_render_measurand, centre_px.x, centre_px.y)

static const fg_member overall_measurand_rows[] = {
    {MEASURAND("radius_mm", radius_mm), .words = "R0"},
    {MEASURAND_CENTRE, .words = "x, y"},
    {MEASURAND("form_error_um", form_error_um), .words = "peak to valley, of the lands"},
};
static const fg_members overall_measurand_members =
    FG_MEMBERS_DEFINED(overall_measurand_rows, "overall_measurand");

static const fg_member bump_measurand_rows[] = {
    {MEASURAND("radius_mm", radius_mm), .words = "R"},
    {MEASURAND("bump_angle_deg", bump_angle_deg), .words = "alpha"},
    {MEASURAND("intersection_angle_deg", intersection_angle_deg), .words = "theta"},
    {MEASURAND("centre_to_centre_mm", centre_to_centre_mm), .words = "X"},
    {MEASURAND("height_mm", height_mm), .words = "h"},
    {MEASURAND_CENTRE, .words = "x, y"},
    {MEASURAND("form_error_um", form_error_um), .words = "peak to valley"},
};
static const fg_members bump_measurand_members =
    FG_MEMBERS_DEFINED(bump_measurand_rows, "bump_measurand");

/* Bumps. */
FG_TRUE_VALUE(find_bump_index, fg_render_bump, o->index)
FG_TRUE_CASE(is_crushed, fg_render_bump, o->crushed)

static const fg_member bump_rows[] = {
    {FG_NUMBER_BY("index", find_bump_index), .words = "1 is next to the lip"},
    {FG_NUMBER("radius_mm", fg_render_bump, radius_mm), .words = "R, of the midline"},
    {FG_NUMBER("bump_angle_deg", fg_render_bump, bump_angle_deg), .words = "alpha"},
    {FG_NUMBER("intersection_angle_deg", fg_render_bump, intersection_angle_deg), .words = "theta"},
    {FG_NUMBER("centre_to_centre_mm", fg_render_bump, centre_to_centre_mm), .words = "X"},
    {FG_NUMBER("height_mm", fg_render_bump, height_mm), .words = "h"},
    {FG_RANGE("centre_px", fg_render_bump, centre_px.x, centre_px.y), .words = "x, y"},
    {FG_FLAG("crushed", fg_render_bump, crushed), .present = is_crushed},
    {FG_OBJECT("measurand", fg_render_bump, measurand, &bump_measurand_members),
     .words = "of the least-squares circles through the bump and the lands as they are, with the "
              "part's effects; the members beside it are of the ideal circles"},
};
static const fg_members bump_members = FG_MEMBERS_DEFINED(bump_rows, "bump");

/* Beams: compliance goes with L³ / w (eq 5.10), the sagitta with L². */
static double length_ratio(const fg_subject *s) {
  return ((const fg_render_beam *)s->object)->length_mm / design_of(s)->beam_length_mm;
}

static double square_of_length(const fg_subject *s) {
  return length_ratio(s) * length_ratio(s);
}

FG_TRUE_VALUE(find_beam_number, fg_render_beam, o->number)
FG_TRUE_VALUE(
    find_compliance_error, fg_render_beam,
    100 * (square_of_length(s) * length_ratio(s) / (o->width_mm / design_of(s)->beam_width_mm) - 1))

static double find_sagitta_error(const fg_subject *s) {
  return 100 * (square_of_length(s) - 1);
}

static double find_sagitta(const fg_subject *s) {
  return design_of(s)->sagitta_mm * length_ratio(s) * length_ratio(s);
}

static double find_clearance_change(const fg_subject *s) {
  return design_of(s)->sagitta_mm * (1 - square_of_length(s));
}

static double find_relative_clearance_change(const fg_subject *s) {
  return 100 * find_clearance_change(s) / design_of(s)->clearance_mm;
}

FG_TRUE_CASE(is_torn, fg_render_beam, o->torn)
FG_TRUE_CASE(is_bent, fg_render_beam, o->bent_deg != 0)

static const fg_member beam_rows[] = {
    {FG_NUMBER_BY("number", find_beam_number), .words = "from 1"},
    {FG_NUMBER("length_mm", fg_render_beam, length_mm),
     .words = "from the line of the roots to the free end; torn: mean of the remainder"},
    {FG_NUMBER("width_mm", fg_render_beam, width_mm), .words = "half way"},
    {FG_NUMBER_BY("compliance_error_pct", find_compliance_error), .words = "against the design"},
    {FG_NUMBER_BY("sagitta_error_pct", find_sagitta_error), .words = "against the design"},
    {FG_NUMBER_BY("sagitta_mm", find_sagitta), .options = FG_MEMBER_LEFT_OUT,
     .words = "where the design states one"},
    {FG_NUMBER_BY("clearance_change_mm", find_clearance_change), .options = FG_MEMBER_LEFT_OUT,
     .words = "by the sagitta"},
    {FG_NUMBER_BY("clearance_change_pct", find_relative_clearance_change),
     .options = FG_MEMBER_LEFT_OUT, .words = "of the design's clearance"},
    {FG_NUMBER("taper_um", fg_render_beam, taper_um),
     .words = "width at the root less that at the free end"},
    {FG_RANGE("root_px", fg_render_beam, root_px.x, root_px.y), .words = "x, y"},
    {FG_RANGE("tip_px", fg_render_beam, tip_px.x, tip_px.y), .words = "x, y"},
    {FG_FLAG("torn", fg_render_beam, torn), .present = is_torn},
    {FG_NUMBER("bent_deg", fg_render_beam, bent_deg), .present = is_bent,
     .words = "in the sheet's plane, about the root"},
};
static const fg_members beam_members = FG_MEMBERS_DEFINED(beam_rows, "beam");

static bool find_beam(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_render_foil *foil = list->object;
  element->object = &foil->beams[i];
  element->index = list->index;
  return i < foil->beam_count;
}

/* Foils: one stands in the document itself. */
FG_TRUE_VALUE(find_arc_length, fg_render_foil,
              o->overall_radius_mm * o->subtended_angle_deg * PI / 180)

static const fg_member foil_rows[] = {
    {FG_RANGE("root_centre_px", fg_render_foil, overall_centre_px.x, overall_centre_px.y),
     .present = has_beams, .words = "x, y of the middle of the line of the roots"},
    {FG_NUMBER("overall_radius_mm", fg_render_foil, overall_radius_mm), .present = has_circle,
     .words = "of the midline"},
    {FG_RANGE("overall_centre_px", fg_render_foil, overall_centre_px.x, overall_centre_px.y),
     .present = has_circle, .words = "x, y"},
    {FG_OBJECT("measurand", fg_render_foil, measurand, &overall_measurand_members),
     .present = has_circle,
     .words = "of the least-squares circle through the lands as they are, with the part's effects "
              "(ovality, spiral, curves); overall_radius_mm is of the ideal circle"},
    {FG_NUMBER("thickness_mm", fg_render_foil, thickness_mm), .words = "of the strip"},
    {FG_NUMBER("subtended_angle_deg", fg_render_foil, subtended_angle_deg), .present = is_plain_arc,
     .words = "of the arc"},
    {FG_NUMBER_BY("length_mm", find_arc_length), .present = is_plain_arc, .words = "of the arc"},
    {FG_NUMBER("rotate_deg", fg_render_foil, rotate_deg),
     .words = "direction of the foil's middle seen from its centre, or of the beams, from the "
              "scan's x axis"},
    {FG_FLAG("mirror", fg_render_foil, mirror),
     .words = "false: bump numbers rise clockwise as the scan is seen"},
    {FG_PART("design", find_design_of_foil, &design_members), .options = FG_MEMBER_NEVER_NULL},
    {FG_PART("nominal", find_design_of_foil, &nominal_members), .options = FG_MEMBER_NEVER_NULL,
     .present = has_bumps},
    {FG_LIST("bumps", fg_render_foil, bumps, bump_count, &bump_members), .present = has_bumps,
     .words = "without the missing ones"},
    {FG_LIST_BY("beams", find_beam, &beam_members), .present = has_beams,
     .words = "without the missing ones"},
};
static const fg_members foil_members = FG_MEMBERS(foil_rows);

static fg_subject find_only_foil(const fg_subject *s) {
  const fg_render_spec *spec = s->object;
  return (fg_subject){.object = spec->truth.foil_count == 1 ? spec->truth.foils : NULL,
                      .whole = spec};
}

FG_TRUE_CASE(has_many_foils, fg_render_spec, o->truth.foil_count > 1)
FG_TRUE_CASE(has_discs, fg_render_spec, o->truth.disc_count > 0)

static const fg_member disc_rows[] = {
    {FG_RANGE("centre_px", fg_render_disc, centre_px.x, centre_px.y), .words = "x, y"},
    {FG_NUMBER("radius_mm", fg_render_disc, radius_mm)},
    {FG_FLAG("hole", fg_render_disc, hole)},
};
static const fg_members disc_members = FG_MEMBERS(disc_rows);

static bool has_marks(const fg_subject *subject) {
  return ((const fg_render_spec *)subject->object)->truth.mark_count > 0;
}

static const fg_member mark_rows[] = {
    {FG_COUNT("grid", fg_render_mark, grid), .words = "from 1"},
    {FG_INTEGER("column", fg_render_mark, column)},
    {FG_INTEGER("row", fg_render_mark, row)},
    {FG_RANGE("centre_px", fg_render_mark, centre_px.x, centre_px.y),
     .words = "x, y, at its true place"},
};
static const fg_members mark_members = FG_MEMBERS(mark_rows);

/* The scan. One number where both axes agree. */
static void write_axes(fg_json *json, const char *name, const double value[2]) {
  if (value[0] == value[1])
    fg_json_number(json, name, value[0]);
  else
    fg_json_numbers(json, name, value, 2);
}

#define AXES_SCHEMA                                                                                \
  "{\"description\": \"x, y; one number where both agree\", \"anyOf\": [{\"type\": \"number\"}, "  \
  "{\"type\": \"array\", \"items\": {\"type\": \"number\"}, \"minItems\": 2, \"maxItems\": 2}]}"
#define AXES(function, field)                                                                      \
  static void function(fg_json *json, const char *name, const fg_subject *s) {                     \
    write_axes(json, name, ((const fg_render_spec *)s->object)->scanner.field);                    \
  }
AXES(write_dpi, dpi)
AXES(write_sensor_dpi, sensor_dpi)
AXES(write_blur, blur_px)

static const char *const resampled_words[] = {"bilinear", "bicubic", NULL},
                         *const way_words[] = {"-y", "+y", NULL},
                         *const roughness_words[] = {"gaussian", "exponential", NULL};

#define TRUE_WORD(function, expression)                                                            \
  static int function(const fg_subject *s) {                                                       \
    const fg_scanner *scanner = &((const fg_render_spec *)s->object)->scanner;                     \
    return (expression);                                                                           \
  }
TRUE_WORD(find_resampling, scanner->bicubic)
TRUE_WORD(find_way, scanner->one_sided_way >= 0)
TRUE_WORD(find_correlation_kind, scanner->edge_exponential)

FG_TRUE_CASE(is_resampled, fg_render_spec, !isnan(o->scanner.sensor_dpi[0]))
FG_TRUE_CASE(is_blur_turned, fg_render_spec, o->scanner.blur_angle_deg != 0)
FG_TRUE_CASE(has_shadow, fg_render_spec, o->scanner.shadow.amplitude != 0)
FG_TRUE_VALUE(find_width, fg_render_spec, (double)o->truth.width_px)
FG_TRUE_VALUE(find_height, fg_render_spec, (double)o->truth.height_px)
FG_TRUE_VALUE(find_bits, fg_render_spec, o->scanner.bits)
FG_TRUE_VALUE(find_seed, fg_render_spec, (double)o->seed)

static const fg_member shadow_rows[] = {
    {FG_NUMBER("amplitude", fg_shadow, amplitude), .words = "of the contrast; negative: darker"},
    {FG_NUMBER("direction_deg", fg_shadow, direction_deg), .words = "of the edges' normal"},
    {FG_NUMBER("width_deg", fg_shadow, width_deg), .words = "of the sector of directions"},
    {FG_NUMBER("length_px", fg_shadow, length_px)},
    {FG_NUMBER("gap_px", fg_shadow, gap_px)},
};
static const fg_members shadow_members = FG_MEMBERS(shadow_rows);

static const fg_member mask_rows[] = {
    {FG_NUMBER("amount_pct", fg_unsharp_mask, amount_pct)},
    {FG_NUMBER("radius_px", fg_unsharp_mask, radius_px), .words = "sd of the Gaussian"},
    {FG_NUMBER("threshold", fg_unsharp_mask, threshold), .words = "counts of 8 bit"},
};
static const fg_members mask_members = FG_MEMBERS(mask_rows);

static const double *list_tone_point(const fg_subject *s, double *pair, size_t *count) {
  const fg_tone_curve *tone = s->object;
  return fg_truth_pair(pair, count, tone->in[s->index], tone->out[s->index]);
}

static const fg_member tone_rows[] = FG_TRUTH_PAIR(list_tone_point);
static const fg_members tone_members = FG_MEMBERS(tone_rows);

static bool find_tone_point(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_driver_settings *driver = list->object;
  element->object = &driver->tone;
  return i < driver->tone.count;
}

FG_TRUE_VALUE(find_tone_bits, fg_driver_settings, o->tone.bits)
FG_TRUE_VALUE(find_levels, fg_driver_settings, o->levels)
FG_TRUE_CASE(has_tone_bits, fg_driver_settings, o->tone.count && o->tone.bits)
FG_TRUE_CASE(has_mask, fg_driver_settings, o->unsharp.amount_pct > 0)
FG_TRUE_CASE(has_levels, fg_driver_settings, o->levels != 0)

static const fg_member driver_rows[] = {
    {FG_LIST_BY("tone_curve", find_tone_point, &tone_members), .options = FG_MEMBER_LEFT_OUT,
     .words = "in, out: counts of 8 bit"},
    {FG_NUMBER_BY("tone_bits", find_tone_bits), .present = has_tone_bits,
     .words = "of the curve's input"},
    {FG_OBJECT("unsharp_mask", fg_driver_settings, unsharp, &mask_members), .present = has_mask},
    {FG_NUMBER_BY("levels", find_levels), .present = has_levels, .words = "of gray"},
    {FG_NUMBER("threshold", fg_driver_settings, threshold), .options = FG_MEMBER_LEFT_OUT,
     .words = "between two levels, where it is not half way"},
};
static const fg_members driver_members = FG_MEMBERS(driver_rows);

#define SCANNER(name) FG_NUMBER(#name, fg_render_spec, scanner.name)

static const fg_member scan_rows[] = {
    {FG_WRITTEN("dpi", write_dpi, AXES_SCHEMA)},
    {FG_WRITTEN("resampled_from_dpi", write_sensor_dpi, AXES_SCHEMA), .present = is_resampled},
    {FG_WORD_BY("resampled_by", find_resampling, resampled_words), .present = is_resampled,
     .options = FG_MEMBER_NEVER_NULL, .words = "the driver"},
    {FG_NUMBER_BY("width", find_width), .words = "pixels"},
    {FG_NUMBER_BY("height", find_height), .words = "pixels"},
    {FG_NUMBER_BY("bits", find_bits), .words = "of a pixel's channel"},
    {FG_WRITTEN("blur_px", write_blur, AXES_SCHEMA)},
    {SCANNER(blur_angle_deg), .present = is_blur_turned, .words = "of its first axis, from x to y"},
    {SCANNER(motion_blur_px), .words = "along y"},
    {SCANNER(background)},
    {SCANNER(contrast)},
    {SCANNER(gamma)},
    {SCANNER(noise), .words = "sd, counts of 8 bit"},
    {SCANNER(noise_correlation)},
    {SCANNER(one_sided_blur_px)},
    {FG_WORD_BY("one_sided_way", find_way, way_words), .options = FG_MEMBER_NEVER_NULL,
     .words = "of the carriage"},
    {SCANNER(edge_roughness_um), .words = "sd of each edge"},
    {SCANNER(edge_common_um), .words = "sd of what both edges have in common"},
    {FG_NUMBER("correlation_um", fg_render_spec, scanner.edge_correlation_um),
     .words = "length of the roughness"},
    {FG_WORD_BY("correlation_form", find_correlation_kind, roughness_words),
     .options = FG_MEMBER_NEVER_NULL, .words = "autocorrelation of the roughness"},
    {SCANNER(halo_fraction)},
    {FG_NUMBER("side_wall_amplitude", fg_render_spec, scanner.wall_amplitude)},
    {FG_OBJECT("shadow", fg_render_spec, scanner.shadow, &shadow_members), .present = has_shadow},
    {FG_SAME(&driver_members), .offset = offsetof(fg_render_spec, scanner.driver)},
    {FG_NUMBER_BY("seed", find_seed)},
};
static const fg_members scan_members = FG_MEMBERS(scan_rows);

static const char *find_schema(const fg_subject *s, char *buffer) {
  (void)s, (void)buffer;
  return "foilgauge/truth/1";
}

FG_TRUE_CASE(has_colour_lines, fg_render_spec, o->scanner.colour.stated)

static const fg_member truth_rows[] = {
    {FG_TEXT_BY("schema", find_schema), .schema = "{\"const\": \"foilgauge/truth/1\"}"},
    {FG_SAME(&foil_members), .part = find_only_foil},
    {FG_LIST("foils", fg_render_spec, truth.foils, truth.foil_count, &foil_members),
     .present = has_many_foils, .words = "where there are several"},
    {FG_LIST("discs", fg_render_spec, truth.discs, truth.disc_count, &disc_members),
     .present = has_discs},
    {FG_LIST("marks", fg_render_spec, truth.marks, truth.mark_count, &mark_members),
     .present = has_marks, .options = FG_MEMBER_ON_LINE, .words = "of all grids"},
    {FG_GROUP("scan", &scan_members)},
    {FG_LIST_BY("effects", fg_truth_effect_at, &fg_truth_effect_members),
     .words = "under the names of the loop's reports; lost rows, stitches and seams last"},
    {FG_GROUP("colour_lines", &fg_truth_colour_members), .present = has_colour_lines,
     .words = "of a colour sensor, against green"},
};
static const fg_members truth_members = FG_MEMBERS(truth_rows);

const fg_document fg_render_truth_document = {
    .file = "truth",
    .title = "foilgauge truth of a render",
    .description = "What a rendered scan shows. Units are in the names; pixels are those of the "
                   "finished picture, x to the right, y down. Numbers lose no digit.",
    .made_by = "`foilgauge render -t`",
    .members = &truth_members,
};

/* Writes the truth without a newline at its end. */
static void write_truth(const fg_render_spec *spec, FILE *out) {
  fg_json json;
  fg_json_begin(&json, out);
  json.exact = true;
  fg_json_object(&json, NULL);
  fg_members_json(&json, &truth_members, &(fg_subject){.object = spec, .whole = spec});
  fg_json_object_end(&json);
}

/* The stream in memory reports a failed allocation only at its end. */
fg_status fg_render_truth_json(fg_context *ctx, const fg_render_spec *spec, char **json) {
  size_t length;
  *json = NULL;
  FILE *out = fg_stream_open(json, &length);
  if (!out) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the truth");
  write_truth(spec, out);
  if (fg_stream_keep(out, json)) return FG_OK;
  return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the truth");
}
