/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/die/plots.h"

#include <math.h>
#include <string.h>

#include "foilgauge/report.h"
#include "page/plot.h"
#include "page/plot_marks.h"

#define DEG (180 / M_PI)

static const char *const half_style[FG_DIE_HALVES] = {"s2", "s1"};
static const char *const half_words[FG_DIE_HALVES] = {"concave half (grooves)",
                                                      "convex half (ridges)"};

static void widen_die_range(double range[2], double low, double high) {
  if (isfinite(low)) range[0] = fmin(range[0], low);
  if (isfinite(high)) range[1] = fmax(range[1], high);
}

static const fg_tolerance *find_tolerance(const fg_die *die, const char *name) {
  for (size_t i = 0; i < die->design.tolerance_count; i++)
    if (!strcmp(die->design.tolerances[i].quantity, name)) return &die->design.tolerances[i];
  return NULL;
}

static void numbers_of(const fg_die *die, int range[2]) {
  const fg_die_side *whole = &die->whole;
  range[0] = whole->bumps[0].number;
  range[1] = whole->bumps[whole->bump_count - 1].number;
}

static void error_range(const fg_die *die, fg_die_quantity q, double range[2]) {
  range[0] = range[1] = 0;
  for (int half = 0; half < FG_DIE_HALVES; half++)
    for (size_t i = 0; i < die->half[half].bump_count; i++) {
      const fg_die_value *v = &die->half[half].bumps[i].value[q];
      widen_die_range(range, v->value - FG_COVERAGE_FACTOR * v->u,
                      v->value + FG_COVERAGE_FACTOR * v->u);
    }
  /* Limits that lie near; far ones would flatten everything. */
  const fg_tolerance *limits = find_tolerance(die, fg_die_row_of(q)->name);
  double span = range[1] - range[0];
  if (limits && limits->lower > range[0] - span) widen_die_range(range, limits->lower, NAN);
  if (limits && limits->upper < range[1] + span) widen_die_range(range, NAN, limits->upper);
  double margin = fmax(0.02, 0.1 * (range[1] - range[0]));
  range[0] -= margin;
  range[1] += margin;
}

static void put_mark(const fg_plot *at, double number, double shift, const fg_die_value *v,
                     const char *style) {
  double x = fg_plot_x(at, number) + shift, half = FG_COVERAGE_FACTOR * v->u;
  double low = fg_plot_y(at, v->value - half), high = fg_plot_y(at, v->value + half);
  fprintf(at->out,
          "<path class=\"%s\" d=\"M%.1f %.1fV%.1fM%.1f %.1fh10M%.1f %.1fh10\"/>"
          "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"5\"/>\n",
          style, x, low, high, x - 5, low, x - 5, high, style, x, fg_plot_y(at, v->value));
}

static void put_limits(const fg_plot *at, const fg_tolerance *limits) {
  const double sides[] = {limits ? limits->lower : NAN, limits ? limits->upper : NAN};
  for (int i = 0; i < 2; i++)
    if (sides[i] > at->y_low && sides[i] < at->y_high)
      fg_plot_segment(at, at->x_low, sides[i], at->x_high, sides[i], "limit");
}

static void put_half_errors(const fg_plot *at, const fg_die *die, fg_die_half half,
                            fg_die_quantity q) {
  const fg_die_side *side = &die->half[half];
  double shift = half == FG_DIE_CONCAVE ? -7 : 7, key = 80 + 420.0 * (double)half;
  if (!side->traces) return;
  fg_plot_segment(at, at->x_low, side->mean[q].value, at->x_high, side->mean[q].value,
                  half == FG_DIE_CONCAVE ? "k0 faint" : "k1 faint");
  for (size_t i = 0; i < side->bump_count; i++)
    put_mark(at, side->bumps[i].number, shift, &side->bumps[i].value[q], half_style[half]);
  fprintf(at->out,
          "<circle class=\"%s\" cx=\"%.0f\" cy=\"14\" r=\"5\"/><text x=\"%.0f\" y=\"19\">%s, mean "
          "%+.3f %%</text>\n",
          half_style[half], key, key + 12, half_words[half], side->mean[q].value);
}

