/* SPDX-License-Identifier: GPL-3.0-or-later */
/* View of arcs, which are plain strips. */
#include <math.h>
#include <stdio.h>

#include "foilgauge/words.h"
#include "page/tile.h"
#include "report/design/parts.h"
#include "report/measure/foil_members.h"
#include "report/measure/foil_view.h"
#include "report/measure/overlay.h"
#include "report/measure/page_tables.h"
#include "report/measure/thickness_budget.h"

static void design_table_of_arc(const fg_design_report *report, FILE *out) {
  const fg_design *design = report->design;
  const fg_nominal *nominal = report->nominal;
  fprintf(out, ", datum %s\n\nstated\n", fg_datum_word(design->datum));
  fg_design_put_row(out, "overall radius", "R0", design->overall_radius_mm, "mm");
  fg_design_put_row(out, "subtended angle", "", design->arc.subtended_angle_deg, "deg");
  fg_design_put_row(out, "thickness", "t", design->thickness_mm, "mm");
  fg_design_put_known(design, out);
  fputs("\nderived\n", out);
  fg_design_put_row(out, "arc length", "", nominal->arc_length_mm, "mm");
}

static void tiles_of_arc(FILE *out, const fg_design *design, const fg_foil *foil) {
  (void)design;
  fputs("<dl class=\"tiles\">\n", out);
  fg_html_quantity_tile(out, FG_QUANTITY_OF_FOIL, "overall.radius_mm", "Radius", foil);
  fg_html_quantity_tile(out, FG_QUANTITY_OF_FOIL, "overall.springback_error_pct",
                        "Springback of the radius", foil);
  fg_html_quantity_tile(out, FG_QUANTITY_OF_FOIL, "arc.subtended_angle_deg",
                        "Angle between the ends", foil);
  fg_html_quantity_tile(out, FG_QUANTITY_OF_FOIL, "arc.subtended_angle_error_pct",
                        "Angle against the design", foil);
  fg_html_quantity_tile(out, FG_QUANTITY_OF_FOIL, "arc.length_mm", "Length", foil);
  fg_html_quantity_tile(out, FG_QUANTITY_OF_FOIL, "thickness_mm", "Thickness", foil);
  fputs("</dl>\n", out);
}

static void details_of_arc(FILE *out, const fg_design *design, const fg_foil *foil) {
  fg_html_foil_table(out, design, foil);
  fg_html_thickness_budget(out, design, foil);
  fg_html_residual_figure(out, foil, "its circle");
  fputs("<h2>What the errors mean</h2>\n<p class=\"note\">Springback of the radius is 100 (design "
        "− actual) / design, that of the angle 100 (actual − design) / design: of a foil that has "
        "opened both are below 0. The angle is that between the two cuts, seen from the centre."
        "</p>\n",
        out);
}

static void summary_of_arc(FILE *out, const fg_design *design, const fg_foil *foil) {
  (void)design;
  fg_html_summary_number(out, foil ? foil->overall.radius_mm : NAN, 4);
  fg_html_summary_number(out, foil ? foil->arc.subtended_angle_deg : NAN, 3);
}

static fg_status put_ends(fg_context *ctx, fg_overlay_legend *legend, const fg_foil *foil) {
  char text[FG_OVERLAY_LINE], angle[64], error[64], length[64];
  fg_overlay_value_text(fg_quantity_find(FG_QUANTITY_OF_FOIL, "arc.subtended_angle_deg"), foil,
                        angle, sizeof angle);
  fg_overlay_value_text(fg_quantity_find(FG_QUANTITY_OF_FOIL, "arc.subtended_angle_error_pct"),
                        foil, error, sizeof error);
  fg_overlay_value_text(fg_quantity_find(FG_QUANTITY_OF_FOIL, "arc.length_mm"), foil, length,
                        sizeof length);
  snprintf(text, sizeof text, "angle between the ends %s °, against the design %s %%, length %s mm",
           angle, error, length);
  return fg_overlay_put_line(ctx, legend, 4, text);
}

static fg_status overlay_of_arc(fg_context *ctx, fg_overlay_legend *legend, const fg_design *design,
                                const fg_foil *foil, bool all) {
  (void)design, (void)all;
  FG_TRY(fg_overlay_put_bent_foil(ctx, legend, foil));
  return put_ends(ctx, legend, foil);
}

static void head_arc(const fg_foil *foil, FILE *out) {
  (void)foil;
  fputs("a plain strip", out);
}

static void head_arc_on_page(const fg_foil *foil, FILE *out) {
  (void)foil;
  fputs(" · a plain strip", out);
}

const fg_foil_view fg_foil_view_arc = {
    .parts = "bumps",
    .u_from = FG_EDGES_SAY,
    .legend = "Blue, dashed: the circle; orange: the cuts at the ends, with their directions from "
              "the centre. Magenta: residuals.",
    .overlay_note = FG_ARCS_NOTE,
    .summary_heads = "<th>radius<br>mm</th><th>angle<br>°</th>",
    .points_heading = FG_STATIONS_HEADING,
    .lines = FG_QUANTITY_OF_FOIL,
    .members = &fg_foil_members,
    .design_table = design_table_of_arc,
    .foil_heading = head_arc,
    .page_heading = head_arc_on_page,
    .tiles = tiles_of_arc,
    .details = details_of_arc,
    .summary = summary_of_arc,
    .overlay = overlay_of_arc,
};
