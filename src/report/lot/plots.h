/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plots of a lot's page; each is one <svg>. */
#ifndef FG_REPORT_LOT_PLOTS_H
#define FG_REPORT_LOT_PLOTS_H

#include <stdio.h>

#include "lot/statistics/analysis.h"

/* More dots than these cannot be told apart, and a page must open on a phone. */
enum { FG_LOT_DOTS_MAX = 3000 };

/* Room around an axis; a value on it. */
void fg_lot_plot_widen(double *low, double *high, double share);

/* Mean ± 2 sd of each bump number and the foils beside them, with the tolerance (thesis figure
 * 5.17), and the reference curve where it speaks of this quantity; NULL: none. And what its marks
 * mean. */
void fg_lot_plot_places(FILE *out, const fg_lot_analysis *analysis, const fg_lot_quantity *quantity,
                        const fg_lot_curve *curve);
void fg_lot_put_places_key(FILE *out, const fg_lot_analysis *analysis,
                           const fg_lot_quantity *quantity);

/* What the curve says of a quantity at its i-th point; false beyond its end, and of others. */
bool fg_lot_curve_value(const fg_lot_curve *curve, const fg_quantity *row, size_t i, double *value);

/* Histogram and kernel density, with the mode (figure 5.11). `scale` and `shift` turn the values
 * into what the axis shows: scale × value + shift. */
void fg_lot_plot_density(FILE *out, const fg_lot_quantity *quantity, double scale, double shift,
                         const char *title);

/* Angle error over radius error, the line through the trimmed values and what a constant arc length
 * says (figure 5.8). */
void fg_lot_plot_correlation(FILE *out, const fg_lot_analysis *analysis);

/* The chart of individuals: foil after foil, limits, signals, and the groups that explain them. */
void fg_lot_plot_chart(FILE *out, const fg_lot_analysis *analysis, const fg_lot_quantity *quantity);

/* Stiffness over radius and angle deviation, with the measured bumps (figures 5.4, 5.10). */
void fg_lot_plot_map(FILE *out, const fg_lot_analysis *analysis);

/* Clearance around one bearing (figure 6.3). */
void fg_lot_plot_polar(FILE *out, const fg_lot_analysis *analysis, const fg_lot_bearing *bearing);

/* Densities of value `value` (fg_assembly_row) of the bearings drawn and of those of the design,
 * with the limits on it; µm. */
void fg_lot_plot_assembly(FILE *out, const fg_lot_analysis *analysis, size_t value);

#endif