void fg_die_plot_errors(FILE *out, const fg_die *die, fg_die_quantity q) {
  double range[2];
  int numbers[2];
  char text[80];
  const fg_die_row *row = fg_die_row_of(q);
  error_range(die, q, range);
  numbers_of(die, numbers);
  fg_plot at = {out,      1000,    70, 985, 34, 240, numbers[0] - 0.6, numbers[1] + 0.6,
                range[0], range[1]};
  snprintf(text, sizeof text, "%s of every bump, by half", row->words);
  fg_plot_begin(&at, 290, text);
  snprintf(text, sizeof text, "%s, %s", row->words, row->unit);
  fg_plot_y_axis(&at, text);
  for (int number = numbers[0]; number <= numbers[1]; number++) {
    snprintf(text, sizeof text, "%d", number);
    fg_plot_x_label(&at, fg_plot_x(&at, number), text);
  }
  fg_plot_x_title(&at, "bump");
  put_limits(&at, find_tolerance(die, row->name));
  for (int half = 0; half < FG_DIE_HALVES; half++)
    put_half_errors(&at, die, (fg_die_half)half, q);
  fg_plot_end(&at);
}

static const fg_die_trace *first_trace(const fg_die *die, fg_die_half half) {
  for (size_t i = 0; i < die->trace_count; i++)
    if (die->traces[i].half == half) return &die->traces[i];
  return NULL;
}

/* An arc of a circle about the direction to a point. */
static void put_arc(const fg_plot *at, fg_point centre, double radius, double middle_rad,
                    double half_rad, const char *style) {
  enum { STEPS = 60 };
  double x[STEPS + 1], y[STEPS + 1];
  for (int i = 0; i <= STEPS; i++) {
    double angle = middle_rad + half_rad * (2.0 * i / STEPS - 1);
    x[i] = centre.x + radius * cos(angle);
    y[i] = centre.y + radius * sin(angle);
  }
  fg_plot_line(at, x, y, STEPS + 1, style);
}

enum { TRACE_WIDTH = 1000, TRACE_EDGE = 20, LINE_POINTS = 1500 };

static fg_plot trace_plot(FILE *out, const fg_die_trace *trace, int *height) {
  double low = INFINITY, high = -INFINITY;
  for (size_t i = 0; i < trace->station_count; i++) {
    low = fmin(low, trace->stations[i].z);
    high = fmax(high, trace->stations[i].z);
  }
  double from = trace->stations[0].x, to = trace->stations[trace->station_count - 1].x;
  double scale = (TRACE_WIDTH - 2 * TRACE_EDGE) / (to - from);
  low -= 16 / scale;
  high += 30 / scale;
  *height = (int)(scale * (high - low)) + 2 * TRACE_EDGE;
  return (fg_plot){out,        TRACE_WIDTH,
                   TRACE_EDGE, TRACE_WIDTH - TRACE_EDGE,
                   TRACE_EDGE, *height - TRACE_EDGE,
                   from,       to,
                   low,        high};
}

static void put_trace_line(const fg_plot *at, const fg_die_trace *trace) {
  size_t every = 1 + trace->station_count / LINE_POINTS;
  fprintf(at->out, "<path class=\"strip\" d=\"");
  for (size_t i = 0; i < trace->station_count; i += every)
    fprintf(at->out, "%c%.1f %.1f", i ? 'L' : 'M', fg_plot_x(at, trace->stations[i].x),
            fg_plot_y(at, trace->stations[i].z));
  fputs("\"/>\n", at->out);
}

static void put_circles(const fg_plot *at, const fg_die *die, const fg_die_trace *trace) {
  char number[16];
  const fg_overall *o = &trace->overall;
  double up = trace->half == FG_DIE_CONCAVE ? M_PI / 2 : -M_PI / 2;
  double reach = asin(fmin(1, 0.5 * trace->length_mm / o->radius_mm));
  put_arc(at, o->centre_mm, o->radius_mm + trace->shift_mm, up, reach, "land hint");
  for (size_t i = 0; i < trace->bump_count; i++) {
    const fg_bump *bump = &trace->bumps[i];
    double towards = atan2(o->centre_mm.y - bump->centre_mm.y, o->centre_mm.x - bump->centre_mm.x);
    double radius = bump->radius_mm - trace->shift_mm,
           label = radius + 14 / (fg_plot_x(at, 1) - fg_plot_x(at, 0));
    put_arc(at, bump->centre_mm, radius, towards, 0.5 * die->design.bumps.angle_deg / DEG, "s1");
    snprintf(number, sizeof number, "%d", bump->number);
    fg_plot_text(at, bump->centre_mm.x + label * cos(towards),
                 bump->centre_mm.y + label * sin(towards) -
                     5 / (fg_plot_x(at, 1) - fg_plot_x(at, 0)),
                 "x bump", number);
  }
}

void fg_die_plot_trace(FILE *out, const fg_die *die, fg_die_half half) {
  const fg_die_trace *trace = first_trace(die, half);
  int height;
  if (!trace || trace->station_count < 2) return;
  fg_plot at = trace_plot(out, trace, &height);
  fg_plot_begin(&at, height, "A trace of this half with its circles");
  put_trace_line(&at, trace);
  put_circles(&at, die, trace);
  fg_plot_end(&at);
}

