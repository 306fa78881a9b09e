/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Axes of a plot as inline SVG. */
#ifndef FG_PAGE_PLOT_H
#define FG_PAGE_PLOT_H

#include <stdio.h>

typedef enum fg_plot_ticks {
  FG_TICKS_NUMBERS,
  FG_TICKS_COUNTS, /* never 1.5 */
  FG_TICKS_OWN,    /* the plot writes its own */
} fg_plot_ticks;

/* A plot: its field for data, in units of its view box, and the ranges of its axes. */
typedef struct fg_plot {
  FILE *out;
  int width; /* of the view box */
  double left, right, top, bottom;
  double x_low, x_high, y_low, y_high;
  const char *y_title, *x_title; /* as in fg_plot_frame */
  fg_plot_ticks ticks;
} fg_plot;

double fg_plot_x(const fg_plot *at, double x);
double fg_plot_y(const fg_plot *at, double y);
double fg_plot_inside(const fg_plot *plot, double y); /* moved to the nearer end of the y axis */

/* Returns a step of ticks: 1, 2 or 5 times a power of ten, about a fifth of the span. */
double fg_plot_nice_step(double span);

/* Opens the <svg>; `label` is for readers that do not see it, and is made harmless. */
void fg_plot_begin(const fg_plot *at, int height, const char *label);
void fg_plot_end(const fg_plot *at);

/* Write numbers, grid lines, and the title (made harmless) along the axis. */
void fg_plot_y_axis(const fg_plot *at, const char *title);
void fg_plot_x_label(const fg_plot *at, double x, const char *text);
void fg_plot_x_number(const fg_plot *plot, int number); /* of a bump: at its place */
void fg_plot_x_numbers(const fg_plot *at);
void fg_plot_x_counts(const fg_plot *at); /* of counts: never 1.5 */
void fg_plot_x_title(const fg_plot *at, const char *title);

#endif
