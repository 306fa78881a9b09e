/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cantilevers: flat foils with beams cut out of them, measured before they are bent. */
#include "geometry/foil_kind.h"

/* 0: not stated. */
static fg_status check_stated(fg_context *ctx, const char *member, double value) {
  return value == 0 ? FG_OK : fg_design_check_positive(ctx, member, value);
}

/* Eq 5.10 is that of a slender beam of a thin sheet; s goes with L² while the beam's arc is flat.
 */
static fg_status check_slender(fg_context *ctx, const fg_design *design) {
  double length = design->beams.length_mm, width = design->beams.width_mm;
  if (width >= length)
    return fg_fail(ctx, FG_ERR_DATA,
                   "beam_width_mm is %g; it must be below beam_length_mm %g: L is from the root "
                   "to the free end, and eq 5.10 is that of a beam",
                   width, length);
  if (design->thickness_mm >= width)
    return fg_fail(ctx, FG_ERR_DATA, "thickness_mm is %g; it must be below beam_width_mm %g",
                   design->thickness_mm, width);
  if (design->beams.sagitta_mm >= length / 2)
    return fg_fail(ctx, FG_ERR_DATA,
                   "sagitta_mm is %g; it must be below half of beam_length_mm %g: it goes with the "
                   "square of the length of flat arcs only",
                   design->beams.sagitta_mm, length);
  if (design->beams.u_thickness_mm >= design->thickness_mm / 2)
    return fg_fail(ctx, FG_ERR_DATA,
                   "u_thickness_mm is %g; a standard uncertainty must be below half of "
                   "thickness_mm %g",
                   design->beams.u_thickness_mm, design->thickness_mm);
  return FG_OK;
}

static fg_status check_cantilever(fg_context *ctx, const fg_design *design) {
  FG_TRY(fg_design_check_positive(ctx, "beam_length_mm", design->beams.length_mm));
  FG_TRY(fg_design_check_positive(ctx, "beam_width_mm", design->beams.width_mm));
  FG_TRY(fg_design_check_positive(ctx, "thickness_mm", design->thickness_mm));
  FG_TRY(check_stated(ctx, "u_thickness_mm", design->beams.u_thickness_mm));
  FG_TRY(check_stated(ctx, "sagitta_mm", design->beams.sagitta_mm));
  FG_TRY(check_stated(ctx, "elastic_modulus_gpa", design->beams.elastic_modulus_gpa));
  FG_TRY(check_stated(ctx, "clearance_mm", design->beams.clearance_mm));
  if (design->beams.clearance_mm != 0 && design->beams.sagitta_mm == 0)
    return fg_fail(ctx, FG_ERR_DATA,
                   "clearance_mm is %g without sagitta_mm: the clearance changes by what the "
                   "sagitta does; state both",
                   design->beams.clearance_mm);
  return check_slender(ctx, design);
}

/* The smallest object is this share of a beam's length. */
#define BEAM_MIN 0.3

static double min_beam_mm(const fg_design *design) {
  return BEAM_MIN * design->beams.length_mm;
}

static size_t stated_beams(const fg_design *design) {
  return design->beams.count;
}

const fg_foil_row fg_foil_kind_cantilever = {
    .traits =
        {
            .name = "cantilever",
            .noun = "a cantilever",
            .group = FG_DESIGN_BEAMS,
            .refused = 1u << FG_DESIGN_DISCS | 1u << FG_DESIGN_ARC,
            .needed = {"beam_length_mm", "beam_width_mm", "thickness_mm"},
            .foreign = {"bump_count", "bump_radius_mm", "bump_angle_deg", "sleeve_radius_mm",
                        "pitch_deg", "fillet_radius_mm", "rotor_diameter_mm",
                        "top_foil_thickness_mm", "overall_radius_mm", "datum"},
            .why_no_thickness_measured =
                "belongs to strips that are seen from their edge; of form \"cantilever\" state "
                "thickness_mm and u_thickness_mm",
            .why_no_gauges =
                "a gauge on the glass is not sought beside flat foils, form \"cantilever\": "
                "leave it out",
            .why_no_loop =
                "form is cantilever, and the loop needs bumps or discs. Scan round gauges "
                "(--form discs) to see what the scanner does to lengths",
            /* Benefits of a correction are judged on radii and heights; beams have none. */
            .why_no_model =
                "a scanner's model corrects bumps and discs, not the beams of form cantilever: "
                "measure "
                "without --model; what the scanner's scale is wrong by belongs into the design's "
                "calibration",
            .why_no_station =
                "a station keeps foils with bumps and plain strips; measure beams with "
                "`foilgauge lot`",
            .why_no_forming =
                "form \"cantilever\" lies flat, and its die is not stated: there is no strip "
                "along a die to bend",
            .is_foil = true,
            .lies_flat = true,
            .part = FG_QUANTITY_OF_BEAM,
            .owners = 1u << FG_QUANTITY_OF_FOIL | 1u << FG_QUANTITY_OF_BEAM,
            .foil_uses = FG_QUANTITY_OF_FLAT,
            .parts_file = "beams.csv",
        },
    .stated_parts = stated_beams,
    .check = check_cantilever,
    .min_object_mm = min_beam_mm,
};
