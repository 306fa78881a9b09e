/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fits of a whole set of effects: noise, shapes, cross-validation, uncertainties. */
#ifndef FG_TABLE_LOOP_FIT_H
#define FG_TABLE_LOOP_FIT_H

#include "table_loop/engine.h"

/* Chooses the noise with the largest residual likelihood. */
fg_status fg_engine_choose_noise(fg_context *ctx, const fg_engine_training *training,
                                 fg_engine_noise *noise);

/* Moves the shapes of the set to the smallest residual sum, one after the other, each between its
 * neighbours in the effect's start values. */
fg_status fg_engine_refine(fg_context *ctx, const fg_loop_problem *problem, const bool *keep,
                           fg_engine_noise noise, fg_engine_set *set);

/* Computes the whitened residual sum of a set's fit. */
fg_status fg_engine_residual_sum(fg_context *ctx, const fg_loop_problem *problem, const bool *keep,
                                 fg_engine_noise noise, const fg_engine_set *set, double *rss);

/* Computes residuals of the rows kept, each predicted without its own fold of groups; n numbers. */
fg_status fg_engine_cross_validate(fg_context *ctx, const fg_loop_problem *problem,
                                   const bool *keep, const fg_engine_set *set,
                                   fg_engine_noise noise, double *residual);

/* Computes the gain in whitened squared error of `after` over `before`, summed, and its standard
 * error from the groups. */
fg_status fg_engine_cross_validated_gain(fg_context *ctx, const fg_loop_problem *problem,
                                         const bool *keep, const fg_engine_set *before,
                                         const fg_engine_set *after, fg_engine_noise noise,
                                         double *gain, double *standard_error);

/* Fits on the rows kept and predicts all: residual of every row of the problem, and the set's
 * contribution (either may be NULL). `sd` is of one row. The noise is the caller's, or chosen by
 * the data. */
fg_status fg_engine_fit_set(fg_context *ctx, const fg_loop_problem *problem, const bool *keep,
                            const fg_engine_set *set, bool choose, fg_engine_noise *noise,
                            double *residual, double *effect, double *sd);

/* Copies what a fit says of a claim: columns, shape, coefficients, amplitude, the noise's value. */
void fg_engine_claim_take_fit(fg_loop_claim *claim, const fg_loop_claim *fit);

/* Fits coefficients, amplitudes and uncertainties of the set's claims (one each, in order; the
 * curve at `curve` is left out) and of the declared parameters. */
fg_status fg_engine_fit_claims(fg_context *ctx, const fg_loop_problem *problem, const bool *keep,
                               const fg_engine_set *set, fg_engine_noise noise,
                               fg_loop_claim *claim, double *parameter, double *parameter_u);

#endif
