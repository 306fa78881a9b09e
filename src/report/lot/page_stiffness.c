/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lot's page: stiffness of the bumps. */
#include "report/lot/page_parts.h"
#include "report/lot/plots.h"

static void put_spread_row(FILE *out, const char *title, const fg_lot_spread *spread) {
  fprintf(out, "<tr><td>%s</td><td>%zu</td>", title, spread->count);
  const double values[] = {spread->mean, spread->mode, spread->relative_sd_pct, spread->min,
                           spread->max};
  for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
    fputs("<td>", out);
    fg_lot_put_number(out, values[i], 4);
    fputs("</td>", out);
  }
  fputs("</tr>\n", out);
}

/* Puts the mean over the design's ± its uncertainty by the thickness, and the origin of that
 * thickness. */
static void put_stiffness_thickness(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_stiffness *stiffness = &analysis->stiffness;
  fprintf(out,
          "<p class=\"note\">The mean of %.4g is known to ± %.2g, since stiffness goes with "
          "t³: the strips measure ",
          stiffness->measured.mean, FG_COVERAGE_FACTOR * stiffness->u_by_thickness);
  fg_lot_put_thickness(out, analysis);
  fputs(".</p>\n", out);
}

void fg_lot_put_thickness(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_thickness *thickness = &analysis->thickness;
  double design_mm = analysis->lot->settings.design.thickness_mm;
  fprintf(out, "%.5g ± %.2g mm", thickness->mean.mm, FG_COVERAGE_FACTOR * thickness->mean.u_mm);
  if (thickness->differs) fprintf(out, " and not %.4g as the design says", design_mm);
}

static void put_stiffness_spreads(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_stiffness *stiffness = &analysis->stiffness;
  fputs("<div class=\"scroll\"><table><thead><tr><th>"
        "over the design's</th><th>n</th><th>mean</th><th>mode</th><th>rel. s, %</th><th>min</th>"
        "<th>max</th></tr></thead>\n<tbody>\n",
        out);
  put_spread_row(out, "measured bumps, arch", &stiffness->measured);
  if (analysis->thickness.differs)
    put_spread_row(out, "the same, strips as thick as designed", &stiffness->at_design_thickness);
  for (int i = 1; i < FG_STIFFNESS_MODELS; i++) {
    char title[80];
    snprintf(title, sizeof title, "measured bumps, %s", fg_stiffness_models()[i].title);
    if (stiffness->by_model[i].count) put_spread_row(out, title, &stiffness->by_model[i]);
  }
  put_spread_row(out, "drawn from the bumps' densities, arch", &stiffness->resampled);
  put_spread_row(out, "sideways, at the feet, arch", &stiffness->foot);
  fputs("</tbody></table></div>\n", out);
}

static void put_stiffness_models(FILE *out, const fg_lot_analysis *analysis, size_t cases) {
  const fg_arch_material *material = &analysis->lot->settings.material;
  double pitch_mm = fg_design_pitch_mm(&analysis->lot->settings.design);
  fputs("<h2>By model</h2>\n", out);
  fg_html_stiffness_table(out, analysis->stiffness.cases, cases, pitch_mm);
  fprintf(out,
          "<p class=\"note\">E %.4g GPa, Poisson's ratio %.3g, friction %.3g; pitch %.4g mm along "
          "the sleeve. An arch with one end welded, as designed: %.4g N/mm²%s.</p>\n",
          material->youngs_modulus_gpa, material->poisson_ratio, material->friction, pitch_mm,
          analysis->stiffness.design_welded.stiffness_n_mm2,
          analysis->stiffness.design_free.stuck ? "; friction holds the feet" : "");
}

static void put_spread_parts(FILE *out, const fg_lot_analysis *analysis) {
  put_stiffness_spreads(out, analysis);
  if (analysis->thickness.foils) put_stiffness_thickness(out, analysis);
  fputs("<figure>", out);
  fg_lot_plot_map(out, analysis);
  fputs("<figcaption>Stiffness of the arch over the design's, for strips as thick as designed: "
        "orange stiffer, blue softer; dashed: as designed; thick orange line: springback at "
        "constant arc length. Each dot is a bump.</figcaption></figure>\n",
        out);
  fg_lot_put_stiffness_budget(out, analysis);
}

void fg_lot_put_stiffness(FILE *out, const fg_lot_analysis *analysis) {
  const char *note = fg_lot_stiffness_note(analysis);
  if (!fg_foil_kind_has_bumps(analysis->lot->settings.design.kind) || !analysis->part_count) return;
  fputs("<section class=\"part\">\n<h1>Stiffness of the bumps</h1>\n", out);
  if (note) fprintf(out, "<p>%s</p>\n", note);
  if (analysis->has_stiffness)
    put_spread_parts(out, analysis);
  else
    fputs("<p class=\"note\">How stiffness varies is not known: that takes two bumps with radius "
          "and angle.</p>\n",
          out);
  put_stiffness_models(out, analysis, analysis->has_stiffness ? FG_LOT_CASES : 1);
  fputs("</section>\n", out);
}
