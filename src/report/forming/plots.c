/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/forming/plots.h"

#include <math.h>
#include <stdio.h>

#include "page/plot_frame.h"

enum { SHOWN_BUMPS = 3 };

/* Returns the value of a stretch that a line shows. */
typedef double piece_value(const fg_forming_piece *piece);

static double die_of(const fg_forming_piece *p) {
  return p->curvature_die;
}
static double free_of(const fg_forming_piece *p) {
  return p->curvature;
}
static double bent_of(const fg_forming_piece *p) {
  return p->stress_mpa[FG_FORMING_BENT];
}
static double heated_of(const fg_forming_piece *p) {
  return p->stress_mpa[FG_FORMING_HEATED];
}
static double left_of(const fg_forming_piece *p) {
  return p->stress_mpa[FG_FORMING_FREE];
}

/* The stretch around the middle bumps: all pitches are alike but for a measured die's. */
static void shown_range(const fg_forming *f, double range[2]) {
  int first = 1, last = (int)f->bump_count;
  if (last > SHOWN_BUMPS) {
    first = (last - SHOWN_BUMPS) / 2 + 1;
    last = first + SHOWN_BUMPS - 1;
  }
  range[0] = f->length_mm;
  range[1] = 0;
  for (size_t i = 0; i < f->count; i++) {
    const fg_forming_piece *p = &f->pieces[i];
    bool land = p->kind == FG_ARC_LAND;
    if (f->bump_count && (p->number < first || p->number > last + land)) continue;
    range[0] = fmin(range[0], p->start_mm);
    range[1] = fmax(range[1], p->start_mm + p->length_mm);
  }
}

/* Draws a line with steps at the ends of stretches. Beyond the plot it runs along the edge. */
static void put_stretch_line(const fg_plot *at, const fg_forming *f, piece_value *value,
                             const char *style) {
  fprintf(at->out, "<path class=\"%s\" d=\"", style);
  char mark = 'M';
  for (size_t i = 0; i < f->count; i++) {
    const fg_forming_piece *p = &f->pieces[i];
    double from = fmax(p->start_mm, at->x_low), to = fmin(p->start_mm + p->length_mm, at->x_high);
    if (to <= from) continue;
    double y = fg_plot_y(at, fg_plot_inside(at, value(p)));
    fprintf(at->out, "%c%.1f %.1fH%.1f", mark, fg_plot_x(at, from), y, fg_plot_x(at, to));
    mark = 'L';
  }
  fputs("\"/>\n", at->out);
}

static void put_bump_numbers(const fg_plot *at, const fg_forming *f) {
  char text[32];
  for (size_t b = 0; b < f->bump_count; b++) {
    double from = f->length_mm, to = 0;
    for (size_t i = 0; i < f->count; i++) {
      const fg_forming_piece *p = &f->pieces[i];
      if (p->kind != FG_ARC_BUMP || p->number != f->bumps[b].number) continue;
      from = fmin(from, p->start_mm);
      to = fmax(to, p->start_mm + p->length_mm);
    }
    double middle = 0.5 * (from + to);
    if (middle < at->x_low || middle > at->x_high) continue;
    snprintf(text, sizeof text, "bump %d", f->bumps[b].number);
    fprintf(at->out, "<text class=\"x bump\" x=\"%.1f\" y=\"%.1f\">%s</text>\n",
            fg_plot_x(at, middle), at->bottom - 8, text);
  }
}

typedef struct line {
  piece_value *value;
  const char *style, *words;
} line;

static void put_key(const fg_plot *at, const line *lines, size_t count) {
  for (size_t i = 0; i < count; i++) {
    double x = 80 + 300 * (double)i;
    fprintf(at->out, "<path class=\"%s\" d=\"M%.0f 14h26\"/><text x=\"%.0f\" y=\"19\">%s</text>\n",
            lines[i].style, x, x + 34, lines[i].words);
  }
}

static void put_along(FILE *out, const fg_forming *f, const line *lines, size_t count, double max,
                      const char *title) {
  double range[2];
  shown_range(f, range);
  fg_plot at = fg_plot_frame_begin(
      out, &(fg_plot_frame){title, .height = 330, .left = 76, .top = 34, .x = range,
                            .y = (double[]){-max, max}, .y_title = title,
                            .x_title = "s along the midline, mm"});
  fg_plot_level(&at, 0, "zero");
  for (size_t i = 0; i < count; i++)
    put_stretch_line(&at, f, lines[i].value, lines[i].style);
  put_bump_numbers(&at, f);
  put_key(&at, lines, count);
  fg_plot_end(&at);
}

