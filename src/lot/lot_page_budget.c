/* The lot's page: where the spread of the bumps' stiffness comes from. */
#include <math.h>

#include "lot/page_parts.h"

/* A sum that leaves less than this of the observed variance aside explains it. */
static const double settled_share = 0.1;

static void put_cell(FILE *out, double value, int digits) {
  fputs("<td>", out);
  fg_lot_put_number(out, value, digits);
  fputs("</td>", out);
}

/* Three digits, and nothing finer than a hundredth of the whole. */
static double share_pct(const fg_lot_budget *budget, double variance_pct2) {
  return round(1e4 * variance_pct2 / pow(budget->observed_pct, 2)) / 100;
}

/* A variance as the spread that it would give alone; below zero it takes away. */
static double as_spread(double variance_pct2) {
  return copysign(sqrt(fabs(variance_pct2)), variance_pct2);
}

static void put_row(FILE *out, const char *style, const char *title, const fg_lot_budget *budget,
                    const fg_lot_budget_term *term) {
  fprintf(out, "<tr%s><td>%s</td>", style, title);
  put_cell(out, term->spread_pct, 3);
  if (isfinite(term->sensitivity))
    fprintf(out, "<td>%s%.2f</td>", term->sensitivity < 0 ? "−" : "+", fabs(term->sensitivity));
  else
    fputs("<td></td>", out);
  put_cell(out, as_spread(term->variance_pct2), 3);
  put_cell(out, share_pct(budget, term->variance_pct2), 3);
  fputs("</tr>\n", out);
}

static void put_sum(FILE *out, const char *style, const char *title, const fg_lot_budget *budget,
                    double variance_pct2) {
  fprintf(out, "<tr%s><td>%s</td><td></td><td></td>", style, title);
  put_cell(out, as_spread(variance_pct2), 3);
  put_cell(out, share_pct(budget, variance_pct2), 3);
  fputs("</tr>\n", out);
}

static void put_sentence(FILE *out, const fg_lot_budget *budget) {
  const struct {
    const char *words;
    const fg_lot_budget_term *term;
  } causes[] = {{"the radius (springback at constant arc length)", &budget->radius},
                {"the arc length of the bumps", &budget->arc_length},
                {"the strip's thickness", &budget->thickness}};
  size_t most = 0;
  for (size_t i = 1; i < sizeof causes / sizeof *causes; i++)
    if (causes[i].term->variance_pct2 > causes[most].term->variance_pct2) most = i;
  fprintf(
      out,
      "<p>From bump to bump stiffness varies by <b>%.3g&nbsp;%%</b> (one standard deviation). Most "
      "of it is %s, which alone would give %.3g&nbsp;%%.</p>\n",
      budget->observed_pct, causes[most].words, as_spread(causes[most].term->variance_pct2));
}

static void put_thickness_note(FILE *out, const fg_lot_analysis *analysis) {
  size_t foils = analysis->thickness.foils;
  if (foils > 1) return;
  fprintf(out,
          "<p class=\"note\">How much the thickness varies is not known: it was measured on "
          "%s. A percent of it would be worth three of stiffness.</p>\n",
          foils ? "one foil only" : "no foil");
}

static void put_rest(FILE *out, const fg_lot_budget *budget) {
  double observed = pow(budget->observed_pct, 2);
  fputs("<p class=\"note\">It is the squares that add up; a minus takes away. ", out);
  if (fabs(budget->unexplained_pct2) > settled_share * observed)
    fprintf(out,
            "The causes add up to %.3g %% where %.3g %% is observed. Slopes hold for small "
            "differences: over a wide lot stiffness curves, %s. ",
            as_spread(budget->sum_pct2), budget->observed_pct,
            budget->unexplained_pct2 < 0 ? "and here that takes away" : "and here that adds");
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

static void put_calibration(FILE *out, const fg_lot_analysis *analysis) {
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
  char title[80];
  if (!budget->known) return;
  fputs("<h2>Where the spread comes from</h2>\n", out);
  put_sentence(out, budget);
  fputs("<div class=\"scroll\"><table><thead><tr><th>cause</th><th>varies by, %</th><th>% of "
        "stiffness<br>per %</th><th>gives, %</th><th>share of the<br>variance, "
        "%</th></tr></thead>\n<tbody>\n",
        out);
  put_row(out, "", "radius, at constant arc length", budget, &budget->radius);
  put_row(out, "", "arc length R α of the bump", budget, &budget->arc_length);
  snprintf(title, sizeof title, "these two together (correlation %s%.2f)",
           budget->correlation < 0 ? "−" : "+", fabs(budget->correlation));
  put_sum(out, "", title, budget, budget->together_pct2);
  put_row(out, "", "thickness of the strip", budget, &budget->thickness);
  put_sum(out, " class=\"total\"", "sum", budget, budget->sum_pct2);
  put_sum(out, "", "observed", budget, pow(budget->observed_pct, 2));
  put_sum(out, "", "not explained by these slopes", budget, budget->unexplained_pct2);
  put_sum(out, "", "of the observed: measurement", budget, pow(budget->measurement_pct, 2));
  fputs("</tbody></table></div>\n", out);
  put_thickness_note(out, analysis);
  put_rest(out, budget);
  put_calibration(out, analysis);
}
