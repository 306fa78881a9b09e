/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/measure/uncertainty_budget.h"

#include <math.h>

#include "core/member.h"
#include "foilgauge/words.h"
#include "page/page.h"
#include "quantity/quantity_rows.h"
#include "report/design/members.h"

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

enum { OWNERS = 4 };
static const fg_quantity_owner owners[OWNERS] = {FG_QUANTITY_OF_FOIL, FG_QUANTITY_OF_BUMP,
                                                 FG_QUANTITY_OF_BEAM, FG_QUANTITY_OF_DISC};

static double root_mean(double squares, size_t count) {
  return sqrt(fmax(0, squares) / (double)count);
}

/* Lines of a budget. */
typedef struct budget_line {
  const fg_quantity *row;
  const char *name;
  double u_statistical, u_calibration, u; /* root mean squares */
} budget_line;

typedef struct budget {
  budget_line lines[OWNERS * FG_QUANTITY_SHOWN_MAX];
  size_t count;
} budget;

static void add_line(budget *to, const fg_quantity *row, const line *sum) {
  if (sum->count)
    to->lines[to->count++] =
        (budget_line){row, row->name, root_mean(sum->all - sum->calibration, sum->count),
                      root_mean(sum->calibration, sum->count), root_mean(sum->all, sum->count)};
}

static const fg_member line_rows[] = {
    {FG_STRING("quantity", budget_line, name), .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER("u_statistical", budget_line, u_statistical)},
    {FG_NUMBER("u_calibration", budget_line, u_calibration)},
    {FG_NUMBER("u", budget_line, u)},
};
static const fg_members line_members = FG_MEMBERS(line_rows);

static const fg_member budget_row = {FG_ARRAY("budget", budget, lines, count, &line_members),
                                     .options = FG_MEMBER_ON_LINE};

/* Budget of all scans of a report, where foil is NULL, or of one foil of a scan. */
static budget find_budget(const fg_report_scan *scans, size_t scan_count, fg_foil_kind kind,
                          const fg_foil *foil) {
  budget all = {.count = 0};
  for (size_t k = 0; k < OWNERS; k++) {
    const fg_quantity *shown[FG_QUANTITY_SHOWN_MAX];
    size_t count = fg_quantity_shown(owners[k], FG_QUANTITY_ON_PAGE, kind, shown);
    for (size_t i = 0; i < count; i++) {
      line sum = {0};
      for (size_t s = 0; s < scan_count; s++)
        if (scans[s].measurement)
          add_scan_budget(&sum, owners[k], shown[i], scans[s].measurement, foil);
      add_line(&all, shown[i], &sum);
    }
  }
  return all;
}

void fg_json_report_calibration(fg_json *json, const fg_report *report) {
  const fg_calibration *calibration = &report->design->calibration;
  if (!calibration->stated) {
    fg_json_string(json, "calibration", NULL);
    return;
  }
  const budget all = find_budget(report->scans, report->scan_count, report->design->kind, NULL);
  fg_json_object(json, "calibration");
  fg_members_json(json, &fg_calibration_used_members, &(fg_subject){.object = calibration});
  fg_member_json(json, &budget_row, &(fg_subject){.object = &all});
  fg_json_object_end(json);
}

static void put_budget_line(FILE *out, const budget_line *of) {
  double k = FG_COVERAGE_FACTOR;
  int decimals = fg_report_decimals(of->row, of->u) + 1;
  fprintf(out,
          "<tr><td>%s</td><td>%.*f</td><td>%.*f</td><td>%.*f</td><td class=\"w\">%s</td></tr>\n",
          of->row->words, decimals, k * of->u_statistical, decimals, k * of->u_calibration,
          decimals, k * of->u, of->row->unit);
}

void fg_html_uncertainty_budget(FILE *out, const fg_measurement *measurement, const fg_foil *foil) {
  const fg_report_scan scan = {.measurement = measurement};
  if (!measurement->calibrated) return;
  const budget all = find_budget(&scan, 1, measurement->design.kind, foil);
  fputs("<div class=\"scroll\"><table><thead><tr><th>U, mean</th><th>statistics</th>"
        "<th>calibration</th><th>together</th><th class=\"w\">unit</th></tr></thead>\n<tbody>\n",
        out);
  for (size_t i = 0; i < all.count; i++)
    put_budget_line(out, &all.lines[i]);
  fputs("</tbody></table></div>\n", out);
}
