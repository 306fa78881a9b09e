/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lot's page: stiffness of the bumps. */
#include "page/table.h"
#include "report/lot/page_parts.h"
#include "report/lot/parts_members.h"
#include "report/lot/plots.h"

/* Line of the table of spreads. */
typedef struct spread_line {
  fg_lot_spread spread; /* first: its members are the columns */
  const char *title;
} spread_line;

static const fg_member spread_line_rows[] = {
    {FG_STRING("of", spread_line, title), .page = {.rank = 1, .heading = "over the design's"}},
    {FG_SAME(&fg_lot_spread_members)},
};
static const fg_members spread_line_members = FG_MEMBERS(spread_line_rows);

static bool find_spread_line(const fg_subject *list, size_t i, fg_subject *element) {
  const spread_line *line = (const spread_line *)list->object + i;
  element->object = line->spread.count ? line : NULL;
  return line->title;
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
  spread_line lines[FG_STIFFNESS_MODELS + 4] = {{stiffness->measured, "measured bumps, arch"}};
  char titles[FG_STIFFNESS_MODELS][80];
  size_t count = 1;
  if (analysis->thickness.differs)
    lines[count++] =
        (spread_line){stiffness->at_design_thickness, "the same, strips as thick as designed"};
  for (int i = 1; i < FG_STIFFNESS_MODELS; i++) {
    snprintf(titles[i], sizeof titles[i], "measured bumps, %s", fg_stiffness_models()[i].title);
    lines[count++] = (spread_line){stiffness->by_model[i], titles[i]};
  }
  lines[count++] = (spread_line){stiffness->resampled, "drawn from the bumps' densities, arch"};
  lines[count] = (spread_line){stiffness->foot, "sideways, at the feet, arch"};
  fg_html_table(out, &spread_line_members, &(fg_subject){.object = lines}, find_spread_line);
}

static void put_stiffness_models(FILE *out, const fg_lot_analysis *analysis, size_t cases) {
  const fg_arch_material *material = &analysis->lot->settings.material;
  double pitch_mm = fg_design_pitch_mm(&analysis->lot->settings.design);
  fputs("<h2>By model</h2>\n", out);
  fg_html_stiffness_table(out, analysis->stiffness.cases, cases);
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