/* The die's own coordinate: directions from O in pitches, bumps at their numbers. */
typedef struct along {
  double turn; /* mean direction minus number */
  double sign;
} along;

static double pitches(const fg_die *die, const fg_die_trace *trace, double x, double z) {
  double dz = z - trace->overall.centre_mm.y;
  return atan2(x - trace->overall.centre_mm.x, trace->half == FG_DIE_CONCAVE ? dz : -dz) * DEG /
         die->design.bumps.pitch_deg;
}

static along along_of(const fg_die *die, const fg_die_trace *trace) {
  along a = {0, trace->reversed ? -1 : 1};
  for (size_t i = 0; i < trace->bump_count; i++) {
    fg_point c = trace->bumps[i].centre_mm;
    a.turn += a.sign * pitches(die, trace, c.x, c.y) - trace->bumps[i].number;
  }
  a.turn /= (double)trace->bump_count;
  return a;
}

/* Width of the bins whose means are drawn: in means, the shape that repeats share rises out of
 * the noise. */
enum { BIN_PX = 2 };

/* One bin of a line: the mean of its points. */
typedef struct bin {
  double column, sum;
  int count, kind; /* bump, or 0 of the lands */
} bin;

static void end_bin(const fg_plot *at, const bin *b, int *kind_before) {
  if (!b->count) return;
  double y = fmin(at->y_high, fmax(at->y_low, b->sum / b->count));
  fprintf(at->out, "%c%.0f %.1f", b->kind == *kind_before ? 'L' : 'M', b->column + BIN_PX / 2,
          fg_plot_y(at, y));
  *kind_before = b->kind;
}

static void put_residuals(const fg_plot *at, const fg_die *die, const fg_die_trace *trace,
                          size_t colour) {
  along a = along_of(die, trace);
  bin b = {0};
  int before = -1;
  fprintf(at->out, "<path class=\"k%zu\" d=\"", colour % 5);
  for (size_t i = 0; i < trace->station_count; i++) {
    const fg_die_station *s = &trace->stations[i];
    if (!isfinite(s->residual_um)) continue;
    double x = fg_plot_x(at, a.sign * pitches(die, trace, s->x, s->z) - a.turn);
    double column = floor(x / BIN_PX) * BIN_PX;
    if (b.count && (column != b.column || s->bump != b.kind)) {
      /* A gap lifts the pen: from one land to the next. */
      end_bin(at, &b, &before);
      if (fabs(column - b.column) > 4 * BIN_PX) before = -1;
      b.count = 0;
    }
    if (!b.count) b = (bin){column, 0, 0, s->bump};
    b.sum += s->residual_um;
    b.count++;
  }
  end_bin(at, &b, &before);
  fputs("\"/>\n", at->out);
}

static double residual_limit(const fg_die *die, fg_die_half half) {
  double max = 0;
  for (size_t i = 0; i < die->trace_count; i++)
    if (die->traces[i].half == half) {
      max = fmax(max, die->traces[i].noise_um);
      max = fmax(max, die->traces[i].overall.rms_um);
    }
  return max > 0 ? 3.2 * max : 1;
}

static void put_bands(const fg_plot *at, const fg_die *die, fg_die_half half) {
  char number[16];
  double wide = 0.8 * die->nominal.half_chord_mm / die->design.overall_radius_mm * DEG /
                die->design.bumps.pitch_deg;
  for (size_t i = 0; i < die->half[half].bump_count; i++) {
    int n = die->half[half].bumps[i].number;
    double from = fg_plot_x(at, n - wide), to = fg_plot_x(at, n + wide);
    snprintf(number, sizeof number, "%d", n);
    fprintf(at->out,
            "<rect class=\"band\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>"
            "<text class=\"x bump\" x=\"%.1f\" y=\"%.1f\">%s</text>\n",
            from, at->top, to - from, at->bottom - at->top, (from + to) / 2, at->top - 6, number);
  }
}

void fg_die_plot_residuals(FILE *out, const fg_die *die, fg_die_half half) {
  double limit = residual_limit(die, half);
  int numbers[2];
  size_t colour = 0;
  numbers_of(die, numbers);
  fg_plot at = {out, 1000, 70, 985, 26, 220, numbers[0] - 0.75, numbers[1] + 0.75, -limit, limit};
  fg_plot_begin(&at, 240, "Residuals of the traces from their circles");
  put_bands(&at, die, half);
  fg_plot_y_axis(&at, "residual, µm");
  for (size_t i = 0; i < die->trace_count; i++)
    if (die->traces[i].half == half) put_residuals(&at, die, &die->traces[i], colour++);
  fg_plot_end(&at);
}
