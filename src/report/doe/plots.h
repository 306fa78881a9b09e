/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plots of an experiment's page. */
#ifndef FG_REPORT_DOE_PLOTS_H
#define FG_REPORT_DOE_PLOTS_H

#include "foilgauge/experiment.h"

/* Each function writes <figure>s; none where there is nothing to show. */
void fg_doe_plot_main_effects(FILE *out, const fg_experiment *experiment);
fg_status fg_doe_plot_interactions(fg_context *ctx, FILE *out, const fg_experiment *experiment);
fg_status fg_doe_plot_effects(fg_context *ctx, FILE *out, const fg_experiment *experiment);
fg_status fg_doe_plot_residuals(fg_context *ctx, FILE *out, const fg_experiment_report *report);
void fg_doe_plot_contours(FILE *out, const fg_experiment *experiment);
/* Plots the response along every numeric factor with its interval (thesis figure 5.7). */
fg_status fg_doe_plot_profiles(fg_context *ctx, FILE *out, const fg_experiment *experiment);

#endif
