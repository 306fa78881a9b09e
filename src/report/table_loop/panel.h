/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plot of rows over one coordinate, with the effects found over it. */
#ifndef FG_REPORT_TABLE_LOOP_PANEL_H
#define FG_REPORT_TABLE_LOOP_PANEL_H

#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"

typedef struct fg_loop_point {
  double x, y;
} fg_loop_point;

typedef struct fg_loop_panel {
  const fg_loop_coordinate *at;
  const double *residual; /* rows */
  double middle, limit;   /* of the ordinate, and both ways from it */
  fg_loop_point *line;
  size_t points;
  bool dashes;                     /* a dash for each point of the line, not a curve */
  bool band;                       /* the line is the upper edge of a band about zero */
  bool joined;                     /* the rows are joined in their order */
  const fg_loop_candidate *marked; /* rows marked with their numbers; NULL: none */
  const char *caption;
} fg_loop_panel;

fg_status fg_loop_panel_put(fg_context *ctx, FILE *out, const fg_loop_report *report,
                            const fg_loop_panel *panel);

#endif
