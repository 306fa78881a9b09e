/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts of a foil's page for pages outside report/measure. */
#ifndef FG_REPORT_FOIL_HTML_H
#define FG_REPORT_FOIL_HTML_H

#include <stdio.h>

#include "foilgauge/report.h"

/* Writes the foil (NULL: the whole scan) cut out of its scan, with circles and residuals over it.
 * Where the scan cannot be read again (standard input) the drawing stands alone. Residuals are
 * drawn `magnification` times as large; 0: as suits this measurement. */
fg_status fg_html_picture(fg_context *ctx, FILE *out, const fg_measurement *measurement,
                          const fg_foil *foil, double magnification);

/* Tables of the foil's bumps or beams, and of its values as a whole. */
void fg_html_part_table(FILE *out, const fg_design *design, const fg_foil *foil);
void fg_html_foil_table(FILE *out, const fg_design *design, const fg_foil *foil);

#endif
