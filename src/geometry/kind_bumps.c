/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Foils with bumps, classical and sinusoidal: what follows from a design (thesis eq 5.1 to 5.8). */
#include <math.h>
#include <stdio.h>

#include "geometry/foil_kind.h"

static const double rad_per_deg = 3.14159265358979323846 / 180;

static fg_status check_values(fg_context *ctx, const fg_design *design) {
  const struct {
    const char *member;
    double value;
  } values[] = {
      {"bump_radius_mm", design->bumps.radius_mm},
      {"bump_angle_deg", design->bumps.angle_deg},
      {"overall_radius_mm", design->overall_radius_mm},
      {"sleeve_radius_mm", design->bumps.sleeve_radius_mm},
      {"pitch_deg", design->bumps.pitch_deg},
      {"fillet_radius_mm", design->bumps.fillet_radius_mm},
      {"thickness_mm", design->thickness_mm},
      {"rotor_diameter_mm", design->bumps.rotor_diameter_mm},
  };
  for (size_t i = 0; i < sizeof values / sizeof *values; i++)
    FG_TRY(fg_design_check_positive(ctx, values[i].member, values[i].value));
  return FG_OK;
}

static double half_chord(const fg_design *design) {
  return design->bumps.radius_mm * sin(design->bumps.angle_deg * rad_per_deg / 2);
}

/* From cos(alpha/2) = (X² + R² - R0²) / (2 X R): the farther of the two roots, for which the bump's
 * centre lies outside the foil and its arc bulges towards O. */
static double centre_to_centre(const fg_design *design) {
  double reach = design->bumps.radius_mm * cos(design->bumps.angle_deg * rad_per_deg / 2);
  double chord = half_chord(design), overall = design->overall_radius_mm;
  return reach + sqrt((overall - chord) * (overall + chord));
}

/* Angle about O from a bump's middle to where its fillet runs out on the land. The fillet's circle
 * (radius r) touches the overall circle from inside and the bump's from outside, so its centre is
 * R0 - r from O and R + r from C: the law of cosines in that triangle. NaN: no such fillet. */
static double half_width_rad(const fg_design *design) {
  double x = centre_to_centre(design), fillet = design->bumps.fillet_radius_mm;
  double from_o = design->overall_radius_mm - fillet, from_c = design->bumps.radius_mm + fillet;
  return acos((from_o * from_o + x * x - from_c * from_c) / (2 * from_o * x));
}

static fg_status check_bump(fg_context *ctx, const fg_design *design) {
  if (design->bumps.angle_deg >= 180)
    return fg_fail(ctx, FG_ERR_DATA,
                   "bump_angle_deg is %g; a bump is less than a half circle (180)",
                   design->bumps.angle_deg);
  if (design->bumps.radius_mm >= design->overall_radius_mm)
    return fg_fail(ctx, FG_ERR_DATA, "bump_radius_mm is %g; it must be below overall_radius_mm %g",
                   design->bumps.radius_mm, design->overall_radius_mm);
  if (half_chord(design) >= design->overall_radius_mm)
    return fg_fail(ctx, FG_ERR_DATA,
                   "bump_angle_deg is %g: a bump of bump_radius_mm %g and this angle cannot meet "
                   "overall_radius_mm %g",
                   design->bumps.angle_deg, design->bumps.radius_mm, design->overall_radius_mm);
  return FG_OK;
}

