/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Arcs: plain strips, as top foils, one circle from end to end. */
#include <math.h>

#include "geometry/arc_foil.h"
#include "geometry/foil_kind.h"
#include "geometry/foil_uncertainty.h"
#include "geometry/labels.h"
#include "geometry/recognise.h"

void fg_design_become_lands(double subtended_angle_deg, fg_design *design) {
  design->kind = FG_FOIL_ARC;
  design->arc = (fg_design_arc){.subtended_angle_deg = subtended_angle_deg};
}

static const double rad_per_deg = 3.14159265358979323846 / 180;

static fg_status check_arc(fg_context *ctx, const fg_design *design) {
  double radius = design->overall_radius_mm, angle = design->arc.subtended_angle_deg;
  FG_TRY(fg_design_check_positive(ctx, "overall_radius_mm", radius));
  FG_TRY(fg_design_check_positive(ctx, "thickness_mm", design->thickness_mm));
  FG_TRY(fg_design_check_positive(ctx, "subtended_angle_deg", angle));
  if (angle >= 360)
    return fg_fail(
        ctx, FG_ERR_DATA,
        "subtended_angle_deg is %g; a strip with two ends has less than a full turn (360)", angle);
  if (design->thickness_mm >= radius)
    return fg_fail(ctx, FG_ERR_DATA, "thickness_mm is %g; it must be below overall_radius_mm %g",
                   design->thickness_mm, radius);
  return FG_OK;
}

static void derive_arc(const fg_design *design, fg_nominal *nominal) {
  nominal->arc_length_mm =
      design->arc.subtended_angle_deg * rad_per_deg * design->overall_radius_mm;
}

/* The smallest arc is this share of the design's length, or of a radian of it. */
#define ARC_MIN 0.25

static double min_arc_mm(const fg_design *design) {
  return ARC_MIN * design->overall_radius_mm *
         fmin(design->arc.subtended_angle_deg * M_PI / 180, 1);
}

static double arc_sagitta(const fg_design *design) {
  return 0.5 * tan(design->arc.subtended_angle_deg * M_PI / 720);
}

static fg_status lay_out_arc(fg_context *ctx, const fg_design *design, unsigned threads,
                             fg_foil *foil, fg_layout *layout, const char **error) {
  (void)threads;
  return fg_arc_foil_layout(ctx, design, &foil->strip, layout, &foil->flags, error);
}

static fg_status fill_arc(fg_context *ctx, const fg_design *design, fg_layout *layout,
                          fg_foil *foil) {
  fg_foil_find_arc_uncertainty(layout, design, foil);
  fg_foil_find_thickness(design, foil);
  fg_layout_overall(layout, design, &foil->overall);
  fg_arc_foil_derive(design, layout, foil);
  fg_foil_recognise(design, foil);
  FG_TRY(fg_labels_fill(ctx, layout, design->datum, foil));
  for (size_t k = 0; k < foil->strip.count; k++)
    if (foil->labels[k].kind == FG_ARC_LAND) foil->labels[k].number = 1;
  return FG_OK;
}

const fg_foil_row fg_foil_kind_arc = {
    .traits =
        {
            .name = "arc",
            .noun = "an arc",
            .group = FG_DESIGN_ARC,
            .refused = 1u << FG_DESIGN_BEAMS | 1u << FG_DESIGN_DISCS,
            .needed = {"overall_radius_mm", "subtended_angle_deg", "thickness_mm"},
            .foreign = {"bump_count", "bump_radius_mm", "bump_angle_deg", "sleeve_radius_mm",
                        "pitch_deg", "fillet_radius_mm", "rotor_diameter_mm",
                        "top_foil_thickness_mm"},
            .why_no_loop =
                "form is arc, and the loop needs bumps or discs: one circle takes up what a "
                "scanner does to it. Scan round gauges (--form discs) and apply what they say "
                "with measure --model",
            .is_foil = true,
            .is_plain_strip = true,
            .part = FG_QUANTITY_OF_BUMP,
            .owners = 1u << FG_QUANTITY_OF_FOIL,
            .parts_file = "bumps.csv",
            .ranked_by = "overall.radius_mm",
            .plural = "plain strips",
            .own_quantities = "overall.radius_mm or arc.subtended_angle_deg",
        },
    .check = check_arc,
    .derive = derive_arc,
    .min_object_mm = min_arc_mm,
    .sagitta_over_chord = arc_sagitta,
    .lay_out = lay_out_arc,
    .fill = fill_arc,
};
