/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plots of a die's page. */
#ifndef FG_REPORT_DIE_PLOTS_H
#define FG_REPORT_DIE_PLOTS_H

#include <stdio.h>

#include "foilgauge/die.h"

/* Plots the error of every bump by half with U, the design's line and its limits. */
void fg_die_plot_errors(FILE *out, const fg_die *die, fg_die_quantity quantity);

/* Plots the first trace of a half to scale, with its circles. */
void fg_die_plot_trace(FILE *out, const fg_die *die, fg_die_half half);

/* Plots the residuals of every trace of a half, one above the other by their bumps. */
void fg_die_plot_residuals(FILE *out, const fg_die *die, fg_die_half half);

#endif
