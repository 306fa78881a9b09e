/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The surface over two factors as bands, lines and the runs. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "page/plot_marks.h"
#include "report/doe/axes.h"
#include "report/doe/plots.h"
#include "report/doe/words.h"
#include "report/unit_words.h"

enum {
  GRID = 64,
  CONTOURS_SHOWN = 3,
  BANDS_MAX = 40,
  POINTS_SHOWN = 1000,
  PLACES_MAX = 300,
  CORNERS_MAX = 8, /* a cell that two levels cut */
  BISECTIONS = 12  /* of a cell: finer than a picture shows */
};

/* A level's words, in units of the view box. */
#define LABEL_WIDE 44.0
#define LABEL_HIGH 18.0

/* Node values of a slice of the surface through the optimum. */
typedef struct slice {
  const fg_experiment *e;
  size_t a, b; /* axes of the surface */
  const fg_factor *fa, *fb;
  double x[FG_SURFACE_FACTORS];
  double value[GRID + 1][GRID + 1]; /* [along b][along a] */
  double step, first;               /* of the contour levels */
} slice;

/* Returns the best setting: among those a machine has, where steps were given. */
static const fg_optimum *best_of(const fg_experiment *e) {
  return e->best.has_rounded ? &e->best.rounded : &e->best.optimum;
}

/* Places of the plot that words keep clear of, in units of its view box. */
typedef struct places {
  double x[PLACES_MAX], y[PLACES_MAX], wide[PLACES_MAX];
  size_t count;
} places;

static double value_along_factor(const fg_factor *f, double share) {
  return f->lowest + (f->highest - f->lowest) * share;
}

static void sample(slice *s) {
  double range[2] = {INFINITY, -INFINITY};
  for (int i = 0; i <= GRID; i++)
    for (int k = 0; k <= GRID; k++) {
      s->x[s->a] = value_along_factor(s->fa, (double)k / GRID);
      s->x[s->b] = value_along_factor(s->fb, (double)i / GRID);
      s->value[i][k] = fg_surface_value(&s->e->surface, s->x);
      fg_range_add(range, s->value[i][k], 0);
    }
  s->step = range[1] > range[0] ? fg_plot_nice_step((range[1] - range[0]) / 2) : 1;
  s->first = floor(range[0] / s->step) * s->step;
}

static double real_a(const slice *s, double k) {
  return fg_factor_real(s->fa, value_along_factor(s->fa, k / GRID));
}

static double real_b(const slice *s, double i) {
  return fg_factor_real(s->fb, value_along_factor(s->fb, i / GRID));
}

/* Bands between the contour levels, from pale to blue: a cell is cut along its levels. */
typedef struct polygon {
  double point[CORNERS_MAX][3]; /* k, i, value */
  int count;
} polygon;

static void add_point(polygon *p, const double *a, const double *b, double share) {
  if (p->count == CORNERS_MAX) return;
  for (int n = 0; n < 3; n++)
    p->point[p->count][n] = a[n] + share * (b[n] - a[n]);
  p->count++;
}

/* Cuts a polygon to the part whose value is at least `level` (sign 1) or at most (sign -1):
 * Sutherland and Hodgman (1974). */
static void cut(polygon *p, double level, double sign) {
  polygon kept = {.count = 0};
  for (int c = 0; c < p->count; c++) {
    const double *a = p->point[c], *b = p->point[(c + 1) % p->count];
    bool in_a = sign * (a[2] - level) >= 0, in_b = sign * (b[2] - level) >= 0;
    if (in_a) add_point(&kept, a, a, 0);
    if (in_a != in_b) add_point(&kept, a, b, (level - a[2]) / (b[2] - a[2]));
  }
  *p = kept;
}

static void put_polygon(const fg_plot *at, const slice *s, const polygon *p) {
  for (int c = 0; c < p->count; c++)
    fprintf(at->out, "%c%.1f %.1f", c ? 'L' : 'M', fg_plot_x(at, real_a(s, p->point[c][0])),
            fg_plot_y(at, real_b(s, p->point[c][1])));
  if (p->count) fputc('z', at->out);
}

