/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lot's page: statistics of the quantities, capability, charts, springback. */
#include <math.h>
#include <string.h>

#include "core/text.h"
#include "foilgauge/words.h"
#include "page/page.h"
#include "page/table.h"
#include "report/lot/members.h"
#include "report/lot/page_parts.h"
#include "report/lot/plots.h"

static bool find_stated(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_lot_analysis *analysis = list->whole;
  const fg_lot_quantity *quantity = &analysis->quantities[i];
  if (i >= analysis->quantity_count) return false;
  bool unstated = !quantity->count && !quantity->tolerance; /* such as without a sagitta */
  element->object = unstated && quantity->owner == FG_QUANTITY_OF_BEAM ? NULL : quantity;
  return true;
}

static void put_quantity_rows(FILE *out, const fg_lot_analysis *analysis) {
  fputs("<h1>Quantities</h1>\n", out);
  fg_html_table(out, &fg_lot_quantity_members,
                &(fg_subject){.whole = analysis, .index = FG_LOT_VALUES}, find_stated);
  if (analysis->left_out)
    fprintf(out,
            "<p class=\"reasons\"><b>%zu of %zu %s %s:</b> judged, but in no statistics%s of this "
            "page.</p>\n",
            analysis->left_out, analysis->part_count, fg_lot_words_of(analysis)->many,
            fg_lot_words_of(analysis)->how,
            analysis->parts == FG_QUANTITY_OF_BUMP ? ", stiffness or clearance" : "");
}

static bool find_known(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_lot_analysis *analysis = list->whole;
  if (i >= analysis->quantity_count) return false;
  element->object = isfinite(analysis->quantities[i].mean_u.u) ? &analysis->quantities[i] : NULL;
  return true;
}

static void put_mean_u(FILE *out, const fg_lot_analysis *analysis) {
  const fg_calibration *calibration = &analysis->lot->settings.design.calibration;
  if (!calibration->stated) {
    fputs("<p class=\"note\">U holds statistics only: no calibration is stated.</p>\n", out);
    return;
  }
  fputs("<h2>How well the means are known</h2>\n", out);
  fg_html_table(out, &fg_lot_quantity_members,
                &(fg_subject){.whole = analysis, .index = FG_LOT_MEAN_U}, find_known);
  fputs("<p class=\"note\">What the scans&#39; statistics leave averages "
        "out over the foils, but for the thickness, whose uncertainty they share; what the calibration "
        "leaves is the same error in each, so no number "
        "of foils makes it smaller. Spreads, charts and differences of foils of one scanner are "
        "free of it.</p>\n",
        out);
}

static bool find_capable(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_lot_analysis *analysis = list->whole;
  if (i >= analysis->quantity_count) return false;
  element->object = analysis->quantities[i].has_capability ? &analysis->quantities[i] : NULL;
  return true;
}

static void put_capability(FILE *out, const fg_lot_analysis *analysis) {
  bool any = false;
  for (size_t i = 0; i < analysis->quantity_count; i++)
    any = any || analysis->quantities[i].has_capability;
  if (!any) return;
  fputs("<h2>Capability</h2>\n", out);
  fg_html_table(out, &fg_lot_capability_members, &(fg_subject){.whole = analysis}, find_capable);
  fprintf(out,
          "<p class=\"note\">Intervals at %.4g %%. Cp and Cpk speak of what "
          "the process will do, so they are stated only while chance explains the signals of its "
          "control charts; "
          "otherwise Pp and Ppk tell what it did. The intervals of Ppk and Cpk hold the error that "
          "all foils share (calibration, tone curve); where nothing is known of the scanner's "
          "scale, they have none.</p>\n",
          100 * analysis->lot->settings.confidence);
}

/* Puts the decision on the signals, and its reason. */
static void put_chance(FILE *out, const char *name, const fg_chart *chart,
                       const fg_chart_chance *chance) {
  if (!chart->signals) return;
  if (chance->outliers)
    fprintf(out, " %s: %zu of them lie%s farther out than chance explains.", name, chance->outliers,
            chance->outliers == 1 ? "s" : "");
  else
    fprintf(out, " %s: chance explains up to %zu, so %s.", name, chance->max,
            chance->steady ? "it is stable" : "it is not stable");
}

