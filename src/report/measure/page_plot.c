/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plots as inline SVG. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/select.h"
#include "report/measure/foil_parts.h"
#include "report/measure/page_tables.h"

static bool has_residual(const fg_station_label *label) {
  return isfinite(label->residual_um) && (label->kind == FG_ARC_BUMP || label->kind == FG_ARC_LAND);
}

/* Returns a limit that nearly all residuals keep: one grain of dust must not flatten the rest.
 * Larger ones are drawn at the limit. */
static double residual_limit(const fg_foil *foil) {
  double *sizes = calloc(foil->strip.count, sizeof *sizes), limit = 1;
  size_t count = 0;
  for (size_t i = 0; sizes && i < foil->strip.count; i++)
    if (has_residual(&foil->labels[i]) && foil->labels[i].fitted)
      sizes[count++] = fabs((double)foil->labels[i].residual_um);
  if (count) {
    fg_sort(sizes, count);
    limit = 1.4 * sizes[(count - 1) * 199 / 200];
  }
  free(sizes);
  return limit > 0 ? limit : 1;
}

static void put_bump_bands(const fg_plot *at, const fg_foil *foil) {
  char number[16];
  for (size_t i = 0; i < foil->bump_count; i++) {
    const fg_bump *bump = &foil->bumps[i];
    if (!(bump->arc_end_mm > bump->arc_start_mm)) continue;
    double from = fg_plot_x(at, bump->arc_start_mm), to = fg_plot_x(at, bump->arc_end_mm);
    snprintf(number, sizeof number, "%d", bump->number);
    fprintf(at->out,
            "<rect class=\"band\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>"
            "<text class=\"x bump\" x=\"%.1f\" y=\"%.1f\">%s</text>\n",
            from, at->top, to - from, at->bottom - at->top, (from + to) / 2, at->top - 6, number);
  }
}

/* Stations are many more than pixels: a stroke from the lowest to the highest of each column. */
static void put_residual_strokes(const fg_plot *at, const fg_foil *foil, fg_arc_kind kind,
                                 const char *style) {
  double column = -1, low = 0, high = 0;
  fprintf(at->out, "<path class=\"%s\" d=\"", style);
  for (size_t i = 0; i < foil->strip.count; i++) {
    if (!has_residual(&foil->labels[i]) || foil->labels[i].kind != kind) continue;
    double value = foil->labels[i].residual_um;
    double x = floor(fg_plot_x(at, foil->strip.stations[i].s_mm)) + 0.5;
    value = fmin(at->y_high, fmax(at->y_low, value));
    if (x != column && column >= 0)
      fprintf(at->out, "M%.1f %.1fV%.1f", column, fg_plot_y(at, low) + 0.7,
              fg_plot_y(at, high) - 0.7);
    if (x != column) low = high = value;
    column = x;
    low = fmin(low, value);
    high = fmax(high, value);
  }
  if (column >= 0)
    fprintf(at->out, "M%.1f %.1fV%.1f", column, fg_plot_y(at, low) + 0.7,
            fg_plot_y(at, high) - 0.7);
  fputs("\"/>\n", at->out);
}

void fg_html_residuals(FILE *out, const fg_foil *foil) {
  if (!foil->labels || foil->strip.count < 2) return;
  double limit = residual_limit(foil);
  fg_plot at = {out, 1000, 70, 985, 26, 240, 0, 1, -limit, limit};
  at.x_low = foil->strip.stations[0].s_mm;
  at.x_high = foil->strip.stations[foil->strip.count - 1].s_mm;
  if (!(at.x_high > at.x_low)) return;
  fg_plot_begin(&at, 290, "Residual of the midline along the foil");
  put_bump_bands(&at, foil);
  fg_plot_y_axis(&at, "residual, µm");
  fg_plot_x_numbers(&at);
  fg_plot_x_title(&at, "along the foil, mm");
  put_residual_strokes(&at, foil, FG_ARC_LAND, "land");
  put_residual_strokes(&at, foil, FG_ARC_BUMP, "arc");
  fputs("</svg>\n", out);
}

typedef struct series {
  const char *quantity, *style, *words, *of_limit; /* text behind a limit's number */
  double shift; /* sideways, so that two error bars do not hide each other */
} series;

/* The two errors that are drawn of every part of a foil. */
typedef struct error_plot {
  const char *title, *axis;
  series series[2];
} error_plot;

static const error_plot of_bumps = {"Springback error of every bump",
                                    "springback error, %",
                                    {{"radius_error_pct", "s1", "bump radius", " % radius", -7},
                                     {"bump_angle_error_pct", "s2", "bump angle", " % angle", 7}}};

static const error_plot of_beams = {
    "Compliance and sagitta of every beam against the design",
    "against the design, %",
    {{"compliance_error_pct", "s1", "compliance", " % compliance", -7},
     {"sagitta_error_pct", "s2", "sagitta", " % sagitta", 7}}};

/* True when the plot's range must hold the part: crushed bumps lie far out, and would flatten
 * the others. */
static bool is_part_shown(const fg_foil_parts *parts, size_t i) {
  if (parts->owner != FG_QUANTITY_OF_BUMP) return true;
  return !(((const fg_bump *)fg_foil_part_at(parts, i))->flags & FG_BUMP_CRUSHED);
}

static const fg_tolerance *limit_of(const fg_design *design, const series *one) {
  for (size_t i = 0; i < design->tolerance_count; i++)
    if (!strcmp(design->tolerances[i].quantity, one->quantity)) return &design->tolerances[i];
  return NULL;
}

