/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/lot/plots.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "page/page.h"
#include "page/plot_frame.h"
#include "report/stiffness/map.h"

enum { CURVE_POINTS = 240, BARS = 30 };

static void put_bars(const fg_plot *plot, const double *bars) {
  double width = (plot->x_high - plot->x_low) / BARS;
  for (int i = 0; i < BARS; i++) {
    double x = fg_plot_x(plot, plot->x_low + i * width), y = fg_plot_y(plot, bars[i]);
    if (bars[i] > 0)
      fprintf(plot->out,
              "<rect class=\"column\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n",
              x + 1, y, (plot->right - plot->left) / BARS - 2, plot->bottom - y);
  }
}

static void fill_bars(const fg_lot_quantity *quantity, double scale, double shift,
                      const double ends[2], double *bars) {
  double width = (ends[1] - ends[0]) / BARS;
  for (size_t i = 0; i < quantity->count; i++) {
    double x = scale * quantity->value[i] + shift;
    int bar = (int)floor((x - ends[0]) / width);
    if (bar >= 0 && bar < BARS) bars[bar] += 1 / (width * (double)quantity->count);
  }
}

void fg_lot_plot_density(FILE *out, const fg_lot_quantity *quantity, double scale, double shift,
                         const char *title) {
  double x[CURVE_POINTS + 1], y[CURVE_POINTS + 1], bars[BARS] = {0};
  char mark[64];
  if (!quantity || !quantity->has_density) return;
  if (!(quantity->sd > 1e-9 * fabs(quantity->mean))) return; /* equal values have no density */
  double a = scale * quantity->min + shift, b = scale * quantity->max + shift;
  double reach = 2.5 * quantity->density.bandwidth * fabs(scale);
  double ends[2] = {fmin(a, b) - reach, fmax(a, b) + reach}, high = 0;
  fill_bars(quantity, scale, shift, ends, bars);
  for (int i = 0; i <= CURVE_POINTS; i++) {
    x[i] = ends[0] + (ends[1] - ends[0]) * i / CURVE_POINTS;
    y[i] = fg_density_at(&quantity->density, (x[i] - shift) / scale) / fabs(scale);
    high = fmax(high, y[i]);
  }
  for (int i = 0; i < BARS; i++)
    high = fmax(high, bars[i]);
  fg_plot plot =
      fg_plot_open(out, &(fg_plot_frame){"Histogram and kernel density", .height = 300, .left = 92,
                                         .top = 24, .x = ends, .y = (double[]){0, 1.08 * high}});
  fg_plot_y_axis(&plot, "density");
  put_bars(&plot, bars);
  fg_plot_x_numbers(&plot);
  fg_plot_x_title(&plot, title);
  fg_plot_line(&plot, x, y, CURVE_POINTS + 1, "curve");
  double mode = scale * quantity->mode + shift;
  fg_plot_segment(&plot, mode, 0, mode, plot.y_high, "hypothesis");
  snprintf(mark, sizeof mark, "mode %.4g", mode);
  bool right = mode > (plot.x_low + plot.x_high) / 2;
  fg_plot_text(&plot, mode + (right ? -0.01 : 0.01) * (plot.x_high - plot.x_low),
               0.95 * plot.y_high, right ? "end" : "key", mark);
  fg_plot_end(&plot);
}

typedef void bump_visit(const fg_plot *plot, const fg_bump *bump);

static void visit_bumps(const fg_plot *plot, const fg_lot_analysis *analysis, bump_visit *visit) {
  size_t total = 0, seen = 0;
  for (size_t i = 0; i < analysis->foil_count; i++)
    total += analysis->foils[i].foil->bump_count;
  size_t every = total / FG_LOT_DOTS_MAX + 1;
  for (size_t i = 0; i < analysis->foil_count; i++)
    for (size_t k = 0; k < analysis->foils[i].foil->bump_count; k++) {
      const fg_foil *foil = analysis->foils[i].foil;
      if (seen++ % every == 0 && fg_lot_bump_counts(foil, &foil->bumps[k]))
        visit(plot, &foil->bumps[k]);
    }
}

