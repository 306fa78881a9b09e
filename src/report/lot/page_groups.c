/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lot's page: groups against each other, and the gauge study. */
#include <math.h>

#include "page/page.h"
#include "page/table.h"
#include "report/lot/members.h"
#include "report/lot/page_parts.h"

static void put_group_number(FILE *out, double p) {
  fprintf(out, "%s%.3g", p < 1e-4 ? "&lt; " : "", p < 1e-4 ? 1e-4 : p);
}

/* The adjusted p decides, because a reader looks for the smallest p of the page. */
static void put_p_value(FILE *out, const fg_lot_analysis *analysis, const fg_lot_difference *one,
                        fg_lot_group_test test) {
  bool differs = fg_lot_group_differs(analysis, one->p_holm[test]);
  if (isnan(one->p[test])) {
    fputs("<td>–</td>", out);
    return;
  }
  fputs(differs ? "<td><b>" : "<td>", out);
  put_group_number(out, one->p_holm[test]);
  fputs(differs ? "</b><i>" : "<i>", out);
  put_group_number(out, one->p[test]);
  fputs("</i></td>", out);
}

static void put_answer(FILE *out, const fg_lot_analysis *analysis) {
  double level = 100 * (1 - analysis->lot->settings.confidence);
  size_t differ = analysis->group_tests_differ, tests = analysis->group_tests;
  if (differ)
    fprintf(
        out,
        "<p><b>%zu of %zu tests find a difference</b> (%.3g %% for all of them together).</p>\n",
        differ, tests, level);
  else
    fprintf(out,
            "<p>None of %zu tests finds a difference (%.3g %% for all of them together).</p>\n",
            tests, level);
}

static void put_method(FILE *out, const fg_lot_analysis *analysis) {
  const char *many = fg_lot_words_of(analysis)->many;
  fprintf(out,
          "<p class=\"note\">Foils are the unit: the %s of one foil are no independent values. A "
          "foil counts by its level, the mean of its %s, freed of what their places do where some "
          "are missing; scans of one foil are one. p: for all tests of this table together "
          "(Holm), below it that of the test alone. Means: Welch. Spread of foils: F and Levene, "
          "by relabelling the foils; that takes three foils a group. Spread within a foil: "
          "Welch&#39;s test of its logarithm.</p>\n",
          many, many);
}

static void put_group_row(FILE *out, const fg_lot_analysis *analysis,
                          const fg_lot_difference *one) {
  const fg_comparison *c = &one->comparison;
  const fg_quantity *row = one->quantity->row;
  fprintf(out, "<tr><td class=\"words\">%s%s%s</td><td class=\"words\">", row->words,
          row->unit[0] ? ", " : "", row->unit);
  fg_html_name(out, one->a);
  fputs(" against ", out);
  fg_html_name(out, one->b);
  fprintf(out, "</td><td>%zu<br>%zu</td><td>%.6g<br>%.6g</td><td>%.4g<i>%.4g … %.4g</i></td>",
          one->foils_a, one->foils_b, one->mean_a, one->mean_b, c->difference, c->low, c->high);
  put_p_value(out, analysis, one, FG_LOT_TEST_MEANS);
  fprintf(out, "<td>%.3g<br>%.3g</td>", one->sd_a, one->sd_b);
  put_p_value(out, analysis, one, FG_LOT_TEST_VARIANCES);
  put_p_value(out, analysis, one, FG_LOT_TEST_LEVENE);
  if (isfinite(one->within_sd_a) && isfinite(one->within_sd_b))
    fprintf(out, "<td>%.3g<br>%.3g</td>", one->within_sd_a, one->within_sd_b);
  else
    fputs("<td>–</td>", out);
  put_p_value(out, analysis, one, FG_LOT_TEST_WITHIN);
  fputs("</tr>\n", out);
}

void fg_lot_put_comparisons(FILE *out, const fg_lot_analysis *analysis) {
  if (!analysis->difference_count) return;
  fputs("<section class=\"part\">\n<h1>Groups: ", out);
  fg_html_text(out, analysis->lot->settings.group_column);
  fputs("</h1>\n", out);
  put_answer(out, analysis);
  fputs(
      "<div class=\"scroll lots\"><table><thead><tr><th>quantity</th><th>groups</th><th>foils</th>"
      "<th>means</th><th>difference</th><th>p<br>means</th><th>s of<br>foils</th><th>p<br>F</th>"
      "<th>p<br>Levene</th><th>s within<br>a foil</th><th>p<br>within</th></tr></thead>\n"
      "<tbody>\n",
      out);
  for (size_t i = 0; i < analysis->difference_count; i++)
    put_group_row(out, analysis, &analysis->differences[i]);
  fputs("</tbody></table></div>\n", out);
  put_method(out, analysis);
  fputs("</section>\n", out);
}

/* Limits by which a gauge is accepted: AIAG, Measurement Systems Analysis, 4th edition. */
enum { GRR_GOOD_PCT = 10, GRR_POOR_PCT = 30, CATEGORIES_MIN = 5 };

static bool find_gauge(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_lot_analysis *analysis = list->whole;
  element->object = &analysis->gauges[i];
  return i < analysis->gauge_count;
}

/* Says why there is no study, where foils were scanned again by several operators. */
static void put_no_gauge(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot *lot = analysis->lot;
  size_t part = fg_manifest_column(&lot->manifest, lot->settings.part_column);
  size_t who = fg_manifest_column(&lot->manifest, lot->settings.operator_column);
  fg_manifest_words parts = {.count = 0}, operators = {.count = 0};
  if (part == FG_NO_COLUMN || who == FG_NO_COLUMN || !analysis->scanned_again) return;
  fg_lot_list_words(analysis, part, &parts);
  fg_lot_list_words(analysis, who, &operators);
  if (parts.count < 2 || operators.count < 2) return;
  fprintf(out,
          "<section class=\"part\">\n<h1>Gauge repeatability and reproducibility</h1>\n"
          "<p class=\"note\">Not stated: it takes every foil by every operator at least twice, and "
          "three quarters of these scans. Here are %zu measured scans of %zu foils by "
          "%zu operators.</p>\n</section>\n",
          analysis->foil_count, parts.count, operators.count);
}

void fg_lot_put_gauge(FILE *out, const fg_lot_analysis *analysis) {
  if (!analysis->gauge_count) {
    put_no_gauge(out, analysis);
    return;
  }
  fputs("<section class=\"part\">\n<h1>Gauge repeatability and reproducibility</h1>\n", out);
  fg_html_table(out, &fg_lot_gauge_members, &(fg_subject){.whole = analysis}, find_gauge);
  fprintf(out,
          "<p class=\"note\">Standard deviations: of one operator's trials, of the operators, of "
          "both together (GRR), of the parts. GRR, %%: of the total standard deviation; up to %d %% "
          "is good, above %d %% is not fit for use (AIAG). Categories: classes of parts that the "
          "gauge tells apart, %d or more are wanted. Both depend on how far the parts of this study "
          "differ.</p>\n</section>\n",
          GRR_GOOD_PCT, GRR_POOR_PCT, CATEGORIES_MIN);
}
