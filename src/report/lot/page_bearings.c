/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lot's page: the bearings that the foils are built into. */
#include <math.h>

#include "core/text.h"
#include "foilgauge/words.h"
#include "page/page.h"
#include "page/verdict.h"
#include "quantity/quantity_rows.h"
#include "report/lot/page_parts.h"
#include "report/lot/plots.h"

enum { POLAR_MAX = 30, BEARING_ROWS_MAX = 200, UM_PER_MM = 1000 };

static void put_bearing_name(FILE *out, const fg_lot_bearing *bearing) {
  if (bearing->name)
    fg_html_name(out, bearing->name);
  else
    fprintf(out, "%zu", bearing->number);
}

static bool is_bearing_judged(const fg_lot_analysis *analysis) {
  return fg_report_of_bearing(&analysis->lot->settings.design, NULL, 0) > 0;
}

/* Names the quantities that fail or cannot be told: a row of numbers would have to be searched. */
static void put_bearing_verdict(FILE *out, const fg_lot_analysis *analysis,
                                const fg_lot_bearing *bearing) {
  const fg_decision *decision = &bearing->decision;
  fg_verdict verdict = decision->outcome.verdict;
  const char *separator = ": ";
  if (!is_bearing_judged(analysis)) return;
  fprintf(out, "<td class=\"%s\">%s", fg_verdict_word(verdict), fg_html_verdict_title(verdict));
  for (size_t i = 0; i < decision->count; i++) {
    if (verdict == FG_VERDICT_PASS || decision->judgements[i].verdict != verdict) continue;
    fprintf(out, "%s%s", separator, decision->judgements[i].row->symbol);
    separator = "; ";
  }
  fputs("</td>", out);
}

static void put_um(FILE *out, double mm) {
  if (isfinite(mm))
    fprintf(out, "%s%.1f", mm < 0 ? "−" : "", UM_PER_MM * fabs(mm));
  else
    fputs("–", out);
}

static void put_bearing_row(FILE *out, const fg_lot_analysis *analysis,
                            const fg_lot_bearing *bearing) {
  fputs("<tr><td>", out);
  put_bearing_name(out, bearing);
  fputs("</td><td class=\"words\">", out);
  for (size_t pad = 0; pad < analysis->layout.pads; pad++) {
    if (pad) fputs(", ", out);
    if (bearing->pad[pad])
      fg_lot_put_foil_link(out, analysis, bearing->pad[pad]);
    else
      fputs("–", out);
  }
  fputs("</td>", out);
  put_bearing_verdict(out, analysis, bearing);
  const fg_quantity *shown[FG_QUANTITY_SHOWN_MAX];
  size_t count = fg_quantity_shown(FG_QUANTITY_OF_BEARING, FG_QUANTITY_ON_PAGE,
                                   analysis->lot->settings.design.kind, shown);
  for (size_t i = 0; i < count; i++) {
    double u = UM_PER_MM * fg_quantity_uncertainty(shown[i], &bearing->clearance);
    fputs("<td>", out);
    put_um(out, bearing->known ? fg_quantity_value(shown[i], &bearing->clearance) : NAN);
    if (bearing->known && isfinite(u)) fprintf(out, " <i>± %.2f</i>", FG_COVERAGE_FACTOR * u);
    fputs("</td>", out);
  }
  fputs("</tr>\n", out);
}

/* Puts the limits above their columns. */
static void put_limit_row(FILE *out, const fg_lot_analysis *analysis) {
  const fg_design *design = &analysis->lot->settings.design;
  const fg_quantity *shown[FG_QUANTITY_SHOWN_MAX];
  size_t count = fg_quantity_shown(FG_QUANTITY_OF_BEARING, FG_QUANTITY_ON_PAGE,
                                   analysis->lot->settings.design.kind, shown);
  if (!is_bearing_judged(analysis)) return;
  fputs("<tr class=\"limits\"><td>tolerance</td><td></td><td></td>", out);
  for (size_t i = 0; i < count; i++) {
    fputs("<td>", out);
    for (size_t k = 0; k < design->tolerance_count; k++) {
      const fg_tolerance *tolerance = &design->tolerances[k];
      if (fg_quantity_of_bearing_for(tolerance->quantity) != shown[i]) continue;
      bool both = isfinite(tolerance->lower) && isfinite(tolerance->upper);
      if (isfinite(tolerance->lower)) {
        fputs(both ? "" : "≥ ", out);
        fg_lot_put_number(out, UM_PER_MM * tolerance->lower, 6);
      }
      if (isfinite(tolerance->upper)) {
        fputs(both ? " … " : "≤ ", out);
        fg_lot_put_number(out, UM_PER_MM * tolerance->upper, 6);
      }
    }
    fputs("</td>", out);
  }
  fputs("</tr>\n", out);
}

