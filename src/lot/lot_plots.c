#include "lot/lot_plots.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report/measure/measure_page_parts.h"
#include "report/plot_marks.h"
#include "report/stiffness/stiffness_map.h"

/* More dots than these cannot be told apart, and a page must open on a phone. */
enum { PLOT_WIDTH = 1000, DOTS_MAX = 3000, CHART_POINTS_MAX = 600, CURVE_POINTS = 240, BARS = 30 };

/* Values that are equal but for rounding still get an axis with room for numbers. */
static void widen(double *low, double *high, double share) {
  static const double least = 1e-9;
  double size = fmax(fabs(*low), fabs(*high)), room = (*high - *low) * share;
  if (!(room > least * size)) room = size > 0 ? 0.01 * size : 1;
  *low -= room;
  *high += room;
}

static void include(double value, double *low, double *high) {
  if (!isfinite(value)) return;
  *low = fmin(*low, value);
  *high = fmax(*high, value);
}

static void put_limits(const fg_plot *at, const fg_tolerance *tolerance) {
  if (!tolerance) return;
  const double limits[2] = {tolerance->lower, tolerance->upper};
  for (int i = 0; i < 2; i++)
    if (limits[i] > at->y_low && limits[i] < at->y_high)
      fg_plot_segment(at, at->x_low, limits[i], at->x_high, limits[i], "limit");
}

/* Beside an axis there is room for some thirty letters; a longer name gives way to its symbol. */
static void axis_title(char *text, size_t size, const fg_quantity *row) {
  enum { LETTERS = 28 };
  snprintf(text, size, "%s%s%s", strlen(row->words) > LETTERS ? row->symbol : row->words,
           *row->unit ? ", " : "", row->unit);
}

bool fg_lot_curve_value(const fg_lot_curve *curve, const fg_quantity *row, size_t i,
                        double *value) {
  bool radius = !strcmp(row->name, "radius_error_pct");
  if (!curve || i >= curve->count) return false;
  if (!radius && strcmp(row->name, "intersection_angle_error_pct") != 0) return false;
  *value = radius ? curve->point[i].radius_error_pct : curve->point[i].angle_error_pct;
  return true;
}

/* The reference curve: its points joined, a diamond each. */
static void put_curve(const fg_plot *at, const fg_quantity *row, const fg_lot_curve *curve) {
  double x[FG_LOT_CURVE_MAX], y[FG_LOT_CURVE_MAX];
  size_t count = 0;
  while (fg_lot_curve_value(curve, row, count, &y[count])) {
    x[count] = curve->point[count].bump;
    count++;
  }
  if (!count) return;
  fg_plot_line(at, x, y, count, "hypothesis");
  for (size_t i = 0; i < count; i++) {
    const double size = 6, px = fg_plot_x(at, x[i]), py = fg_plot_y(at, y[i]);
    fprintf(at->out,
            "<path class=\"hypothesis\" style=\"stroke-dasharray:none\" d=\"M%.1f %.1fl%g %gl%g "
            "%gl%g %gz\"/>\n",
            px, py - size, size, size, -size, size, -size, -size);
  }
}

