/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/doe/axes.h"

#include <math.h>
#include <stdbool.h>

#include "page/page.h"

void fg_range_add(double range[2], double value) {
  if (!isfinite(value)) return;
  range[0] = fmin(range[0], value);
  range[1] = fmax(range[1], value);
}

static void widen_axis_range(const double range[2], double *low, double *high) {
  *low = range[0];
  *high = range[1];
  if (!(range[0] <= range[1])) {
    *low = -1;
    *high = 1;
  }
  double margin = *high > *low ? 0.06 * (*high - *low) : fmax(1e-9, 0.1 * fabs(*high));
  *low -= margin;
  *high += margin;
}

fg_plot fg_axes_begin(FILE *out, const char *title, const double x[2], const double y[2]) {
  fg_plot at = {.out = out,
                .width = FG_AXES_WIDTH,
                .left = 74,
                .right = FG_AXES_WIDTH - 14,
                .top = 12,
                .bottom = FG_AXES_HEIGHT - 50};
  widen_axis_range(x, &at.x_low, &at.x_high);
  widen_axis_range(y, &at.y_low, &at.y_high);
  fputs("<figure><h3>", out);
  fg_html_text(out, title);
  fputs("</h3>", out);
  fg_plot_begin(&at, FG_AXES_HEIGHT, title);
  return at;
}

void fg_axes_end(const fg_plot *at) {
  fg_plot_end(at);
  fputs("</figure>\n", at->out);
}

void fg_axes_dot(const fg_plot *at, const char *style, double x, double y, double radius) {
  if (isfinite(x) && isfinite(y))
    fprintf(at->out, "<circle class=\"%s\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/>\n", style,
            fg_plot_x(at, x), fg_plot_y(at, y), radius);
}

void fg_axes_line(const fg_plot *at, const char *style, double x0, double y0, double x1,
                  double y1) {
  fprintf(at->out, "<path class=\"%s\" d=\"M%.1f %.1fL%.1f %.1f\"/>\n", style, fg_plot_x(at, x0),
          fg_plot_y(at, y0), fg_plot_x(at, x1), fg_plot_y(at, y1));
}

void fg_axes_text(const fg_plot *at, double x, double y, const char *text) {
  bool left = fg_plot_x(at, x) > at->left + 0.55 * (at->right - at->left);
  fprintf(at->out, "<text class=\"%s\" x=\"%.1f\" y=\"%.1f\">", left ? "y" : "start",
          fg_plot_x(at, x) + (left ? -9 : 9), fg_plot_y(at, y) + 5);
  fg_html_text(at->out, text);
  fputs("</text>\n", at->out);
}
