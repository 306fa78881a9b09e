/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The control chart of a trend. Tolerances are broad red ground beyond a solid line, control
 * limits are dashed blue lines: they answer different questions and must not look alike. */
#include <math.h>
#include <stdlib.h>

#include "core/select.h"
#include "page/page.h"
#include "page/plot_frame.h"
#include "station/cause.h"
#include "station/trend.h"

enum { DOTS_MAX = 120, COLUMNS_MAX = 450, NAME_BYTES = 140, LABELS = 5 };
/* A tolerance is drawn unless it makes the plot's range larger than GROWTH_MAX times that of the
 * values. */
#define GROWTH_MAX   4.0
#define SIGNAL_PX    6.0
#define DOT_PX       4.0
#define LABEL_GAP_PX 18.0

typedef struct drawing {
  fg_plot at;
  sqlite3 *reader;
  const fg_trend *trend;
  const fg_chart *chart;
  int decimals, height;
  double upper, lower; /* tolerances that are drawn; NaN */
} drawing;

static double place_of_point(const drawing *d, size_t point) {
  return (double)fg_trend_number(d->trend, point);
}

static void find_span(const drawing *d, double range[2]) {
  for (size_t i = d->trend->first; i <= d->trend->last; i++) {
    const fg_chart_point *point = &d->chart->point[i];
    fg_range_add(range, point->value, 0);
    fg_range_add(range, point->lower, 0);
    fg_range_add(range, point->upper, 0);
  }
  if (!(range[1] > range[0])) fg_range_pad(range, 0, fmax(fabs(range[0]) * 1e-6, 1e-9));
}

/* The tolerance's limits, as far as they are near enough not to press the values flat. */
static void include_tolerance(drawing *d, double range[2]) {
  const fg_tolerance *tolerance = d->trend->quantity.tolerance;
  double span = range[1] - range[0];
  d->upper = d->lower = NAN;
  if (!tolerance) return;
  if (fmax(tolerance->upper, range[1]) - range[0] <= GROWTH_MAX * span) d->upper = tolerance->upper;
  if (range[1] - fmin(tolerance->lower, range[0]) <= GROWTH_MAX * span) d->lower = tolerance->lower;
  fg_range_add(range, d->upper, 0);
  fg_range_add(range, d->lower, 0);
}

static void set_axes(drawing *d) {
  double range[2] = {INFINITY, -INFINITY};
  find_span(d, range);
  include_tolerance(d, range);
  fg_range_pad(range, 0.07, 0);
  d->at.y_low = range[0];
  d->at.y_high = range[1];
  d->at.x_low = place_of_point(d, d->trend->first) - 0.5;
  d->at.x_high = place_of_point(d, d->trend->last) + 0.5;
  double step = fg_plot_nice_step(d->at.y_high - d->at.y_low);
  d->decimals = step < 1 ? (int)ceil(-log10(step) - 1e-9) : 0;
}

static void draw_y_axis(const drawing *d) {
  const fg_plot *at = &d->at;
  const fg_quantity *row = d->trend->choice->row;
  double step = fg_plot_nice_step(at->y_high - at->y_low);
  char title[160];
  for (double y = ceil(at->y_low / step) * step; y <= at->y_high; y += step)
    fprintf(at->out,
            "<path class=\"grid\" d=\"M%.1f %.1fH%.1f\"/><text class=\"y\" x=\"%.1f\" y=\"%.1f\">"
            "%.*f</text>\n",
            at->left, fg_plot_y(at, y), at->right, at->left - 8, fg_plot_y(at, y) + 5, d->decimals,
            fabs(y) < step * 1e-6 ? 0 : y);
  snprintf(title, sizeof title, "%s%s%s", row->words, row->unit[0] ? ", " : "", row->unit);
  fprintf(at->out, "<text class=\"start\" x=\"4\" y=\"16\">");
  fg_html_text(at->out, title);
  fputs("</text>\n", at->out);
}

