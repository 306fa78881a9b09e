/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/design.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double rad_per_deg = 3.14159265358979323846 / 180;

void fg_design_default(fg_design *design) {
  *design = (fg_design){
      .name = "gen2-classical",
      .kind = FG_FOIL_CLASSICAL,
      .datum = FG_DATUM_MID,
      .bump_count = 9,
      .bump_radius_mm = 3.32,
      .bump_angle_deg = 63.15,
      .overall_radius_mm = 20.73,
      .sleeve_radius_mm = 20.73,
      .pitch_deg = 40.0 / 3,
      .fillet_radius_mm = 0.35,
      .thickness_mm = 0.1,
      .rotor_diameter_mm = 40,
  };
}

static fg_status check_positive(fg_context *ctx, const char *member, double value) {
  if (isfinite(value) && value > 0) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA, "%s is %g; it must be a number above 0", member, value);
}

static fg_status check_values(fg_context *ctx, const fg_design *design) {
  const struct {
    const char *member;
    double value;
  } values[] = {
      {"bump_radius_mm", design->bump_radius_mm},
      {"bump_angle_deg", design->bump_angle_deg},
      {"overall_radius_mm", design->overall_radius_mm},
      {"sleeve_radius_mm", design->sleeve_radius_mm},
      {"pitch_deg", design->pitch_deg},
      {"fillet_radius_mm", design->fillet_radius_mm},
      {"thickness_mm", design->thickness_mm},
      {"rotor_diameter_mm", design->rotor_diameter_mm},
  };
  for (size_t i = 0; i < sizeof values / sizeof *values; i++)
    FG_TRY(check_positive(ctx, values[i].member, values[i].value));
  return FG_OK;
}

static double half_chord(const fg_design *design) {
  return design->bump_radius_mm * sin(design->bump_angle_deg * rad_per_deg / 2);
}

/* From cos(alpha/2) = (X² + R² - R0²) / (2 X R): the farther of the two roots, for which the bump's
 * centre lies outside the foil and its arc bulges towards O. */
static double centre_to_centre(const fg_design *design) {
  double reach = design->bump_radius_mm * cos(design->bump_angle_deg * rad_per_deg / 2);
  double chord = half_chord(design), overall = design->overall_radius_mm;
  return reach + sqrt((overall - chord) * (overall + chord));
}

/* Angle about O from a bump's middle to where its fillet runs out on the land. The fillet's circle
 * (radius r) touches the overall circle from inside and the bump's from outside, so its centre is
 * R0 - r from O and R + r from C: the law of cosines in that triangle. NaN: no such fillet. */
static double half_width_rad(const fg_design *design) {
  double x = centre_to_centre(design), fillet = design->fillet_radius_mm;
  double from_o = design->overall_radius_mm - fillet, from_c = design->bump_radius_mm + fillet;
  return acos((from_o * from_o + x * x - from_c * from_c) / (2 * from_o * x));
}

static fg_status check_bump(fg_context *ctx, const fg_design *design) {
  if (design->bump_angle_deg >= 180)
    return fg_fail(ctx, FG_ERR_DATA,
                   "bump_angle_deg is %g; a bump is less than a half circle (180)",
                   design->bump_angle_deg);
  if (design->bump_radius_mm >= design->overall_radius_mm)
    return fg_fail(ctx, FG_ERR_DATA, "bump_radius_mm is %g; it must be below overall_radius_mm %g",
                   design->bump_radius_mm, design->overall_radius_mm);
  if (half_chord(design) >= design->overall_radius_mm)
    return fg_fail(ctx, FG_ERR_DATA,
                   "bump_angle_deg is %g: a bump of bump_radius_mm %g and this angle cannot meet "
                   "overall_radius_mm %g",
                   design->bump_angle_deg, design->bump_radius_mm, design->overall_radius_mm);
  return FG_OK;
}

