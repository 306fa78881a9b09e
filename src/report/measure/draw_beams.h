/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The beams of a flat foil over its scan. */
#ifndef FG_REPORT_MEASURE_DRAW_BEAMS_H
#define FG_REPORT_MEASURE_DRAW_BEAMS_H

#include "foilgauge/foil.h"
#include "page/canvas.h"

/* Draws outlines of the fitted lines, root lines, axes, numbers, and residuals towards the void
 * `magnification` times as large. */
fg_status fg_draw_beams(fg_context *ctx, fg_canvas *canvas, const fg_foil *foil,
                        double magnification);

#endif
