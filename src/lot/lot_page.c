/* The lot's page: verdict, counts, the worst three and one chart first; then the details. */
#include <math.h>
#include <string.h>

#include "core/file.h"
#include "lot/lot_plots.h"
#include "lot/page_parts.h"
#include "lot/writers.h"
#include "quantity/quantity.h"
#include "report/measure/measure_page_parts.h"
#include "report/measure/scan_model_words.h"

enum { FOIL_ROWS_MAX = 300, POLAR_MAX = 4, BEARING_ROWS_MAX = 200, UM_PER_MM = 1000 };

static void put_tile(FILE *out, const char *title, size_t count) {
  fprintf(out, "<div><dt>%s</dt><dd>%zu</dd></div>\n", title, count);
}

static void put_tiles(FILE *out, const fg_lot_analysis *analysis) {
  const size_t *by = analysis->by_verdict;
  fputs("<dl class=\"tiles\">\n", out);
  put_tile(out, "Foils", analysis->foil_count);
  bool judged = analysis->lot->settings.design.tolerance_count > 0;
  if (judged) put_tile(out, "Pass", by[FG_VERDICT_PASS]);
  if (judged || by[FG_VERDICT_FAIL]) put_tile(out, "Fail", by[FG_VERDICT_FAIL]);
  if (judged) put_tile(out, "Cannot tell", by[FG_VERDICT_UNDECIDED]);
  put_tile(out, "Not measured", by[FG_VERDICT_NOT_MEASURED] + analysis->failed_scans);
  fputs("</dl>\n", out);
}

static void put_label(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil) {
  fg_html_text(out, fg_manifest_label(&analysis->lot->manifest, foil->item));
  if (analysis->lot->records[foil->item].foil_count > 1)
    fprintf(out, ", foil %d", foil->foil->number);
}

/* What stands against a foil most: what it is, or its farthest value. */
static void put_reason(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil) {
  char defect[200];
  if (foil->foil->error[0]) {
    fg_html_text(out, foil->foil->error);
  } else if (fg_foil_defect(&analysis->lot->settings.design, foil->foil, defect, sizeof defect)) {
    fputs(defect, out);
  } else if (foil->worst_field) {
    fputs(foil->worst_field->words, out);
    if (foil->worst_number) fprintf(out, " of bump %d", foil->worst_number);
    fputs(": ", out);
    put_number(out, foil->worst_value, 5);
    fprintf(out, " %s", foil->worst_field->unit);
  }
}

static void put_worst(FILE *out, const fg_lot_analysis *analysis) {
  if (!analysis->worst[0]) return;
  fputs("<h2>The worst three</h2>\n<ol class=\"worst\">\n", out);
  for (int i = 0; i < 3 && analysis->worst[i]; i++) {
    const fg_lot_foil *foil = analysis->worst[i];
    fputs("<li><b>", out);
    put_label(out, analysis, foil);
    fputs("</b>: ", out);
    put_reason(out, analysis, foil);
    fputs("</li>\n", out);
  }
  fputs("</ol>\n", out);
}

/* What the first chart shows: the first bump quantity with a tolerance, else the height. */
static const fg_lot_quantity *leading_quantity(const fg_lot_analysis *analysis) {
  for (size_t i = 0; i < analysis->quantity_count; i++)
    if (analysis->quantities[i].tolerance && analysis->quantities[i].owner == FG_QUANTITY_OF_BUMP)
      return &analysis->quantities[i];
  return fg_lot_find_quantity(analysis, "height_mm");
}

/* By what, what it did at most, and how many foils it was not made for. */
static fg_status put_corrected(fg_context *ctx, FILE *out, const fg_lot_analysis *analysis) {
  char moved[FG_CORRECTION_WORDS], added[FG_CORRECTION_WORDS];
  const fg_correction most = fg_lot_correction_largest(analysis);
  size_t beyond = 0;
  fg_correction_moved(&most, moved, sizeof moved);
  fg_correction_added(&most, added, sizeof added);
  FG_TRY(fg_html_corrected(ctx, out, analysis->lot->model, moved, added));
  for (size_t i = 0; i < analysis->foil_count; i++)
    beyond += (analysis->foils[i].foil->flags & FG_FOIL_BEYOND_MODEL_REGION) != 0;
  if (beyond)
    fprintf(
        out,
        "<ul class=\"flags\"><li>%zu of %zu foils reach beyond the region that the scanner&#39;s "
        "model was found in: there the correction is not known to hold (flag "
        "beyond_model_region in foils.csv).</li></ul>\n",
        beyond, analysis->foil_count);
  return FG_OK;
}

