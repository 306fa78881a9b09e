/* Marks in a plot, in units of its axes; the page's style names their looks. */
#ifndef FG_REPORT_PLOT_MARKS_H
#define FG_REPORT_PLOT_MARKS_H

#include <stddef.h>

#include "report/plot.h"

void fg_plot_dot(const fg_plot *at, double x, double y, double radius, const char *style);

/* A value that is not finite leaves a gap. */
void fg_plot_line(const fg_plot *at, const double *x, const double *y, size_t count,
                  const char *style);
void fg_plot_segment(const fg_plot *at, double x1, double y1, double x2, double y2,
                     const char *style);

/* The text is made harmless. */
void fg_plot_text(const fg_plot *at, double x, double y, const char *style, const char *text);

#endif
