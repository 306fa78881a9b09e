/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lot's page: causes of the spread of the bumps' stiffness. */
#include <math.h>

#include "report/lot/page_parts.h"

static void put_term_cell(FILE *out, double value, int digits) {
  fputs("<td>", out);
  fg_lot_put_number(out, value, digits);
  fputs("</td>", out);
}

/* Returns the spread that a variance would give alone. */
static double variance_to_spread(double variance_pct2) {
  return sqrt(variance_pct2);
}

/* Rounds to a tenth of a percent, which is fine enough. */
static double round_share(double share_pct) {
  return round(10 * share_pct) / 10;
}

static void put_term_row(FILE *out, const char *title, const fg_lot_budget_term *term) {
  fprintf(out, "<tr><td>%s</td>", title);
  put_term_cell(out, term->spread_pct, 3);
  if (isfinite(term->sensitivity))
    fprintf(out, "<td>%s%.2f</td>", term->sensitivity < 0 ? "−" : "+", fabs(term->sensitivity));
  else
    fputs("<td></td>", out);
  put_term_cell(out, variance_to_spread(term->variance_pct2), 3);
  put_term_cell(out, round_share(term->share_pct), 3);
  fputs("</tr>\n", out);
}

static void put_share(FILE *out, const char *style, const char *title, double spread_pct,
                      double share_pct) {
  fprintf(out, "<tr%s><td>%s</td><td></td><td></td>", style, title);
  put_term_cell(out, spread_pct, 3);
  put_term_cell(out, round_share(share_pct), 3);
  fputs("</tr>\n", out);
}

static void put_budget_sentence(FILE *out, const fg_lot_budget *budget) {
  const struct {
    const char *words;
    const fg_lot_budget_term *term;
  } causes[] = {{"the radius (springback at constant arc length)", &budget->radius},
                {"the arc length of the bumps", &budget->arc_length},
                {"the strip's thickness", &budget->thickness}};
  size_t max = 0;
  for (size_t i = 1; i < sizeof causes / sizeof *causes; i++)
    if (causes[i].term->share_pct > causes[max].term->share_pct) max = i;
  fprintf(
      out,
      "<p>From bump to bump stiffness varies by <b>%.3g&nbsp;%%</b> (one standard deviation). Most "
      "of it is %s, which alone would give %.3g&nbsp;%%.</p>\n",
      budget->observed_pct, causes[max].words, variance_to_spread(causes[max].term->variance_pct2));
}

static void put_thickness_note(FILE *out, const fg_lot_analysis *analysis) {
  size_t foils = analysis->thickness.foils;
  if (foils > 1) return;
  fprintf(out,
          "<p class=\"note\">How much the thickness varies is not known: it was measured on "
          "%s. A percent of it would be worth three of stiffness.</p>\n",
          foils ? "one foil only" : "no foil");
}

static void put_unexplained(FILE *out, const fg_lot_budget *budget) {
  fprintf(out,
          "<p class=\"note\">The shares are what each cause adds to the variance that a regression "
          "on the causes explains, averaged over the orders in which they may enter (Lindeman, "
          "Merenda and Gold): none is negative, and with what is not explained, as stiffness "
          "curves, they are 100 %%. Radius and arc length go together with a correlation of "
          "%s%.2f: what each gives alone does not add up. ",
          budget->correlation < 0 ? "−" : "+", fabs(budget->correlation));
  if (isfinite(budget->measurement_pct) && budget->measurement_pct > 0)
    fprintf(out,
            "Measurement is in the observed spread and not in the parts: radius and angle of a "
            "bump are known well enough for its stiffness within %.2g %%; the parts themselves "
            "vary by %.3g %%. ",
            budget->measurement_pct, budget->parts_pct);
  fputs("What all scans share, the doubt about the thickness, is in the mean above and not in a "
        "spread.</p>\n",
        out);
}

static void put_calibration_note(FILE *out, const fg_lot_analysis *analysis) {
  double mean = analysis->stiffness.measured.mean, u = analysis->stiffness.u_by_calibration;
  if (!analysis->lot->settings.design.calibration.stated) {
    fputs("<p class=\"note\">Calibration: none is stated; what it leaves is not in the mean&#39;s "
          "U.</p>\n",
          out);
    return;
  }
  fprintf(out,
          "<p class=\"note\">Calibration: the same in every bump, so in no spread; of the mean "
          "± %.2g %% (U).</p>\n",
          100 * FG_COVERAGE_FACTOR * u / mean);
}

void fg_lot_put_stiffness_budget(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_budget *budget = &analysis->stiffness.budget;
  if (!budget->known) return;
  fputs("<h2>Where the spread comes from</h2>\n", out);
  put_budget_sentence(out, budget);
  fputs("<div class=\"scroll\"><table><thead><tr><th>cause</th><th>varies by, %</th><th>% of "
        "stiffness<br>per %</th><th>alone gives, %</th><th>share of the<br>variance, "
        "%</th></tr></thead>\n<tbody>\n",
        out);
  put_term_row(out, "radius, at constant arc length", &budget->radius);
  put_term_row(out, "arc length R α of the bump", &budget->arc_length);
  put_term_row(out, "thickness of the strip", &budget->thickness);
  put_share(out, "", "not explained by these", NAN, budget->rest_share_pct);
  put_share(out, " class=\"total\"", "observed", budget->observed_pct, 100);
  fputs("</tbody></table></div>\n", out);
  put_thickness_note(out, analysis);
  put_unexplained(out, budget);
  put_calibration_note(out, analysis);
}
