/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Key numbers of a page: those of a foil, a plain strip, the discs of a scan. */
#include <math.h>

#include "page/tile.h"
#include "report/measure/foil_parts.h"
#include "report/measure/foil_view.h"
#include "report/measure/page_tables.h"

void fg_html_quantity_tile(FILE *out, fg_quantity_owner owner, const char *name, const char *title,
                           const void *object) {
  const fg_quantity *row = fg_quantity_find(owner, name);
  double value = fg_quantity_value(row, object), u = fg_quantity_uncertainty(row, object);
  fg_html_tile(out, &(fg_tile){title, .value = value, .u = u, .unit = row->unit,
                               .decimals = fg_report_decimals(row, u), .u_words = ""});
}

/* Writes the mean over the parts, with their spread as a standard deviation. */
static void put_mean_tile(FILE *out, const fg_foil_parts *parts, const char *name,
                          const char *title) {
  const fg_quantity *row = fg_quantity_find(parts->owner, name);
  double sum = 0, squares = 0;
  size_t count = 0;
  for (size_t i = 0; i < parts->count; i++) {
    double value = fg_quantity_value(row, fg_foil_part_at(parts, i));
    if (!isfinite(value)) continue;
    count++;
    double step = value - sum;
    sum += step / (double)count; /* the running mean */
    squares += step * (value - sum);
  }
  if (count == 0) return;
  char small[64] = "";
  if (count > 1)
    snprintf(small, sizeof small, "s = %.*f, n = %zu", row->decimals,
             sqrt(squares / (double)(count - 1)), count);
  fg_html_tile(out, &(fg_tile){title, .value = sum, .unit = row->unit, .decimals = row->decimals,
                               .small = small});
}

void fg_tiles_of_beams(FILE *out, const fg_design *design, const fg_foil *foil) {
  const fg_foil_parts beams = fg_foil_parts_of(design, foil);
  fputs("<dl class=\"tiles\">\n", out);
  put_mean_tile(out, &beams, "length_mm", "Length, mean");
  put_mean_tile(out, &beams, "width_mm", "Width, mean");
  put_mean_tile(out, &beams, "compliance_error_pct", "Compliance against the design, mean");
  put_mean_tile(out, &beams, "sagitta_error_pct", "Sagitta against the design, mean");
  put_mean_tile(out, &beams, "clearance_change_mm", "Clearance change, mean");
  fputs("</dl>\n", out);
}

void fg_tiles_of_bumps(FILE *out, const fg_design *design, const fg_foil *foil) {
  const fg_foil_parts bumps = fg_foil_parts_of(design, foil);
  fputs("<dl class=\"tiles\">\n", out);
  fg_html_quantity_tile(out, FG_QUANTITY_OF_FOIL, "overall.radius_mm", "Overall radius", foil);
  fg_html_quantity_tile(out, FG_QUANTITY_OF_FOIL, "overall.springback_error_pct",
                        "Overall springback", foil);
  put_mean_tile(out, &bumps, "radius_mm", "Bump radius, mean");
  put_mean_tile(out, &bumps, "height_mm", "Bump height, mean");
  put_mean_tile(out, &bumps, "clearance_mm", "Clearance, free, mean");
  put_mean_tile(out, &bumps, "clearance_fitted_mm", "Clearance, fitted, mean");
  fg_html_quantity_tile(out, FG_QUANTITY_OF_FOIL, "thickness_mm", "Thickness", foil);
  fputs("</dl>\n", out);
}

/* The disc that is farthest from round, the smallest and the largest. */
void fg_html_disc_tiles(FILE *out, const fg_measurement *measurement) {
  const fg_disc *small = NULL, *large = NULL, *odd = NULL;
  for (size_t i = 0; i < measurement->disc_count; i++) {
    const fg_disc *disc = &measurement->discs[i];
    if (!isfinite(disc->diameter_mm)) continue;
    if (!small || disc->diameter_mm < small->diameter_mm) small = disc;
    if (!large || disc->diameter_mm > large->diameter_mm) large = disc;
    if (!odd || disc->roundness_um > odd->roundness_um) odd = disc;
  }
  if (!small) return;
  char title[64];
  fputs("<dl class=\"tiles\">\n", out);
  snprintf(title, sizeof title, "Smallest diameter, disc %d", small->number);
  fg_html_quantity_tile(out, FG_QUANTITY_OF_DISC, "diameter_mm", title, small);
  snprintf(title, sizeof title, "Largest diameter, disc %d", large->number);
  fg_html_quantity_tile(out, FG_QUANTITY_OF_DISC, "diameter_mm", title, large);
  snprintf(title, sizeof title, "Farthest from round, disc %d", odd->number);
  fg_html_quantity_tile(out, FG_QUANTITY_OF_DISC, "roundness_um", title, odd);
  fputs("</dl>\n", out);
}
