/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The frame of a plot: size, ranges with room around the data, axes. */
#ifndef FG_PAGE_PLOT_FRAME_H
#define FG_PAGE_PLOT_FRAME_H

#include "page/plot_marks.h"

/* Makes room for value - reach to value + reach. A value that is not finite is left out, a reach
 * that is not finite counts as 0. Ranges start as INFINITY, -INFINITY. */
void fg_range_add(double range[2], double value, double reach);

/* Widens a range at both sides by this share of itself, by `min` at least. */
void fg_range_pad(double range[2], double share, double min);
/* Widens a range by this share of itself; one of equal values gets a percent of their size. */
void fg_range_pad_by_size(double range[2], double share);

/* Margins are px around the field for data. */
typedef struct fg_plot_frame {
  const char *label;               /* for readers that do not see the plot */
  int width, height;               /* of the view box; width 0: 1000 */
  double left, right, top, bottom; /* right 0: 15; top 0: 14; bottom 0: 50, room for the x axis */
  const double *x, *y;             /* both ends of the axes */
  const double *band; /* two levels with a ground between them below the axes; NULL: none */
  const char *band_style;
  const char *y_title, *x_title; /* NULL: no y axis, no title of the x axis */
  fg_plot_ticks ticks;
} fg_plot_frame;

/* Opens the <svg>. Marks that are written before the axes lie below their lines. */
fg_plot fg_plot_open(FILE *out, const fg_plot_frame *frame);
void fg_plot_axes(const fg_plot *plot);
/* Opens the <svg> and writes the axes. fg_plot_end closes it. */
fg_plot fg_plot_frame_begin(FILE *out, const fg_plot_frame *frame);

#endif
