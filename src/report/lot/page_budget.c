/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lot's page: causes of the spread of the bumps' stiffness. */
#include <math.h>

#include "page/table.h"
#include "report/lot/page_parts.h"
#include "report/lot/parts_members.h"

/* Returns the spread that a variance would give alone. */
static double variance_to_spread(double variance_pct2) {
  return sqrt(variance_pct2);
}

/* Line of the table of causes. */
typedef struct budget_line {
  fg_lot_budget_term term; /* first: its members are columns */
  const char *cause, *look;
} budget_line;

static double find_spread_alone(const fg_subject *subject) {
  const budget_line *line = subject->object;
  return variance_to_spread(line->term.variance_pct2);
}

static const fg_member budget_line_rows[] = {
    {FG_STRING("cause", budget_line, cause), .page = {.rank = 1, .heading = "cause"}},
    {FG_SAME(&fg_lot_budget_term_members)},
    {FG_NUMBER_BY("alone_pct", find_spread_alone),
     .words = "spread of the stiffness from this cause alone",
     .page = {.rank = 3, .heading = "alone gives, %", .digits = 3}},
};

static const char *look_at_budget_line(const fg_subject *element) {
  return ((const budget_line *)element->object)->look;
}

static const fg_members budget_line_members =
    FG_MEMBERS_LOOKED_AT(budget_line_rows, look_at_budget_line);

static bool find_budget_line(const fg_subject *list, size_t i, fg_subject *element) {
  const budget_line *line = (const budget_line *)list->object + i;
  element->object = line;
  return line->cause;
}

static void put_budget_table(FILE *out, const fg_lot_budget *budget) {
  double observed_pct2 = budget->observed_pct * budget->observed_pct;
  const budget_line lines[] = {
      {budget->radius, "radius, at constant arc length", NULL},
      {budget->arc_length, "arc length R α of the bump", NULL},
      {budget->thickness, "thickness of the strip", NULL},
      {{NAN, NAN, NAN, budget->rest_share_pct}, "not explained by these", NULL},
      {{NAN, NAN, observed_pct2, 100}, "observed", "total"},
      {.cause = NULL},
  };
  fg_html_table(out, &budget_line_members, &(fg_subject){.object = lines}, find_budget_line);
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
  fputs("What all scans share, the uncertainty of the thickness, is in the mean above and not in a "
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
  put_budget_table(out, budget);
  put_thickness_note(out, analysis);
  put_unexplained(out, budget);
  put_calibration_note(out, analysis);
}
