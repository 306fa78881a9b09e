<<<<<<< HEAD
/* Plots as inline SVG: a frame, axes, lines, dots. The page's style names their looks. */
#ifndef FG_REPORT_PLOT_H
#define FG_REPORT_PLOT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { FG_PLOT_WIDTH = 1000 };

/* A plot's place for data, in units of its view box, and what its axes span. */
typedef struct fg_plot {
  FILE *out;
=======
/* Axes of a plot as inline SVG. */
#ifndef FG_REPORT_PLOT_H
#define FG_REPORT_PLOT_H

#include <stdio.h>

/* A plot's place for data, in units of its view box, and what its axes span. */
typedef struct fg_plot {
  FILE *out;
  int width; /* of the view box */
>>>>>>> main
  double left, right, top, bottom;
  double x_low, x_high, y_low, y_high;
} fg_plot;

double fg_plot_x(const fg_plot *at, double x);
double fg_plot_y(const fg_plot *at, double y);

<<<<<<< HEAD
void fg_plot_begin(const fg_plot *at, int height, const char *label);
void fg_plot_end(const fg_plot *at);

/* Grid lines with numbers at 1, 2 or 5 times a power of ten. */
void fg_plot_y_axis(const fg_plot *at, const char *title);
void fg_plot_x_numbers(const fg_plot *at);
void fg_plot_x_label(const fg_plot *at, double x, const char *text); /* x in the view box */
void fg_plot_x_title(const fg_plot *at, const char *title);

/* In units of the axes. A value that is not finite leaves a gap in a line. */
void fg_plot_dot(const fg_plot *at, double x, double y, double radius, const char *style);
void fg_plot_line(const fg_plot *at, const double *x, const double *y, size_t count,
                  const char *style);
void fg_plot_segment(const fg_plot *at, double x1, double y1, double x2, double y2,
                     const char *style);
void fg_plot_text(const fg_plot *at, double x, double y, const char *style, const char *text);

=======
/* 1, 2 or 5 times a power of ten, about a fifth of the span. */
double fg_plot_nice_step(double span);

/* Opens the <svg>; `label` is for readers that do not see it, and is made harmless. */
void fg_plot_begin(const fg_plot *at, int height, const char *label);
void fg_plot_end(const fg_plot *at);

/* Numbers, grid lines, and the title (made harmless) along the axis. */
void fg_plot_y_axis(const fg_plot *at, const char *title);
void fg_plot_x_label(const fg_plot *at, double x, const char *text);
void fg_plot_x_numbers(const fg_plot *at);
void fg_plot_x_title(const fg_plot *at, const char *title);

>>>>>>> main
#endif
