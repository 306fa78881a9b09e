/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures over lots: superimposed densities, and a quantity over the lots. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/text.h"
#include "lots/index.h"
#include "page/page.h"
#include "page/plot_frame.h"

enum {
  CURVE_POINTS = 300,
  LINES_MAX = 8,    /* beyond this most curves are grey: more cannot be told apart */
  MARKED = 4,       /* number of coloured curves then */
  NAMES_MAX = 6,    /* lots whose names fit under an axis */
  DATES_MAX = 10,   /* lots whose dates fit */
  NUMBERS_MAX = 40, /* lots whose numbers fit; else every second, third .. */
  LABEL_LETTERS = 26,
  AXIS_LETTERS = 18,
};

/* Okabe and Ito's colours, told apart by the colour-blind; dashes tell them apart in black and
 * white too. Yellow is left out, which white paper swallows. */
static const struct {
  const char *colour, *dash;
} looks[LINES_MAX] = {
    {"#0072b2", ""},        {"#d55e00", "9 4"},  {"#00795a", "3 3"}, {"#aa4499", "12 3 3 3"},
    {"#16202a", "6 2 2 2"}, {"#2b8cbe", "14 5"}, {"#a86400", "2 4"}, {"#5b6875", "5 5"},
};

/* Curve of a lot or a die. */
typedef struct curve {
  const fg_index_spread *spread;
  const char *name;
  size_t number; /* on the page; 0: none */
  int look;      /* index into looks; -1: grey */
  double x, y;   /* of its label, px */
} curve;

static double find_peak(const curve *c) {
  return fg_density_at(&c->spread->density, c->spread->mode);
}

static void put_density_curve(const fg_plot *plot, const curve *c) {
  double step = (plot->x_high - plot->x_low) / CURVE_POINTS;
  if (c->look < 0)
    fputs("<path stroke=\"#b4bdc6\" stroke-width=\"1\" d=\"", plot->out);
  else
    fprintf(plot->out,
            "<path stroke=\"%s\" stroke-width=\"2.5\" stroke-linejoin=\"round\" "
            "stroke-dasharray=\"%s\" d=\"",
            looks[c->look].colour, looks[c->look].dash);
  for (int i = 0; i <= CURVE_POINTS; i++) {
    double x = plot->x_low + i * step;
    fprintf(plot->out, "%c%.1f %.1f", i ? 'L' : 'M', fg_plot_x(plot, x),
            fg_plot_y(plot, fg_density_at(&c->spread->density, x)));
  }
  fputs("\"/>\n", plot->out);
}

/* Puts the number at the top of a curve, beside the numbers that are there. */
static void put_curve_number(const fg_plot *plot, curve *curves, size_t i) {
  enum { WIDE = 22, HIGH = 15 };
  curve *c = &curves[i];
  c->x = fg_plot_x(plot, c->spread->mode);
  c->y = fg_plot_y(plot, find_peak(c)) - 7;
  for (size_t k = 0; k < i; k++)
    if (curves[k].look >= 0 && fabs(curves[k].x - c->x) < WIDE && fabs(curves[k].y - c->y) < HIGH) {
      c->x = curves[k].x + WIDE;
      k = (size_t)-1; /* restarts: the new place may be occupied, too */
    }
  fprintf(plot->out,
          "<text x=\"%.1f\" y=\"%.1f\" style=\"fill:%s;text-anchor:middle;font-weight:650\">", c->x,
          c->y, looks[c->look].colour);
  if (c->number)
    fprintf(plot->out, "%zu", c->number);
  else
    fg_html_text(plot->out, c->name);
  fputs("</text>\n", plot->out);
}

/* Puts line, number and name at the right. */
static void put_curve_legend(const fg_plot *plot, const curve *c, size_t row) {
  char name[4 * LABEL_LETTERS + 4];
  double y = plot->top + 14 + 22 * (double)row;
  fprintf(plot->out,
          "<path stroke=\"%s\" stroke-width=\"2.5\" stroke-dasharray=\"%s\" d=\"M%.0f %.1fH%.0f\"/>"
          "<text x=\"%.0f\" y=\"%.1f\">",
          looks[c->look].colour, looks[c->look].dash, plot->right + 16, y - 5, plot->right + 52,
          plot->right + 60, y);
  if (c->number) fprintf(plot->out, "%zu  ", c->number);
  fg_index_clip_name(c->name, LABEL_LETTERS, name, sizeof name);
  fg_html_text(plot->out, name);
  fputs("</text>\n", plot->out);
}

/* Chooses the curves to colour among many: the last, then in turns the lowest and the highest mean.
 */
