/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plots as inline SVG. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/select.h"
#include "page/plot_frame.h"
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
  for (size_t i = 0; i < foil->bump_count; i++) {
    const fg_bump *bump = &foil->bumps[i];
    if (bump->arc_end_mm > bump->arc_start_mm)
      fg_plot_bump_band(at, bump->arc_start_mm, bump->arc_end_mm, bump->number);
  }
}

/* Stations are many more than pixels: a stroke from the lowest to the highest of each column. */
static void put_residual_strokes(const fg_plot *at, const fg_foil *foil, fg_arc_kind kind,
                                 const char *style) {
  double column = -1, low = 0, high = 0;
  fprintf(at->out, "<path class=\"%s\" d=\"", style);
  for (size_t i = 0; i < foil->strip.count; i++) {
    if (!has_residual(&foil->labels[i]) || foil->labels[i].kind != kind) continue;
    double value = fg_plot_inside(at, foil->labels[i].residual_um);
    double x = floor(fg_plot_x(at, foil->strip.stations[i].s_mm)) + 0.5;
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
  const fg_station *stations = foil->strip.stations;
  double ends[2] = {stations[0].s_mm, stations[foil->strip.count - 1].s_mm};
  if (!(ends[1] > ends[0])) return;
  fg_plot at = fg_plot_open(
      out, &(fg_plot_frame){"Residual of the midline along the foil", .height = 290, .left = 70,
                            .top = 26, .x = ends, .y = (double[]){-limit, limit},
                            .y_title = "residual, µm", .x_title = "along the foil, mm"});
  put_bump_bands(&at, foil);
  fg_plot_axes(&at);
  put_residual_strokes(&at, foil, FG_ARC_LAND, "land");
  put_residual_strokes(&at, foil, FG_ARC_BUMP, "arc");
  fg_plot_end(&at);
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
      if (is_part_shown(parts, i)) fg_range_add(range, value, FG_COVERAGE_FACTOR * u);
    }
    const fg_tolerance *limit = limit_of(design, &plot->series[k]);
    if (limit) fg_range_add(range, limit->lower, 0);
    if (limit) fg_range_add(range, limit->upper, 0);
  }
  fg_range_pad(range, 0.08, 0.05);
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
  int number = fg_foil_part_number(parts, i);
  if (value > at->y_high || value < at->y_low)
    put_outside(at, one, fg_plot_x(at, number) + one->shift, value);
  else
    fg_plot_interval(at, number, one->shift, value, isfinite(u) ? FG_COVERAGE_FACTOR * u : 0,
                     one->style);
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
  fg_plot at = fg_plot_frame_begin(
      out, &(fg_plot_frame){plot->title, .height = 310, .left = 70,
                            .right = 15 + fg_html_limit_room(labels, count), .top = 34,
                            .x = (double[]){0.4, last + 0.6}, .y = range, .y_title = plot->axis,
                            .ticks = FG_TICKS_OWN});
  for (size_t i = 0; i < parts.count; i++)
    fg_plot_x_number(&at, fg_foil_part_number(&parts, i));
  fg_plot_x_title(&at, title_of_numbers(&parts, foil));
  fg_html_limit_lines(&at, labels, count);
  for (size_t k = 0; k < 2; k++) {
    const series *one = &plot->series[k];
    for (size_t i = 0; i < parts.count; i++)
      put_mark(&at, one, &parts, i);
    fg_plot_key(&at, 80 + 230 * (double)k, one->style, one->words);
  }
  fg_plot_end(&at);
}
