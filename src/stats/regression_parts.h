/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts of a regression that are computed after the least-squares solution. */
#ifndef FG_STATS_REGRESSION_PARTS_H
#define FG_STATS_REGRESSION_PARTS_H

#include "foilgauge/regression.h"
#include "stats/orthogonal.h"

/* Input of the parts: the problem and its solution. */
typedef struct fg_fit {
  const fg_model *model;
  const fg_extended *response;
  const double *weights; /* NULL: all 1 */
  fg_orthogonal solution;
} fg_fit;

/* Share of column `other` in the mean of `column` over the levels of the words that `other` has
 * besides: a product of 1 / levels; 0: `other` is no such product. The first levels, which have no
 * column, count in the mean with 0. */
double fg_model_share_in_mean(const fg_model *model, size_t column, size_t other);

fg_status fg_regression_note(fg_context *ctx, fg_regression *regression, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

fg_status fg_regression_coefficients(fg_context *ctx, const fg_fit *fit, fg_regression *regression);
fg_status fg_regression_aliases(fg_context *ctx, const fg_fit *fit, fg_regression *regression);
/* Notes the combinations of factors' levels without runs, where an interaction lacks numbers. */
fg_status fg_regression_empty_cells(fg_context *ctx, const fg_model *model,
                                    fg_regression *regression);
fg_status fg_regression_condition(fg_context *ctx, const fg_fit *fit, fg_regression *regression);
fg_status fg_regression_anova(fg_context *ctx, const fg_fit *fit, fg_regression *regression);
fg_status fg_regression_lack_of_fit(fg_context *ctx, const fg_fit *fit,
                                    const fg_regression_options *options,
                                    fg_regression *regression);
fg_status fg_regression_diagnostics(fg_context *ctx, const fg_fit *fit, fg_regression *regression);

#endif
