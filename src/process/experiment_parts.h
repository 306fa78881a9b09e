/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stages of fg_experiment_analyse, in their order. */
#ifndef FG_PROCESS_EXPERIMENT_PARTS_H
#define FG_PROCESS_EXPERIMENT_PARTS_H

#include "foilgauge/experiment.h"

fg_status fg_experiment_note(fg_context *ctx, fg_experiment *experiment, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Repeats the fit with weights where the measurement's uncertainty requires it. */
fg_status fg_experiment_weigh(fg_context *ctx, fg_experiment *experiment,
                              const fg_extended *response);

/* Returns the dof of row · b in a weighted fit. */
double fg_experiment_weighted_dof(const fg_experiment *experiment, const double *row);

/* Computes split plots, coefficients by stratum, Lenth, Box-Cox, curvature, and the measurement's
 * contribution. */
fg_status fg_experiment_effects(fg_context *ctx, fg_experiment *experiment);

/* Tests the residuals over the order of the runs. */
fg_status fg_experiment_check_order(fg_context *ctx, fg_experiment *experiment);

/* Finds surface and region, then stationary point, optimum, ridge. `whole`: the experiment with all
 * factors when this one lacks some, or NULL. */
fg_status fg_experiment_surface(fg_context *ctx, const fg_experiment_options *options,
                                const fg_experiment *whole, fg_experiment *experiment);
fg_status fg_experiment_optimise(fg_context *ctx, const fg_experiment_options *options,
                                 const fg_experiment *whole, fg_experiment *experiment);

/* Returns a response's cost by the goal: the best setting has the lowest. */
double fg_experiment_cost(const fg_experiment *experiment, double response);

/* Predicts the response at the requested settings. */
fg_status fg_experiment_ask(fg_context *ctx, const fg_experiment_options *options,
                            fg_experiment *experiment);

/* Analyses everything before the surface. */
fg_status fg_experiment_fit(fg_context *ctx, const fg_table *runs,
                            const fg_experiment_options *options, fg_experiment *experiment);

/* Finds the factors that are not significant, and makes the experiment without them. */
fg_status fg_experiment_reduce(fg_context *ctx, const fg_table *runs,
                               const fg_experiment_options *options, fg_experiment *experiment);

/* Adds the half-spaces of the whole experiment's region. A factor that is left out gets the value
 * of its range that restricts the others least. */
void fg_experiment_add_constraints(const fg_experiment *whole, fg_experiment *experiment);

/* Adds "2*a + b <= 3" (real units) to the region as a half-space in the model's units. */
fg_status fg_experiment_constrain(fg_context *ctx, const fg_experiment *experiment,
                                  const char *text, fg_region *region);

/* Model row of a setting, averaged over the blocks. */
fg_status fg_experiment_row(fg_context *ctx, const fg_experiment *experiment, const double *setting,
                            double *row);

/* Writes the random error of a row's prediction as a sum over independent standard normal errors,
 * one per column: |direction| is the standard error. Not for restricted likelihood. Returns its
 * dof.
 */
double fg_experiment_direction(const fg_experiment *experiment, const double *row,
                               double *direction);

/* Sets the next combination of levels of the word factors that are no blocks; false after the last.
 */
bool fg_experiment_next_levels(const fg_experiment *experiment, double *setting);

/* Computes what makes intervals simultaneous over the region, of the model with all factors where
 * the runs chose this one out of it; then gives a prediction at a place of the surface its
 * simultaneous intervals. Outside the region of the runs they hold everywhere (Scheffé 1953). */
fg_status fg_experiment_simultaneous(fg_context *ctx, const fg_experiment *whole,
                                     fg_experiment *experiment);
void fg_experiment_widen(const fg_experiment *experiment, const double *x,
                         fg_prediction *prediction);

/* Predicts the response at a place of the surface, with simultaneous intervals; tests whether a
 * place is on the border. */
fg_status fg_experiment_predict_at(fg_context *ctx, const fg_experiment *experiment,
                                   const double *x, fg_prediction *prediction);
/* FG_ERR_USAGE: a subtracted effect is of the model's own factors, so the response at a setting
 * cannot be predicted. */
fg_status fg_experiment_check_subtracted(fg_context *ctx, const fg_experiment *e);
bool fg_experiment_on_border(const fg_region *region, const double *x);

/* Finds the best feasible setting, where steps are given. */
fg_status fg_experiment_round(fg_context *ctx, const fg_experiment_options *options,
                              fg_experiment *experiment);

#endif
