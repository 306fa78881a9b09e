/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plots of a lot's page; each is one <svg>. */
#ifndef FG_REPORT_LOT_PLOTS_H
#define FG_REPORT_LOT_PLOTS_H

#include <stdio.h>

#include "lot/statistics/analysis.h"

/* Maximum of dots: more cannot be told apart, and a page must open on a phone. */
enum { FG_LOT_DOTS_MAX = 3000 };

/* Plots mean ± 2 sd of each bump number with the foils beside them, the tolerance (thesis
 * figure 5.17), and the reference curve of this quantity, if any (NULL: none); and explains its
 * marks. */
void fg_lot_plot_places(FILE *out, const fg_lot_analysis *analysis, const fg_lot_quantity *quantity,
                        const fg_lot_curve *curve);
void fg_lot_put_places_key(FILE *out, const fg_lot_analysis *analysis,
                           const fg_lot_quantity *quantity);

/* Finds the curve's value of a quantity at its i-th point; false beyond its end, and for other
 * quantities. */
bool fg_lot_curve_value(const fg_lot_curve *curve, const fg_quantity *row, size_t i, double *value);

/* Plots histogram and kernel density with the mode (figure 5.11). The axis shows scale × value +
 * shift. */
void fg_lot_plot_density(FILE *out, const fg_lot_quantity *quantity, double scale, double shift,
                         const char *title);

/* Plots angle error over radius error, the line through the trimmed values, and the hypothesis of a
 * constant arc length (figure 5.8). */
void fg_lot_plot_correlation(FILE *out, const fg_lot_analysis *analysis);

/* Plots the chart of individuals: foil after foil, limits, signals, and the groups that explain
 * them. */
void fg_lot_plot_chart(FILE *out, const fg_lot_analysis *analysis, const fg_lot_quantity *quantity);

/* Plots stiffness over the deviations of radius and angle, with the measured bumps
 * (figures 5.4, 5.10). */
void fg_lot_plot_map(FILE *out, const fg_lot_analysis *analysis);

/* Plots the clearance around one bearing (figure 6.3). */
void fg_lot_plot_polar(FILE *out, const fg_lot_analysis *analysis, const fg_lot_bearing *bearing);

/* Plots densities of value `value` (fg_assembly_row) of drawn bearings and of those of the design,
 * with its limits; µm. */
void fg_lot_plot_assembly(FILE *out, const fg_lot_analysis *analysis, size_t value);

#endif