static fg_status put_first_screen(fg_context *ctx, FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_quantity *leading = leading_quantity(analysis);
  fputs("<section>\n<header><h1>", out);
  fg_html_text(out, analysis->lot->settings.name);
  fputs("</h1>", out);
  fg_html_outcome(out, &analysis->outcome);
  fprintf(out, "<p>%zu foils of %zu scans, design ", analysis->foil_count,
          analysis->lot->manifest.items);
  fg_html_text(out, analysis->lot->settings.design.name);
  fputs("</p></header>\n", out);
  FG_TRY(put_corrected(ctx, out, analysis));
  put_tiles(out, analysis);
  put_worst(out, analysis);
  if (leading) {
    fputs("<figure>", out);
    fg_lot_plot_places(out, leading);
    fprintf(out,
            "<figcaption>%s of each bump number: mean and two standard deviations over the "
            "foils%s.</figcaption></figure>\n",
            leading->field->words, leading->tolerance ? "; red: tolerance" : "");
  }
  fputs("</section>\n", out);
  return FG_OK;
}

static void put_failed_scans(FILE *out, const fg_lot_analysis *analysis) {
  size_t told = 0;
  if (!analysis->failed_scans) return;
  fprintf(out, "<section>\n<h1>Scans that could not be measured: %zu</h1>\n<ul>\n",
          analysis->failed_scans);
  for (size_t i = 0; i < analysis->lot->manifest.items && told < FOIL_ROWS_MAX; i++) {
    if (!analysis->lot->records[i].error) continue;
    told++;
    fputs("<li>", out);
    fg_html_text(out, analysis->lot->records[i].error);
    fputs("</li>\n", out);
  }
  fputs("</ul>\n", out);
  if (told < analysis->failed_scans) fputs("<p class=\"note\">The rest: foils.csv.</p>\n", out);
  fputs("</section>\n", out);
}

static void put_quantity_rows(FILE *out, const fg_lot_analysis *analysis) {
  fputs("<h1>Quantities</h1>\n<div class=\"scroll\"><table><thead><tr><th>quantity</th><th>unit"
        "</th><th>n</th><th>mean</th><th>s</th><th>median</th><th>mode</th><th>min</th><th>max</th>"
        "<th>runs</th></tr></thead>\n<tbody>\n",
        out);
  for (size_t i = 0; i < analysis->quantity_count; i++) {
    const fg_lot_quantity *quantity = &analysis->quantities[i];
    const double values[] = {quantity->mean, quantity->sd,    quantity->median,
                             quantity->mode, quantity->least, quantity->most};
    fprintf(out, "<tr><td>%s</td><td>%s</td><td>%zu</td>", quantity->field->words,
            quantity->field->unit, quantity->count);
    for (size_t k = 0; k < sizeof values / sizeof *values; k++) {
      fputs("<td>", out);
      put_number(out, values[k], k == 1 ? 3 : 6);
      fputs("</td>", out);
    }
    fprintf(out, "<td>%s</td></tr>\n",
            !quantity->has_chart ? "–"
            : quantity->stable   ? "stable"
                                 : "not stable");
  }
  fputs("</tbody></table></div>\n", out);
  if (analysis->crushed)
    fprintf(out,
            "<p class=\"note\">%zu of %zu bumps are crushed: they are in no statistics, stiffness "
            "or clearance of this page.</p>\n",
            analysis->crushed, analysis->bumps);
}

static void put_ratio(FILE *out, const fg_ratio *ratio) {
  fputs("<td>", out);
  put_number(out, ratio->value, 3);
  if (isfinite(ratio->value)) {
    fputs(" <i>", out);
    put_number(out, ratio->low, 3);
    fputs(" … ", out);
    put_number(out, ratio->high, 3);
    fputs("</i>", out);
  }
  fputs("</td>", out);
}