static void error_range(const fg_design *design, const error_plot *plot, const fg_foil_parts *parts,
                        double range[2]) {
  range[0] = range[1] = 0;
  for (size_t k = 0; k < 2; k++) {
    const fg_quantity *row = fg_quantity_find(parts->owner, plot->series[k].quantity);
    for (size_t i = 0; i < parts->count; i++) {
      double value = fg_quantity_value(row, fg_foil_part_at(parts, i));
      double u = fg_quantity_uncertainty(row, fg_foil_part_at(parts, i));
      if (!isfinite(value) || !is_part_shown(parts, i)) continue;
      double expanded = isfinite(u) ? FG_COVERAGE_FACTOR * u : 0;
      range[0] = fmin(range[0], value - expanded);
      range[1] = fmax(range[1], value + expanded);
    }
    const fg_tolerance *limit = limit_of(design, &plot->series[k]);
    if (limit && isfinite(limit->lower)) range[0] = fmin(range[0], limit->lower);
    if (limit && isfinite(limit->upper)) range[1] = fmax(range[1], limit->upper);
  }
  double margin = fmax(0.05, 0.08 * (range[1] - range[0]));
  range[0] -= margin;
  range[1] += margin;
}

/* Writes the value of a point beyond the plot, at the edge nearest to it. */
static void put_outside(const fg_plot *at, const series *one, double x, double value) {
  bool above = value > at->y_high;
  double y = above ? at->top : at->bottom;
  fprintf(at->out,
          "<path class=\"%s\" d=\"M%.1f %.1fl0 %.0fM%.1f %.1fl-5 %.0fm5 %.0fl5 %.0f\"/>"
          "<text x=\"%.1f\" y=\"%.1f\">%s%.1f %%</text>\n",
          one->style, x, y, above ? 22.0 : -22.0, x, y, above ? 8.0 : -8.0, above ? -8.0 : 8.0,
          above ? 8.0 : -8.0, x + 9, above ? y + 16 : y - 6, value < 0 ? "−" : "", fabs(value));
}

static void put_mark(const fg_plot *at, const series *one, const fg_foil_parts *parts, size_t i) {
  const fg_quantity *row = fg_quantity_find(parts->owner, one->quantity);
  double value = fg_quantity_value(row, fg_foil_part_at(parts, i));
  double u = fg_quantity_uncertainty(row, fg_foil_part_at(parts, i));
  if (!isfinite(value)) return;
  double x = fg_plot_x(at, fg_foil_part_number(parts, i)) + one->shift, y = fg_plot_y(at, value);
  if (value > at->y_high || value < at->y_low) {
    put_outside(at, one, x, value);
    return;
  }
  double expanded = isfinite(u) ? FG_COVERAGE_FACTOR * u : 0;
  fprintf(at->out,
          "<path class=\"%s\" d=\"M%.1f %.1fV%.1fM%.1f %.1fh10M%.1f %.1fh10\"/>"
          "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"5\"/>\n",
          one->style, x, fg_plot_y(at, value - expanded), fg_plot_y(at, value + expanded), x - 5,
          fg_plot_y(at, value - expanded), x - 5, fg_plot_y(at, value + expanded), one->style, x,
          y);
}

static const char *title_of_numbers(const fg_foil_parts *parts, const fg_foil *foil) {
  if (parts->owner == FG_QUANTITY_OF_BEAM) return "beam";
  return foil->flags & FG_FOIL_NO_LIP ? "bump" : "bump, 1 is next to the lip";
}

static size_t limit_labels(const fg_design *design, const error_plot *plot,
                           fg_plot_label labels[4]) {
  size_t count = 0;
  for (size_t k = 0; k < 2; k++) {
    const fg_tolerance *limit = limit_of(design, &plot->series[k]);
    if (limit) count += fg_html_limit_labels(limit, plot->series[k].of_limit, &labels[count]);
  }
  return count;
}

void fg_html_errors(FILE *out, const fg_design *design, const fg_foil *foil) {
  const fg_foil_parts parts = fg_foil_parts_of(design, foil);
  const error_plot *plot = parts.owner == FG_QUANTITY_OF_BEAM ? &of_beams : &of_bumps;
  double range[2];
  int last = 1;
  if (parts.count == 0) return;
  for (size_t i = 0; i < parts.count; i++)
    if (fg_foil_part_number(&parts, i) > last) last = fg_foil_part_number(&parts, i);
  error_range(design, plot, &parts, range);
  fg_plot_label labels[4];
  size_t count = limit_labels(design, plot, labels);
  fg_plot at = {out, 1000, 70, 985, 34, 260, 0.4, last + 0.6, range[0], range[1]};
  at.right -= fg_html_limit_room(labels, count);
  fg_plot_begin(&at, 310, plot->title);
  fg_plot_y_axis(&at, plot->axis);
  for (size_t i = 0; i < parts.count; i++) {
    char number[16];
    snprintf(number, sizeof number, "%d", fg_foil_part_number(&parts, i));
    fg_plot_x_label(&at, fg_plot_x(&at, fg_foil_part_number(&parts, i)), number);
  }
  fg_plot_x_title(&at, title_of_numbers(&parts, foil));
  fg_html_limit_lines(&at, labels, count);
  for (size_t k = 0; k < 2; k++) {
    const series *one = &plot->series[k];
    for (size_t i = 0; i < parts.count; i++)
      put_mark(&at, one, &parts, i);
    fprintf(
        out,
        "<circle class=\"%s\" cx=\"%.0f\" cy=\"14\" r=\"5\"/><text x=\"%.0f\" y=\"19\">%s</text>\n",
        one->style, 80 + 230.0 * (double)k, 92 + 230.0 * (double)k, one->words);
  }
  fputs("</svg>\n", out);
}
