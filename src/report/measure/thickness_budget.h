/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Budget of the strip's thickness. */
#ifndef FG_REPORT_MEASURE_THICKNESS_BUDGET_H
#define FG_REPORT_MEASURE_THICKNESS_BUDGET_H

#include <stdio.h>

#include "foilgauge/foil.h"

/* A table of its parts with their shares, and where the thickness in force comes from. */
void fg_html_thickness_budget(FILE *out, const fg_design *design, const fg_foil *foil);

/* One line, where the thickness in force is not the scan's or a tone curve is most of its u. */
void fg_text_thickness_budget(FILE *out, const fg_design *design, const fg_foil *foil);

#endif