static void draw_x_axis(const drawing *d) {
  const fg_plot *at = &d->at;
  double step = fmax(1, fg_plot_nice_step(at->x_high - at->x_low));
  char text[32];
  for (double x = ceil(at->x_low / step) * step; x <= at->x_high; x += step) {
    snprintf(text, sizeof text, "%.0f", x);
    if (x > 0) fg_plot_x_label(at, fg_plot_x(at, x), text);
  }
  fg_plot_x_title(at, d->trend->choice->by_lots ? "lot, in the order of their first foils"
                                                : "foil, in the order of measuring");
}

static void draw_zone(const drawing *d, double limit, bool above) {
  const fg_plot *at = &d->at;
  if (!isfinite(limit)) return;
  fg_plot_band(at, above ? limit : at->y_low, above ? at->y_high : limit, "zone");
  fprintf(at->out, "<path class=\"tolerance\" d=\"M%.1f %.1fH%.1f\"/>\n", at->left,
          fg_plot_y(at, limit), at->right);
}

typedef enum chart_level { LEVEL_LOWER, LEVEL_CENTRE, LEVEL_UPPER } chart_level;

/* Centre of the chart at a point: causes move it. */
static double centre_at(const drawing *d, size_t point) {
  bool moved = d->trend->shift && !d->trend->choice->taken_out;
  return d->chart->centre + (moved ? d->trend->shift[point] : 0);
}

/* Steps where the limits follow the sizes of lots; where points are many, one in each column. */
static void draw_level(const drawing *d, const char *style, chart_level level) {
  const fg_trend *trend = d->trend;
  double before = NAN;
  fprintf(d->at.out, "<path class=\"%s\" d=\"", style);
  for (size_t i = trend->first; i <= trend->last; i++) {
    const fg_chart_point *point = &d->chart->point[i];
    double limit = level == LEVEL_UPPER   ? point->upper
                   : level == LEVEL_LOWER ? point->lower
                                          : centre_at(d, i);
    double y = fg_plot_y(&d->at, limit), x = fg_plot_x(&d->at, place_of_point(d, i) - 0.5);
    bool differs = !(fabs(y - before) < 0.05);
    if (isnan(before))
      fprintf(d->at.out, "M%.1f %.1f", x, y);
    else if (differs)
      fprintf(d->at.out, "H%.1fV%.1f", x, y);
    if (differs) before = y;
  }
  fprintf(d->at.out, "H%.1f\"/>\n", d->at.right);
}

/* Draws many points as the lowest and the highest of each column, so that outliers show at any
 * number. */
static void draw_columns(const drawing *d) {
  const fg_trend *trend = d->trend;
  size_t count = trend->last - trend->first + 1, share = count / COLUMNS_MAX + 1;
  char letter = 'M';
  fputs("<path class=\"curve\" d=\"", d->at.out);
  for (size_t i = trend->first; i <= trend->last; i += share) {
    size_t min = i, max = i;
    for (size_t k = i; k <= trend->last && k < i + share; k++) {
      if (d->chart->point[k].value < d->chart->point[min].value) min = k;
      if (d->chart->point[k].value > d->chart->point[max].value) max = k;
    }
    const size_t ends[] = {min < max ? min : max, min < max ? max : min};
    for (int e = ends[0] == ends[1]; e < 2; e++, letter = 'L')
      fprintf(d->at.out, "%c%.1f %.1f", letter, fg_plot_x(&d->at, place_of_point(d, ends[e])),
              fg_plot_y(&d->at, d->chart->point[ends[e]].value));
  }
  fputs("\"/>\n", d->at.out);
}