static void put_capability_row(FILE *out, const fg_lot_quantity *quantity) {
  const fg_capability *capability = &quantity->capability;
  fprintf(out, "<tr><td>%s</td><td>", quantity->field->words);
  put_number(out, quantity->tolerance->lower, 6);
  fputs(" … ", out);
  put_number(out, quantity->tolerance->upper, 6);
  fputs("</td>", out);
  put_ratio(out, &capability->p);
  put_ratio(out, &capability->pk);
  put_ratio(out, &capability->c);
  put_ratio(out, &capability->ck);
  fputs("<td>", out);
  put_number(out, capability->quantile_pk, 3);
  fprintf(out, "</td><td class=\"words\">%s, %s</td></tr>\n",
          capability->stable ? "stable" : "not stable",
          capability->normal ? "normal" : "not normal: the quantile method holds");
}

static void put_capability(FILE *out, const fg_lot_analysis *analysis) {
  bool any = false;
  for (size_t i = 0; i < analysis->quantity_count; i++)
    any = any || analysis->quantities[i].has_capability;
  if (!any) return;
  fputs("<h2>Capability</h2>\n<div class=\"scroll\"><table><thead><tr><th>quantity</th><th>"
        "tolerance</th><th>Pp</th><th>Ppk</th><th>Cp</th><th>Cpk</th><th>Ppk by quantiles</th><th>"
        "</th></tr></thead>\n<tbody>\n",
        out);
  for (size_t i = 0; i < analysis->quantity_count; i++)
    if (analysis->quantities[i].has_capability) put_capability_row(out, &analysis->quantities[i]);
  fprintf(
      out,
      "</tbody></table></div>\n<p class=\"note\">Intervals at %.4g %%. Cp and Cpk speak of what "
      "the process will do, so they are stated only while its control charts show no signal; "
      "otherwise Pp and Ppk tell what it did.</p>\n",
      100 * analysis->lot->settings.confidence);
}

static void put_signals(FILE *out, const fg_lot_quantity *quantity) {
  unsigned rules = 0;
  for (size_t i = 0; i < quantity->chart.count; i++)
    rules |= quantity->chart.point[i].rules;
  fprintf(out, "Limits at three sigma from foil to foil; %zu signals", quantity->chart.signals);
  for (unsigned rule = 1; rule <= FG_RUN_RULES; rule++)
    if (rules & (1u << (rule - 1))) fprintf(out, "; %s", fg_run_rule_words(rule));
  if (quantity->has_subgroups)
    fprintf(out, ". Spread within foils: %zu signals", quantity->deviations.signals);
  fputs(".", out);
}

static void put_charts(FILE *out, const fg_lot_analysis *analysis) {
  static const char *const shown[] = {"radius_error_pct", "height_mm", "overall.radius_mm"};
  fputs("<h2>How the process runs</h2>\n", out);
  for (size_t i = 0; i < sizeof shown / sizeof *shown; i++) {
    const fg_lot_quantity *quantity = fg_lot_find_quantity(analysis, shown[i]);
    if (!quantity || !quantity->has_chart) continue;
    fputs("<figure>", out);
    fg_lot_plot_chart(out, quantity);
    fputs("<figcaption>", out);
    put_signals(out, quantity);
    fputs("</figcaption></figure>\n", out);
  }
}

