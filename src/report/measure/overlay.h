/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines of the legend under an overlay, for the rows of kinds. */
#ifndef FG_REPORT_MEASURE_OVERLAY_H
#define FG_REPORT_MEASURE_OVERLAY_H

#include "report/measure/foil_view.h"

enum { FG_OVERLAY_LINE = 256 };

/* "20.9500 ± 0.0012" */
void fg_overlay_value_text(const fg_quantity *row, const void *object, char *text, size_t size);

/* A line that begins at a column, in heights of capitals. */
fg_status fg_overlay_put_line(fg_context *ctx, fg_overlay_legend *legend, double column_em,
                              const char *text);

/* The line that foils bent about a centre have in common: radius, springback, thickness. */
fg_status fg_overlay_put_bent_foil(fg_context *ctx, fg_overlay_legend *legend, const fg_foil *foil);

#endif
