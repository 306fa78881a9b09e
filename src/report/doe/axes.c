/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/doe/axes.h"

#include <math.h>
#include <stdbool.h>

#include "page/page.h"

static void pad_axis(const double data[2], double range[2]) {
  bool known = data[0] <= data[1];
  range[0] = known ? data[0] : -1;
  range[1] = known ? data[1] : 1;
  fg_range_pad(range, 0.06, range[1] > range[0] ? 0 : fmax(1e-9, 0.1 * fabs(range[1])));
}

fg_plot fg_axes_begin(FILE *out, const fg_plot_frame *frame) {
  double x[2], y[2];
  fg_plot_frame axes = *frame;
  axes.width = FG_AXES_WIDTH;
  axes.height = FG_AXES_HEIGHT;
  axes.left = 74;
  axes.right = 14;
  if (!(axes.top > 0)) axes.top = 12;
  pad_axis(frame->x, x);
  pad_axis(frame->y, y);
  axes.x = x;
  axes.y = y;
  fputs("<figure><h3>", out);
  fg_html_text(out, frame->label);
  fputs("</h3>", out);
  return fg_plot_frame_begin(out, &axes);
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

void fg_axes_text(const fg_plot *at, double x, double y, const char *text) {
  bool left = fg_plot_x(at, x) > at->left + 0.55 * (at->right - at->left);
  fprintf(at->out, "<text class=\"%s\" x=\"%.1f\" y=\"%.1f\">", left ? "y" : "start",
          fg_plot_x(at, x) + (left ? -9 : 9), fg_plot_y(at, y) + 5);
  fg_html_text(at->out, text);
  fputs("</text>\n", at->out);
}
