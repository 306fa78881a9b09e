/* What is reported of a whole foil. */
#include <stddef.h>

#include "quantity/rows.h"

enum {
  PAGE = FG_QUANTITY_ON_PAGE,
  TERMINAL = FG_QUANTITY_ON_TERMINAL,
  LOT = FG_QUANTITY_IN_LOT,
  CAUSE = FG_QUANTITY_IS_CAUSE,
  ARC = FG_QUANTITY_OF_ARC,
  FLAT = FG_QUANTITY_OF_FLAT,
};

static double overall_radius_of(const fg_design *design, const fg_nominal *nominal) {
  (void)nominal;
  return design->overall_radius_mm;
}

static double thickness_of(const fg_design *design, const fg_nominal *nominal) {
  (void)nominal;
  return design->thickness_mm;
}

static double subtended_angle_of(const fg_design *design, const fg_nominal *nominal) {
  (void)nominal;
  return design->subtended_angle_deg;
}

static double arc_length_of(const fg_design *design, const fg_nominal *nominal) {
  (void)design;
  return nominal->arc_length_mm;
}

static const fg_quantity rows[] = {
    {.name = "rotation_deg",
     .unit = "°",
     .symbol = "rotation",
     .words = "direction of the foil's middle seen from the overall centre",
     FG_AT(fg_foil, rotation_deg),
     .decimals = 2,
     .uses = CAUSE | FLAT},
    {.name = "thickness_mm",
     .unit = "mm",
     .symbol = "t",
     .words = "strip thickness",
     FG_AT_U(fg_foil, thickness_mm, u_thickness_mm),
     .decimals = 4,
     .uses = PAGE | TERMINAL | LOT | CAUSE,
     .rank = 3,
     .characteristic = "Thickness",
     .nominal = thickness_of},
    {.name = "overall.radius_mm",
     .unit = "mm",
     .symbol = "R0",
     .words = "overall radius",
     FG_AT_U(fg_foil, overall.radius_mm, overall.u_radius_mm),
     FG_IN_COVARIANCE(fg_foil, overall.covariance, 2),
     .decimals = 4,
     .uses = PAGE | TERMINAL | LOT,
     .rank = 1,
     .characteristic = "Radius",
     .nominal = overall_radius_of},
    {.name = "overall.centre_mm",
     .unit = "mm",
     .symbol = "O",
     .words = "overall centre in the scan",
     .kind = FG_QUANTITY_PAIR,
     FG_AT_U(fg_foil, overall.centre_mm, overall.u_centre_mm),
     FG_IN_COVARIANCE(fg_foil, overall.covariance, 0),
     .decimals = 4,
     .uses = CAUSE},
    {.name = "overall.springback_error_pct",
     .unit = "%",
     .symbol = "springback",
     .words = "springback error of the overall radius",
     FG_AT_U(fg_foil, overall.springback_error_pct, overall.u_springback_error_pct),
     .decimals = 3,
     .uses = PAGE | TERMINAL | LOT,
     .rank = 2},
    {.name = "overall.rms_um",
     .unit = "µm",
     .symbol = "rms",
     .words = "residual of the lands from the overall circle",
     FG_AT(fg_foil, overall.rms_um),
     .decimals = 2},
    {.name = "overall.points",
     .unit = "",
     .symbol = "n",
     .words = "points on the lands",
     .kind = FG_QUANTITY_COUNT,
     FG_AT(fg_foil, overall.points)},
    {.name = "arc.subtended_angle_deg",
     .unit = "°",
     .symbol = "angle",
     .words = "angle between the ends about the centre",
     FG_AT_U(fg_foil, arc.subtended_angle_deg, arc.u_subtended_angle_deg),
     .decimals = 3,
     .uses = PAGE | TERMINAL | LOT | ARC,
     .rank = 5,
     .characteristic = "Angle",
     .nominal = subtended_angle_of},
    {.name = "arc.subtended_angle_error_pct",
     .unit = "%",
     .symbol = "e_angle",
     .words = "springback error of the angle between the ends",
     FG_AT_U(fg_foil, arc.subtended_angle_error_pct, arc.u_subtended_angle_error_pct),
     .decimals = 3,
     .uses = PAGE | TERMINAL | LOT | ARC,
     .rank = 6},
    {.name = "arc.length_mm",
     .unit = "mm",
     .symbol = "length",
     .words = "arc length from end to end",
     FG_AT_U(fg_foil, arc.length_mm, arc.u_length_mm),
     .decimals = 4,
     .uses = PAGE | TERMINAL | LOT | ARC,
     .rank = 7,
     .characteristic = "Length",
     .nominal = arc_length_of},
    {.name = "noise_um",
     .unit = "µm",
     .symbol = "noise",
     .words = "standard deviation of the residuals",
     FG_AT(fg_foil, noise_um),
     .decimals = 3,
     .uses = TERMINAL | FLAT,
     .rank = 4},
    {.name = "correlation_mm",
     .unit = "mm",
     .symbol = "correlation",
     .words = "correlation length of the residuals along the strip",
     FG_AT(fg_foil, correlation_mm),
     .decimals = 3,
     .uses = FLAT},
    {.name = "edge_model_um",
     .unit = "µm",
     .symbol = "edge model",
     .words = "systematic part of the edges' uncertainty",
     FG_AT(fg_foil, edge_model_um),
     .decimals = 3},
    {.name = "correction.overall_radius_mm",
     .unit = "mm",
     .symbol = "ΔR0",
     .words = "what the scanner's model moved the overall radius by",
     FG_AT_U(fg_foil, correction.overall_radius_mm, correction.u_overall_radius_mm),
     .decimals = 4},
    {.name = "correction.radius_mm",
     .unit = "mm",
     .symbol = "ΔR",
     .words = "what the scanner's model moved a bump radius by, at most",
     FG_AT_U(fg_foil, correction.radius_mm, correction.u_radius_mm),
     .decimals = 4},
    {.name = "correction.height_mm",
     .unit = "mm",
     .symbol = "Δh",
     .words = "what the scanner's model moved a bump height by, at most",
     FG_AT_U(fg_foil, correction.height_mm, correction.u_height_mm),
     .decimals = 4},
};

const fg_quantity_rows fg_quantities_of_foil = FG_QUANTITY_ROWS(rows);
