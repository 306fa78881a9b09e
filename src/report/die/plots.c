/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/die/plots.h"

#include <math.h>
#include <string.h>

#include "foilgauge/report.h"
#include "page/plot_frame.h"

#define DEG (180 / M_PI)

static const char *const half_style[FG_DIE_HALVES] = {"s2", "s1"};
static const char *const half_words[FG_DIE_HALVES] = {"concave half (grooves)",
                                                      "convex half (ridges)"};

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
      fg_range_add(range, v->value, FG_COVERAGE_FACTOR * v->u);
    }
  /* Limits that lie near; far ones would flatten everything. */
  const fg_tolerance *limits = find_tolerance(die, fg_die_row_of(q)->name);
  double span = range[1] - range[0];
  if (limits && limits->lower > range[0] - span) fg_range_add(range, limits->lower, 0);
  if (limits && limits->upper < range[1] + span) fg_range_add(range, limits->upper, 0);
  fg_range_pad(range, 0.1, 0.02);
}

static void put_half_errors(const fg_plot *at, const fg_die *die, fg_die_half half,
                            fg_die_quantity q) {
  const fg_die_side *side = &die->half[half];
  char words[80];
  if (!side->traces) return;
  fg_plot_level(at, side->mean[q].value, half == FG_DIE_CONCAVE ? "k0 faint" : "k1 faint");
  for (size_t i = 0; i < side->bump_count; i++) {
    const fg_die_value *v = &side->bumps[i].value[q];
    fg_plot_interval(at, side->bumps[i].number, half == FG_DIE_CONCAVE ? -7 : 7, v->value,
                     FG_COVERAGE_FACTOR * v->u, half_style[half]);
  }
  snprintf(words, sizeof words, "%s, mean %+.3f %%", half_words[half], side->mean[q].value);
  fg_plot_key(at, 80 + 420 * (double)half, half_style[half], words);
}

void fg_die_plot_errors(FILE *out, const fg_die *die, fg_die_quantity q) {
  double range[2];
  int numbers[2];
  char label[80], title[80];
  const fg_die_row *row = fg_die_row_of(q);
  error_range(die, q, range);
  numbers_of(die, numbers);
  snprintf(label, sizeof label, "%s of every bump, by half", row->words);
  snprintf(title, sizeof title, "%s, %s", row->words, row->unit);
  fg_plot at = fg_plot_frame_begin(
      out, &(fg_plot_frame){label, .height = 290, .left = 70, .top = 34,
                            .x = (double[]){numbers[0] - 0.6, numbers[1] + 0.6}, .y = range,
                            .y_title = title, .ticks = FG_TICKS_OWN});
  for (int number = numbers[0]; number <= numbers[1]; number++)
    fg_plot_x_number(&at, number);
  fg_plot_x_title(&at, "bump");
  fg_plot_tolerance(&at, find_tolerance(die, row->name));
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

/* Opens a plot whose scale is the same along both axes. */
static fg_plot open_trace_plot(FILE *out, const fg_die_trace *trace) {
  double x[2] = {trace->stations[0].x, trace->stations[trace->station_count - 1].x};
  double scale = (TRACE_WIDTH - 2 * TRACE_EDGE) / (x[1] - x[0]), z[2] = {INFINITY, -INFINITY};
  for (size_t i = 0; i < trace->station_count; i++)
    fg_range_add(z, trace->stations[i].z, 0);
  z[0] -= 16 / scale;
  z[1] += 30 / scale;
  return fg_plot_open(out,
                      &(fg_plot_frame){"A trace of this half with its circles",
                                       .height = (int)(scale * (z[1] - z[0])) + 2 * TRACE_EDGE,
                                       .left = TRACE_EDGE, .right = TRACE_EDGE, .top = TRACE_EDGE,
                                       .bottom = TRACE_EDGE, .x = x, .y = z});
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
  if (!trace || trace->station_count < 2) return;
  fg_plot at = open_trace_plot(out, trace);
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
  fprintf(at->out, "%c%.0f %.1f", b->kind == *kind_before ? 'L' : 'M', b->column + BIN_PX / 2,
          fg_plot_y(at, fg_plot_inside(at, b->sum / b->count)));
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
  double wide = 0.8 * die->nominal.half_chord_mm / die->design.overall_radius_mm * DEG /
                die->design.bumps.pitch_deg;
  for (size_t i = 0; i < die->half[half].bump_count; i++) {
    int number = die->half[half].bumps[i].number;
    fg_plot_bump_band(at, number - wide, number + wide, number);
  }
}

void fg_die_plot_residuals(FILE *out, const fg_die *die, fg_die_half half) {
  double limit = residual_limit(die, half);
  int numbers[2];
  size_t colour = 0;
  numbers_of(die, numbers);
  fg_plot at =
      fg_plot_open(out, &(fg_plot_frame){"Residuals of the traces from their circles",
                                         .height = 240, .left = 70, .top = 26, .bottom = 20,
                                         .x = (double[]){numbers[0] - 0.75, numbers[1] + 0.75},
                                         .y = (double[]){-limit, limit}});
  put_bands(&at, die, half);
  fg_plot_y_axis(&at, "residual, µm");
  for (size_t i = 0; i < die->trace_count; i++)
    if (die->traces[i].half == half) put_residuals(&at, die, &die->traces[i], colour++);
  fg_plot_end(&at);
}
