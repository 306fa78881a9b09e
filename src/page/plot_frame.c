/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "page/plot_frame.h"

#include <math.h>

void fg_range_add(double range[2], double value, double reach) {
  if (!isfinite(value)) return;
  if (!isfinite(reach)) reach = 0;
  range[0] = fmin(range[0], value - reach);
  range[1] = fmax(range[1], value + reach);
}

static void widen_both_sides(double range[2], double margin) {
  range[0] -= margin;
  range[1] += margin;
}

void fg_range_pad(double range[2], double share, double min) {
  widen_both_sides(range, fmax(min, share * (range[1] - range[0])));
}

void fg_range_pad_by_size(double range[2], double share) {
  static const double min = 1e-9; /* of the size: below, numbers of an axis would not differ */
  double size = fmax(fabs(range[0]), fabs(range[1])), room = share * (range[1] - range[0]);
  if (!(room > min * size)) room = size > 0 ? 0.01 * size : 1;
  widen_both_sides(range, room);
}

fg_plot fg_plot_open(FILE *out, const fg_plot_frame *frame) {
  fg_plot plot = {.out = out,
                  .width = frame->width ? frame->width : 1000,
                  .left = frame->left,
                  .top = frame->top > 0 ? frame->top : 14,
                  .bottom = frame->height - (frame->bottom > 0 ? frame->bottom : 50),
                  .x_low = frame->x[0],
                  .x_high = frame->x[1],
                  .y_low = frame->y[0],
                  .y_high = frame->y[1],
                  .y_title = frame->y_title,
                  .x_title = frame->x_title,
                  .ticks = frame->ticks};
  plot.right = plot.width - (frame->right > 0 ? frame->right : 15);
  fg_plot_begin(&plot, frame->height, frame->label);
  if (frame->band) fg_plot_band(&plot, frame->band[0], frame->band[1], frame->band_style);
  return plot;
}

void fg_plot_axes(const fg_plot *plot) {
  if (plot->y_title) fg_plot_y_axis(plot, plot->y_title);
  if (plot->ticks == FG_TICKS_NUMBERS) fg_plot_x_numbers(plot);
  if (plot->ticks == FG_TICKS_COUNTS) fg_plot_x_counts(plot);
  if (plot->x_title) fg_plot_x_title(plot, plot->x_title);
}

fg_plot fg_plot_frame_begin(FILE *out, const fg_plot_frame *frame) {
  fg_plot plot = fg_plot_open(out, frame);
  fg_plot_axes(&plot);
  return plot;
}
