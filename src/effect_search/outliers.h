/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows that speak of no effect lose their weight. */
#ifndef FG_EFFECT_SEARCH_OUTLIERS_H
#define FG_EFFECT_SEARCH_OUTLIERS_H

#include "effect/set.h"

/* Rows far outside what is left elsewhere are no effect of the scanner or the part: an arc that
 * reached into its fillet, a burr. Should there be many, they are no outliers. With `own_noise`
 * residuals are taken in units of their rows' noise. */
fg_status fg_search_drop_outliers(fg_context *ctx, fg_edge_fit *edge_fit, bool own_noise,
                                  const double *residual_um);

/* A run's last rows may reach into a fillet; they leave the line of those before them as no others
 * do. */
fg_status fg_search_drop_ends(fg_context *ctx, fg_edge_fit *edge_fit, const double *residual_um);

/* Rows that lie across a step hold some of both sides: those nearer to it than this. */
void fg_search_drop_across_steps(fg_edge_fit *edge_fit, const fg_effect_set *set, double half_mm);

#endif