static fg_status check_pitch(fg_context *ctx, const fg_design *design) {
  double min_deg = 2 * half_width_rad(design) / rad_per_deg;
  if (!(design->fillet_radius_mm < design->overall_radius_mm) || !isfinite(min_deg))
    return fg_fail(ctx, FG_ERR_DATA,
                   "fillet_radius_mm is %g; no such fillet fits between the bump and the land",
                   design->fillet_radius_mm);
  if (min_deg >= design->pitch_deg)
    return fg_fail(ctx, FG_ERR_DATA,
                   "pitch_deg is %g: bumps overlap; with their fillets they need more than %.4g",
                   design->pitch_deg, min_deg);
  if ((double)design->bump_count * design->pitch_deg > 360 * (1 + 1e-6))
    return fg_fail(ctx, FG_ERR_DATA, "bump_count is %zu: at pitch_deg %g they exceed 360 degrees",
                   design->bump_count, design->pitch_deg);
  return FG_OK;
}

/* Strip and bearing: what has no place. */
static fg_status check_bearing(fg_context *ctx, const fg_design *design) {
  if (design->thickness_mm >= design->bump_radius_mm)
    return fg_fail(ctx, FG_ERR_DATA, "thickness_mm is %g; it must be below bump_radius_mm %g",
                   design->thickness_mm, design->bump_radius_mm);
  if (design->rotor_diameter_mm / 2 >= design->sleeve_radius_mm)
    return fg_fail(ctx, FG_ERR_DATA,
                   "rotor_diameter_mm is %g; it must be below twice sleeve_radius_mm %g",
                   design->rotor_diameter_mm, design->sleeve_radius_mm);
  return FG_OK;
}

/* With a top foil a design must leave the rotor room: a relative clearance error over a nominal
 * clearance of 0 or less says nothing. */
static fg_status check_top_foil(fg_context *ctx, const fg_design *design) {
  double top = design->top_foil_thickness_mm;
  if (!isfinite(top) || top < 0)
    return fg_fail(ctx, FG_ERR_DATA,
                   "top_foil_thickness_mm is %g; it must be a number above 0, or 0 for none", top);
  double height = design->bump_radius_mm - (centre_to_centre(design) - design->sleeve_radius_mm);
  double clearance = fg_design_clearance(design, height);
  if (top == 0 || clearance > 0) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "top_foil_thickness_mm is %g: between the bumps and rotor_diameter_mm %g are "
                 "%.4g mm only, which leaves no clearance; the rotor must be below %.6g",
                 top, design->rotor_diameter_mm, clearance + top,
                 design->rotor_diameter_mm + 2 * clearance);
}

/* A thickness this many times the design's, or its inverse, is in another unit. */
static const double thickness_times = 10;

/* 0: not stated. The scan of what lies flat, or is round, shows no thickness. */
static fg_status check_thickness_measured(fg_context *ctx, const fg_design *design) {
  static const char *const name = "thickness_measured";
  double value = design->thickness_measured_mm, u = design->u_thickness_measured_mm;
  if (value == 0 && u == 0) return FG_OK;
  if (design->kind == FG_FOIL_CANTILEVER)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s belongs to strips that are seen from their edge; of form \"cantilever\" "
                   "state thickness_mm and u_thickness_mm",
                   name);
  if (design->kind == FG_FOIL_DISCS)
    return fg_fail(ctx, FG_ERR_DATA, "%s belongs to strips; form is \"discs\"", name);
  if (!(value > 0) || !isfinite(value))
    return fg_fail(ctx, FG_ERR_DATA, "%s.value_mm is %g; it must be a number above 0, in mm", name,
                   value);
  if (design->thickness_mm > 0 && fabs(log(value / design->thickness_mm)) > log(thickness_times))
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s.value_mm is %g, and thickness_mm %g: is it in mm? 100 µm is 0.1 mm", name,
                   value, design->thickness_mm);
  if (!(u > 0 && u < value / 2))
    return fg_fail(ctx, FG_ERR_DATA,
                   "%s.u_mm is %g; a standard uncertainty, in mm, must be above 0, as no "
                   "micrometer is exact, and below half of the value %g",
                   name, u, value);
  return FG_OK;
}
/* A width that is known no better is no gauge. */
#define U_DIAMETERS_MAX_MM 0.1

