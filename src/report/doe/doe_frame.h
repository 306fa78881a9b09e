/* A plot among others on an experiment's page. */
#ifndef FG_REPORT_DOE_DOE_FRAME_H
#define FG_REPORT_DOE_DOE_FRAME_H

#include "report/plot.h"

enum { FG_FRAME_WIDTH = 480, FG_FRAME_HEIGHT = 330 };

/* Opens <figure> and <svg> for data within these ranges, widened by a margin; ranges that are empty
 * or unknown become -1 to 1. */
fg_plot fg_frame_begin(FILE *out, const char *title, const double x[2], const double y[2]);
void fg_frame_end(const fg_plot *at);

/* Makes room for a value; ranges start as INFINITY, -INFINITY. */
void fg_range_add(double range[2], double value);

void fg_frame_dot(const fg_plot *at, const char *style, double x, double y, double radius);
void fg_frame_line(const fg_plot *at, const char *style, double x0, double y0, double x1,
                   double y1);
/* Text beside a point, to its right where there is room, else to its left. */
void fg_frame_text(const fg_plot *at, double x, double y, const char *text);

#endif