static void put_springback(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_quantity *radius = fg_lot_find_quantity(analysis, "radius_mm");
  const fg_lot_quantity *errors = fg_lot_find_quantity(analysis, "radius_error_pct");
  const fg_lot_quantity *angles = fg_lot_find_quantity(analysis, "bump_angle_error_pct");
  fputs("<section>\n<h1>Springback</h1>\n<figure>", out);
  fg_lot_plot_places(out, errors);
  fg_lot_plot_places(out, angles);
  fputs("<figcaption>Each bump number: mean and two standard deviations over the foils."
        "</figcaption></figure>\n<h2>Radius over design</h2>\n<figure>",
        out);
  fg_lot_plot_density(out, radius, 1 / analysis->lot->settings.design.bump_radius_mm, 0,
                      "radius over design");
  fputs("<figcaption>Histogram and kernel density.</figcaption></figure>\n", out);
  if (analysis->has_correlation) {
    const fg_lot_correlation *line = &analysis->correlation;
    fputs("<h2>Angle against radius</h2>\n<figure>", out);
    fg_lot_plot_correlation(out, analysis);
    fprintf(out,
            "<figcaption>Dashed: constant arc length. Orange: least squares over %zu bumps (%zu "
            "trimmed by their radius), slope %.3f, r %.3f. In logarithms, where a constant arc "
            "length is a slope of −1 exactly: %.4f",
            line->count - line->trimmed, line->trimmed, line->slope, line->r, line->log_slope);
    if (isfinite(line->log_freedom))
      fprintf(out, " (%.4f … %.4f; bumps of %zu foils, %.1f degrees of freedom)", line->log_low,
              line->log_high, line->foils, line->log_freedom);
    fprintf(out,
            ". Arc length against the design, all %zu bumps: %+.3f %%, s %.3f %%."
            "</figcaption></figure>\n",
            line->count, line->arc_length_mean_pct, line->arc_length_sd_pct);
  }
  fputs("</section>\n", out);
}

static void put_bearing_name(FILE *out, const fg_lot_bearing *bearing) {
  if (bearing->name)
    fg_html_text(out, bearing->name);
  else
    fprintf(out, "%zu", bearing->number);
}

static void put_bearing_row(FILE *out, const fg_lot_analysis *analysis,
                            const fg_lot_bearing *bearing) {
  fputs("<tr><td>", out);
  put_bearing_name(out, bearing);
  fputs("</td><td class=\"words\">", out);
  for (size_t pad = 0; pad < analysis->layout.pads; pad++) {
    if (pad) fputs(", ", out);
    if (bearing->pad[pad])
      put_label(out, analysis, bearing->pad[pad]);
    else
      fputs("–", out);
  }
  fputs("</td>", out);
  const fg_quantity *shown[FG_QUANTITY_SHOWN_MAX];
  size_t count = fg_quantity_shown(FG_QUANTITY_OF_BEARING, FG_QUANTITY_ON_PAGE, shown);
  for (size_t i = 0; i < count; i++) {
    double value = fg_quantity_value(shown[i], &bearing->clearance);
    fputs("<td>", out);
    put_number(out, bearing->known ? UM_PER_MM * value : NAN, 4);
    fputs("</td>", out);
  }
  fputs("</tr>\n", out);
}

static void put_bearing_table(FILE *out, const fg_lot_analysis *analysis) {
  const fg_quantity *shown[FG_QUANTITY_SHOWN_MAX];
  size_t count = fg_quantity_shown(FG_QUANTITY_OF_BEARING, FG_QUANTITY_ON_PAGE, shown);
  fputs("<div class=\"scroll\"><table><thead><tr><th>bearing</th><th>pads</th>", out);
  for (size_t i = 0; i < count; i++)
    fprintf(out, "<th>%s<br>µm</th>", shown[i]->symbol);
  fputs("</tr></thead>\n<tbody>\n", out);
  for (size_t i = 0; i < analysis->bearing_count && i < BEARING_ROWS_MAX; i++)
    put_bearing_row(out, analysis, &analysis->bearings[i]);
  fputs("</tbody></table></div>\n", out);
  if (analysis->bearing_count > BEARING_ROWS_MAX)
    fprintf(out, "<p class=\"note\">The first %d of %zu; the rest: lot.json.</p>\n",
            BEARING_ROWS_MAX, analysis->bearing_count);
}

static void put_mean_and_sd(FILE *out, const fg_lot_spread *spread) {
  fputs("mean ", out);
  put_number(out, spread->mean, 4);
  fputs(" %, s ", out);
  put_number(out, spread->sd, 4);
  fputs(" %", out);
}

