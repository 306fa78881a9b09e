/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of a next die. */
#ifndef FG_COMPENSATION_PLOTS_H
#define FG_COMPENSATION_PLOTS_H

#include "foilgauge/compensation.h"

/* The die now, the die to be cut and the expected foil, laid over each other. */
fg_status fg_next_die_plot_profile(fg_context *ctx, const fg_next_die *next, FILE *out);

/* Radii over the bumps: the last foils, the die now and next, the expected lot, the target. */
void fg_next_die_plot_radii(const fg_next_die *next, FILE *out);

/* The trade over the first factor, a line for each value of the second: die and u of the lot. */
void fg_next_die_plot_settings(const fg_next_die *next, FILE *out);

#endif
