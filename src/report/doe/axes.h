/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plot among others on an experiment's page. */
#ifndef FG_REPORT_DOE_AXES_H
#define FG_REPORT_DOE_AXES_H

#include "page/plot_frame.h"

enum { FG_AXES_WIDTH = 480, FG_AXES_HEIGHT = 330 };

/* Points of a plot at most; of more, only some are drawn. */
enum { FG_DOE_POINTS_SHOWN = 2000 };

/* Opens <figure> and <svg> for data within the frame's ranges, widened by a margin; ranges that are
 * empty or unknown become -1 to 1. The frame's label is the heading, its size is not read. */
fg_plot fg_axes_begin(FILE *out, const fg_plot_frame *frame);
void fg_axes_end(const fg_plot *at);

void fg_axes_dot(const fg_plot *at, const char *style, double x, double y, double radius);
/* Writes text beside a point: right of it where there is room, else left. */
void fg_axes_text(const fg_plot *at, double x, double y, const char *text);

#endif