static void put_bearings(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_settings *settings = &analysis->lot->settings;
  const fg_lot_quantity *clearance = fg_lot_find_quantity(analysis, "clearance_fitted_mm");
  double nominal = analysis->lot->nominal.clearance_mm;
  fputs("<section>\n<h1>Clearance of the bearings</h1>\n<figure>", out);
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
  if (analysis->bearing_count) {
    bool assumed =
        fg_manifest_column(&analysis->lot->manifest, settings->bearing_column) == FG_NO_COLUMN;
    fprintf(out,
            "<p class=\"note\">%zu pads of %zu bumps, %.2f° apart, from bump %zu of each foil; "
            "clearances of the foils fitted into the sleeve%s.%s%s</p>\n<div class=\"pair\">\n",
            analysis->layout.pads, analysis->layout.bumps_per_pad,
            fg_bearing_pitch_deg(&analysis->layout), analysis->layout.first_bump,
            assumed ? ". The manifest assigns no bearing: foils in a row are taken together" : "",
            analysis->layout_note[0] ? " " : "", analysis->layout_note);
    for (size_t i = 0; i < analysis->bearing_count && i < POLAR_MAX; i++) {
      fputs("<figure>", out);
      fg_lot_plot_polar(out, analysis, &analysis->bearings[i]);
      fputs("<figcaption>Bearing ", out);
      put_bearing_name(out, &analysis->bearings[i]);
      fputs("; radial lines: pads.</figcaption></figure>\n", out);
    }
    fputs("</div>\n", out);
    put_bearing_table(out, analysis);
  }
  fputs("</section>\n", out);
}

static void put_p(FILE *out, double p) {
  fprintf(out, "<td>%s%.3g</td>", p < 1e-4 ? "&lt; " : "", p < 1e-4 ? 1e-4 : p);
}

static void put_comparisons(FILE *out, const fg_lot_analysis *analysis) {
  if (!analysis->difference_count) return;
  fputs("<section>\n<h1>Groups: ", out);
  fg_html_text(out, analysis->lot->settings.group_column);
  fputs("</h1>\n<div class=\"scroll\"><table><thead><tr><th>quantity</th><th>groups</th><th>means"
        "</th><th>difference</th><th>p (Welch)</th><th>s</th><th>p (F)</th><th>p (Levene)</th></tr>"
        "</thead>\n<tbody>\n",
        out);
  for (size_t i = 0; i < analysis->difference_count; i++) {
    const fg_lot_difference *one = &analysis->differences[i];
    fprintf(out, "<tr><td>%s</td><td class=\"words\">", one->quantity->field->words);
    fg_html_text(out, one->a);
    fputs(" against ", out);
    fg_html_text(out, one->b);
    fprintf(out, "</td><td>%.6g, %.6g</td><td>%.4g <i>%.4g … %.4g</i></td>", one->mean_a,
            one->mean_b, one->comparison.difference, one->comparison.low, one->comparison.high);
    put_p(out, one->comparison.p_means);
    fprintf(out, "<td>%.3g, %.3g</td>", one->sd_a, one->sd_b);
    put_p(out, one->comparison.p_variances);
    put_p(out, one->comparison.p_levene);
    fputs("</tr>\n", out);
  }
  fputs("</tbody></table></div>\n</section>\n", out);
}

static void put_gauge(FILE *out, const fg_lot_analysis *analysis) {
  if (!analysis->gauge_count) return;
  fputs("<section>\n<h1>Gauge repeatability and reproducibility</h1>\n<div class=\"scroll\"><table>"
        "<thead><tr><th>quantity</th><th>bump</th><th>repeatability</th><th>reproducibility</th>"
        "<th>GRR</th><th>part</th><th>GRR, %</th><th>categories</th></tr></thead>\n<tbody>\n",
        out);
  for (size_t i = 0; i < analysis->gauge_count; i++) {
    const fg_lot_gauge *gauge = &analysis->gauges[i];
    const fg_gauge_study *study = &gauge->study;
    fprintf(out,
            "<tr><td>%s</td><td>%d</td><td>%.3g</td><td>%.3g</td><td>%.3g</td><td>%.3g</td><td>%.3g"
            "</td><td>%.0f</td></tr>\n",
            gauge->quantity->field->words, gauge->bump, study->repeatability,
            study->reproducibility, study->grr, study->part, study->grr_pct,
            floor(study->distinct_categories));
  }
  fputs("</tbody></table></div>\n</section>\n", out);
}