static void put_chart_signals(FILE *out, const fg_lot_quantity *quantity) {
  unsigned rules = 0;
  for (size_t i = 0; i < quantity->chart.count; i++)
    rules |= quantity->chart.point[i].rules;
  fprintf(out, "%zu signal%s", quantity->chart.signals, quantity->chart.signals == 1 ? "" : "s");
  for (unsigned rule = 1; rule <= FG_RUN_RULES; rule++)
    if (rules & (1u << (rule - 1))) fprintf(out, "; %s", fg_run_rule_words(rule));
  if (quantity->has_subgroups)
    fprintf(out, ". Spread within foils: %zu signal%s", quantity->deviations.signals,
            quantity->deviations.signals == 1 ? "" : "s");
  fputs(".", out);
  put_chance(out, "Chart", &quantity->chart, &quantity->chance);
  if (quantity->has_subgroups)
    put_chance(out, "Spread", &quantity->deviations, &quantity->spread_chance);
}

static void put_control_chart(FILE *out, const fg_lot_analysis *analysis,
                              const fg_lot_quantity *quantity) {
  fputs("<figure>", out);
  fg_lot_plot_chart(out, analysis, quantity);
  fputs("<figcaption>", out);
  put_chart_signals(out, quantity);
  if (quantity->cause.column != FG_NO_COLUMN) {
    fputs(" They", out);
    fg_lot_put_cause(out, analysis, quantity);
  }
  fputs("</figcaption></figure>\n", out);
}

static bool is_charted(const fg_lot_analysis *analysis, const fg_lot_quantity *quantity) {
  for (const char *const *name = fg_lot_charted; *name; name++)
    if (!strcmp(quantity->row->name, *name)) return quantity->has_chart;
  return fg_lot_is_watched(analysis, quantity) && !quantity->stable;
}

static void put_charts(FILE *out, const fg_lot_analysis *analysis) {
  fprintf(out,
          "<h2>How the process runs</h2>\n<p class=\"note\">Red, dashed: three sigma from foil to "
          "foil about the mean. Red squares: signals. What chance explains "
          "has a level of %d %%: of 100 steady charts about %d has more.</p>\n",
          FG_LOT_CHART_LEVEL_PCT, FG_LOT_CHART_LEVEL_PCT);
  for (size_t i = 0; i < analysis->quantity_count; i++)
    if (is_charted(analysis, &analysis->quantities[i]))
      put_control_chart(out, analysis, &analysis->quantities[i]);
}

void fg_lot_put_quantities(FILE *out, const fg_lot_analysis *analysis) {
  fputs("<section class=\"part\">\n", out);
  put_quantity_rows(out, analysis);
  put_mean_u(out, analysis);
  put_capability(out, analysis);
  put_charts(out, analysis);
  fputs("</section>\n", out);
}

/* Puts the distance of the lot's means from the curve, in words. */
static void put_against_curve(FILE *out, const fg_lot_quantity *quantity,
                              const fg_lot_curve *curve) {
  double sum = 0, max = 0, value;
  int bumps = 0, at = 0;
  for (size_t i = 0; fg_lot_curve_value(curve, quantity->row, i, &value); i++) {
    size_t place = (size_t)curve->point[i].bump - 1;
    if (place >= quantity->places || !quantity->place[place].count) continue;
    double off = quantity->place[place].mean - value;
    sum += off;
    bumps++;
    if (bumps > 1 && fabs(off) <= fabs(max)) continue;
    max = off;
    at = curve->point[i].bump;
  }
  if (!bumps) return;
  fprintf(out, " %s: %+.3g percentage points on the mean of %d bumps, farthest %+.3g at bump %d.",
          quantity->row->words, sum / bumps, bumps, max, at);
}

