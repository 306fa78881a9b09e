/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Marks of values beyond their limits, on the picture of a foil or of discs. */
#ifndef FG_REPORT_MEASURE_PICTURE_MARKS_H
#define FG_REPORT_MEASURE_PICTURE_MARKS_H

#include "page/canvas.h"

/* Draws a ring around every bump with a value that fails (red) or is undecided (amber), and
 * writes the worst of its values with its limit at a free place. The foil's own values have no
 * ring; a bump that is missing or could not be fitted has one. `measurement` has that one foil,
 * or discs. Call it after fg_draw_measurement. */
fg_status fg_draw_verdicts(fg_context *ctx, fg_canvas *canvas, const fg_measurement *measurement);

#endif
