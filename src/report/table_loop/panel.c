/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plot of the loop's page as SVG. */
#include "report/table_loop/panel.h"

#include <math.h>

#include "core/text.h"
#include "page/page.h"
#include "page/plot_frame.h"

enum { LEFT = 84, RIGHT = 510, BOTTOM = 250, WIDTH = 520, HEIGHT = 296 };

static double nice_step(double range) {
  double step = pow(10, floor(log10(range / 5)));
  return range / step > 25   ? 5 * step
         : range / step > 12 ? 2.5 * step
         : range / step > 10 ? 2 * step
                             : step;
}

/* Counts the multiples of a step in a range. A step that vanishes beside its ends (10^17 and a
 * range of 100) would make the loop endless. */
static size_t tick_count(double low, double high, double step) {
  double count = floor(high / step) - ceil(low / step) + 1;
  return count >= 1 && count <= 40 ? (size_t)count : 0;
}

/* Writes as many names as there is room for, each cut to its room. */
static void put_level_names(const fg_plot *at, const fg_loop_coordinate *coordinate) {
  enum { ROOM = 62 };
  size_t every = coordinate->levels / (ROOM / 8 + 1) + 1;
  size_t max = every > 1 ? 8 : ROOM / coordinate->levels;
  for (size_t k = 0; k < coordinate->levels; k += every) {
    char name[FG_LOOP_NAME];
    fg_text_clip(name, max + 1 < sizeof name ? max + 1 : sizeof name, "%s",
                 coordinate->level_name[k]);
    fprintf(at->out, "<text class=\"x\" x=\"%.1f\" y=\"%d\">", fg_plot_x(at, (double)k),
            BOTTOM + 18);
    fg_html_text(at->out, name);
    fputs("</text>\n", at->out);
  }
}

static void put_axes(const fg_plot *at, const fg_loop_coordinate *coordinate, const char *title) {
  double step = nice_step(at->y_high - at->y_low);
  size_t ticks = tick_count(at->y_low, at->y_high, step);
  for (size_t i = 0; i < ticks; i++) {
    double y = (ceil(at->y_low / step) + (double)i) * step;
    fprintf(at->out,
            "<path class=\"%s\" d=\"M%d %.1fH%d\"/><text class=\"y\" x=\"%d\" y=\"%.1f\">%.4g"
            "</text>\n",
            fabs(y) < step / 1e6 ? "zero" : "grid", LEFT, fg_plot_y(at, y), RIGHT, LEFT - 6,
            fg_plot_y(at, y) + 4, fabs(y) < step / 1e6 ? 0 : y);
  }
  if (coordinate->levels) {
    put_level_names(at, coordinate);
  } else {
    step = nice_step(at->x_high - at->x_low);
    ticks = tick_count(at->x_low, at->x_high, step);
    for (size_t i = 0; i < ticks; i++) {
      double x = (ceil(at->x_low / step) + (double)i) * step;
      fprintf(at->out, "<text class=\"x\" x=\"%.1f\" y=\"%d\">%.4g</text>\n", fg_plot_x(at, x),
              BOTTOM + 18, x);
    }
  }
  fprintf(at->out, "<text class=\"t\" x=\"%d\" y=\"%d\">", (LEFT + RIGHT) / 2, HEIGHT - 8);
  fg_html_text(at->out, coordinate->name);
  fputs("</text>\n<text class=\"t\" transform=\"translate(13 132) rotate(-90)\">", at->out);
  fg_html_text(at->out, title);
  fputs("</text>\n", at->out);
}

/* Maximum number of points: more would only blacken the page. */
enum { POINTS_MAX = 4000 };

static double clip(const fg_plot *at, double y) {
  return fg_plot_y(at, fg_plot_inside(at, y));
}

/* Levels are spread a little, so that rows do not hide each other. */
static double abscissa_of_row(const fg_loop_coordinate *at, size_t row) {
  return at->value[row] + (at->levels ? 0.16 * sin(12.9898 * (double)row) : 0);
}

static void put_points(const fg_plot *at, const fg_loop_problem *problem,
                       const fg_loop_panel *panel) {
  size_t stride = problem->rows / POINTS_MAX + 1;
  for (int held = 0; held < 2; held++)
    for (size_t i = 0; i < problem->rows; i += stride) {
      if ((problem->held_out && problem->held_out[i]) != held || !isfinite(panel->at->value[i]))
        continue;
      fprintf(at->out, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/>\n",
              held ? "held" : "fit", fg_plot_x(at, abscissa_of_row(panel->at, i)),
              clip(at, panel->residual[i]),
              problem->rows > 400   ? 1.6
              : problem->rows > 100 ? 2.4
                                    : 3.4);
    }
}