static void put_error_dot(const fg_plot *plot, const fg_bump *bump) {
  double x = bump->radius_error_pct, y = bump->bump_angle_error_pct;
  if (!(x >= plot->x_low && x <= plot->x_high && y >= plot->y_low && y <= plot->y_high)) return;
  fg_plot_dot(plot, x, y, 4.5, "dot");
}

/* Puts alpha at constant arc length: 100 (1 / (1 + e_R / 100) - 1). */
static void put_arc_hypothesis(const fg_plot *plot) {
  double x[CURVE_POINTS + 1], y[CURVE_POINTS + 1];
  for (int i = 0; i <= CURVE_POINTS; i++) {
    x[i] = plot->x_low + (plot->x_high - plot->x_low) * i / CURVE_POINTS;
    y[i] = 100 * (1 / (1 + x[i] / 100) - 1);
    if (!(y[i] >= plot->y_low && y[i] <= plot->y_high)) y[i] = NAN;
  }
  fg_plot_line(plot, x, y, CURVE_POINTS + 1, "hypothesis");
}

/* Puts the part of the line inside the plot. */
static void put_error_line(const fg_plot *plot, double slope, double intercept) {
  double x[2] = {plot->x_low, plot->x_high}, y[2];
  double first = (plot->y_low - intercept) / slope, second = (plot->y_high - intercept) / slope;
  x[0] = fmax(x[0], fmin(first, second));
  x[1] = fmin(x[1], fmax(first, second));
  for (int i = 0; i < 2; i++)
    y[i] = intercept + slope * x[i];
  if (x[1] > x[0]) fg_plot_line(plot, x, y, 2, "fit");
}

static bool error_axes(const fg_lot_analysis *analysis, double x[2], double y[2]) {
  const fg_lot_quantity *radius = fg_lot_find_quantity(analysis, "radius_error_pct");
  const fg_lot_quantity *angle = fg_lot_find_quantity(analysis, "bump_angle_error_pct");
  if (!radius || !angle || radius->count < 2 || angle->count < 2) return false;
  x[0] = fmin(0, radius->min);
  x[1] = fmax(0, radius->max);
  y[0] = fmin(0, angle->min);
  y[1] = fmax(0, angle->max);
  fg_range_pad_by_size(x, 0.06);
  fg_range_pad_by_size(y, 0.06);
  return true;
}

void fg_lot_plot_correlation(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_correlation *line = &analysis->correlation;
  double x[2], y[2];
  if (!analysis->has_correlation || !error_axes(analysis, x, y)) return;
  fg_plot plot = fg_plot_frame_begin(
      out,
      &(fg_plot_frame){"Angle error over radius error of every bump", .height = 430, .left = 92,
                       .x = x, .y = y, .y_title = "angle error, %", .x_title = "radius error, %"});
  put_arc_hypothesis(&plot);
  visit_bumps(&plot, analysis, put_error_dot);
  put_error_line(&plot, line->slope, line->intercept);
  fg_plot_end(&plot);
}

static void put_stiffness_dot(const fg_plot *plot, const fg_bump *bump) {
  double x = 1 + bump->radius_error_pct / 100, y = 1 + bump->bump_angle_error_pct / 100;
  if (!(x >= plot->x_low && x <= plot->x_high && y >= plot->y_low && y <= plot->y_high)) return;
  fg_plot_dot(plot, x, y, 4.5, "mapped");
}

static void put_stiffness_dots(const fg_plot *plot, const void *user) {
  visit_bumps(plot, user, put_stiffness_dot);
}

void fg_lot_plot_map(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_settings *settings = &analysis->lot->settings;
  double x[2], y[2];
  if (!error_axes(analysis, x, y)) return;
  const fg_stiffness_map map = {&settings->design, &settings->material, 1 + x[0] / 100,
                                1 + x[1] / 100,    1 + y[0] / 100,      1 + y[1] / 100};
  fg_stiffness_plot_map(out, &map, put_stiffness_dots, analysis);
}

/* Polar plot: clearance outwards from a circle of zero, so that contact shows inside it. */
typedef struct polar {
  FILE *out;
  double zero_px, px_per_mm;
} polar;

enum { POLAR_SIZE = 560, POLAR_MIDDLE = POLAR_SIZE / 2 };

