/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quantities of a bump. Values and gradients: geometry/derive.c. */
#include <math.h>
#include <stddef.h>

#include "quantity/rows.h"

enum {
  EDGES = FG_QUANTITY_BETWEEN_EDGES,
  DATUM = FG_QUANTITY_OF_DATUM,
  PAGE = FG_QUANTITY_ON_PAGE,
  TERMINAL = FG_QUANTITY_ON_TERMINAL,
  PICTURE = FG_QUANTITY_ON_PICTURE,
  LOT = FG_QUANTITY_IN_LOT,
  CAUSE = FG_QUANTITY_IS_CAUSE,
  OWN = FG_QUANTITY_IS_OWN,
};

static double radius_of(const fg_design *design, const fg_nominal *nominal) {
  (void)nominal;
  return design->bumps.radius_mm;
}

static double bump_angle_of(const fg_design *design, const fg_nominal *nominal) {
  (void)nominal;
  return design->bumps.angle_deg;
}

static double height_of(const fg_design *design, const fg_nominal *nominal) {
  (void)design;
  return nominal->height_mm;
}

static double clearance_of(const fg_design *design, const fg_nominal *nominal) {
  (void)design;
  return nominal->clearance_mm;
}

static double bump_angle_by(const fg_design *design, const fg_springback *springback) {
  (void)design;
  return springback->bump_angle_deg;
}

static double height_by(const fg_design *design, const fg_springback *springback) {
  (void)design;
  return springback->height_mm;
}

static double clearance_by(const fg_design *design, const fg_springback *springback) {
  (void)design;
  return springback->clearance_mm;
}

/* eq 5.9 */
static double clearance_error_by(const fg_design *design, const fg_springback *springback) {
  fg_nominal nominal;
  if (fg_design_derive(NULL, design, &nominal) != FG_OK) return NAN;
  return (nominal.clearance_mm - springback->clearance_mm) / nominal.clearance_mm;
}

