/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Several foils on one page: a table of their outcomes, before the first of them. */
#include <math.h>
#include <string.h>

#include "report/measure/foil_parts.h"
#include "report/measure/foil_view.h"
#include "report/measure/page_tables.h"

const char *fg_html_base_name(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash && slash[1] ? slash + 1 : path;
}

static size_t sections_of(const fg_report *report, const fg_report_scan *scan) {
  if (!scan->measurement || !fg_foil_traits_of(report->design->kind)->is_foil) return 1;
  return scan->measurement->foil_count;
}

size_t fg_html_sections(const fg_report *report) {
  size_t count = 0;
  for (size_t i = 0; i < report->scan_count; i++)
    count += sections_of(report, &report->scans[i]);
  return count;
}

static void put_verdict_cell(FILE *out, fg_verdict verdict, const char *words) {
  fprintf(out, "<td class=\"w %s\">%s</td>", fg_verdict_word(verdict), words);
}

static void put_link(FILE *out, size_t section, const char *scan) {
  fprintf(out, "<tr><td><a href=\"#part%zu\">%zu</a></td><td class=\"words\">", section, section);
  fg_html_name(out, fg_html_base_name(scan));
  fputs("</td>", out);
}

void fg_html_summary_number(FILE *out, double value, int decimals) {
  if (isfinite(value))
    fprintf(out, "<td>%s%.*f</td>", value < 0 ? "−" : "", decimals, fabs(value));
  else
    fputs("<td>–</td>", out);
}

static double mean_of(const fg_design *design, const fg_foil *foil, const char *name) {
  const fg_foil_parts parts = fg_foil_parts_of(design, foil);
  const fg_quantity *row = fg_quantity_find(parts.owner, name);
  double sum = 0, count = 0;
  for (size_t i = 0; i < parts.count; i++) {
    double value = fg_quantity_value(row, fg_foil_part_at(&parts, i));
    if (isfinite(value)) sum += value, count++;
  }
  return count > 0 ? sum / count : NAN;
}

void fg_summary_of_beams(FILE *out, const fg_design *design, const fg_foil *foil) {
  fg_html_summary_number(out, foil ? mean_of(design, foil, "length_mm") : NAN, 4);
  fg_html_summary_number(out, foil ? mean_of(design, foil, "width_mm") : NAN, 4);
  fg_html_summary_number(out, foil ? mean_of(design, foil, "compliance_error_pct") : NAN, 3);
}

void fg_summary_of_bumps(FILE *out, const fg_design *design, const fg_foil *foil) {
  fg_html_summary_number(out, foil ? foil->overall.radius_mm : NAN, 4);
  fg_html_summary_number(out, foil ? mean_of(design, foil, "radius_mm") : NAN, 4);
  fg_html_summary_number(out, foil ? mean_of(design, foil, "height_mm") : NAN, 4);
}

static fg_status put_foil(fg_context *ctx, FILE *out, const fg_report *report,
                          const fg_report_scan *scan, const fg_foil *foil, size_t section) {
  fg_decision decision;
  FG_TRY(fg_foil_decide(ctx, report->design, foil, &decision));
  put_link(out, section, scan->name ? scan->name : scan->path);
  put_verdict_cell(out, decision.outcome.verdict, fg_html_verdict_title(decision.outcome.verdict));
  fg_foil_view_of(report->design->kind)
      ->summary(out, report->design, foil->flags & FG_FOIL_NOT_MEASURED ? NULL : foil);
  fputs("<td class=\"words\">", out);
  fg_html_reason_line(out, report->design, foil, &decision);
  fputs("</td></tr>\n", out);
  fg_decision_free(&decision);
  return FG_OK;
}