void fg_lot_plot_places(FILE *out, const fg_lot_quantity *quantity, const fg_lot_curve *curve) {
  double low = INFINITY, high = -INFINITY;
  char title[160], number[24];
  for (size_t i = 0; i < quantity->places; i++) {
    double reach = isfinite(quantity->place[i].sd) ? 2 * quantity->place[i].sd : 0;
    include(quantity->place[i].mean - reach, &low, &high);
    include(quantity->place[i].mean + reach, &low, &high);
  }
  if (!(high >= low)) return;
  double value;
  for (size_t i = 0; fg_lot_curve_value(curve, quantity->row, i, &value); i++)
    include(value, &low, &high);
  if (quantity->tolerance) {
    include(quantity->tolerance->lower, &low, &high);
    include(quantity->tolerance->upper, &low, &high);
  }
  widen(&low, &high, 0.06);
  fg_plot at = {out, PLOT_WIDTH, 92, 985, 14, 250, 0.4, (double)quantity->places + 0.6, low, high};
  axis_title(title, sizeof title, quantity->row);
  fg_plot_begin(&at, 300, "Mean and two standard deviations of every bump number");
  fg_plot_y_axis(&at, title);
  fg_plot_x_title(&at, "bump, 1 is next to the lip");
  put_limits(&at, quantity->tolerance);
  for (size_t i = 0; i < quantity->places; i++) {
    const fg_lot_place *place = &quantity->place[i];
    double x = (double)i + 1;
    snprintf(number, sizeof number, "%zu", i + 1);
    fg_plot_x_label(&at, fg_plot_x(&at, x), number);
    if (!place->count) continue;
    if (isfinite(place->sd))
      fg_plot_segment(&at, x, place->mean - 2 * place->sd, x, place->mean + 2 * place->sd, "curve");
    fg_plot_dot(&at, x, place->mean, 6, "s1");
  }
  put_curve(&at, quantity->row, curve);
  fg_plot_end(&at);
}

static void put_bars(const fg_plot *at, const double *bars) {
  double width = (at->x_high - at->x_low) / BARS;
  for (int i = 0; i < BARS; i++) {
    double x = fg_plot_x(at, at->x_low + i * width), y = fg_plot_y(at, bars[i]);
    if (bars[i] > 0)
      fprintf(at->out,
              "<rect class=\"column\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n",
              x + 1, y, (at->right - at->left) / BARS - 2, at->bottom - y);
  }
}

static void fill_bars(const fg_lot_quantity *quantity, double scale, double shift,
                      const fg_plot *at, double *bars) {
  double width = (at->x_high - at->x_low) / BARS;
  for (size_t i = 0; i < quantity->count; i++) {
    double x = scale * quantity->value[i] + shift;
    int bar = (int)floor((x - at->x_low) / width);
    if (bar >= 0 && bar < BARS) bars[bar] += 1 / (width * (double)quantity->count);
  }
}

void fg_lot_plot_density(FILE *out, const fg_lot_quantity *quantity, double scale, double shift,
                         const char *title) {
  double x[CURVE_POINTS + 1], y[CURVE_POINTS + 1], bars[BARS] = {0}, high = 0;
  char mark[64];
  if (!quantity || !quantity->has_density) return;
  if (!(quantity->sd > 1e-9 * fabs(quantity->mean))) return; /* one line, no distribution */
  double a = scale * quantity->least + shift, b = scale * quantity->most + shift;
  fg_plot at = {out, PLOT_WIDTH, 92, 985, 24, 250, fmin(a, b), fmax(a, b), 0, 1};
  double reach = 2.5 * quantity->density.bandwidth * fabs(scale);
  at.x_low -= reach;
  at.x_high += reach;
  fill_bars(quantity, scale, shift, &at, bars);
  for (int i = 0; i <= CURVE_POINTS; i++) {
    x[i] = at.x_low + (at.x_high - at.x_low) * i / CURVE_POINTS;
    y[i] = fg_density_at(&quantity->density, (x[i] - shift) / scale) / fabs(scale);
    high = fmax(high, y[i]);
  }
  for (int i = 0; i < BARS; i++)
    high = fmax(high, bars[i]);
  at.y_high = 1.08 * high;
  fg_plot_begin(&at, 300, "Histogram and kernel density");
  fg_plot_y_axis(&at, "density");
  put_bars(&at, bars);
  fg_plot_x_numbers(&at);
  fg_plot_x_title(&at, title);
  fg_plot_line(&at, x, y, CURVE_POINTS + 1, "curve");
  double mode = scale * quantity->mode + shift;
  fg_plot_segment(&at, mode, 0, mode, at.y_high, "hypothesis");
  snprintf(mark, sizeof mark, "mode %.4g", mode);
  bool right = mode > (at.x_low + at.x_high) / 2;
  fg_plot_text(&at, mode + (right ? -0.01 : 0.01) * (at.x_high - at.x_low), 0.95 * at.y_high,
               right ? "end" : "key", mark);
  fg_plot_end(&at);
}