/* Puts figure 5.17 of the thesis: both errors by bump number, with the reference curve. */
static void put_errors_by_bump(FILE *out, const fg_lot_analysis *analysis) {
  static const char *const shown[] = {"radius_error_pct", "intersection_angle_error_pct",
                                      "bump_angle_error_pct"};
  const fg_lot_curve *curve = &analysis->lot->settings.curve;
  const fg_lot_quantity *last = NULL;
  for (size_t i = 0; i < sizeof shown / sizeof *shown; i++) {
    const fg_lot_quantity *quantity = fg_lot_find_quantity(analysis, shown[i]);
    if (!quantity) continue;
    if (last)
      fputs("</figure>\n<figure>",
            out); /* in a figure of its own, so that a printed page can break */
    fg_lot_plot_places(out, analysis, quantity, curve);
    last = quantity;
  }
  fputs("<figcaption>Errors of the bump radius (e_R), the intersection angle θ (e_θ) and the bump "
        "angle α (e_α) of each bump number. ",
        out);
  if (last) fg_lot_put_places_key(out, analysis, last);
  if (curve->count) {
    fputs(" Diamonds, dashed: the reference curve ", out);
    fg_html_text(out, curve->name);
    fputs(". The lot against it:", out);
    for (size_t i = 0; i < 2; i++) {
      const fg_lot_quantity *quantity = fg_lot_find_quantity(analysis, shown[i]);
      if (quantity) put_against_curve(out, quantity, curve);
    }
  }
  fputs("</figcaption></figure>\n", out);
}

static void put_correlation(FILE *out, const fg_lot_correlation *line) {
  fprintf(out,
          "<figcaption>Dashed: constant arc length. Orange: least squares over %zu bumps (%zu "
          "trimmed by their radius), slope ",
          line->count - line->trimmed, line->trimmed);
  fg_lot_put_decimals(out, line->slope, 3);
  fputs(", r ", out);
  fg_lot_put_decimals(out, line->r, 3);
  fputs(". In logarithms, where a constant arc length is a slope of −1 exactly: ", out);
  fg_lot_put_decimals(out, line->log_slope, 4);
  if (isfinite(line->log_dof)) {
    fputs(" (", out);
    fg_lot_put_decimals(out, line->log_low, 4);
    fputs(" … ", out);
    fg_lot_put_decimals(out, line->log_high, 4);
    fprintf(out, "; bumps of %zu foil%s, %.1f degrees of freedom)", line->foils,
            fg_plural(line->foils), line->log_dof);
  }
  fprintf(out, ". Arc length against the design, all %zu bumps: ", line->count);
  fg_lot_put_decimals(out, line->arc_length_mean_pct, 3);
  fputs(" %, s ", out);
  fg_lot_put_decimals(out, line->arc_length_sd_pct, 3);
  fputs(" %.</figcaption></figure>\n", out);
}

void fg_lot_put_springback(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_quantity *radius = fg_lot_find_quantity(analysis, "radius_mm");
  fputs("<section class=\"part\">\n<h1>Springback</h1>\n<figure>", out);
  put_errors_by_bump(out, analysis);
  fputs("<h2>Radius over design</h2>\n<figure>", out);
  fg_lot_plot_density(out, radius, 1 / analysis->lot->settings.design.bumps.radius_mm, 0,
                      "radius over design");
  fputs("<figcaption>Histogram and kernel density.</figcaption></figure>\n", out);
  if (analysis->has_correlation) {
    fputs("<h2>Angle against radius</h2>\n<figure>", out);
    fg_lot_plot_correlation(out, analysis);
    put_correlation(out, &analysis->correlation);
  }
  fputs("</section>\n", out);
}

void fg_lot_put_arcs(FILE *out, const fg_lot_analysis *analysis) {
  const fg_design *design = &analysis->lot->settings.design;
  const struct {
    const char *name, *words;
    double design;
  } shown[] = {
      {"overall.radius_mm", "radius over design", design->overall_radius_mm},
      {"arc.subtended_angle_deg", "angle over design", design->arc.subtended_angle_deg},
  };
  fputs("<section class=\"part\">\n<h1>Springback</h1>\n", out);
  for (size_t i = 0; i < sizeof shown / sizeof *shown; i++) {
    const fg_lot_quantity *quantity = fg_lot_find_quantity(analysis, shown[i].name);
    if (!quantity || !quantity->has_density) continue;
    fputs("<figure>", out);
    fg_lot_plot_density(out, quantity, 1 / shown[i].design, 0, shown[i].words);
    fprintf(out,
            "<figcaption>%s over the design's %g, %zu foil%s: mean %.5f.</figcaption></figure>\n",
            quantity->row->words, shown[i].design, quantity->count, fg_plural(quantity->count),
            quantity->mean / shown[i].design);
  }
  fputs("</section>\n", out);
}
