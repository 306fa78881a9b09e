/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Budget of the strip's thickness. */
#ifndef FG_REPORT_MEASURE_THICKNESS_BUDGET_H
#define FG_REPORT_MEASURE_THICKNESS_BUDGET_H

#include <stdio.h>

#include "foilgauge/foil.h"

/* Writes a table of its parts with their shares, and the source of the thickness in force. */
void fg_html_thickness_budget(FILE *out, const fg_design *design, const fg_foil *foil);

/* Writes one line where the thickness in force is not the scan's, or a tone curve is the largest
 * part of its u. */
void fg_text_thickness_budget(FILE *out, const fg_design *design, const fg_foil *foil);

#endif