/* Draws the part of band n in a row of cells; whole neighbouring cells make one polygon. */
static void put_band_row(const fg_plot *at, const slice *s, int i, double low, double high) {
  for (int k = 0, from = -1; k <= GRID; k++) {
    double min = INFINITY, max = -INFINITY;
    for (int c = 0; k < GRID && c < 4; c++) {
      double value = s->value[i + (c > 1)][k + c % 2];
      min = fmin(min, value);
      max = fmax(max, value);
    }
    bool whole = k < GRID && min >= low && max <= high;
    if (whole && from < 0) from = k;
    if (!whole && from >= 0) {
      const polygon p = {{{from, i, 0}, {k, i, 0}, {k, i + 1, 0}, {from, i + 1, 0}}, 4};
      put_polygon(at, s, &p);
      from = -1;
    }
    if (k == GRID || whole || max < low || min > high) continue;
    polygon p = {{{k, i, s->value[i][k]},
                  {k + 1, i, s->value[i][k + 1]},
                  {k + 1, i + 1, s->value[i + 1][k + 1]},
                  {k, i + 1, s->value[i + 1][k]}},
                 4};
    cut(&p, low, 1);
    cut(&p, high, -1);
    put_polygon(at, s, &p);
  }
}

static void put_bands(const fg_plot *at, const slice *s) {
  int bands = 1;
  for (int i = 0; i <= GRID; i++)
    for (int k = 0; k <= GRID; k++)
      bands = (int)fmax(bands, fmin(BANDS_MAX, ceil((s->value[i][k] - s->first) / s->step)));
  for (int n = 0; n < bands; n++) {
    double share = (n + 0.5) / bands, low = s->first + n * s->step;
    int red = (int)(247 - 165 * share), green = (int)(250 - 110 * share),
        blue = (int)(253 - 45 * share);
    fprintf(at->out, "<path style=\"fill:rgb(%d,%d,%d);stroke:rgb(%d,%d,%d)\" d=\"", red, green,
            blue, red, green, blue);
    for (int i = 0; i < GRID; i++)
      put_band_row(at, s, i, low, low + s->step);
    fputs("\"/>\n", at->out);
  }
}

/* True when a point of the slice, in cells, is in the region. */
static bool is_inside(const slice *s, double k, double i) {
  double x[FG_SURFACE_FACTORS];
  memcpy(x, s->x, sizeof x);
  x[s->a] = value_along_factor(s->fa, k / GRID);
  x[s->b] = value_along_factor(s->fb, i / GRID);
  return fg_region_contains(&s->e->region, x, 1e-9);
}

/* Returns the point where the region's edge crosses the line from inside to outside, as a share
 * of the line, by bisection. */
static double edge_between(const slice *s, const double *in, const double *out) {
  double low = 0, high = 1;
  for (int step = 0; step < BISECTIONS; step++) {
    double middle = (low + high) / 2;
    if (is_inside(s, in[0] + middle * (out[0] - in[0]), in[1] + middle * (out[1] - in[1])))
      low = middle;
    else
      high = middle;
  }
  return (low + high) / 2;
}

/* The part of a cell that lies outside the region. Its edge within the cell goes into `edge`. */
static void put_outside_cell(const fg_plot *at, const slice *s, int i, int k, FILE *edge) {
  const double corner[4][3] = {{k, i}, {k + 1, i}, {k + 1, i + 1}, {k, i + 1}};
  polygon p = {.count = 0};
  int met = 0;
  for (int c = 0; c < 4; c++) {
    const double *a = corner[c], *b = corner[(c + 1) % 4];
    bool in_a = is_inside(s, a[0], a[1]), in_b = is_inside(s, b[0], b[1]);
    if (!in_a) add_point(&p, a, a, 0);
    if (in_a == in_b) continue;
    double share = in_a ? edge_between(s, a, b) : 1 - edge_between(s, b, a);
    add_point(&p, a, b, share);
    const double *met_at = p.point[p.count - 1];
    if (edge)
      fprintf(edge, "%c%.1f %.1f", met++ % 2 ? 'L' : 'M', fg_plot_x(at, real_a(s, met_at[0])),
              fg_plot_y(at, real_b(s, met_at[1])));
  }
  put_polygon(at, s, &p);
}

