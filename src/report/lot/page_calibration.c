/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lot's page: uncertainty of its means. */
#include <math.h>

#include "foilgauge/words.h"
#include "report/lot/page_parts.h"

static void put_known_row(FILE *out, const fg_lot_quantity *quantity, const fg_lot_mean_u *known) {
  const double k = FG_COVERAGE_FACTOR;
  const double cells[] = {k * known->u_statistical, k * known->u_calibration, k * known->u};
  int decimals = fg_report_decimals(quantity->row, known->u) + 1;
  fprintf(out, "<tr><td class=\"words\">%s</td><td>%s</td>", quantity->row->words,
          quantity->row->unit);
  for (size_t i = 0; i < sizeof cells / sizeof *cells; i++) {
    fputs("<td>", out);
    fg_lot_put_decimals(out, cells[i], decimals);
    fputs("</td>", out);
  }
  fputs("</tr>\n", out);
}

void fg_lot_put_mean_u(FILE *out, const fg_lot_analysis *analysis) {
  const fg_calibration *calibration = &analysis->lot->settings.design.calibration;
  if (!calibration->stated) {
    fputs("<p class=\"note\">U holds statistics only: no calibration is stated.</p>\n", out);
    return;
  }
  fputs("<h2>How well the means are known</h2>\n<div class=\"scroll\"><table><thead><tr><th>U of "
        "the mean</th><th>unit</th><th>statistics</th><th>calibration</th><th>together</th></tr>"
        "</thead>\n<tbody>\n",
        out);
  for (size_t i = 0; i < analysis->quantity_count; i++) {
    const fg_lot_mean_u known = fg_lot_find_mean_u(analysis, &analysis->quantities[i]);
    if (isfinite(known.u)) put_known_row(out, &analysis->quantities[i], &known);
  }
  fputs("</tbody></table></div>\n<p class=\"note\">What the scans&#39; statistics leave averages "
        "out over the foils, but for the thickness, whose doubt they share; what the calibration "
        "leaves is the same error in each, so no number "
        "of foils makes it smaller. Spreads, charts and differences of foils of one scanner are "
        "free of it.</p>\n",
        out);
}
