/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plots of a die's page. */
#ifndef FG_REPORT_DIE_PLOTS_H
#define FG_REPORT_DIE_PLOTS_H

#include <stdio.h>

#include "foilgauge/die.h"

/* Error of every bump by half with U, the design's line, the limits that it states. */
void fg_die_plot_errors(FILE *out, const fg_die *die, fg_die_quantity quantity);

/* The first trace of a half to scale, its circles drawn on. */
void fg_die_plot_trace(FILE *out, const fg_die *die, fg_die_half half);

/* Residuals of every trace of a half, one above the other by their bumps. */
void fg_die_plot_residuals(FILE *out, const fg_die *die, fg_die_half half);

#endif
