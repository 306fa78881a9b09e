/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Budget of the strip's thickness: the tone curve, and all else. */
#include "report/measure/thickness_budget.h"

#include <math.h>

#include "foilgauge/report.h"

/* A part that is less than this of u² is not worth a line on the terminal. */
#define MAX_SHARE 0.5

static double expanded_um(double u_mm) {
  return 1000 * FG_COVERAGE_FACTOR * u_mm;
}

/* Returns the tone curve's share of the scan's u²; NaN where there is none. */
static double tone_share(const fg_foil *foil) {
  double u = foil->thickness.u_scan_mm, tone = foil->thickness.u_tone_mm;
  return u > 0 ? tone * tone / (u * u) : NAN;
}

static void put_thickness_row(FILE *out, const char *words, double u_mm, double share) {
  fprintf(out, "<tr><td class=\"w\">%s</td><td>%.2g</td><td>%.0f</td></tr>\n", words,
          expanded_um(u_mm), 100 * share);
}

static const char *tone_words(const fg_design *design, const fg_foil *foil) {
  if (foil->strip.picture.level_known)
    return "level of the edges, by a gauge or the scanner's model";
  if (design->tone == FG_TONE_LINEAR) return "level of the edges, the tone linear as stated";
  return "level of the edges: a tone curve of the scanner that is not known";
}

void fg_html_thickness_budget(FILE *out, const fg_design *design, const fg_foil *foil) {
  double share = tone_share(foil), u = foil->thickness.u_scan_mm;
  if (!isfinite(share)) return;
  fputs("<h2>Thickness of the strip</h2>\n<div class=\"scroll\"><table><thead><tr>"
        "<th class=\"w\">what its U holds</th><th>U, µm</th><th>% of u²</th></tr></thead>\n"
        "<tbody>\n",
        out);
  put_thickness_row(out, tone_words(design, foil), foil->thickness.u_tone_mm, share);
  put_thickness_row(out, "scatter along the strip, compression", u * sqrt(fmax(0, 1 - share)),
                    1 - share);
  put_thickness_row(out, "thickness by the scan", u, 1);
  fputs("</tbody></table></div>\n<p class=\"note\">", out);
  fprintf(out, "The scan: %.4f ± %.4f mm. ", foil->thickness.scan_mm, FG_COVERAGE_FACTOR * u);
  if (design->thickness_measured_mm > 0)
    fprintf(out,
            "In force: %.4f ± %.4f mm, as stated (thickness_measured). Clearances are over "
            "that.</p>\n",
            foil->thickness.mm, FG_COVERAGE_FACTOR * foil->thickness.u_mm);
  else
    fputs(
        "Clearances hold the same U. The level of the edges errs alike in all foils of a scanner: "
        "their number does not make it less. Radii and heights of the midline are free of it."
        "</p>\n",
        out);
}

void fg_text_thickness_budget(FILE *out, const fg_design *design, const fg_foil *foil) {
  double share = tone_share(foil), scan = FG_COVERAGE_FACTOR * foil->thickness.u_scan_mm;
  if (design->thickness_measured_mm > 0 && isfinite(scan))
    fprintf(out, "  the thickness is stated; the scan says %.4f ± %.4f mm\n",
            foil->thickness.scan_mm, scan);
  else if (design->tone != FG_TONE_LINEAR && !foil->strip.picture.level_known && share > MAX_SHARE)
    fprintf(out,
            "  ± %.4f mm of thickness and clearances is by a tone curve that is not known: "
            "--thickness-measured\n",
            FG_COVERAGE_FACTOR * foil->thickness.u_tone_mm);
}