static fg_status check_discs(fg_context *ctx, const fg_design *design) {
  if (design->diameter_count > FG_DIAMETERS_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "diameters_mm has %zu values; at most %d",
                   design->diameter_count, FG_DIAMETERS_MAX);
  for (size_t i = 0; i < design->diameter_count; i++) {
    char member[48];
    snprintf(member, sizeof member, "diameters_mm[%zu]", i);
    FG_TRY(check_positive(ctx, member, design->diameters_mm[i]));
  }
  if (!(design->u_diameters_mm >= 0 && design->u_diameters_mm <= U_DIAMETERS_MAX_MM))
    return fg_fail(ctx, FG_ERR_DATA, "u_diameters_mm is %g; it must be from 0 to %g mm",
                   design->u_diameters_mm, U_DIAMETERS_MAX_MM);
  return FG_OK;
}

static fg_status check_arc(fg_context *ctx, const fg_design *design) {
  double radius = design->overall_radius_mm, angle = design->subtended_angle_deg;
  FG_TRY(check_positive(ctx, "overall_radius_mm", radius));
  FG_TRY(check_positive(ctx, "thickness_mm", design->thickness_mm));
  FG_TRY(check_positive(ctx, "subtended_angle_deg", angle));
  if (angle >= 360)
    return fg_fail(
        ctx, FG_ERR_DATA,
        "subtended_angle_deg is %g; a strip with two ends has less than a full turn (360)", angle);
  if (design->thickness_mm >= radius)
    return fg_fail(ctx, FG_ERR_DATA, "thickness_mm is %g; it must be below overall_radius_mm %g",
                   design->thickness_mm, radius);
  if (design->top_foil_thickness_mm != 0)
    return fg_fail(
        ctx, FG_ERR_DATA,
        "top_foil_thickness_mm belongs to a foil with bumps; this one's is thickness_mm");
  return FG_OK;
}

/* 0: not stated. */
static fg_status check_stated(fg_context *ctx, const char *member, double value) {
  return value == 0 ? FG_OK : check_positive(ctx, member, value);
}

/* Eq 5.10 is that of a slender beam of a thin sheet; s goes with L² while the beam's arc is flat.
 */
static fg_status check_slender(fg_context *ctx, const fg_design *design) {
  double length = design->beam_length_mm, width = design->beam_width_mm;
  if (width >= length)
    return fg_fail(ctx, FG_ERR_DATA,
                   "beam_width_mm is %g; it must be below beam_length_mm %g: L is from the root "
                   "to the free end, and eq 5.10 is that of a beam",
                   width, length);
  if (design->thickness_mm >= width)
    return fg_fail(ctx, FG_ERR_DATA, "thickness_mm is %g; it must be below beam_width_mm %g",
                   design->thickness_mm, width);
  if (design->sagitta_mm >= length / 2)
    return fg_fail(ctx, FG_ERR_DATA,
                   "sagitta_mm is %g; it must be below half of beam_length_mm %g: it goes with the "
                   "square of the length of flat arcs only",
                   design->sagitta_mm, length);
  if (design->u_thickness_mm >= design->thickness_mm / 2)
    return fg_fail(ctx, FG_ERR_DATA,
                   "u_thickness_mm is %g; a standard uncertainty must be below half of "
                   "thickness_mm %g",
                   design->u_thickness_mm, design->thickness_mm);
  return FG_OK;
}