static void put_bearing_table(FILE *out, const fg_lot_analysis *analysis) {
  const fg_quantity *shown[FG_QUANTITY_SHOWN_MAX];
  size_t count = fg_quantity_shown(FG_QUANTITY_OF_BEARING, FG_QUANTITY_ON_PAGE,
                                   analysis->lot->settings.design.kind, shown);
  fputs("<div class=\"scroll\"><table><thead><tr><th>bearing</th><th>pads</th>", out);
  if (is_bearing_judged(analysis)) fputs("<th>verdict</th>", out);
  for (size_t i = 0; i < count; i++)
    fprintf(out, "<th>%s<br>µm</th>", shown[i]->symbol);
  fputs("</tr></thead>\n<tbody>\n", out);
  put_limit_row(out, analysis);
  for (size_t i = 0; i < analysis->bearing_count && i < BEARING_ROWS_MAX; i++)
    put_bearing_row(out, analysis, &analysis->bearings[i]);
  fputs("</tbody></table></div>\n", out);
  if (analysis->bearing_count > BEARING_ROWS_MAX)
    fprintf(out, "<p class=\"note\">The first %d of %zu; the rest: bearings.csv.</p>\n",
            BEARING_ROWS_MAX, analysis->bearing_count);
}

static void put_mean_and_sd(FILE *out, const fg_lot_spread *spread) {
  fputs("mean ", out);
  fg_lot_put_number(out, spread->mean, 4);
  fputs(" %, s ", out);
  fg_lot_put_number(out, spread->sd, 4);
  fputs(" %", out);
}

/* Draws bearings that do not pass before others, where not all can be drawn. */
static bool is_drawn(const fg_lot_analysis *analysis, size_t bearing) {
  size_t before = 0;
  bool good = analysis->bearings[bearing].decision.outcome.verdict == FG_VERDICT_PASS;
  for (size_t i = 0; i < analysis->bearing_count; i++) {
    bool other = analysis->bearings[i].decision.outcome.verdict == FG_VERDICT_PASS;
    before += other == good ? i < bearing : good;
  }
  return before < POLAR_MAX;
}

static void put_bearing_counts(FILE *out, const fg_lot_analysis *analysis,
                               const fg_lot_bearing *bearing) {
  if (is_bearing_judged(analysis))
    fprintf(out, ": %s", fg_html_verdict_title(bearing->decision.outcome.verdict));
  if (!bearing->known) fputs(": not known, a foil or a value is missing", out);
}

