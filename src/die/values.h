/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values of the quantities reported of a die. */
#ifndef FG_DIE_VALUES_H
#define FG_DIE_VALUES_H

#include "foilgauge/die.h"

/* Returns one trace's value of one bump, and its own standard uncertainty. */
double fg_die_value_of(const fg_design *design, const fg_die_trace *trace, const fg_bump *bump,
                       fg_die_quantity q, double *u);

/* Computes the uncertainties by tip and scale, which are common to all traces. */
void fg_die_systematic_u(const fg_die *die, const fg_die_trace *trace, const fg_bump *bump,
                         double u[FG_DIE_QUANTITIES]);

#endif