typedef void bump_visit(const fg_plot *at, const fg_bump *bump);

static void each_bump(const fg_plot *at, const fg_lot_analysis *analysis, bump_visit *visit) {
  size_t total = 0, seen = 0;
  for (size_t i = 0; i < analysis->foil_count; i++)
    total += analysis->foils[i].foil->bump_count;
  size_t every = total / DOTS_MAX + 1;
  for (size_t i = 0; i < analysis->foil_count; i++)
    for (size_t k = 0; k < analysis->foils[i].foil->bump_count; k++) {
      const fg_foil *foil = analysis->foils[i].foil;
      if (seen++ % every == 0 && fg_lot_bump_counts(foil, &foil->bumps[k]))
        visit(at, &foil->bumps[k]);
    }
}

static void put_bump(const fg_plot *at, const fg_bump *bump) {
  double x = bump->radius_error_pct, y = bump->bump_angle_error_pct;
  if (!(x >= at->x_low && x <= at->x_high && y >= at->y_low && y <= at->y_high)) return;
  fg_plot_dot(at, x, y, 4.5, "dot");
}

/* alpha at constant arc length: 100 (1 / (1 + e_R / 100) - 1). */
static void put_constant_arc(const fg_plot *at) {
  double x[CURVE_POINTS + 1], y[CURVE_POINTS + 1];
  for (int i = 0; i <= CURVE_POINTS; i++) {
    x[i] = at->x_low + (at->x_high - at->x_low) * i / CURVE_POINTS;
    y[i] = 100 * (1 / (1 + x[i] / 100) - 1);
    if (!(y[i] >= at->y_low && y[i] <= at->y_high)) y[i] = NAN;
  }
  fg_plot_line(at, x, y, CURVE_POINTS + 1, "hypothesis");
}

/* The part of the line that lies inside the plot. */
static void put_fit(const fg_plot *at, double slope, double intercept) {
  double x[2] = {at->x_low, at->x_high}, y[2];
  double first = (at->y_low - intercept) / slope, second = (at->y_high - intercept) / slope;
  x[0] = fmax(x[0], fmin(first, second));
  x[1] = fmin(x[1], fmax(first, second));
  for (int i = 0; i < 2; i++)
    y[i] = intercept + slope * x[i];
  if (x[1] > x[0]) fg_plot_line(at, x, y, 2, "fit");
}

static bool error_axes(const fg_lot_analysis *analysis, fg_plot *at) {
  const fg_lot_quantity *radius = fg_lot_find_quantity(analysis, "radius_error_pct");
  const fg_lot_quantity *angle = fg_lot_find_quantity(analysis, "bump_angle_error_pct");
  if (!radius || !angle || radius->count < 2 || angle->count < 2) return false;
  at->x_low = fmin(0, radius->least);
  at->x_high = fmax(0, radius->most);
  at->y_low = fmin(0, angle->least);
  at->y_high = fmax(0, angle->most);
  widen(&at->x_low, &at->x_high, 0.06);
  widen(&at->y_low, &at->y_high, 0.06);
  return true;
}

void fg_lot_plot_correlation(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_correlation *line = &analysis->correlation;
  fg_plot at = {
      .out = out, .width = PLOT_WIDTH, .left = 92, .right = 985, .top = 14, .bottom = 380};
  if (!analysis->has_correlation || !error_axes(analysis, &at)) return;
  fg_plot_begin(&at, 430, "Angle error over radius error of every bump");
  fg_plot_y_axis(&at, "angle error, %");
  fg_plot_x_numbers(&at);
  fg_plot_x_title(&at, "radius error, %");
  put_constant_arc(&at);
  each_bump(&at, analysis, put_bump);
  put_fit(&at, line->slope, line->intercept);
  fg_plot_end(&at);
}