/* The rows of a series, joined. */
static void put_joined(const fg_plot *at, const fg_loop_problem *problem,
                       const fg_loop_panel *panel) {
  if (problem->rows > POINTS_MAX) return;
  fputs("<path class=\"joined\" d=\"", at->out);
  for (size_t i = 0; i < problem->rows; i++)
    fprintf(at->out, "%s%.1f %.1f", i && problem->series[i] == problem->series[i - 1] ? "L" : "M",
            fg_plot_x(at, panel->at->value[i]), clip(at, panel->residual[i]));
  fputs("\"/>\n", at->out);
}

static void put_marked(const fg_plot *at, const fg_loop_report *report,
                       const fg_loop_panel *panel) {
  const fg_loop_candidate *marked = panel->marked;
  size_t count = marked->effect->outlier == FG_LOOP_EXCHANGED_ROWS ? 2 : marked->rows;
  for (size_t k = 0; k < count; k++) {
    size_t i = marked->row[k], row = report->problem->row[i];
    double x = fg_plot_x(at, abscissa_of_row(panel->at, i)), y = clip(at, panel->residual[i]);
    bool right = x < (LEFT + RIGHT) / 2.0;
    fprintf(at->out,
            "<circle class=\"mark\" cx=\"%.1f\" cy=\"%.1f\" r=\"5\"/><text class=\"%s\" x=\"%.1f\" "
            "y=\"%.1f\">",
            x, y, right ? "l" : "y", x + (right ? 9 : -9), y + 4);
    if (report->row_name)
      fg_html_text(at->out, report->row_name[row]);
    else
      fprintf(at->out, "row %zu", row + 1);
    fputs("</text>\n", at->out);
  }
}

/* Half of a dash or bar, in pixels: levels must not touch. */
static double half_dash(const fg_loop_panel *panel) {
  return fmin(28, fmax(1.5, 0.36 * (RIGHT - LEFT) / (double)(panel->points ? panel->points : 1)));
}

static void put_band(const fg_plot *at, const fg_loop_panel *panel) {
  double half = half_dash(panel);
  if (panel->dashes) {
    for (size_t i = 0; i < panel->points; i++) {
      double top = clip(at, panel->line[i].y), bottom = clip(at, -panel->line[i].y);
      fprintf(at->out, "<path class=\"band\" d=\"M%.1f %.1fh%.1fV%.1fh%.1fz\"/>\n",
              fg_plot_x(at, panel->line[i].x) - half, top, 2 * half, bottom, -2 * half);
    }
    return;
  }
  fputs("<path class=\"band\" d=\"", at->out);
  for (size_t i = 0; i < panel->points; i++)
    fprintf(at->out, "%s%.1f %.1f", i ? "L" : "M", fg_plot_x(at, panel->line[i].x),
            clip(at, panel->line[i].y));
  for (size_t i = panel->points; i-- > 0;)
    fprintf(at->out, "L%.1f %.1f", fg_plot_x(at, panel->line[i].x), clip(at, -panel->line[i].y));
  fputs("z\"/>\n", at->out);
}

static void put_panel_line(const fg_plot *at, const fg_loop_panel *panel) {
  double half = half_dash(panel);
  if (!panel->points) return;
  fputs("<path class=\"effect\" d=\"", at->out);
  for (size_t i = 0; i < panel->points; i++) {
    double x = fg_plot_x(at, panel->line[i].x), y = clip(at, panel->line[i].y);
    if (panel->dashes)
      fprintf(at->out, "M%.1f %.1fh%.1f", x - half, y, 2 * half);
    else
      fprintf(at->out, "%s%.1f %.1f", i ? "L" : "M", x, y);
  }
  fputs("\"/>\n", at->out);
}

fg_status fg_loop_panel_put(fg_context *ctx, FILE *out, const fg_loop_report *report,
                            const fg_loop_panel *panel) {
  const fg_loop_problem *problem = &report->problem->problem;
  const fg_loop_coordinate *x = panel->at;
  double margin = x->levels ? 0.5 : 0.03 * (x->high - x->low);
  double ends[2] = {x->low - margin, x->high + margin};
  (void)ctx;
  if (!(ends[1] > ends[0])) return FG_OK;
  fputs("<figure>", out);
  fg_plot at = fg_plot_open(out, &(fg_plot_frame){panel->caption, .width = WIDTH, .height = HEIGHT,
                                                  .left = LEFT, .right = WIDTH - RIGHT,
                                                  .bottom = HEIGHT - BOTTOM, .x = ends,

                                                  .y = (double[]){panel->middle - panel->limit,
                                                                  panel->middle + panel->limit}});
  put_axes(&at, x, report->spec->response);
  if (panel->band) put_band(&at, panel);
  if (panel->joined) put_joined(&at, problem, panel);
  put_points(&at, problem, panel);
  if (!panel->band) put_panel_line(&at, panel);
  if (panel->marked) put_marked(&at, report, panel);
  fprintf(out, "</svg><figcaption>%s</figcaption></figure>\n", panel->caption);
  return FG_OK;
}