static fg_status check_cantilever(fg_context *ctx, const fg_design *design) {
  FG_TRY(check_positive(ctx, "beam_length_mm", design->beam_length_mm));
  FG_TRY(check_positive(ctx, "beam_width_mm", design->beam_width_mm));
  FG_TRY(check_positive(ctx, "thickness_mm", design->thickness_mm));
  FG_TRY(check_stated(ctx, "u_thickness_mm", design->u_thickness_mm));
  FG_TRY(check_stated(ctx, "sagitta_mm", design->sagitta_mm));
  FG_TRY(check_stated(ctx, "elastic_modulus_gpa", design->elastic_modulus_gpa));
  FG_TRY(check_stated(ctx, "clearance_mm", design->clearance_mm));
  if (design->clearance_mm != 0 && design->sagitta_mm == 0)
    return fg_fail(ctx, FG_ERR_DATA,
                   "clearance_mm is %g without sagitta_mm: the clearance changes by what the "
                   "sagitta does; state both",
                   design->clearance_mm);
  return check_slender(ctx, design);
}

/* What a cantilever alone has. */
static fg_status check_no_beams(fg_context *ctx, const fg_design *design) {
  const struct {
    const char *member;
    double value;
  } values[] = {
      {"beam_count", (double)design->beam_count},
      {"beam_length_mm", design->beam_length_mm},
      {"beam_width_mm", design->beam_width_mm},
      {"u_thickness_mm", design->u_thickness_mm},
      {"sagitta_mm", design->sagitta_mm},
      {"elastic_modulus_gpa", design->elastic_modulus_gpa},
      {"clearance_mm", design->clearance_mm},
  };
  for (size_t i = 0; i < sizeof values / sizeof *values; i++)
    if (values[i].value != 0)
      return fg_fail(ctx, FG_ERR_DATA, "%s belongs to form \"cantilever\" only", values[i].member);
  return FG_OK;
}

static fg_status check_tolerances(fg_context *ctx, const fg_design *design) {
  if (design->tolerance_count > FG_TOLERANCES_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "tolerances has %zu entries; at most %d",
                   design->tolerance_count, FG_TOLERANCES_MAX);
  for (size_t i = 0; i < design->tolerance_count; i++) {
    const fg_tolerance *t = &design->tolerances[i];
    if (!(t->lower <= t->upper))
      return fg_fail(ctx, FG_ERR_DATA, "tolerances.%.47s: min %g is above max %g", t->quantity,
                     t->lower, t->upper);
  }
  return FG_OK;
}

static fg_status check_gauges(fg_context *ctx, const fg_design *design) {
  if (design->gauge_count > FG_GAUGES_MAX)
    return fg_fail(ctx, FG_ERR_DATA, "gauges has %zu entries; at most %d", design->gauge_count,
                   FG_GAUGES_MAX);
  if (design->gauge_count && design->kind == FG_FOIL_CANTILEVER)
    return fg_fail(ctx, FG_ERR_DATA,
                   "gauges: a gauge on the glass is not sought beside flat foils, form "
                   "\"cantilever\": leave it out");
  for (size_t i = 0; i < design->gauge_count; i++) {
    char name[48];
    snprintf(name, sizeof name, "gauges[%zu]", i);
    FG_TRY(fg_gauge_check(ctx, name, &design->gauges[i]));
  }
  return FG_OK;
}

