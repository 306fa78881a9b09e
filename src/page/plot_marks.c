/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "page/plot_marks.h"

#include <math.h>
#include <stdbool.h>

#include "core/select.h"
#include "page/page.h"

void fg_plot_dot(const fg_plot *at, double x, double y, double radius, const char *style) {
  fprintf(at->out, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.3g\"/>\n", style,
          fg_plot_x(at, x), fg_plot_y(at, y), radius);
}

/* Outlines in units of the radius, about the centre. */
static const char *const outlines[FG_SHAPES] = {
    [FG_SHAPE_CIRCLE] = "M-1 0a1 1 0 1 0 2 0a1 1 0 1 0-2 0z",
    [FG_SHAPE_SQUARE] = "M-.9-.9h1.8v1.8h-1.8z",
    [FG_SHAPE_TRIANGLE] = "M0-1.15l1.1 1.95h-2.2z",
    [FG_SHAPE_DIAMOND] = "M0-1.25l1.1 1.25l-1.1 1.25l-1.1-1.25z",
    [FG_SHAPE_CROSS] = "M-1-1l2 2m0-2l-2 2",
};

void fg_plot_shape_at(FILE *out, double x, double y, double radius, fg_shape shape,
                      const char *style) {
  fprintf(out,
          "<path class=\"mark %s\" vector-effect=\"non-scaling-stroke\" "
          "transform=\"translate(%.1f %.1f) scale(%.3g)\" d=\"%s\"/>\n",
          style, x, y, radius, outlines[shape]);
}

void fg_plot_shape(const fg_plot *at, double x, double y, double radius, fg_shape shape,
                   const char *style) {
  if (isfinite(x) && isfinite(y))
    fg_plot_shape_at(at->out, fg_plot_x(at, x), fg_plot_y(at, y), radius, shape, style);
}

void fg_plot_line(const fg_plot *at, const double *x, const double *y, size_t count,
                  const char *style) {
  bool open = false;
  fprintf(at->out, "<path class=\"%s\" d=\"", style);
  for (size_t i = 0; i < count; i++) {
    bool known = isfinite(x[i]) && isfinite(y[i]);
    if (known)
      fprintf(at->out, "%c%.1f %.1f", open ? 'L' : 'M', fg_plot_x(at, x[i]), fg_plot_y(at, y[i]));
    open = known;
  }
  fputs("\"/>\n", at->out);
}

void fg_plot_segment(const fg_plot *at, double x1, double y1, double x2, double y2,
                     const char *style) {
  fg_plot_line(at, (const double[]){x1, x2}, (const double[]){y1, y2}, 2, style);
}

void fg_plot_level(const fg_plot *plot, double y, const char *style) {
  if (y > plot->y_low && y < plot->y_high)
    fg_plot_segment(plot, plot->x_low, y, plot->x_high, y, style);
}

void fg_plot_tolerance(const fg_plot *plot, const fg_tolerance *tolerance) {
  if (!tolerance) return;
  fg_plot_level(plot, tolerance->lower, "limit");
  fg_plot_level(plot, tolerance->upper, "limit");
}

void fg_plot_rect(const fg_plot *plot, const double x[2], const double y[2], const char *style) {
  double left = fg_plot_x(plot, x[0]), top = fg_plot_y(plot, y[1]);
  fprintf(plot->out, "<rect class=\"%s\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n",
          style, left, top, fg_plot_x(plot, x[1]) - left, fg_plot_y(plot, y[0]) - top);
}

void fg_plot_band(const fg_plot *plot, double low, double high, const char *style) {
  fg_plot_rect(plot, (double[]){plot->x_low, plot->x_high}, (double[]){low, high}, style);
}

void fg_plot_bump_band(const fg_plot *plot, double from, double to, int number) {
  double left = fg_plot_x(plot, from), right = fg_plot_x(plot, to);
  fprintf(plot->out,
          "<rect class=\"band\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>"
          "<text class=\"x bump\" x=\"%.1f\" y=\"%.1f\">%d</text>\n",
          left, plot->top, right - left, plot->bottom - plot->top, (left + right) / 2,
          plot->top - 6, number);
}

