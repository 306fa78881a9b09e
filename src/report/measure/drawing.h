/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The drawing over a scan: edges, circles, numbers, residuals. */
#ifndef FG_REPORT_MEASURE_DRAWING_H
#define FG_REPORT_MEASURE_DRAWING_H

#include "foilgauge/report.h"
#include "page/canvas.h"

/* The emptiest corner of the canvas, where the residuals' scale is drawn: its lowest and highest x
 * and y, mm. */
typedef struct fg_drawing_box {
  fg_point low, high;
} fg_drawing_box;
fg_drawing_box fg_drawing_scale_box(const fg_canvas *canvas, const fg_measurement *measurement);

/* Returns the magnification of residuals, one for all scans of a report, so that they compare:
 * 1, 2 or 5 times a power of ten. */
double fg_drawing_magnification(const fg_report *report);

/* Draws every foil and disc, and the residuals' scale in the emptiest corner. Residuals are
 * `magnification` times as large; 0: as suits this measurement. */
fg_status fg_draw_measurement(fg_context *ctx, fg_canvas *canvas, const fg_measurement *measurement,
                              double magnification);

#endif
