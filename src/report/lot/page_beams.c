/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lot's page: effect of the beams' lengths and widths on compliance and sagitta. */
#include <math.h>

#include "foilgauge/cantilever.h"
#include "page/page.h"
#include "report/lot/page_parts.h"
#include "report/lot/plots.h"

static void put_beam_places(FILE *out, const fg_lot_analysis *analysis, const char *name,
                            const char *words) {
  const fg_lot_quantity *quantity = fg_lot_find_quantity(analysis, name);
  if (!quantity || !quantity->count) return;
  fputs("<figure>", out);
  fg_lot_plot_places(out, analysis, quantity, NULL);
  fprintf(out, "<figcaption>%s ", words);
  fg_lot_put_places_key(out, analysis, quantity);
  fputs("</figcaption></figure>\n", out);
}

/* To first order 100 dS / S = 3 x 100 dL / L - 100 dw / w. */
static void put_compliance_spread(FILE *out, const fg_lot_analysis *analysis) {
  const fg_design *design = &analysis->lot->settings.design;
  const fg_lot_quantity *length = fg_lot_find_quantity(analysis, "length_mm");
  const fg_lot_quantity *width = fg_lot_find_quantity(analysis, "width_mm");
  const fg_lot_quantity *compliance = fg_lot_find_quantity(analysis, "compliance_error_pct");
  if (!length || !width || !compliance || !(compliance->sd > 0)) return;
  double by_length = 300 * length->sd / design->beams.length_mm;
  double by_width = 100 * width->sd / design->beams.width_mm;
  fprintf(out,
          "<p>Compliance S = L³ / (3 E I), I = w t³ / 12 (eq 5.10), against the design at the same "
          "thickness: mean %+.2f %%, standard deviation %.2f %%. The spread of the length makes "
          "3 s(L) / L = %.2f %% of it, that of the width s(w) / w = %.2f %%; together, were they "
          "independent, %.2f %%.</p>\n",
          compliance->mean, compliance->sd, by_length, by_width, hypot(by_length, by_width));
}

/* Puts the extremes of the lot: the longest beam that is narrowest, and the shortest that is
 * widest. */
static void put_extremes(FILE *out, const fg_lot_analysis *analysis) {
  const fg_design *design = &analysis->lot->settings.design;
  const fg_lot_quantity *length = fg_lot_find_quantity(analysis, "length_mm");
  const fg_lot_quantity *width = fg_lot_find_quantity(analysis, "width_mm");
  if (!length || !width || !length->count || !width->count) return;
  const fg_beam_size ends[] = {{.length_mm = length->max, .width_mm = width->min},
                               {.length_mm = length->min, .width_mm = width->max}};
  static const char *const names[] = {"longest and narrowest", "shortest and widest"};
  fputs("<div class=\"scroll\"><table><thead><tr><th>of this lot&#39;s lengths and widths</th>"
        "<th>L<br>mm</th><th>w<br>mm</th><th>compliance<br>%</th><th>sagitta<br>%</th>"
        "<th>clearance<br>mm</th><th>clearance<br>%</th></tr></thead>\n<tbody>\n",
        out);
  for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
    const fg_cantilever beam = fg_cantilever_of(design, &ends[i]);
    const struct {
      double value;
      int decimals;
    } cells[] = {{ends[i].length_mm, 4},         {ends[i].width_mm, 4},
                 {beam.compliance_error_pct, 2}, {beam.sagitta_error_pct, 2},
                 {beam.clearance_change_mm, 4},  {beam.clearance_change_pct, 1}};
    fprintf(out, "<tr><td class=\"words\">%s</td>", names[i]);
    for (size_t k = 0; k < sizeof cells / sizeof *cells; k++) {
      fputs("<td>", out);
      fg_lot_put_decimals(out, cells[k].value, cells[k].decimals);
      fputs("</td>", out);
    }
    fputs("</tr>\n", out);
  }
  fputs("</tbody></table></div>\n<p class=\"note\">Compliance and sagitta against the design; the "
        "clearance changes by what the sagitta does (L² at the design&#39;s curvature), the other "
        "way. The scans do not show the thickness: it is taken to be the design&#39;s.</p>\n",
        out);
}

void fg_lot_put_beams(FILE *out, const fg_lot_analysis *analysis) {
  if (!analysis->part_count) return;
  fputs("<section class=\"part\">\n<h1>Compliance and sagitta</h1>\n", out);
  put_compliance_spread(out, analysis);
  put_extremes(out, analysis);
  put_beam_places(out, analysis, "length_mm",
                  "Length of every beam, from the line of the roots to the "
                  "free end.");
  put_beam_places(out, analysis, "width_mm", "Width of every beam, half way along.");
  put_beam_places(out, analysis, "sagitta_error_pct", "Sagitta of every beam against the design.");
  fputs("</section>\n", out);
}