static fg_status check_pitch(fg_context *ctx, const fg_design *design) {
  double min_deg = 2 * half_width_rad(design) / rad_per_deg;
  if (!(design->bumps.fillet_radius_mm < design->overall_radius_mm) || !isfinite(min_deg))
    return fg_fail(ctx, FG_ERR_DATA,
                   "fillet_radius_mm is %g; no such fillet fits between the bump and the land",
                   design->bumps.fillet_radius_mm);
  if (min_deg >= design->bumps.pitch_deg)
    return fg_fail(ctx, FG_ERR_DATA,
                   "pitch_deg is %g: bumps overlap; with their fillets they need more than %.4g",
                   design->bumps.pitch_deg, min_deg);
  if ((double)design->bumps.count * design->bumps.pitch_deg > 360 * (1 + 1e-6))
    return fg_fail(ctx, FG_ERR_DATA, "bump_count is %zu: at pitch_deg %g they exceed 360 degrees",
                   design->bumps.count, design->bumps.pitch_deg);
  return FG_OK;
}

/* Strip and bearing: the quantities that no bump has. */
static fg_status check_bearing(fg_context *ctx, const fg_design *design) {
  if (design->thickness_mm >= design->bumps.radius_mm)
    return fg_fail(ctx, FG_ERR_DATA, "thickness_mm is %g; it must be below bump_radius_mm %g",
                   design->thickness_mm, design->bumps.radius_mm);
  if (design->bumps.rotor_diameter_mm / 2 >= design->bumps.sleeve_radius_mm)
    return fg_fail(ctx, FG_ERR_DATA,
                   "rotor_diameter_mm is %g; it must be below twice sleeve_radius_mm %g",
                   design->bumps.rotor_diameter_mm, design->bumps.sleeve_radius_mm);
  return FG_OK;
}

/* With a top foil a design must leave the rotor room: a relative clearance error over a nominal
 * clearance of 0 or less says nothing. */
static fg_status check_top_foil(fg_context *ctx, const fg_design *design) {
  double top = design->bumps.top_foil_thickness_mm;
  if (!isfinite(top) || top < 0)
    return fg_fail(ctx, FG_ERR_DATA,
                   "top_foil_thickness_mm is %g; it must be a number above 0, or 0 for none", top);
  double height =
      design->bumps.radius_mm - (centre_to_centre(design) - design->bumps.sleeve_radius_mm);
  double clearance = fg_design_clearance(design, height);
  if (top == 0 || clearance > 0) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "top_foil_thickness_mm is %g: between the bumps and rotor_diameter_mm %g are "
                 "%.4g mm only, which leaves no clearance; the rotor must be below %.6g",
                 top, design->bumps.rotor_diameter_mm, clearance + top,
                 design->bumps.rotor_diameter_mm + 2 * clearance);
}

static fg_status check_bumps(fg_context *ctx, const fg_design *design) {
  FG_TRY(check_values(ctx, design));
  FG_TRY(check_bump(ctx, design));
  FG_TRY(check_pitch(ctx, design));
  FG_TRY(check_bearing(ctx, design));
  return check_top_foil(ctx, design);
}

static void derive_bumps(const fg_design *design, fg_nominal *nominal) {
  double radius = design->bumps.radius_mm, overall = design->overall_radius_mm;
  double alpha_rad = design->bumps.angle_deg * rad_per_deg;
  double x = centre_to_centre(design);
  double cosine = (x * x - radius * radius - overall * overall) / (2 * radius * overall);
  nominal->centre_to_centre_mm = x;
  nominal->half_chord_mm = half_chord(design);
  nominal->arc_length_mm = alpha_rad * radius;
  nominal->intersection_angle_deg = acos(cosine) / rad_per_deg;
  nominal->height_mm = radius - (x - design->bumps.sleeve_radius_mm);
  nominal->die_height_mm = design->thickness_mm + radius - radius * cos(alpha_rad / 2);
  nominal->clearance_mm = fg_design_clearance(design, nominal->height_mm);
}

double fg_design_clearance_over(const fg_design *design, double height_mm, double thickness_mm) {
  return design->bumps.sleeve_radius_mm - height_mm - design->bumps.rotor_diameter_mm / 2 -
         thickness_mm - design->bumps.top_foil_thickness_mm;
}

double fg_design_clearance(const fg_design *design, double height_mm) {
  return fg_design_clearance_over(design, height_mm, design->thickness_mm);
}