/* Puts the layout, drawings of bearings, and a line for each. */
static void put_assembled(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_settings *settings = &analysis->lot->settings;
  bool assumed =
      fg_manifest_column(&analysis->lot->manifest, settings->bearing_column) == FG_NO_COLUMN;
  fprintf(out,
          "<p class=\"note\">%zu pads of %zu bumps, %.2f° apart, from bump %zu of each foil; "
          "clearances of the foils fitted into the sleeve%s.%s%s</p>\n<div class=\"bearings\">\n",
          analysis->layout.pads, analysis->layout.bumps_per_pad,
          fg_bearing_pitch_deg(&analysis->layout), analysis->layout.first_bump,
          assumed ? ". The manifest assigns no bearing: foils in a row are taken together" : "",
          analysis->layout_note[0] ? " " : "", analysis->layout_note);
  for (size_t i = 0; i < analysis->bearing_count; i++) {
    if (!is_drawn(analysis, i)) continue;
    fputs("<figure>", out);
    fg_lot_plot_polar(out, analysis, &analysis->bearings[i]);
    fputs("<figcaption>Bearing ", out);
    put_bearing_name(out, &analysis->bearings[i]);
    put_bearing_counts(out, analysis, &analysis->bearings[i]);
    fputs("</figcaption></figure>\n", out);
  }
  fprintf(out,
          "</div>\n<p class=\"note\">Radial lines: pads; red, dashed: no clearance; grey, dashed: "
          "as designed, %.0f µm; red dots: bumps that touch.",
          UM_PER_MM * analysis->lot->nominal.clearance_mm);
  if (analysis->bearing_count > POLAR_MAX)
    fprintf(out,
            " <b>%d of %zu bearings are drawn</b>, those that do not pass first; %zu are not: "
            "bearings.csv has them.",
            POLAR_MAX, analysis->bearing_count, analysis->bearing_count - POLAR_MAX);
  fputs("</p>\n", out);
  put_bearing_table(out, analysis);
}

/* Puts the foils that are in no bearing, and tolerances that therefore judge nothing. */
static void put_unplaced(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_unplaced *unplaced = &analysis->unplaced;
  const fg_lot_settings *settings = &analysis->lot->settings;
  bool assumed =
      fg_manifest_column(&analysis->lot->manifest, settings->bearing_column) == FG_NO_COLUMN;
  if (is_bearing_judged(analysis) && !analysis->bearing_count)
    fprintf(out,
            "<p class=\"reasons\"><b>Not measured:</b> the design states tolerances of a bearing, "
            "and these foils make none: a bearing takes %zu.</p>\n",
            analysis->layout.pads);
  if (unplaced->without)
    fprintf(out, "<p class=\"note\">In no bearing: %zu foil%s%s.</p>\n", unplaced->without,
            fg_plural(unplaced->without),
            assumed ? "; too few are left for another one" : "; the manifest names none for them");
  if (unplaced->displaced)
    fprintf(out,
            "<p class=\"reasons\"><b>Left out: %zu foil%s.</b> The manifest gives them a pad "
            "that another foil has already, or a bearing whose %zu pads are taken.</p>\n",
            unplaced->displaced, fg_plural(unplaced->displaced), analysis->layout.pads);
  if (unplaced->bad_pads)
    fprintf(out,
            "<p class=\"reasons\"><b>No number from 1 to %zu: %zu pad%s of the manifest.</b> Their "
            "foils "
            "took the next free one.</p>\n",
            analysis->layout.pads, unplaced->bad_pads, fg_plural(unplaced->bad_pads));
}

void fg_lot_put_bearings(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_settings *settings = &analysis->lot->settings;
  const fg_lot_quantity *clearance = fg_lot_find_quantity(analysis, "clearance_fitted_mm");
  double nominal = analysis->lot->nominal.clearance_mm;
  fputs("<section class=\"part\">\n<h1>Clearance of the bearings</h1>\n<figure>", out);
  fg_lot_plot_density(out, clearance, 100 / nominal, -100,
                      "local clearance against design, foil fitted, %");
  fputs("<figcaption>100 (C − C<sub>D</sub>) / C<sub>D</sub> of every bump, its foil fitted into "
        "the sleeve: ",
        out);
  put_mean_and_sd(out, &analysis->clearance_fitted_pct);
  fputs(". The foils free, as scanned: ", out);
  put_mean_and_sd(out, &analysis->clearance_pct);
  fputs(".</figcaption></figure>\n", out);
  if (analysis->thickness.differs) {
    double more = analysis->thickness.mean.mm - settings->design.thickness_mm;
    fputs("<p class=\"note\">Clearances are over the strips as they are: they measure ", out);
    fg_lot_put_thickness(out, analysis);
    fprintf(out, "; with the design's thickness clearances would be %.3g µm %s.</p>\n",
            1000 * fabs(more), more > 0 ? "larger" : "smaller");
  }
  put_unplaced(out, analysis);
  if (analysis->bearing_count) put_assembled(out, analysis);
  fputs("</section>\n", out);
}
