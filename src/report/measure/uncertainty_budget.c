/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/measure/uncertainty_budget.h"

#include <math.h>

#include "foilgauge/words.h"
#include "page/page.h"
#include "quantity/quantity_rows.h"
#include "report/design/calibration_json.h"

/* Root mean squares of one quantity over all parts that have it. */
typedef struct line {
  double all, calibration; /* squares, summed */
  size_t count;
} line;

static void add_object(line *sum, fg_quantity_owner owner, const fg_quantity *row,
                       const void *object, const fg_calibrated *calibrated) {
  double u = fg_quantity_uncertainty(row, object);
  double own = fg_quantity_calibration(owner, row, calibrated);
  if (!isfinite(u) || !isfinite(own)) return;
  sum->all += u * u;
  sum->calibration += own * own;
  sum->count++;
}

static void add_foil_budget(line *sum, fg_quantity_owner owner, const fg_quantity *row,
                            const fg_foil *foil) {
  if (!fg_foil_is_measured(foil)) return;
  if (owner == FG_QUANTITY_OF_FOIL) add_object(sum, owner, row, foil, &foil->calibrated);
  for (size_t b = 0; owner == FG_QUANTITY_OF_BUMP && b < foil->bump_count; b++)
    add_object(sum, owner, row, &foil->bumps[b], &foil->bumps[b].calibrated);
  for (size_t b = 0; owner == FG_QUANTITY_OF_BEAM && b < foil->beam_count; b++)
    add_object(sum, owner, row, &foil->beams[b], &foil->beams[b].calibrated);
}

/* `foil` NULL: every foil of the scan. */
static void add_scan_budget(line *sum, fg_quantity_owner owner, const fg_quantity *row,
                            const fg_measurement *m, const fg_foil *foil) {
  if (foil) add_foil_budget(sum, owner, row, foil);
  for (size_t f = 0; !foil && f < m->foil_count; f++)
    add_foil_budget(sum, owner, row, &m->foils[f]);
  for (size_t d = 0; owner == FG_QUANTITY_OF_DISC && d < m->disc_count; d++)
    add_object(sum, owner, row, &m->discs[d], &m->discs[d].calibrated);
}

static const fg_quantity_owner owners[] = {FG_QUANTITY_OF_FOIL, FG_QUANTITY_OF_BUMP,
                                           FG_QUANTITY_OF_BEAM, FG_QUANTITY_OF_DISC};

static double root_mean(double squares, size_t count) {
  return sqrt(fmax(0, squares) / (double)count);
}

static void write_line(fg_json *json, const fg_quantity *row, const line *sum) {
  fg_json_object(json, NULL);
  fg_json_line(json);
  fg_json_string(json, "quantity", row->name);
  fg_json_number(json, "u_statistical", root_mean(sum->all - sum->calibration, sum->count));
  fg_json_number(json, "u_calibration", root_mean(sum->calibration, sum->count));
  fg_json_number(json, "u", root_mean(sum->all, sum->count));
  fg_json_object_end(json);
  fg_json_line_end(json);
}

static void write_budget(fg_json *json, const fg_report *report, fg_quantity_owner owner) {
  const fg_quantity *shown[FG_QUANTITY_SHOWN_MAX];
  size_t count = fg_quantity_shown(owner, FG_QUANTITY_ON_PAGE, report->design->kind, shown);
  for (size_t i = 0; i < count; i++) {
    line sum = {0};
    for (size_t s = 0; s < report->scan_count; s++)
      if (report->scans[s].measurement)
        add_scan_budget(&sum, owner, shown[i], report->scans[s].measurement, NULL);
    if (sum.count) write_line(json, shown[i], &sum);
  }
}

void fg_json_report_calibration(fg_json *json, const fg_report *report) {
  const fg_calibration *calibration = &report->design->calibration;
  if (!calibration->stated) {
    fg_json_string(json, "calibration", NULL);
    return;
  }
  fg_json_object(json, "calibration");
  fg_json_calibration_members(json, calibration);
  fg_json_array(json, "budget");
  for (size_t k = 0; k < sizeof owners / sizeof *owners; k++)
    write_budget(json, report, owners[k]);
  fg_json_array_end(json);
  fg_json_object_end(json);
}

static void put_budget_line(FILE *out, const fg_quantity *row, const line *sum) {
  double k = FG_COVERAGE_FACTOR, all = k * root_mean(sum->all, sum->count);
  int decimals = fg_report_decimals(row, all / k) + 1;
  fprintf(out,
          "<tr><td>%s</td><td>%.*f</td><td>%.*f</td><td>%.*f</td><td class=\"w\">%s</td></tr>\n",
          row->words, decimals, k * root_mean(sum->all - sum->calibration, sum->count), decimals,
          k * root_mean(sum->calibration, sum->count), decimals, all, row->unit);
}

void fg_html_uncertainty_budget(FILE *out, const fg_measurement *measurement, const fg_foil *foil) {
  if (!measurement->calibrated) return;
  fputs("<div class=\"scroll\"><table><thead><tr><th>U, mean</th><th>statistics</th>"
        "<th>calibration</th><th>together</th><th class=\"w\">unit</th></tr></thead>\n<tbody>\n",
        out);
  for (size_t k = 0; k < sizeof owners / sizeof *owners; k++) {
    const fg_quantity *shown[FG_QUANTITY_SHOWN_MAX];
    size_t count =
        fg_quantity_shown(owners[k], FG_QUANTITY_ON_PAGE, measurement->design.kind, shown);
    for (size_t i = 0; i < count; i++) {
      line sum = {0};
      add_scan_budget(&sum, owners[k], shown[i], measurement, foil);
      if (sum.count) put_budget_line(out, shown[i], &sum);
    }
  }
  fputs("</tbody></table></div>\n", out);
}