/* M = sqrt(X_m² + R² - 2 X_m R cos phi), phi = alpha_m / 2, written as (X_m - R)² +
 * 4 X_m R sin²(phi/2). With alpha_m R constant, d phi / dR = -phi / R and d X_m / dR = 1:
 * M dM/dR = (X_m + R)(1 - cos phi) - X_m phi sin phi. */
void fg_design_springback(const fg_design *design, const fg_nominal *nominal, double radius_mm,
                          fg_springback *model) {
  double angle_deg = design->bumps.angle_deg * design->bumps.radius_mm / radius_mm;
  double x = nominal->centre_to_centre_mm + (radius_mm - design->bumps.radius_mm);
  double phi = angle_deg * rad_per_deg / 2, half_sine = sin(phi / 2);
  double crown = x - radius_mm;
  double foot = sqrt(crown * crown + 4 * x * radius_mm * half_sine * half_sine);
  model->bump_angle_deg = angle_deg;
  model->bump_angle_slope = -angle_deg / radius_mm;
  model->height_mm = nominal->height_mm - (design->bumps.sleeve_radius_mm - foot);
  model->height_slope = ((x + radius_mm) * 2 * half_sine * half_sine - x * phi * sin(phi)) / foot;
  model->clearance_mm = fg_design_clearance(design, model->height_mm);
}

/* The smallest object is this share of a bump's radius. */
#define OBJECT_MIN 1.0

static double min_bump_mm(const fg_design *design) {
  return OBJECT_MIN * design->bumps.radius_mm;
}

static size_t stated_bumps(const fg_design *design) {
  return design->bumps.count;
}

enum {
  REFUSED = 1u << FG_DESIGN_BEAMS | 1u << FG_DESIGN_DISCS | 1u << FG_DESIGN_ARC,
  OWNERS = 1u << FG_QUANTITY_OF_FOIL | 1u << FG_QUANTITY_OF_BUMP | 1u << FG_QUANTITY_OF_DISC |
           1u << FG_QUANTITY_OF_STRIP | 1u << FG_QUANTITY_OF_BEARING
};

const fg_foil_row fg_foil_kind_classical = {
    .traits =
        {
            .name = "classical",
            .noun = "a foil with bumps",
            .has_lip = true,
            .group = FG_DESIGN_BUMPS,
            .refused = REFUSED,
            .built_in = true,
            .is_foil = true,
            .has_bumps = true,
            .part = FG_QUANTITY_OF_BUMP,
            .owners = OWNERS,
            .foil_not = FG_QUANTITY_OF_ARC,
            .parts_file = "bumps.csv",
        },
    .stated_parts = stated_bumps,
    .check = check_bumps,
    .derive = derive_bumps,
    .min_object_mm = min_bump_mm,
    .lay_out = fg_foil_lay_out_bumps,
    .fill = fg_foil_fill_bumps,
};

const fg_foil_row fg_foil_kind_sinusoidal = {
    .traits =
        {
            .name = "sinusoidal",
            .noun = "a foil with bumps",
            .stiffness_note =
                "The model is the classical bump's: a circular arch on its two feet. The long "
                "fillets of "
                "these sinusoidal foils bend too, and are not in it: these bumps are softer.",
            .group = FG_DESIGN_BUMPS,
            .refused = REFUSED,
            .built_in = true,
            .is_foil = true,
            .has_bumps = true,
            .part = FG_QUANTITY_OF_BUMP,
            .owners = OWNERS,
            .foil_not = FG_QUANTITY_OF_ARC,
            .parts_file = "bumps.csv",
        },
    .stated_parts = stated_bumps,
    .check = check_bumps,
    .derive = derive_bumps,
    .min_object_mm = min_bump_mm,
    .lay_out = fg_foil_lay_out_bumps,
    .fill = fg_foil_fill_bumps,
};
