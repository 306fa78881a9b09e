/* The lot's page: what the foils do to the bearings they are built into. */
#include <math.h>

#include "lot/lot_plots.h"
#include "lot/page_parts.h"
#include "quantity/quantity_rows.h"
#include "report/measure/measure_page_parts.h"

enum { POLAR_MAX = 4, BEARING_ROWS_MAX = 200, UM_PER_MM = 1000 };

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
      fg_lot_put_label(out, analysis, bearing->pad[pad]);
    else
      fputs("–", out);
  }
  fputs("</td>", out);
  const fg_quantity *shown[FG_QUANTITY_SHOWN_MAX];
  size_t count = fg_quantity_shown(FG_QUANTITY_OF_BEARING, FG_QUANTITY_ON_PAGE, shown);
  for (size_t i = 0; i < count; i++) {
    double value = fg_quantity_value(shown[i], &bearing->clearance);
    fputs("<td>", out);
    fg_lot_put_number(out, bearing->known ? UM_PER_MM * value : NAN, 4);
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
  fg_lot_put_number(out, spread->mean, 4);
  fputs(" %, s ", out);
  fg_lot_put_number(out, spread->sd, 4);
  fputs(" %", out);
}

/* How the foils lie around the bearings, drawings of the first, and a line of each. */
static void put_assembled(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_settings *settings = &analysis->lot->settings;
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

void fg_lot_put_bearings(FILE *out, const fg_lot_analysis *analysis) {
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
  if (analysis->bearing_count) put_assembled(out, analysis);
  fputs("</section>\n", out);
}
