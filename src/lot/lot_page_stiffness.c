/* The lot's page: stiffness of the bumps. */
#include "lot/lot_plots.h"
#include "lot/page_parts.h"

static void put_spread_row(FILE *out, const char *title, const fg_lot_spread *spread) {
  fprintf(out, "<tr><td>%s</td><td>%zu</td>", title, spread->count);
  const double values[] = {spread->mean, spread->mode, spread->relative_sd_pct, spread->least,
                           spread->most};
  for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
    fputs("<td>", out);
    fg_lot_put_number(out, values[i], 4);
    fputs("</td>", out);
  }
  fputs("</tr>\n", out);
}

/* Mean over the design's ± what the thickness leaves in doubt, and which thickness that is. */
static void put_thickness(FILE *out, const fg_lot_analysis *analysis) {
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

void fg_lot_put_stiffness(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_stiffness *stiffness = &analysis->stiffness;
  const char *note = fg_lot_stiffness_note(analysis);
  if (!analysis->has_stiffness) return;
  fputs("<section>\n<h1>Stiffness of the bumps</h1>\n", out);
  if (note) fprintf(out, "<p>%s</p>\n", note);
  fputs("<div class=\"scroll\"><table><thead><tr><th>"
        "over the design's</th><th>n</th><th>mean</th><th>mode</th><th>rel. s, %</th><th>min</th>"
        "<th>max</th></tr></thead>\n<tbody>\n",
        out);
  put_spread_row(out, "measured bumps", &stiffness->measured);
  if (analysis->thickness.differs)
    put_spread_row(out, "the same, strips as thick as designed", &stiffness->at_design_thickness);
  put_spread_row(out, "drawn from their densities", &stiffness->resampled);
  put_spread_row(out, "sideways, at the feet", &stiffness->foot);
  fputs("</tbody></table></div>\n", out);
  if (analysis->thickness.foils) put_thickness(out, analysis);
  fputs("<figure>", out);
  fg_lot_plot_map(out, analysis);
  fprintf(
      out,
      "<figcaption>Stiffness over the design's, for strips as thick as designed: orange stiffer, "
      "blue softer; dashed: as designed. A percent of radius alone is worth %+.2f %%, of angle "
      "alone %+.2f %%, of "
      "radius at constant arc length %+.2f %%.</figcaption></figure>\n",
      stiffness->sensitivity.radius, stiffness->sensitivity.angle,
      stiffness->sensitivity.radius_at_arc_length);
  fprintf(out,
          "<p class=\"note\">Arch model: E %.4g GPa, Poisson's ratio %.3g, friction %.3g. Design, "
          "per mm of width: free bump %.4g N/mm², welded %.4g N/mm²%s.</p>\n</section>\n",
          analysis->lot->settings.material.youngs_modulus_gpa,
          analysis->lot->settings.material.poisson_ratio, analysis->lot->settings.material.friction,
          stiffness->design_free.stiffness_n_mm2, stiffness->design_welded.stiffness_n_mm2,
          stiffness->design_free.stuck ? "; friction holds the feet" : "");
}