static void choose_looks(curve *curves, size_t count) {
  size_t given = 0;
  for (size_t i = 0; i < count; i++)
    curves[i].look = count <= LINES_MAX ? (int)i : -1;
  if (count <= LINES_MAX) return;
  curves[count - 1].look = (int)given++;
  for (; given < MARKED; given++) {
    size_t best = count;
    double sign = given % 2 ? 1 : -1;
    for (size_t i = 0; i < count; i++)
      if (curves[i].look < 0 &&
          (best == count || sign * curves[i].spread->mean > sign * curves[best].spread->mean))
        best = i;
    curves[best].look = (int)given;
  }
}

static void plot_curves(FILE *out, curve *curves, size_t count, const char *label) {
  double x[2] = {INFINITY, -INFINITY}, y[2] = {0, 0};
  for (size_t i = 0; i < count; i++) {
    double reach = 2.5 * curves[i].spread->density.bandwidth;
    fg_range_add(x, curves[i].spread->min, reach);
    fg_range_add(x, curves[i].spread->max, reach);
    fg_range_add(y, 1.1 * find_peak(&curves[i]), 0);
  }
  choose_looks(curves, count);
  fg_plot plot = fg_plot_frame_begin(
      out, &(fg_plot_frame){label, .height = 384, .left = 70, .right = 260, .top = 26, .bottom = 54,
                            .x = x, .y = y, .y_title = "density",
                            .x_title = "bump radius over design, R / R_D"});
  if (plot.x_low < 1 && plot.x_high > 1) {
    fg_plot_segment(&plot, 1, 0, 1, plot.y_high, "hypothesis");
    fg_plot_text(&plot, 1, plot.y_high * 1.01, "key", "design");
  }
  size_t row = 0;
  for (int pass = 0; pass < 3; pass++)
    for (size_t i = 0; i < count; i++) {
      if ((curves[i].look >= 0) != (pass > 0)) continue;
      if (pass < 2) put_density_curve(&plot, &curves[i]);
      if (pass == 2) {
        put_curve_number(&plot, curves, i);
        put_curve_legend(&plot, &curves[i], row++);
      }
    }
  if (count > LINES_MAX) {
    char text[40];
    snprintf(text, sizeof text, "grey: %zu more", count - MARKED);
    fprintf(out, "<text class=\"soft\" x=\"%.0f\" y=\"%.1f\">%s</text>\n", plot.right + 60,
            plot.top + 14 + 22 * (double)row, text);
  }
  fg_plot_end(&plot);
}

void fg_index_plot_lots(FILE *out, const fg_index *index) {
  size_t count = 0;
  curve *curves = calloc(index->read + 1, sizeof *curves);
  for (size_t i = 0; curves && i < index->read; i++)
    if (index->lots[i].spread.has_density)
      curves[count++] =
          (curve){.spread = &index->lots[i].spread, .name = index->lots[i].name, .number = i + 1};
  if (count) plot_curves(out, curves, count, "Densities of the bump radius over the design's");
  free(curves);
}

void fg_index_plot_dies(FILE *out, const fg_index *index) {
  size_t count = 0;
  curve *curves = calloc(index->die_count + 1, sizeof *curves);
  for (size_t i = 0; curves && i < index->die_count; i++)
    if (index->dies[i].spread.has_density)
      curves[count++] = (curve){.spread = &index->dies[i].spread, .name = index->dies[i].name};
  if (count) plot_curves(out, curves, count, "Densities of the bump radius by die");
  free(curves);
}

/* Includes values and limits wholly, and expected intervals as far as 0.3 of that span at each
 * side: few lots expect almost anything. */
static bool find_axis_range(const fg_index *index, const fg_index_axis *axis, double range[2]) {
  for (size_t i = 0; i < index->read; i++) {
    const fg_index_stat *stat = fg_index_stat_of(axis, &index->lots[i]);
    if (!stat || !stat->count) continue;
    fg_range_add(range, stat->mean, stat->sd);
    fg_range_add(range, stat->lower, 0);
    fg_range_add(range, stat->upper, 0);
  }
  if (!(range[1] >= range[0])) return false;
  double span = range[1] - range[0], first = range[0] - 0.3 * span, last = range[1] + 0.3 * span;
  for (size_t i = 0; i < index->read; i++) {
    const fg_index_stat *stat = fg_index_stat_of(axis, &index->lots[i]);
    if (!stat) continue;
    fg_range_add(range, fmax(first, stat->expected_low), 0);
    fg_range_add(range, fmin(last, stat->expected_high), 0);
  }
  fg_range_pad_by_size(range, 0.07);
  return true;
}

