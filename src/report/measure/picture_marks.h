/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What lies beyond its limit, marked where it is on the picture of a foil or of discs. */
#ifndef FG_REPORT_MEASURE_PICTURE_MARKS_H
#define FG_REPORT_MEASURE_PICTURE_MARKS_H

#include "page/canvas.h"

/* A ring around every bump with a value that fails (red) or of which the limit cannot tell
 * (amber), and the worst of its values with its limit, where nothing else stands; the same of the
 * whole foil without a ring, and a ring where a bump is missing or could not be fitted.
 * `measurement` has that one foil, or discs; after fg_draw_measurement. */
fg_status fg_draw_verdicts(fg_context *ctx, fg_canvas *canvas, const fg_measurement *measurement);

#endif