static fg_status put_whole_scan(fg_context *ctx, FILE *out, const fg_report *report,
                                const fg_report_scan *scan, size_t section) {
  fg_report_outcome outcome;
  FG_TRY(fg_report_judge_scan(ctx, report->design, scan, &outcome));
  put_link(out, section, scan->path);
  put_verdict_cell(out, outcome.verdict, fg_html_verdict_title(outcome.verdict));
  const fg_foil_view *view = fg_foil_view_of(report->design->kind);
  if (view->summary) view->summary(out, report->design, NULL);
  fputs("<td class=\"words\">", out);
  if (scan->measurement && scan->measurement->grid)
    fprintf(out, "%zu marks", scan->measurement->grid->count);
  else if (scan->measurement)
    fprintf(out, "%zu round features", scan->measurement->disc_count);
  else
    fg_html_text(out, scan->error);
  fputs("</td></tr>\n", out);
  return FG_OK;
}

static fg_status count_verdicts(fg_context *ctx, const fg_report *report, size_t counts[5]) {
  for (size_t i = 0; i < report->scan_count; i++) {
    const fg_report_scan *scan = &report->scans[i];
    bool whole = !scan->measurement || !fg_foil_traits_of(report->design->kind)->is_foil;
    fg_report_outcome outcome;
    FG_TRY(fg_report_judge_scan(ctx, report->design, scan, &outcome));
    if (whole) counts[outcome.verdict]++;
    for (size_t k = 0; !whole && k < scan->measurement->foil_count; k++) {
      fg_decision decision;
      FG_TRY(fg_foil_decide(ctx, report->design, &scan->measurement->foils[k], &decision));
      counts[decision.outcome.verdict]++;
      fg_decision_free(&decision);
    }
  }
  return FG_OK;
}

static void put_counts(FILE *out, const fg_report *report, const size_t counts[5]) {
  static const char *const words[] = {"within tolerance", "out of tolerance", "cannot tell",
                                      "not measured", "without a tolerance"};
  const char *separator = "";
  fprintf(out, "<p>%zu scan%s: ", report->scan_count, report->scan_count == 1 ? "" : "s");
  for (int k = 0; k < 5; k++) {
    if (!counts[k]) continue;
    fprintf(out, "%s%zu %s", separator, counts[k], words[k]);
    separator = ", ";
  }
  fputs("</p>", out);
}

static void put_heads(FILE *out, const fg_design *design) {
  fputs("<div class=\"scroll\"><table class=\"why\">\n<thead><tr><th>no.</th><th "
        "class=\"w\">scan</th>"
        "<th class=\"w\">verdict</th>",
        out);
  fputs(fg_foil_view_of(design->kind)->summary_heads, out);
  fputs("<th class=\"w\">why</th></tr></thead>\n<tbody>\n", out);
}

fg_status fg_html_summary(fg_context *ctx, FILE *out, const fg_report *report) {
  size_t counts[5] = {0}, section = 0;
  fg_report_outcome outcome;
  FG_TRY(fg_report_judge(ctx, report, &outcome));
  FG_TRY(count_verdicts(ctx, report, counts));
  fprintf(out, "<section class=\"judged %s\">\n<header><h1>%zu %s</h1>",
          fg_verdict_word(outcome.verdict), fg_html_sections(report),
          fg_foil_traits_of(report->design->kind)->is_foil ? "foils" : "scans");
  fg_html_outcome(out, &outcome);
  put_counts(out, report, counts);
  fputs("</header>\n", out);
  put_heads(out, report->design);
  for (size_t i = 0; i < report->scan_count; i++) {
    const fg_report_scan *scan = &report->scans[i];
    bool whole = !scan->measurement || !fg_foil_traits_of(report->design->kind)->is_foil;
    if (whole) FG_TRY(put_whole_scan(ctx, out, report, scan, ++section));
    for (size_t k = 0; !whole && k < scan->measurement->foil_count; k++)
      FG_TRY(put_foil(ctx, out, report, scan, &scan->measurement->foils[k], ++section));
  }
  fputs("</tbody></table></div>\n</section>\n", out);
  return FG_OK;
}
