/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marks in a plot, in units of its axes; the page's style names their looks. */
#ifndef FG_PAGE_PLOT_MARKS_H
#define FG_PAGE_PLOT_MARKS_H

#include <stddef.h>

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