void fg_plot_ribbon(const fg_plot *plot, const double *x, const double *low, const double *high,
                    size_t count, const char *style, const char *css) {
  fprintf(plot->out, "<path class=\"%s\"", style);
  if (css) fprintf(plot->out, " style=\"%s\"", css);
  fputs(" d=\"", plot->out);
  for (size_t i = 0; i < count; i++)
    fprintf(plot->out, "%c%.1f %.1f", i ? 'L' : 'M', fg_plot_x(plot, x[i]),
            fg_plot_y(plot, fg_plot_inside(plot, high[i])));
  for (size_t i = count; i-- > 0;)
    fprintf(plot->out, "L%.1f %.1f", fg_plot_x(plot, x[i]),
            fg_plot_y(plot, fg_plot_inside(plot, low[i])));
  fputs("Z\"/>\n", plot->out);
}

void fg_plot_interval(const fg_plot *plot, double x, double shift_px, double value, double reach,
                      const char *style) {
  double at = fg_plot_x(plot, x) + shift_px, middle = fg_plot_y(plot, value);
  double low = fg_plot_y(plot, value - reach), high = fg_plot_y(plot, value + reach);
  fprintf(plot->out,
          "<path class=\"%s\" d=\"M%.1f %.1fV%.1fM%.1f %.1fh10M%.1f %.1fh10\"/>"
          "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"5\"/>\n",
          style, at, low, high, at - 5, low, at - 5, high, style, at, middle);
}

void fg_plot_key(const fg_plot *plot, double x_px, const char *style, const char *words) {
  fprintf(plot->out,
          "<circle class=\"%s\" cx=\"%.0f\" cy=\"14\" r=\"5\"/><text x=\"%.0f\" y=\"19\">", style,
          x_px, x_px + 12);
  fg_html_text(plot->out, words);
  fputs("</text>\n", plot->out);
}

void fg_plot_text(const fg_plot *at, double x, double y, const char *style, const char *text) {
  fprintf(at->out, "<text class=\"%s\" x=\"%.1f\" y=\"%.1f\">", style, fg_plot_x(at, x),
          fg_plot_y(at, y));
  fg_html_text(at->out, text);
  fputs("</text>\n", at->out);
}

/* Compares labels: the highest comes first. */
static int by_height(const void *a, const void *b) {
  const fg_plot_label *one = a, *other = b;
  return (one->y < other->y) - (one->y > other->y);
}

/* Moves labels down from the top until the gap is kept, then up again from the plot's lower end. */
static void spread(const fg_plot *at, const fg_plot_label *labels, double *y, size_t count,
                   double gap_px) {
  for (size_t i = 0; i < count; i++) {
    y[i] = fg_plot_y(at, labels[i].y);
    if (i) y[i] = fmax(y[i], y[i - 1] + gap_px);
  }
  if (!count || !(y[count - 1] > at->bottom)) return;
  y[count - 1] = at->bottom;
  for (size_t i = count - 1; i > 0; i--)
    y[i - 1] = fmin(y[i - 1], y[i] - gap_px);
}

void fg_plot_labels(const fg_plot *at, fg_plot_label *labels, size_t count, double gap_px) {
  enum { LABELS_MAX = 16 };
  const double away_px = 6, half_letter_px = 5;
  double y[LABELS_MAX];
  if (count > LABELS_MAX) count = LABELS_MAX;
  fg_sort_items(labels, count, sizeof *labels, by_height);
  spread(at, labels, y, count, gap_px);
  for (size_t i = 0; i < count; i++) {
    fprintf(at->out, "<text class=\"%s\" x=\"%.1f\" y=\"%.1f\">", labels[i].style,
            at->right + away_px, y[i] + half_letter_px);
    fg_html_text(at->out, labels[i].text);
    fputs("</text>\n", at->out);
  }
}
