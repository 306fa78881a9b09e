/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Removal of rows that carry no information on effects. */
#ifndef FG_EFFECT_SEARCH_OUTLIERS_H
#define FG_EFFECT_SEARCH_OUTLIERS_H

#include "effect/set.h"

/* Drops rows far outside the scatter of the others: an arc that reached into its fillet, or a burr,
 * is no effect of scanner or part. When they are many, they are no outliers and stay. With
 * `own_noise` residuals are compared in units of their rows' noise. */
fg_status fg_search_drop_outliers(fg_context *ctx, fg_edge_fit *edge_fit, bool own_noise,
                                  const double *residual_um);

/* Drops the last rows of a run where they leave the line of those before them by more than others
 * do: they reach into a fillet. */
fg_status fg_search_drop_ends(fg_context *ctx, fg_edge_fit *edge_fit, const double *residual_um);

/* Drops rows within `half_mm` of a step: they average both of its sides. */
void fg_search_drop_across_steps(fg_edge_fit *edge_fit, const fg_effect_set *set, double half_mm);

#endif
