/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts of a measurement's page: verdict, values, the picture of a foil, plots. */
#ifndef FG_REPORT_MEASURE_PAGE_PARTS_H
#define FG_REPORT_MEASURE_PAGE_PARTS_H

#include "foilgauge/words.h"

/* "Within tolerance", ...; and the same as a coloured pill. */
const char *fg_html_verdict_title(fg_verdict verdict);
void fg_html_verdict(FILE *out, fg_verdict verdict);
/* The same of an outcome: "Rejected" when it is a defect and no value that fails. */
void fg_html_outcome(FILE *out, const fg_report_outcome *outcome);

/* "3.39288 ± 0.00042", or "–" when it is not known. */
void fg_html_value(FILE *out, const fg_quantity *row, const void *object);

/* The foil (NULL: the whole scan) cut out of its scan, with circles and residuals over it. Where
 * the scan cannot be read again (standard input) the drawing stands alone. Residuals are drawn
 * `magnification` times as large; 0: as suits this measurement. */
fg_status fg_html_picture(fg_context *ctx, FILE *out, const fg_measurement *measurement,
                          const fg_foil *foil, double magnification);

/* Residual of the midline along the foil, bumps marked. */
void fg_html_residuals(FILE *out, const fg_foil *foil);

/* Radius and angle error of every bump with error bars (as the thesis's figure 5.17), of every beam
 * those of compliance and sagitta, and limits where there are any. */
void fg_html_errors(FILE *out, const fg_design *design, const fg_foil *foil);

#endif