void fg_lot_plot_chart(FILE *out, const fg_lot_quantity *quantity) {
  const fg_chart *chart = &quantity->chart;
  char title[160];
  if (!quantity->has_chart) return;
  double low = chart->point[0].lower, high = chart->point[0].upper;
  for (size_t i = 0; i < chart->count; i++)
    include(chart->point[i].value, &low, &high);
  widen(&low, &high, 0.08);
  fg_plot at = {out, PLOT_WIDTH, 92, 985, 14, 250, 0.5, (double)chart->count + 0.5, low, high};
  size_t every = chart->count / CHART_POINTS_MAX + 1;
  axis_title(title, sizeof title, quantity->row);
  fg_plot_begin(&at, 300, "Control chart, foil after foil");
  fg_plot_y_axis(&at, title);
  fg_plot_x_numbers(&at);
  fg_plot_x_title(&at,
                  quantity->owner == FG_QUANTITY_OF_BUMP ? "foil (mean of its bumps)" : "foil");
  fg_plot_segment(&at, at.x_low, chart->centre, at.x_high, chart->centre, "thin");
  fg_plot_segment(&at, at.x_low, chart->point[0].lower, at.x_high, chart->point[0].lower, "limit");
  fg_plot_segment(&at, at.x_low, chart->point[0].upper, at.x_high, chart->point[0].upper, "limit");
  fputs("<path class=\"curve\" d=\"", out);
  for (size_t i = 0; i < chart->count; i += every)
    fprintf(out, "%c%.1f %.1f", i ? 'L' : 'M', fg_plot_x(&at, (double)i + 1),
            fg_plot_y(&at, chart->point[i].value));
  fputs("\"/>\n", out);
  for (size_t i = 0; i < chart->count; i++)
    if (chart->point[i].rules || (every == 1 && chart->count <= 120))
      fg_plot_dot(&at, (double)i + 1, chart->point[i].value, chart->point[i].rules ? 6 : 4,
                  chart->point[i].rules ? "signal" : "s2");
  fg_plot_end(&at);
}

static void put_ratio(const fg_plot *at, const fg_bump *bump) {
  double x = 1 + bump->radius_error_pct / 100, y = 1 + bump->bump_angle_error_pct / 100;
  if (!(x >= at->x_low && x <= at->x_high && y >= at->y_low && y <= at->y_high)) return;
  fg_plot_dot(at, x, y, 4.5, "mapped");
}

static void put_ratios(const fg_plot *at, const void *user) {
  each_bump(at, user, put_ratio);
}

void fg_lot_plot_map(FILE *out, const fg_lot_analysis *analysis) {
  const fg_lot_settings *settings = &analysis->lot->settings;
  fg_plot at;
  if (!error_axes(analysis, &at)) return;
  const fg_stiffness_map map = {&settings->design,   &settings->material, 1 + at.x_low / 100,
                                1 + at.x_high / 100, 1 + at.y_low / 100,  1 + at.y_high / 100};
  fg_stiffness_plot_map(out, &map, put_ratios, analysis);
}

/* A polar plot: the clearance outwards from a zero circle, so that a rub shows inside it. */
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
  fprintf(p->out, "<text class=\"key\" x=\"%d\" y=\"%.1f\">%s</text>\n", POLAR_MIDDLE + 5,
          POLAR_MIDDLE - radius - 4, words);
}

static void put_pads(const polar *p, const fg_bearing_layout *layout) {
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

static void put_places(const polar *p, const fg_lot_bearing *bearing) {
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
  double reach = fmax(fabs(bearing->clearance.least_mm), fabs(bearing->clearance.most_mm));
  const polar p = {out, 140, (POLAR_MIDDLE - 24 - 140) / fmax(reach, fabs(design))};
  fprintf(out,
          "<svg class=\"plot polar\" viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"Local "
          "clearance around the bearing, foils fitted\">\n",
          POLAR_SIZE, POLAR_SIZE);
  put_pads(&p, &analysis->layout);
  put_ring(&p, 0, "limit", "0");
  char words[48];
  snprintf(words, sizeof words, "design %.0f µm", 1000 * design);
  put_ring(&p, design, "hypothesis", words);
  put_places(&p, bearing);
  fputs("</svg>\n", out);
}