static void polar_point(const polar *p, double angle_deg, double clearance_mm, double xy[2]) {
  double angle = angle_deg * 3.14159265358979323846 / 180;
  double radius = fmax(0, p->zero_px + p->px_per_mm * clearance_mm);
  xy[0] = POLAR_MIDDLE + radius * cos(angle);
  xy[1] = POLAR_MIDDLE - radius * sin(angle);
}

static void put_ring(const polar *p, double clearance_mm, const char *style, const char *words) {
  double radius = p->zero_px + p->px_per_mm * clearance_mm;
  fprintf(p->out, "<circle cx=\"%d\" cy=\"%d\" r=\"%.1f\" fill=\"none\" class=\"%s\"/>\n",
          POLAR_MIDDLE, POLAR_MIDDLE, radius, style);
  if (words)
    fprintf(p->out, "<text class=\"key\" x=\"%d\" y=\"%.1f\">%s</text>\n", POLAR_MIDDLE + 5,
            POLAR_MIDDLE - radius - 4, words);
}

static void put_pad_arcs(const polar *p, const fg_bearing_layout *layout) {
  double gap = 180 / (double)layout->pads -
               fg_bearing_pitch_deg(layout) * (double)(layout->bumps_per_pad - 1) / 2;
  for (size_t pad = 0; pad < layout->pads; pad++) {
    double inner[2], outer[2], angle = fg_bearing_angle_deg(layout, pad, 0) - gap;
    polar_point(p, angle, -p->zero_px / p->px_per_mm + 60 / p->px_per_mm, inner);
    polar_point(p, angle, (POLAR_MIDDLE - 8 - p->zero_px) / p->px_per_mm, outer);
    fprintf(p->out, "<path class=\"thin\" d=\"M%.1f %.1fL%.1f %.1f\"/>\n", inner[0], inner[1],
            outer[0], outer[1]);
  }
}

static void put_polar_places(const polar *p, const fg_lot_bearing *bearing) {
  double xy[2];
  bool open = false;
  fputs("<path class=\"curve\" d=\"", p->out);
  for (size_t i = 0; i <= bearing->places; i++) {
    size_t at = i % bearing->places;
    bool known = isfinite(bearing->clearance_mm[at]);
    polar_point(p, bearing->angle_deg[at], known ? bearing->clearance_mm[at] : 0, xy);
    if (known) fprintf(p->out, "%c%.1f %.1f", open ? 'L' : 'M', xy[0], xy[1]);
    open = known;
  }
  fputs("\"/>\n", p->out);
  for (size_t i = 0; i < bearing->places; i++) {
    if (!isfinite(bearing->clearance_mm[i])) continue;
    polar_point(p, bearing->angle_deg[i], bearing->clearance_mm[i], xy);
    fprintf(p->out, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"5\"/>\n",
            bearing->clearance_mm[i] < 0 ? "signal" : "s2", xy[0], xy[1]);
  }
}

void fg_lot_plot_polar(FILE *out, const fg_lot_analysis *analysis, const fg_lot_bearing *bearing) {
  double design = analysis->lot->nominal.clearance_mm;
  if (!bearing->known) return;
  double reach = fmax(fabs(bearing->clearance.min_mm), fabs(bearing->clearance.max_mm));
  const polar p = {out, 140, (POLAR_MIDDLE - 24 - 140) / fmax(reach, fabs(design))};
  fprintf(out,
          "<svg class=\"plot polar\" viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"Local "
          "clearance around the bearing, foils fitted\">\n",
          POLAR_SIZE, POLAR_SIZE);
  put_pad_arcs(&p, &analysis->layout);
  put_ring(&p, 0, "limit", "0");
  put_ring(&p, design, "hypothesis", NULL);
  fprintf(out,
          "<text class=\"x\" x=\"%d\" y=\"%d\">least</text><text class=\"x\" x=\"%d\" "
          "y=\"%d\">%.1f µm</text>\n",
          POLAR_MIDDLE, POLAR_MIDDLE - 8, POLAR_MIDDLE, POLAR_MIDDLE + 18,
          1000 * bearing->clearance.min_mm);
  put_polar_places(&p, bearing);
  fputs("</svg>\n", out);
}
