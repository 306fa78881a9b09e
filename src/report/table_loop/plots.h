/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Plots of the effects that the loop on tables found. */
#ifndef FG_REPORT_TABLE_LOOP_PLOTS_H
#define FG_REPORT_TABLE_LOOP_PLOTS_H

#include "foilgauge/loop.h"
#include "foilgauge/loop_table.h"

/* Writes a section per finding: curves as curves, levels as dashes, spread as a band, outlier rows
 * marked. */
fg_status fg_loop_plots_put(fg_context *ctx, FILE *out, const fg_loop_report *report);

#endif
