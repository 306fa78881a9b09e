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
