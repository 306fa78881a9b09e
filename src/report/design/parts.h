/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lines of a design for the terminal. */
#ifndef FG_REPORT_DESIGN_PARTS_H
#define FG_REPORT_DESIGN_PARTS_H

#include <stdio.h>

#include "foilgauge/design.h"

void fg_design_put_row(FILE *out, const char *words, const char *symbol, double value,
                       const char *unit);

/* Knowledge beside the design, as of the strip that was made. */
void fg_design_put_known(const fg_design *design, FILE *out);

#endif
