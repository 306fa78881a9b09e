/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbers behind the rows of what is reported of a die. */
#ifndef FG_DIE_VALUES_H
#define FG_DIE_VALUES_H

#include "foilgauge/die.h"

/* One trace's value of one bump, and its own standard uncertainty. */
double fg_die_value_of(const fg_design *design, const fg_die_trace *trace, const fg_bump *bump,
                       fg_die_quantity q, double *u);

/* What tip and scale are uncertain by, which every trace has alike. */
void fg_die_systematic_u(const fg_die *die, const fg_die_trace *trace, const fg_bump *bump,
                         double u[FG_DIE_QUANTITIES]);

#endif
