/* The surface over two factors as bands, lines and the runs. */
#include <math.h>
#include <string.h>

#include "report/doe/doe_axes.h"
#include "report/doe/doe_plots.h"
#include "report/doe/doe_words.h"

enum { GRID = 64, CONTOURS_SHOWN = 3, BANDS_MAX = 40, POINTS_SHOWN = 1000 };

/* Node values of a slice of the surface through the optimum. */
typedef struct slice {
  const fg_experiment *e;
  size_t a, b; /* axes of the surface */
  const fg_factor *fa, *fb;
  double x[FG_SURFACE_FACTORS];
  double value[GRID + 1][GRID + 1]; /* [along b][along a] */
  double step, first;               /* of the contour levels */
} slice;

static double along(const fg_factor *f, double share) {
  return f->lowest + (f->highest - f->lowest) * share;
}

static void sample(slice *s) {
  double range[2] = {INFINITY, -INFINITY};
  for (int i = 0; i <= GRID; i++)
    for (int k = 0; k <= GRID; k++) {
      s->x[s->a] = along(s->fa, (double)k / GRID);
      s->x[s->b] = along(s->fb, (double)i / GRID);
      s->value[i][k] = fg_surface_value(&s->e->surface, s->x);
      fg_range_add(range, s->value[i][k]);
    }
  s->step = range[1] > range[0] ? fg_plot_nice_step((range[1] - range[0]) / 2) : 1;
  s->first = floor(range[0] / s->step) * s->step;
}

static int band_of(const slice *s, int i, int k) {
  double middle =
      (s->value[i][k] + s->value[i + 1][k] + s->value[i][k + 1] + s->value[i + 1][k + 1]) / 4;
  return (int)fmin(BANDS_MAX, floor((middle - s->first) / s->step));
}

static bool is_inside(const slice *s, int i, int k) {
  double x[FG_SURFACE_FACTORS];
  memcpy(x, s->x, sizeof x);
  x[s->a] = along(s->fa, (k + 0.5) / GRID);
  x[s->b] = along(s->fb, (i + 0.5) / GRID);
  return fg_region_contains(&s->e->region, x, 1e-9);
}

static double real_a(const slice *s, double k) {
  return fg_factor_real(s->fa, along(s->fa, k / GRID));
}

static double real_b(const slice *s, double i) {
  return fg_factor_real(s->fb, along(s->fb, i / GRID));
}

/* One rectangle per run of cells of one colour: from pale to blue; washed out outside the region.
 */
static void put_bands(const fg_plot *at, const slice *s) {
  int bands = 1;
  for (int i = 0; i < GRID; i++)
    for (int k = 0; k < GRID; k++)
      bands = band_of(s, i, k) + 1 > bands ? band_of(s, i, k) + 1 : bands;
  for (int i = 0; i < GRID; i++)
    for (int start = 0, end = 0; start < GRID; start = end) {
      int band = band_of(s, i, start);
      bool inside = is_inside(s, i, start);
      for (end = start; end < GRID && band_of(s, i, end) == band && is_inside(s, i, end) == inside;)
        end++;
      double share = (band + 0.5) / bands;
      double x0 = fg_plot_x(at, real_a(s, start)), x1 = fg_plot_x(at, real_a(s, end));
      double y0 = fg_plot_y(at, real_b(s, i)), y1 = fg_plot_y(at, real_b(s, i + 1));
      fprintf(at->out,
              "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" "
              "fill=\"rgb(%d,%d,%d)\"%s/>\n",
              x0, y1, x1 - x0 + 0.4, y0 - y1 + 0.4, (int)(247 - 165 * share),
              (int)(250 - 110 * share), (int)(253 - 45 * share),
              inside ? "" : " fill-opacity=\"0.3\"");
    }
}

/* Where the level crosses the sides of a cell: two points, or four at a saddle (paired as met). */
static void put_cell(const fg_plot *at, const slice *s, int i, int k, double level) {
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

/* The label stands where the level crosses a slanting line through the plot, away from the rim. */
static void put_label(const fg_plot *at, const slice *s, double level) {
  for (int i = 4; i < GRID - 4; i++) {
    int k = GRID - i;
    double here = s->value[i][k], next = s->value[i + 1][k - 1];
    if ((here < level) == (next < level)) continue;
    fprintf(at->out, "<text class=\"x level\" x=\"%.1f\" y=\"%.1f\">%.4g</text>\n",
            fg_plot_x(at, real_a(s, k)), fg_plot_y(at, real_b(s, i)) + 4, level);
    return;
  }
}

static void put_lines(const fg_plot *at, const slice *s) {
  for (int n = 1; n < BANDS_MAX; n++) {
    double level = s->first + n * s->step;
    if (fabs(level) < s->step * 1e-9) level = 0;
    fputs("<path class=\"contour\" d=\"M0 0", at->out);
    for (int i = 0; i < GRID; i++)
      for (int k = 0; k < GRID; k++)
        put_cell(at, s, i, k, level);
    fputs("\"/>\n", at->out);
    put_label(at, s, level);
  }
}

static void put_runs(const fg_plot *at, const slice *s) {
  const fg_experiment *e = s->e;
  size_t variables = e->model.formula.variables, step = e->regression.rows / POINTS_SHOWN + 1;
  for (size_t i = 0; i < e->regression.rows; i += step)
    fg_axes_dot(at, "run", fg_factor_real(s->fa, e->setting[i * variables + s->fa->variable]),
                fg_factor_real(s->fb, e->setting[i * variables + s->fb->variable]), 5);
  fg_axes_dot(at, "best", fg_factor_real(s->fa, e->optimum.x[s->a]),
              fg_factor_real(s->fb, e->optimum.x[s->b]), 6);
}

static void put_contour(FILE *out, const fg_experiment *e, size_t a, size_t b) {
  static const size_t title_size = 600;
  slice s = {.e = e, .a = a, .b = b};
  char title[600];
  s.fa = fg_surface_factor(e, a);
  s.fb = fg_surface_factor(e, b);
  memcpy(s.x, e->optimum.x, sizeof s.x);
  sample(&s);
  memcpy(s.x, e->optimum.x, sizeof s.x);
  double x[2] = {real_a(&s, 0), real_a(&s, GRID)}, y[2] = {real_b(&s, 0), real_b(&s, GRID)};
  snprintf(title, title_size, "%.250s and %.250s", s.fa->name, s.fb->name);
  fg_plot at = fg_axes_begin(out, title, x, y);
  fg_plot_y_axis(&at, s.fb->name);
  fg_plot_x_numbers(&at);
  fg_plot_x_title(&at, s.fa->name);
  put_bands(&at, &s);
  put_lines(&at, &s);
  put_runs(&at, &s);
  fg_axes_end(&at);
}

void fg_doe_plot_contours(FILE *out, const fg_experiment *e) {
  size_t shown = 0;
  if (!e->has_optimum) return;
  for (size_t a = 0; a < e->surface.factors; a++)
    for (size_t b = a + 1; b < e->surface.factors && shown < CONTOURS_SHOWN; b++, shown++)
      put_contour(out, e, a, b);
}
