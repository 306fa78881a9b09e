/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A design's page. */
#include <math.h>

#include "core/file.h"
#include "foilgauge/design_report.h"
#include "foilgauge/words.h"
#include "page/page.h"
#include "page/tile.h"
#include "report/provenance.h"
#include "report/stiffness/map.h"
#include "report/stiffness/table.h"

static fg_tile make_design_tile(const char *title, double value, const char *unit,
                                const char *source) {
  return (fg_tile){title, .value = value, .digits = 5, .unit = unit, .small = source};
}

static void put_design_tiles(FILE *out, const fg_design_report *report) {
  const fg_design *design = report->design;
  const fg_nominal *nominal = report->nominal;
  const fg_tile tiles[] = {
      make_design_tile("bump radius", design->bumps.radius_mm, "mm", "R<sub>D</sub>, stated"),
      make_design_tile("bump angle", design->bumps.angle_deg, "°", "α<sub>D</sub>, stated"),
      make_design_tile("overall radius", design->overall_radius_mm, "mm", "stated"),
      make_design_tile("thickness", design->thickness_mm, "mm", "stated"),
      make_design_tile("bump height", nominal->height_mm, "mm", "h<sub>D</sub>, eq 5.5"),
      make_design_tile("arc length of a bump", nominal->arc_length_mm, "mm",
                       "α<sub>D</sub> R<sub>D</sub>"),
      make_design_tile("intersection angle", nominal->intersection_angle_deg, "°", "θ<sub>D</sub>"),
      make_design_tile("clearance", 1000 * nominal->clearance_mm, "µm", "C<sub>D</sub>, eq 5.8"),
  };
  fg_html_tiles(out, "tiles four", tiles, sizeof tiles / sizeof *tiles);
}

fg_status fg_design_write_html(fg_context *ctx, const fg_design_report *report, FILE *out) {
  if (!fg_foil_kind_has_bumps(report->design->kind))
    return fg_fail(ctx, FG_ERR_DATA, "form \"%s\" has no bumps, so there is no page of them",
                   fg_foil_kind_word(report->design->kind));
  const fg_stiffness_of_design stiffness =
      fg_stiffness_find_of_design(report->design, report->material);
  double along = stiffness.bump.by_model[0].sensitivity.radius_at_arc_length;
  fg_html_begin(out, report->design->name);
  fputs("<section>\n<header><h1>Design ", out);
  fg_html_text(out, report->design->name);
  fputs("</h1></header>\n", out);
  put_design_tiles(out, report);
  fputs("<h2>Stiffness of a bump</h2>\n", out);
  if (stiffness.note) fprintf(out, "<p>%s</p>\n", stiffness.note);
  fg_html_stiffness_table(out, &stiffness.bump, 1);
  fprintf(
      out,
      "<p class=\"note\">E %.4g GPa, Poisson's ratio %.3g, friction %.3g; pitch s %.4g mm along "
      "the sleeve. A percent more thickness is worth three of stiffness in every model.</p>\n",
      report->material->youngs_modulus_gpa, report->material->poisson_ratio,
      report->material->friction, stiffness.pitch_mm);
  fputs("</section>\n<section>\n<h2 class=\"first\">What springback does to it</h2>\n<figure>",
        out);
  fg_stiffness_plot_map(out, &stiffness.map, NULL, NULL);
  fputs("<figcaption>Stiffness of the arch over the design's: orange stiffer, blue softer; dashed: "
        "as designed. The thick orange line is springback at constant arc length",
        out);
  if (isfinite(along))
    fprintf(out, ", along which a percent of radius is worth %s%.2g&nbsp;%% of stiffness at first",
            along < 0 ? "−" : "+", fabs(along));
  fputs(".</figcaption></figure>\n</section>\n", out);
  fg_provenance from = {.design = report->design, .calibration = true};
  if (report->path) fg_provenance_include_file(&from, report->path);
  FG_TRY(fg_html_provenance_section(ctx, out, &from));
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the page");
}