static void draw_dot(const drawing *d, size_t i) {
  const fg_chart_point *point = &d->chart->point[i];
  char name[NAME_BYTES];
  fg_trend_name(d->reader, d->trend, i, name, sizeof name);
  if (!d->trend->choice->by_lots)
    fprintf(d->at.out, "<a href=\"/foil?id=%lld\"%s>", (long long)d->trend->foil[i],
            point->rules ? "" : " tabindex=\"-1\"");
  fprintf(d->at.out, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.3g\"><title>",
          point->rules ? "signal" : "s2", fg_plot_x(&d->at, place_of_point(d, i)),
          fg_plot_y(&d->at, point->value), point->rules ? SIGNAL_PX : DOT_PX);
  fg_html_text(d->at.out, name);
  fprintf(d->at.out, " (no. %zu): %.*f ", fg_trend_number(d->trend, i), d->decimals + 1,
          point->value);
  fg_html_text(d->at.out, d->trend->choice->row->unit);
  for (unsigned rule = 1; rule <= FG_RUN_RULES; rule++)
    if (point->rules & (1u << (rule - 1))) fprintf(d->at.out, "; %s", fg_run_rule_words(rule));
  fprintf(d->at.out, "</title></circle>%s\n", d->trend->choice->by_lots ? "" : "</a>");
}

/* All points where they are few, else the signals, no two on the same spot. */
static void draw_dots(const drawing *d) {
  const fg_trend *trend = d->trend;
  bool few = trend->last - trend->first < DOTS_MAX;
  double x_before = -INFINITY, y_before = 0;
  for (size_t i = trend->first; i <= trend->last; i++) {
    const fg_chart_point *point = &d->chart->point[i];
    double x = fg_plot_x(&d->at, place_of_point(d, i)), y = fg_plot_y(&d->at, point->value);
    if (few) {
      draw_dot(d, i);
    } else if (point->rules && hypot(x - x_before, y - y_before) >= SIGNAL_PX) {
      fprintf(d->at.out, "<circle class=\"signal\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.3g\"/>\n", x, y,
              DOT_PX);
      x_before = x;
      y_before = y;
    }
  }
}

/* The number under which the words below the chart speak of it, over the end of the run. Of several
 * on one spot the newest has it. */
static void draw_runs(const drawing *d, const fg_trend_run *runs, size_t count) {
  const fg_trend *trend = d->trend;
  double drawn[FG_TREND_RUNS];
  size_t marks = 0;
  for (size_t i = 0; i < count; i++) {
    if (runs[i].last < trend->first || runs[i].last > trend->last) continue;
    const fg_chart_point *point = &d->chart->point[runs[i].last];
    double x = fg_plot_x(&d->at, place_of_point(d, runs[i].last)), nearest = INFINITY;
    for (size_t k = 0; k < marks; k++)
      nearest = fmin(nearest, fabs(drawn[k] - x));
    if (nearest < LABEL_GAP_PX) continue;
    drawn[marks++] = x;
    double y = fg_plot_y(&d->at, point->value) + (point->value >= d->chart->centre ? -11 : 24);
    fprintf(d->at.out, "<text class=\"mark\" x=\"%.1f\" y=\"%.1f\">%zu</text>\n", x, y,
            runs[i].mark);
  }
}

static void draw_changes(const drawing *d) {
  for (size_t i = 0; i < d->trend->changes; i++) {
    double x = fg_plot_x(&d->at, place_of_point(d, d->trend->change[i].point) - 0.5);
    fprintf(d->at.out, "<path class=\"change\" d=\"M%.1f %.1fV%.1f\"/>\n", x, d->at.top,
            d->at.bottom);
  }
}

/* The point with which a cause began; 0: before the chart, or never. */
static size_t find_beginning(sqlite3 *reader, const fg_trend *trend, const fg_cause *cause) {
  fg_query query;
  fg_context unused;
  size_t point = 0;
  if (!cause->since) return 0;
  fg_query_begin(reader,
                 "SELECT min(foils.id) FROM scans JOIN foils ON foils.scan = scans.id WHERE at >= ?"
                 " AND foils.id >= ?",
                 &query);
  fg_query_integer(&query, cause->since);
  fg_query_integer(&query, trend->foil[0]);
  int64_t foil =
      fg_query_row(&query) && !fg_query_is_null(&query, 0) ? fg_query_get_integer(&query, 0) : 0;
  if (fg_query_end(&unused, &query, "reading a time") != FG_OK || !foil) return 0;
  while (point < trend->count && trend->foil[point] < foil)
    point++;
  return point;
}