fg_status fg_design_check(fg_context *ctx, const fg_design *design) {
  FG_TRY(check_tolerances(ctx, design));
  FG_TRY(fg_calibration_check(ctx, &design->calibration));
  FG_TRY(check_thickness_measured(ctx, design));
  FG_TRY(check_gauges(ctx, design));
  if (design->kind != FG_FOIL_CANTILEVER) FG_TRY(check_no_beams(ctx, design));
  if (design->kind == FG_FOIL_DISCS) return check_discs(ctx, design);
  if (design->diameter_count != 0 || design->u_diameters_mm != 0)
    return fg_fail(ctx, FG_ERR_DATA, "diameters_mm belongs to form \"discs\" only");
  if (design->kind == FG_FOIL_ARC) return check_arc(ctx, design);
  if (design->subtended_angle_deg != 0)
    return fg_fail(ctx, FG_ERR_DATA, "subtended_angle_deg belongs to form \"arc\" only");
  if (design->kind == FG_FOIL_CANTILEVER) return check_cantilever(ctx, design);
  FG_TRY(check_values(ctx, design));
  FG_TRY(check_bump(ctx, design));
  FG_TRY(check_pitch(ctx, design));
  FG_TRY(check_bearing(ctx, design));
  return check_top_foil(ctx, design);
}

static fg_nominal no_nominal(void) {
  return (fg_nominal){NAN, NAN, NAN, NAN, NAN, NAN, NAN};
}

fg_status fg_design_derive(fg_context *ctx, const fg_design *design, fg_nominal *nominal) {
  FG_TRY(fg_design_check(ctx, design));
  *nominal = no_nominal();
  if (design->kind == FG_FOIL_DISCS || design->kind == FG_FOIL_CANTILEVER) return FG_OK;
  if (design->kind == FG_FOIL_ARC) {
    nominal->arc_length_mm = design->subtended_angle_deg * rad_per_deg * design->overall_radius_mm;
    return FG_OK;
  }
  double radius = design->bump_radius_mm, overall = design->overall_radius_mm;
  double alpha_rad = design->bump_angle_deg * rad_per_deg;
  double x = centre_to_centre(design);
  double cosine = (x * x - radius * radius - overall * overall) / (2 * radius * overall);
  nominal->centre_to_centre_mm = x;
  nominal->half_chord_mm = half_chord(design);
  nominal->arc_length_mm = alpha_rad * radius;
  nominal->intersection_angle_deg = acos(cosine) / rad_per_deg;
  nominal->height_mm = radius - (x - design->sleeve_radius_mm);
  nominal->die_height_mm = design->thickness_mm + radius - radius * cos(alpha_rad / 2);
  nominal->clearance_mm = fg_design_clearance(design, nominal->height_mm);
  return FG_OK;
}

double fg_design_clearance_over(const fg_design *design, double height_mm, double thickness_mm) {
  return design->sleeve_radius_mm - height_mm - design->rotor_diameter_mm / 2 - thickness_mm -
         design->top_foil_thickness_mm;
}

double fg_design_clearance(const fg_design *design, double height_mm) {
  return fg_design_clearance_over(design, height_mm, design->thickness_mm);
}

/* M = sqrt(X_m² + R² - 2 X_m R cos phi), phi = alpha_m / 2, written as (X_m - R)² +
 * 4 X_m R sin²(phi/2). With alpha_m R constant, d phi / dR = -phi / R and d X_m / dR = 1:
 * M dM/dR = (X_m + R)(1 - cos phi) - X_m phi sin phi. */
void fg_design_springback(const fg_design *design, const fg_nominal *nominal, double radius_mm,
                          fg_springback *model) {
  double angle_deg = design->bump_angle_deg * design->bump_radius_mm / radius_mm;
  double x = nominal->centre_to_centre_mm + (radius_mm - design->bump_radius_mm);
  double phi = angle_deg * rad_per_deg / 2, half_sine = sin(phi / 2);
  double crown = x - radius_mm;
  double foot = sqrt(crown * crown + 4 * x * radius_mm * half_sine * half_sine);
  model->bump_angle_deg = angle_deg;
  model->bump_angle_slope = -angle_deg / radius_mm;
  model->height_mm = nominal->height_mm - (design->sleeve_radius_mm - foot);
  model->height_slope = ((x + radius_mm) * 2 * half_sine * half_sine - x * phi * sin(phi)) / foot;
  model->clearance_mm = fg_design_clearance(design, model->height_mm);
}
