/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plots of a quantity over the numbers of the parts, and over the foils. */
#include <math.h>
#include <string.h>

#include "core/text.h"
#include "page/page.h"
#include "page/plot_frame.h"
#include "report/lot/page_parts.h"
#include "report/lot/plots.h"

/* Maximum of points; beyond it a chart is a line with its signals. */
enum { CHART_POINTS_MAX = 600, DOTS_DRAWN_MAX = 120 };

/* Offsets of the mean and of the foils' dots from the place of a number. */
#define MEAN_AT   (-0.17)
#define FIRST_DOT (-0.05)
#define LAST_DOT  0.35

/* Shortens a name of more than thirty letters, which do not fit beside an axis, to its symbol. */
static void format_axis_title(char *text, size_t size, const fg_quantity *row) {
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

/* Puts the reference curve: joined points, each a diamond. */
static void put_reference_curve(const fg_plot *plot, const fg_quantity *row,
                                const fg_lot_curve *curve) {
  double x[FG_LOT_CURVE_MAX], y[FG_LOT_CURVE_MAX];
  size_t count = 0;
  while (fg_lot_curve_value(curve, row, count, &y[count])) {
    x[count] = curve->point[count].bump;
    count++;
  }
  if (!count) return;
  fg_plot_line(plot, x, y, count, "hypothesis");
  for (size_t i = 0; i < count; i++) {
    const double size = 6, px = fg_plot_x(plot, x[i]), py = fg_plot_y(plot, y[i]);
    fprintf(plot->out,
            "<path class=\"hypothesis\" style=\"stroke-dasharray:none\" d=\"M%.1f %.1fl%g %gl%g "
            "%gl%g %gz\"/>\n",
            px, py - size, size, size, -size, size, -size, -size);
  }
}

/* Returns the step between drawn foils. */
static size_t foils_per_dot(const fg_lot_analysis *analysis, const fg_lot_quantity *quantity) {
  (void)analysis;
  return quantity->count / FG_LOT_DOTS_MAX + 1;
}

/* Puts the values of one foil's parts right of their means, from left to right in order of the
 * foils. A cross marks a value beyond a limit. */
static void put_foil_dots(const fg_plot *plot, const fg_lot_quantity *quantity, const fg_foil *foil,
                          double share) {
  for (size_t k = 0; k < fg_part_count(foil, quantity->owner); k++) {
    const fg_foil_part part = fg_part_at(foil, quantity->owner, k);
    double value = fg_quantity_value(quantity->row, part.object);
    int number = fg_lot_part_number(foil, &part);
    if (number < 1 || !isfinite(value) || !fg_lot_part_counts(foil, quantity->owner, &part))
      continue;
    double x = number + FIRST_DOT + (LAST_DOT - FIRST_DOT) * share;
    const fg_tolerance *limits = quantity->tolerance;
    bool beyond = limits && fg_margin_to(limits->lower, limits->upper, value).inside < 0;
    if (beyond)
      fg_plot_shape(plot, x, value, 5, FG_SHAPE_CROSS, "beyond-limit");
    else
      fg_plot_dot(plot, x, value, 3, "dot");
  }
}

static void put_all_dots(const fg_plot *plot, const fg_lot_analysis *analysis,
                         const fg_lot_quantity *quantity) {
  size_t every = foils_per_dot(analysis, quantity), foils = analysis->foil_count;
  for (size_t i = 0; i < foils; i += every)
    put_foil_dots(plot, quantity, analysis->foils[i].foil,
                  foils > 1 ? (double)i / (double)(foils - 1) : 0.5);
}

static void put_place_means(const fg_plot *plot, const fg_lot_quantity *quantity) {
  for (size_t i = 0; i < quantity->places; i++) {
    const fg_lot_place *place = &quantity->place[i];
    double x = (double)i + 1, mean_x = x + MEAN_AT;
    fg_plot_x_number(plot, (int)i + 1);
    if (!place->count) continue;
    if (isfinite(place->sd))
      fg_plot_segment(plot, mean_x, place->mean - 2 * place->sd, mean_x,
                      place->mean + 2 * place->sd, "curve");
    fg_plot_dot(plot, mean_x, place->mean, 6, "s1");
  }
}

static bool find_place_range(const fg_lot_quantity *quantity, const fg_lot_curve *curve,
                             double range[2]) {
  double value;
  for (size_t i = 0; i < quantity->places; i++)
    fg_range_add(range, quantity->place[i].mean, 2 * quantity->place[i].sd);
  if (!(range[1] >= range[0])) return false;
  fg_range_add(range, quantity->min, 0);
  fg_range_add(range, quantity->max, 0);
  for (size_t i = 0; fg_lot_curve_value(curve, quantity->row, i, &value); i++)
    fg_range_add(range, value, 0);
  if (quantity->tolerance) {
    fg_range_add(range, quantity->tolerance->lower, 0);
    fg_range_add(range, quantity->tolerance->upper, 0);
  }
  fg_range_pad_by_size(range, 0.06);
  return true;
}

void fg_lot_plot_places(FILE *out, const fg_lot_analysis *analysis, const fg_lot_quantity *quantity,
                        const fg_lot_curve *curve) {
  double range[2] = {INFINITY, -INFINITY};
  char title[160];
  if (!find_place_range(quantity, curve, range)) return;
  format_axis_title(title, sizeof title, quantity->row);
  fg_plot plot = fg_plot_frame_begin(
      out,
      &(fg_plot_frame){"By number: mean, two standard deviations, and every foil", .height = 300,
                       .left = 92, .x = (double[]){0.4, (double)quantity->places + 0.6}, .y = range,
                       .y_title = title, .x_title = fg_lot_words_of(analysis)->numbers,
                       .ticks = FG_TICKS_OWN});
  fg_plot_tolerance(&plot, quantity->tolerance);
  put_all_dots(&plot, analysis, quantity);
  put_place_means(&plot, quantity);
  put_reference_curve(&plot, quantity->row, curve);
  fg_plot_end(&plot);
}

void fg_lot_put_places_key(FILE *out, const fg_lot_analysis *analysis,
                           const fg_lot_quantity *quantity) {
  size_t every = foils_per_dot(analysis, quantity);
  fputs("Orange dot and bar: mean and two standard deviations over the foils; beside them every "
        "foil, from left to right in order",
        out);
  if (every > 1) fprintf(out, ", one of %zu drawn", every);
  if (quantity->tolerance) fputs("; red, dashed: tolerance; red crosses: values beyond it", out);
  fputs(".", out);
}

/* Returns the foil of the chart's next point. */
static size_t find_next_foil(const fg_lot_quantity *quantity, size_t foil) {
  while (!quantity->size[foil])
    foil++;
  return foil;
}

/* Begins a mark that links to its foil and names it under a pointer. */
static bool begin_mark(const fg_plot *plot, const fg_lot_analysis *analysis, size_t foil) {
  const fg_lot_foil *marked = &analysis->foils[foil];
  if (!fg_lot_begin_foil_link(plot->out, analysis, marked)) return false;
  bool several = analysis->lot->records[marked->item].foil_count > 1;
  fputs(several ? "<title>" : "<title translate=\"no\">", plot->out);
  fg_html_text(plot->out, fg_manifest_label(&analysis->lot->manifest, marked->item));
  if (several) fprintf(plot->out, ", foil %d", marked->foil->number);
  fputs("</title>", plot->out);
  return true;
}

/* Puts the groups that explain the signals: a shape for each, a line at its mean, a key above. */
static void put_cause_groups(const fg_plot *plot, const fg_lot_analysis *analysis,
                             const fg_lot_quantity *quantity) {
  const fg_lot_cause *cause = &quantity->cause;
  size_t foil = 0;
  for (size_t g = 0; g < cause->groups; g++) {
    char text[200];
    double x = plot->left + (double)g * (plot->right - plot->left) / (double)cause->groups + 12;
    fg_plot_segment(plot, plot->x_low, cause->mean[g], plot->x_high, cause->mean[g], "hint");
    fg_text_clip(text, sizeof text, "%s %s: mean %.5g", analysis->lot->manifest.name[cause->column],
                 cause->name[g], cause->mean[g]);
    fg_plot_shape_at(plot->out, x, 12, 6, (fg_shape)(g % FG_SHAPES), "group");
    fprintf(plot->out, "<text class=\"start\" x=\"%.1f\" y=\"17\">", x + 12);
    fg_html_text(plot->out, text);
    fputs("</text>\n", plot->out);
  }
  for (size_t i = 0; i < quantity->chart.count; i++, foil++) {
    foil = find_next_foil(quantity, foil);
    const char *name =
        fg_manifest_cell(&analysis->lot->manifest, analysis->foils[foil].item, cause->column);
    size_t g = 0;
    while (g + 1 < cause->groups && strcmp(cause->name[g], name) != 0)
      g++;
    bool linked = begin_mark(plot, analysis, foil);
    fg_plot_shape(plot, (double)i + 1, quantity->chart.point[i].value, 6, (fg_shape)(g % FG_SHAPES),
                  quantity->chart.point[i].rules ? "signal" : "group");
    if (linked) fputs("</a>\n", plot->out);
  }
}

static void put_chart_points(const fg_plot *plot, const fg_lot_analysis *analysis,
                             const fg_lot_quantity *quantity) {
  const fg_chart *chart = &quantity->chart;
  size_t foil = 0;
  for (size_t i = 0; i < chart->count; i++, foil++) {
    const fg_chart_point *point = &chart->point[i];
    foil = find_next_foil(quantity, foil);
    if (!point->rules && chart->count > DOTS_DRAWN_MAX) continue;
    bool linked = begin_mark(plot, analysis, foil);
    if (point->rules)
      fg_plot_shape(plot, (double)i + 1, point->value, 7, FG_SHAPE_SQUARE, "signal");
    else
      fg_plot_dot(plot, (double)i + 1, point->value, 4, "s2");
    if (linked) fputs("</a>\n", plot->out);
  }
}

void fg_lot_plot_chart(FILE *out, const fg_lot_analysis *analysis,
                       const fg_lot_quantity *quantity) {
  const fg_chart *chart = &quantity->chart;
  char title[160];
  if (!quantity->has_chart) return;
  bool groups = quantity->cause.column != FG_NO_COLUMN && chart->count <= DOTS_DRAWN_MAX;
  double range[2] = {chart->point[0].lower, chart->point[0].upper}, down = groups ? 20 : 0;
  for (size_t i = 0; i < chart->count; i++)
    fg_range_add(range, chart->point[i].value, 0);
  fg_range_pad_by_size(range, 0.08);
  size_t every = chart->count / CHART_POINTS_MAX + 1;
  format_axis_title(title, sizeof title, quantity->row);
  fg_plot plot = fg_plot_frame_begin(
      out,
      &(fg_plot_frame){
          "Control chart, foil after foil", .height = 260 + (int)down, .left = 92, .top = 14 + down,
          .x = (double[]){0.5, (double)chart->count + 0.5}, .y = range, .y_title = title,
          .x_title = fg_owner_is_part(quantity->owner) ? fg_lot_words_of(analysis)->mean : "foil",
          .ticks = FG_TICKS_COUNTS});
  fg_plot_level(&plot, chart->centre, "thin");
  fg_plot_level(&plot, chart->point[0].lower, "limit");
  fg_plot_level(&plot, chart->point[0].upper, "limit");
  fputs("<path class=\"curve\" d=\"", out);
  for (size_t i = 0; i < chart->count; i += every)
    fprintf(out, "%c%.1f %.1f", i ? 'L' : 'M', fg_plot_x(&plot, (double)i + 1),
            fg_plot_y(&plot, chart->point[i].value));
  fputs("\"/>\n", out);
  if (groups)
    put_cause_groups(&plot, analysis, quantity);
  else
    put_chart_points(&plot, analysis, quantity);
  fg_plot_end(&plot);
}