static const fg_quantity rows[] = {
    {.name = "radius_mm",
     .unit = "mm",
     .symbol = "R",
     .words = "bump radius",
     FG_AT_U(fg_bump, radius_mm, u_radius_mm),
     FG_IN_COVARIANCE(fg_bump, covariance, 2),
     .decimals = 4,
     .uses = PAGE | TERMINAL | PICTURE | LOT | OWN | DATUM,
     .rank = 1,
     .characteristic = "Radius",
     .nominal = radius_of},
    {.name = "centre_mm",
     .unit = "mm",
     .symbol = "C",
     .words = "bump centre in the scan",
     .kind = FG_QUANTITY_PAIR,
     FG_AT_U(fg_bump, centre_mm, u_centre_mm),
     FG_IN_COVARIANCE(fg_bump, covariance, 0),
     .decimals = 4,
     .uses = CAUSE},
    {.name = "centre_to_centre_mm",
     .unit = "mm",
     .symbol = "X",
     .words = "bump centre to overall centre",
     FG_AT_U(fg_bump, centre_to_centre_mm, u_centre_to_centre_mm),
     .decimals = 4},
    {.name = "bump_angle_deg",
     .unit = "°",
     .symbol = "α",
     .words = "bump angle",
     FG_AT_U(fg_bump, bump_angle_deg, u_bump_angle_deg),
     .decimals = 2,
     .uses = PAGE | TERMINAL | PICTURE | LOT | DATUM,
     .rank = 2,
     .characteristic = "Angle",
     .nominal = bump_angle_of,
     .by_arc_length = bump_angle_by},
    {.name = "intersection_angle_deg",
     .unit = "°",
     .symbol = "θ",
     .words = "intersection angle",
     FG_AT_U(fg_bump, intersection_angle_deg, u_intersection_angle_deg),
     .decimals = 2,
     .uses = PAGE | PICTURE | DATUM,
     .rank = 3},
    {.name = "height_mm",
     .unit = "mm",
     .symbol = "h",
     .words = "bump height, foil free",
     FG_AT_U(fg_bump, height_mm, u_height_mm),
     .decimals = 4,
     .uses = PAGE | TERMINAL | PICTURE | LOT,
     .rank = 4,
     .characteristic = "Height",
     .nominal = height_of,
     .by_arc_length = height_by},
    {.name = "clearance_mm",
     .unit = "mm",
     .symbol = "C_loc",
     .words = "local clearance, foil free",
     FG_AT_U(fg_bump, clearance_mm, u_clearance_mm),
     .decimals = 4,
     .uses = PAGE | TERMINAL | PICTURE | LOT | EDGES,
     .rank = 5,
     .characteristic = "Length",
     .nominal = clearance_of,
     .by_arc_length = clearance_by},
    {.name = "clearance_error",
     .unit = "",
     .symbol = "e_C",
     .words = "clearance error, a ratio, foil free",
     FG_AT_U(fg_bump, clearance_error, u_clearance_error),
     .decimals = 3,
     .uses = LOT | EDGES,
     .rank = 10,
     .by_arc_length = clearance_error_by},
    {.name = "height_fitted_mm",
     .unit = "mm",
     .symbol = "h_fit",
     .words = "bump height, foil fitted into the sleeve",
     FG_AT_U(fg_bump, height_fitted_mm, u_height_fitted_mm),
     .decimals = 4,
     .uses = LOT | DATUM,
     .rank = 6,
     .nominal = height_of},
    {.name = "clearance_fitted_mm",
     .unit = "mm",
     .symbol = "C_fit",
     .words = "local clearance, foil fitted into the sleeve",
     FG_AT_U(fg_bump, clearance_fitted_mm, u_clearance_fitted_mm),
     .decimals = 4,
     .uses = PAGE | TERMINAL | LOT | EDGES,
     .rank = 7,
     .nominal = clearance_of},
    {.name = "radius_error_pct",
     .unit = "%",
     .symbol = "e_R",
     .words = "springback error of the bump radius",
     FG_AT_U(fg_bump, radius_error_pct, u_radius_error_pct),
     .decimals = 2,
     .uses = PAGE | TERMINAL | PICTURE | LOT | OWN | DATUM,
     .rank = 8},
    {.name = "bump_angle_error_pct",
     .unit = "%",
     .symbol = "e_α",
     .words = "springback error of the bump angle",
     FG_AT_U(fg_bump, bump_angle_error_pct, u_bump_angle_error_pct),
     .decimals = 2,
     .uses = PAGE | LOT | DATUM,
     .rank = 9},
    {.name = "intersection_angle_error_pct",
     .unit = "%",
     .symbol = "e_θ",
     .words = "springback error of the intersection angle",
     FG_AT_U(fg_bump, intersection_angle_error_pct, u_intersection_angle_error_pct),
     .decimals = 2,
     .uses = LOT | DATUM,
     .rank = 12},
    {.name = "height_model_mm",
     .unit = "mm",
     .symbol = "h_m",
     .words = "bump height that the springback model predicts from the radius",
     FG_AT_U(fg_bump, height_model_mm, u_height_model_mm),
     .decimals = 4,
     .uses = OWN},
    {.name = "bump_angle_model_deg",
     .unit = "°",
     .symbol = "α_m",
     .words = "bump angle that the springback model predicts from the radius",
     FG_AT_U(fg_bump, bump_angle_model_deg, u_bump_angle_model_deg),
     .decimals = 2,
     .uses = OWN},
    {.name = "rms_um",
     .unit = "µm",
     .symbol = "rms",
     .words = "residual from the bump circle",
     FG_AT(fg_bump, rms_um),
     .decimals = 2,
     .uses = PAGE | OWN,
     .rank = 11},
    {.name = "points",
     .unit = "",
     .symbol = "n",
     .words = "points in the fit",
     .kind = FG_QUANTITY_COUNT,
     FG_AT(fg_bump, points)},
    {.name = "arc_start_mm",
     .unit = "mm",
     .symbol = "from",
     .words = "where the fitted arc starts",
     FG_AT(fg_bump, arc_start_mm),
     .decimals = 3},
    {.name = "arc_end_mm",
     .unit = "mm",
     .symbol = "to",
     .words = "where the fitted arc ends",
     FG_AT(fg_bump, arc_end_mm),
     .decimals = 3},
    {.name = "position_deg",
     .unit = "°",
     .symbol = "position",
     .words = "direction of the bump seen from the overall centre",
     FG_AT(fg_bump, position_deg),
     .decimals = 2,
     .uses = CAUSE},
};

const fg_quantity_rows fg_quantities_of_bump = FG_QUANTITY_ROWS(rows);