/* Puts the expected interval; edges outside the picture are not drawn. */
static void put_expected_band(const fg_plot *plot, double x, const fg_index_stat *stat) {
  if (!isfinite(stat->expected_low)) return;
  const double edges[2] = {stat->expected_low, stat->expected_high};
  double top = fmin(edges[1], plot->y_high), foot = fmax(edges[0], plot->y_low);
  if (!(top > foot)) return;
  double left = fg_plot_x(plot, x - 0.5), width = fg_plot_x(plot, x + 0.5) - left;
  fprintf(plot->out,
          "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"#eff2f5\"/>\n", left,
          fg_plot_y(plot, top), width, fg_plot_y(plot, foot) - fg_plot_y(plot, top));
  for (int i = 0; i < 2; i++)
    if (edges[i] > plot->y_low && edges[i] < plot->y_high)
      fg_plot_segment(plot, x - 0.5, edges[i], x + 0.5, edges[i], "thin");
}

static void put_lot_limits(const fg_plot *plot, double x, const fg_index_stat *stat) {
  const double limits[2] = {stat->lower, stat->upper};
  for (int i = 0; i < 2; i++)
    if (isfinite(limits[i])) fg_plot_segment(plot, x - 0.5, limits[i], x + 0.5, limits[i], "limit");
}

static void put_lot_mean(const fg_plot *plot, double x, const fg_index_stat *stat, bool few) {
  double size = few ? 6 : 4;
  if (!stat->count) return;
  if (isfinite(stat->sd))
    fg_plot_segment(plot, x, stat->mean - stat->sd, x, stat->mean + stat->sd, "s2");
  if (stat->unexpected)
    fprintf(plot->out,
            "<rect class=\"signal\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n",
            fg_plot_x(plot, x) - size, fg_plot_y(plot, stat->mean) - size, 2 * size, 2 * size);
  else
    fg_plot_dot(plot, x, stat->mean, size, "run");
}

static void put_lot_label(const fg_plot *plot, const fg_index *index, size_t i) {
  size_t every = index->read / NUMBERS_MAX + 1;
  char text[4 * AXIS_LETTERS + 32], name[4 * AXIS_LETTERS + 4];
  double x = fg_plot_x(plot, (double)i + 1);
  if (i % every) return;
  fg_index_clip_name(index->lots[i].name, AXIS_LETTERS, name, sizeof name);
  if (index->read <= NAMES_MAX)
    snprintf(text, sizeof text, "%zu  %s", i + 1, name);
  else
    snprintf(text, sizeof text, "%zu", i + 1);
  fg_plot_x_label(plot, x, text);
  if (index->read > DATES_MAX) return;
  fprintf(plot->out,
          "<text class=\"x soft\" style=\"font-size:12px\" x=\"%.1f\" y=\"%.1f\">%.10s</text>\n", x,
          plot->bottom + 37, index->lots[i].date.from ? index->lots[i].date.first : "no date");
}

void fg_index_plot_axis(FILE *out, const fg_index *index, const fg_index_axis *axis) {
  double range[2] = {INFINITY, -INFINITY};
  char title[96];
  const char *unit = fg_index_unit(axis);
  if (!find_axis_range(index, axis, range)) return;
  fg_text_clip(title, sizeof title, "%s%s%s%s", axis->row->symbol,
               axis->scale == FG_INDEX_OVER_DESIGN ? " over design" : "", *unit ? ", " : "", unit);
  int room = index->read > DATES_MAX ? 28 : 44;
  fg_plot plot = fg_plot_open(out, &(fg_plot_frame){axis->row->words, .height = 210 + room, .left = 92, .bottom = room, .x = (double[]){0.5, (double)index->read + 0.5}, .y = range, .y_title = title, .ticks = FG_TICKS_OWN});
  for (size_t i = 0; i < index->read; i++) {
    const fg_index_stat *stat = fg_index_stat_of(axis, &index->lots[i]);
    if (stat) put_expected_band(&plot, (double)i + 1, stat);
  }
  fg_plot_axes(&plot);
  for (size_t i = 0; i < index->read; i++) {
    const fg_index_stat *stat = fg_index_stat_of(axis, &index->lots[i]);
    put_lot_label(&plot, index, i);
    if (!stat) continue;
    put_lot_limits(&plot, (double)i + 1, stat);
    put_lot_mean(&plot, (double)i + 1, stat, index->read <= NUMBERS_MAX);
  }
  fg_plot_end(&plot);
}