/* Pale outside the region of the data and the constraints, and the region's edge. */
static void put_outside(const fg_plot *at, const slice *s) {
  char *text = NULL;
  size_t size;
  FILE *edge = fg_stream_open(&text, &size);
  fputs("<path class=\"outside\" d=\"M0 0", at->out);
  for (int i = 0; i < GRID; i++)
    for (int k = 0; k < GRID; k++)
      put_outside_cell(at, s, i, k, edge);
  fputs("\"/>\n", at->out);
  if (fg_stream_keep(edge, &text) && *text)
    fprintf(at->out, "<path class=\"edge\" d=\"%s\"/>\n", text);
  free(text);
}

/* Draws the level in a cell: it crosses the sides at two points, or at four at a saddle (paired
 * as met). */
static void put_contour_cell(const fg_plot *at, const slice *s, int i, int k, double level) {
  const double corner[4][3] = {{k, i, s->value[i][k]},
                               {k + 1, i, s->value[i][k + 1]},
                               {k + 1, i + 1, s->value[i + 1][k + 1]},
                               {k, i + 1, s->value[i + 1][k]}};
  int met = 0;
  for (int c = 0; c < 4; c++) {
    const double *from = corner[c], *to = corner[(c + 1) % 4];
    if ((from[2] < level) == (to[2] < level)) continue;
    double share = (level - from[2]) / (to[2] - from[2]);
    fprintf(at->out, "%c%.1f %.1f", met++ % 2 ? 'L' : 'M',
            fg_plot_x(at, real_a(s, from[0] + share * (to[0] - from[0]))),
            fg_plot_y(at, real_b(s, from[1] + share * (to[1] - from[1]))));
  }
}

/* True when words at this place cover no others, no run, not the best setting, nor the rim. */
static bool is_free(const fg_plot *at, const places *taken, double x, double y) {
  if (x < at->left + LABEL_WIDE / 2 || x > at->right - LABEL_WIDE / 2 || y < at->top + LABEL_HIGH ||
      y > at->bottom - LABEL_HIGH / 2)
    return false;
  for (size_t n = 0; n < taken->count; n++)
    if (fabs(taken->x[n] - x) < taken->wide[n] && fabs(taken->y[n] - y) < LABEL_HIGH) return false;
  return true;
}

static void occupy_place(places *taken, double x, double y, double wide) {
  if (taken->count == PLACES_MAX) return;
  taken->x[taken->count] = x;
  taken->y[taken->count] = y;
  taken->wide[taken->count++] = wide;
}

/* Writes the label of a level on its line, at the first free place; a line without one gets no
 * label. */
static void put_label(const fg_plot *at, const slice *s, double level, places *taken) {
  for (int n = 0; n < 4 * GRID; n++) /* from the middle diagonal outwards; first in the region */
    for (int i = 2; i < GRID - 2; i++) {
      int slant = n % (2 * GRID), k = GRID - i + (slant % 2 ? slant / 2 : -slant / 2);
      if (k < 2 || k > GRID - 2 || (n < 2 * GRID && !is_inside(s, k, i))) continue;
      double here = s->value[i][k], next = s->value[i + 1][k - 1];
      if ((here < level) == (next < level)) continue;
      double x = fg_plot_x(at, real_a(s, k - 0.5)), y = fg_plot_y(at, real_b(s, i + 0.5));
      if (!is_free(at, taken, x, y)) continue;
      occupy_place(taken, x, y, LABEL_WIDE);
      fprintf(at->out, "<text class=\"x level\" x=\"%.1f\" y=\"%.1f\">%.4g</text>\n", x, y + 4,
              level);
      return;
    }
}

