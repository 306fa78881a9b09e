/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marks in a plot, in units of its axes; the page's style names their looks. */
#ifndef FG_PAGE_PLOT_MARKS_H
#define FG_PAGE_PLOT_MARKS_H

#include <stddef.h>

#include "foilgauge/design.h"
#include "page/plot.h"

void fg_plot_dot(const fg_plot *at, double x, double y, double radius, const char *style);

/* Marks that can be told apart without their colour. */
typedef enum fg_shape {
  FG_SHAPE_CIRCLE,
  FG_SHAPE_SQUARE,
  FG_SHAPE_TRIANGLE,
  FG_SHAPE_DIAMOND,
  FG_SHAPE_CROSS,
  FG_SHAPES
} fg_shape;
void fg_plot_shape(const fg_plot *at, double x, double y, double radius, fg_shape shape,
                   const char *style);
/* Draws the mark at a point of the view box. */
void fg_plot_shape_at(FILE *out, double x, double y, double radius, fg_shape shape,
                      const char *style);

/* Draws a line through the points; a value that is not finite leaves a gap. */
void fg_plot_line(const fg_plot *at, const double *x, const double *y, size_t count,
                  const char *style);
void fg_plot_segment(const fg_plot *at, double x1, double y1, double x2, double y2,
                     const char *style);

/* Draws a line across the plot; a level beyond it is not drawn. */
void fg_plot_level(const fg_plot *plot, double y, const char *style);
/* Draws both limits of a tolerance as levels; NULL: none. */
void fg_plot_tolerance(const fg_plot *plot, const fg_tolerance *tolerance);

/* Fills the rectangle; x[0] <= x[1], y[0] <= y[1]. */
void fg_plot_rect(const fg_plot *plot, const double x[2], const double y[2], const char *style);
/* Fills the whole width between two levels. */
void fg_plot_band(const fg_plot *plot, double low, double high, const char *style);
/* Fills the whole height of a bump, with its number above. */
void fg_plot_bump_band(const fg_plot *plot, double from, double to, int number);

/* Fills the stretch between two lines, of which what lies beyond the plot is moved to its edge.
 * `css` is a style of its own; NULL: none. */
void fg_plot_ribbon(const fg_plot *plot, const double *x, const double *low, const double *high,
                    size_t count, const char *style, const char *css);

/* Draws a dot with its interval, `shift_px` beside x, so that two do not hide each other. */
void fg_plot_interval(const fg_plot *plot, double x, double shift_px, double value, double reach,
                      const char *style);

/* Writes an entry of the legend above the plot: a dot at x_px, and words, made harmless. The
 * plot's top is 34 px then. */
void fg_plot_key(const fg_plot *plot, double x_px, const char *style, const char *words);

/* Writes text, made harmless. */
void fg_plot_text(const fg_plot *at, double x, double y, const char *style, const char *text);

/* Labels of levels, right of the plot. They are sorted by height and moved apart to the gap, so
 * that none covers another; they stay within the plot's height as long as they fit. Texts are
 * made harmless. */
typedef struct fg_plot_label {
  double y; /* in units of the axis */
  const char *style;
  char text[80];
} fg_plot_label;
#define FG_PLOT_LABEL_GAP_PX 20.0
void fg_plot_labels(const fg_plot *at, fg_plot_label *labels, size_t count, double gap_px);

#endif
