/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plots of a forming: along the strip, over the bumps; of a fit over its runs. */
#ifndef FG_REPORT_FORMING_PLOTS_H
#define FG_REPORT_FORMING_PLOTS_H

#include "foilgauge/forming.h"

void fg_forming_plot_curvature(FILE *out, const fg_forming *forming);
void fg_forming_plot_stress(FILE *out, const fg_forming *forming);
void fg_forming_plot_errors(FILE *out, const fg_forming *forming);
void fg_forming_plot_fit(FILE *out, const fg_forming_fit *fit);

#endif