static void put_foil_row(FILE *out, const fg_lot_analysis *analysis, const fg_lot_foil *foil) {
  fputs("<tr><td>", out);
  put_label(out, analysis, foil);
  fprintf(out, "</td><td class=\"%s\">%s</td><td>", fg_verdict_word(foil->verdict),
          foil->verdict == FG_VERDICT_UNDECIDED      ? "cannot tell"
          : foil->verdict == FG_VERDICT_NOT_MEASURED ? "not measured"
          : foil->verdict == FG_VERDICT_NONE         ? "–"
                                                     : fg_verdict_word(foil->verdict));
  fprintf(out, "%zu</td><td>", foil->foil->bump_count);
  put_number(out, foil->foil->overall.radius_mm, 6);
  fputs("</td><td class=\"words\">", out);
  put_reason(out, analysis, foil);
  fputs("</td></tr>\n", out);
}

/* Those that do not pass first; a page of 100,000 rows helps nobody. */
static void put_foils(FILE *out, const fg_lot_analysis *analysis) {
  size_t rows = 0;
  fputs("<section>\n<h1>Foils</h1>\n<div class=\"scroll\"><table><thead><tr><th>foil</th><th>"
        "verdict</th><th>bumps</th><th>R0<br>mm</th><th>farthest value, or why "
        "not</th></tr></thead>\n"
        "<tbody>\n",
        out);
  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0; i < analysis->foil_count && rows < FOIL_ROWS_MAX; i++) {
      const fg_lot_foil *foil = &analysis->foils[i];
      bool good = foil->verdict == FG_VERDICT_PASS || foil->verdict == FG_VERDICT_NONE;
      if (good != (pass == 1)) continue;
      put_foil_row(out, analysis, foil);
      rows++;
    }
  fputs("</tbody></table></div>\n", out);
  if (rows < analysis->foil_count)
    fprintf(out,
            "<p class=\"note\">%zu of %zu, those that do not pass first; all: foils.csv.</p>\n",
            rows, analysis->foil_count);
  fputs("</section>\n", out);
}

static fg_status put_origin(fg_context *ctx, FILE *out, const fg_lot_analysis *analysis) {
  char scale[FG_SCALE_WORDS];
  fg_scale_words(analysis->lot->model, scale, sizeof scale);
  fprintf(out,
          "<section>\n<h1>Where it comes from</h1>\n<dl class=\"facts\"><dt>Program</dt><dd>"
          "foilgauge %s</dd><dt>Recipe, SHA-256</dt><dd>%s</dd><dt>Manifest, SHA-256</dt><dd>%s"
          "</dd>",
          analysis->lot->head.version, analysis->lot->head.recipe_sha256,
          analysis->lot->head.manifest_sha256);
  FG_TRY(fg_html_model_facts(ctx, out, analysis->lot->model));
  fputs("</dl>\n<p class=\"note\">", out);
  fg_html_text(out, scale);
  fputs(" A value passes when value ± U lies inside its tolerance "
        "(U = 2 u, about 95 %), fails when it lies outside, and cannot be told when a limit runs "
        "through it. All numbers: lot.json, foils.csv, bumps.csv; for quality systems "
        "results.qif and results.dfq.</p>\n</section>\n",
        out);
  return FG_OK;
}

fg_status fg_lot_write_page(fg_context *ctx, const fg_lot_analysis *analysis, FILE *out) {
  fg_html_begin(out, analysis->lot->settings.name);
  FG_TRY(put_first_screen(ctx, out, analysis));
  put_failed_scans(out, analysis);
  fputs("<section>\n", out);
  put_quantity_rows(out, analysis);
  put_capability(out, analysis);
  put_charts(out, analysis);
  fputs("</section>\n", out);
  put_springback(out, analysis);
  fg_lot_put_stiffness(out, analysis);
  put_bearings(out, analysis);
  put_comparisons(out, analysis);
  put_gauge(out, analysis);
  put_foils(out, analysis);
  FG_TRY(put_origin(ctx, out, analysis));
  fg_html_end(out);
  return fg_stream_finish(ctx, out, "the lot's page");
}
