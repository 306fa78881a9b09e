/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plots of a measurement's page. */
#ifndef FG_REPORT_MEASURE_PAGE_PARTS_H
#define FG_REPORT_MEASURE_PAGE_PARTS_H

#include "foilgauge/words.h"
#include "page/verdict.h"
#include "report/foil_html.h"

/* Plots the residual of the midline along the foil, bumps marked. */
void fg_html_residuals(FILE *out, const fg_foil *foil);

/* Plots radius and angle error of every bump with error bars (as the thesis's figure 5.17), of
 * every beam those of compliance and sagitta, and limits where there are any. */
void fg_html_errors(FILE *out, const fg_design *design, const fg_foil *foil);

#endif