/* Beginnings of causes, with the letters under which the words below speak of them. */
static void draw_causes(const drawing *d) {
  const fg_trend *trend = d->trend;
  for (size_t k = 0; k < trend->causes; k++) {
    size_t point = find_beginning(d->reader, trend, &trend->cause[k]);
    if (point <= trend->first || point > trend->last) continue;
    double x = fg_plot_x(&d->at, place_of_point(d, point) - 0.5);
    fprintf(d->at.out,
            "<path class=\"cause\" d=\"M%.1f %.1fV%.1f\"/><text class=\"cause\" x=\"%.1f\" "
            "y=\"%.1f\">%c</text>\n",
            x, d->at.top, d->at.bottom, x + 4, d->at.top + 14, (char)('a' + k % 26));
  }
}

/* Decimals that tell limits apart: a tenth of sigma, and one or two more than the ticks have. */
static int label_decimals(const drawing *d) {
  double sigma = d->chart->sigma, wanted = sigma > 0 ? ceil(-log10(sigma)) + 1 : 0;
  return (int)fmin(fmax(wanted, d->decimals + 1), d->decimals + 2);
}

static size_t add_label(const drawing *d, fg_plot_label labels[LABELS], size_t count, double value,
                        const char *words, const char *style) {
  if (!isfinite(value)) return count;
  labels[count] = (fg_plot_label){.y = value, .style = style};
  int decimals = value == d->upper || value == d->lower ? d->decimals + 1 : label_decimals(d);
  snprintf(labels[count].text, sizeof labels[count].text, "%s %.*f", words, decimals, value);
  return count + 1;
}

static void draw_labels(const drawing *d) {
  fg_plot_label labels[LABELS];
  size_t count = 0;
  const fg_chart_point *last = &d->chart->point[d->trend->last];
  count = add_label(d, labels, count, d->upper, "max", "start tolerance");
  count = add_label(d, labels, count, last->upper, "+3σ", "start control");
  count = add_label(d, labels, count, centre_at(d, d->trend->last), "mean", "start");
  count = add_label(d, labels, count, last->lower, "−3σ", "start control");
  count = add_label(d, labels, count, d->lower, "min", "start tolerance");
  fg_plot_labels(&d->at, labels, count, LABEL_GAP_PX);
}

static void draw_trend(const drawing *d, const fg_trend_run *runs, size_t run_count) {
  fg_plot_begin(&d->at, d->height, "Control chart; its limits and signals are told below it");
  draw_zone(d, d->upper, true);
  draw_zone(d, d->lower, false);
  draw_y_axis(d);
  draw_x_axis(d);
  draw_level(d, "thin", LEVEL_CENTRE);
  draw_level(d, "control", LEVEL_UPPER);
  draw_level(d, "control", LEVEL_LOWER);
  draw_changes(d);
  draw_causes(d);
  draw_columns(d);
  draw_dots(d);
  draw_runs(d, runs, run_count);
  draw_labels(d);
  fg_plot_end(&d->at);
}

void fg_trend_plot(FILE *out, sqlite3 *reader, const fg_trend *trend, const fg_trend_run *runs,
                   size_t run_count, bool narrow) {
  drawing d = {.reader = reader, .trend = trend, .chart = fg_trend_chart(trend)};
  if (narrow) {
    d.at = (fg_plot){.out = out, .width = 480, .left = 64, .right = 380, .top = 26, .bottom = 330};
    d.height = 380;
  } else {
    d.at = (fg_plot){.out = out, .width = 1080, .left = 78, .right = 960, .top = 26, .bottom = 380};
    d.height = 430;
  }
  set_axes(&d);
  fprintf(out,
          "<figure class=\"zoom %s\" data-left=\"%.4f\" data-right=\"%.4f\" data-from=\"%zu\" "
          "data-to=\"%zu\">\n",
          narrow ? "narrow" : "wide", d.at.left / d.at.width, d.at.right / d.at.width,
          fg_trend_number(trend, trend->first), fg_trend_number(trend, trend->last));
  draw_trend(&d, runs, run_count);
  fputs("</figure>\n", out);
}
