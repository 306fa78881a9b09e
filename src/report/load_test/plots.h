/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plots of a load-displacement test's page. */
#ifndef FG_REPORT_LOAD_TEST_PLOTS_H
#define FG_REPORT_LOAD_TEST_PLOTS_H

#include <stdio.h>

#include "foilgauge/load_test.h"

/* Plots force over displacement as recorded, with the threshold and the points where it is
 * passed. */
void fg_load_plot_loops(FILE *out, const fg_load_test *test, const fg_load_direction *direction);

/* Plots stiffness over displacement with U. */
void fg_load_plot_stiffness(FILE *out, const fg_load_direction *direction);

/* Plots the clearance of every azimuth with U of the repeats, the fitted curve, the lot's
 * prediction. */
void fg_load_plot_azimuths(FILE *out, const fg_load_test *test, size_t bearing);

/* Plots break-away friction over dead weight, and the fitted line. */
void fg_load_plot_break_away(FILE *out, const fg_load_test *test, size_t bearing);

#endif