static void put_lines(const fg_plot *at, const slice *s, places *taken) {
  for (int n = 1; n < BANDS_MAX; n++) {
    double level = s->first + n * s->step;
    if (fabs(level) < s->step * 1e-9) level = 0;
    fputs("<path class=\"contour\" d=\"M0 0", at->out);
    for (int i = 0; i < GRID; i++)
      for (int k = 0; k < GRID; k++)
        put_contour_cell(at, s, i, k, level);
    fputs("\"/>\n", at->out);
    put_label(at, s, level, taken);
  }
}

/* Adds the places that words must leave free. */
static void occupy_runs(const fg_plot *at, const slice *s, places *taken) {
  const fg_experiment *e = s->e;
  size_t variables = e->model.formula.variables;
  for (size_t i = 0; i < e->regression.rows; i++)
    occupy_place(taken,
                 fg_plot_x(at, fg_factor_real(s->fa, e->setting[i * variables + s->fa->variable])),
                 fg_plot_y(at, fg_factor_real(s->fb, e->setting[i * variables + s->fb->variable])),
                 LABEL_WIDE / 2 + 8);
  occupy_place(taken, fg_plot_x(at, fg_factor_real(s->fa, best_of(e)->x[s->a])),
               fg_plot_y(at, fg_factor_real(s->fb, best_of(e)->x[s->b])), LABEL_WIDE / 2 + 10);
}

static void put_run_marks(const fg_plot *at, const slice *s) {
  const fg_experiment *e = s->e;
  size_t variables = e->model.formula.variables, step = e->regression.rows / POINTS_SHOWN + 1;
  for (size_t i = 0; i < e->regression.rows; i += step)
    fg_axes_dot(at, "run", fg_factor_real(s->fa, e->setting[i * variables + s->fa->variable]),
                fg_factor_real(s->fb, e->setting[i * variables + s->fb->variable]), 5);
  fg_plot_shape(at, fg_factor_real(s->fa, best_of(e)->x[s->a]),
                fg_factor_real(s->fb, best_of(e)->x[s->b]), 8, FG_SHAPE_DIAMOND, "best");
}

static void put_contour(FILE *out, const fg_experiment *e, size_t a, size_t b) {
  static const size_t title_size = 600;
  slice s = {.e = e, .a = a, .b = b};
  char title[600], name_a[300], name_b[300];
  s.fa = fg_surface_factor(e, a);
  s.fb = fg_surface_factor(e, b);
  memcpy(s.x, best_of(e)->x, sizeof s.x);
  sample(&s);
  memcpy(s.x, best_of(e)->x, sizeof s.x);
  double x[2] = {real_a(&s, 0), real_a(&s, GRID)}, y[2] = {real_b(&s, 0), real_b(&s, GRID)};
  fg_name_words(s.fa->name, name_a, sizeof name_a);
  fg_name_words(s.fb->name, name_b, sizeof name_b);
  snprintf(title, title_size, "%.250s and %.250s", name_a, name_b);
  fg_axis_words(s.fa->name, name_a, sizeof name_a);
  fg_axis_words(s.fb->name, name_b, sizeof name_b);
  fg_plot at = fg_axes_begin(
      out, &(fg_plot_frame){title, .x = x, .y = y, .y_title = name_b, .x_title = name_a});
  places taken = {.count = 0};
  occupy_runs(&at, &s, &taken);
  put_bands(&at, &s);
  put_outside(&at, &s);
  put_lines(&at, &s, &taken);
  put_run_marks(&at, &s);
  fg_axes_end(&at);
}

void fg_doe_plot_contours(FILE *out, const fg_experiment *e) {
  size_t shown = 0;
  if (!e->best.found) return;
  for (size_t a = 0; a < e->surface.factors; a++)
    for (size_t b = a + 1; b < e->surface.factors && shown < CONTOURS_SHOWN; b++, shown++)
      put_contour(out, e, a, b);
}