void fg_forming_plot_curvature(FILE *out, const fg_forming *f) {
  static const line lines[] = {{die_of, "s2", "in the die"}, {free_of, "s1", "free"}};
  double max = 0;
  /* Fillets are far sharper: they would flatten everything else. */
  for (size_t i = 0; i < f->count; i++)
    if (f->pieces[i].kind != FG_ARC_FILLET) max = fmax(max, fabs(f->pieces[i].curvature_die));
  put_along(out, f, lines, 2, 1.6 * max, "curvature, 1/mm");
}

void fg_forming_plot_stress(FILE *out, const fg_forming *f) {
  static const line lines[] = {{bent_of, "s2", "bent, cold, in the die"},
                               {heated_of, "thin", "at the end of the treatment"},
                               {left_of, "s1", "free"}};
  put_along(out, f, lines, 3, 1.15 * fmax(1, f->largest_stress_mpa[FG_FORMING_BENT]),
            "stress at the face, MPa");
}

/* ---- over the bumps ---- */

static double radius_error(const fg_forming_bump *b) {
  return b->fitted.radius_error_pct;
}
static double angle_error(const fg_forming_bump *b) {
  return b->fitted.intersection_angle_error_pct;
}

void fg_forming_plot_errors(FILE *out, const fg_forming *f) {
  static const struct {
    double (*value)(const fg_forming_bump *);
    const char *style, *words;
  } series[] = {{radius_error, "s1", "bump radius"},
                {angle_error, "s2", "intersection angle theta"}};
  double y[2] = {0, 0};
  for (size_t i = 0; i < f->bump_count; i++)
    for (size_t s = 0; s < 2; s++)
      fg_range_add(y, series[s].value(&f->bumps[i]), 0);
  fg_range_pad(y, 0.1, 0.2);
  fg_plot at = fg_plot_frame_begin(
      out,
      &(fg_plot_frame){"Errors of radius and intersection angle of every bump", .height = 290,
                       .left = 76, .top = 34, .x = (double[]){0.4, (double)f->bump_count + 0.6},
                       .y = y, .y_title = "error, %", .ticks = FG_TICKS_OWN});
  for (size_t i = 0; i < f->bump_count; i++)
    fg_plot_x_number(&at, f->bumps[i].number);
  fg_plot_x_title(&at, "bump");
  fg_plot_level(&at, 0, "zero");
  for (size_t s = 0; s < 2; s++) {
    for (size_t i = 0; i < f->bump_count; i++)
      if (isfinite(series[s].value(&f->bumps[i])))
        fg_plot_dot(&at, f->bumps[i].number, series[s].value(&f->bumps[i]), 5, series[s].style);
    fg_plot_key(&at, 80 + 300 * (double)s, series[s].style, series[s].words);
  }
  fg_plot_end(&at);
}

/* ---- a fit ---- */

void fg_forming_plot_fit(FILE *out, const fg_forming_fit *fit) {
  double range[2] = {INFINITY, -INFINITY};
  for (size_t i = 0; i < fit->runs; i++) {
    fg_range_add(range, fit->run[i].measured, 0);
    fg_range_add(range, fit->run[i].fitted, 0);
    fg_range_add(range, fit->run[i].left_out, 0);
  }
  fg_range_pad(range, 0.06, 1e-6);
  fg_plot at = fg_plot_frame_begin(
      out, &(fg_plot_frame){"Predicted against measured", .height = 430, .left = 76, .top = 34,
                            .x = range, .y = range, .y_title = "predicted, %",
                            .x_title = "measured, %"});
  fg_plot_segment(&at, at.x_low, at.x_low, at.x_high, at.x_high, "hint");
  for (size_t i = 0; i < fit->runs; i++) {
    const fg_forming_run_fit *r = &fit->run[i];
    fg_plot_segment(&at, r->measured, r->fitted, r->measured, r->left_out, "thin");
    fg_plot_dot(&at, r->measured, r->left_out, 5, "s2");
    fg_plot_dot(&at, r->measured, r->fitted, 5, "s1");
  }
  fputs("<circle class=\"s1\" cx=\"80\" cy=\"14\" r=\"5\"/><text x=\"92\" y=\"19\">fitted</text>"
        "<circle class=\"s2\" cx=\"380\" cy=\"14\" r=\"5\"/><text x=\"392\" y=\"19\">by the other "
        "runs alone</text>\n",
        out);
  fg_plot_end(&at);
}
