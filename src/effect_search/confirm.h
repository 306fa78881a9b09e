/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Confirmation of an effect from disc to disc. */
#ifndef FG_EFFECT_SEARCH_CONFIRM_H
#define FG_EFFECT_SEARCH_CONFIRM_H

#include "effect/set.h"

/* Tests an effect of the set that left these residuals from disc to disc. `confirmed` is positive
 * when the discs confirm it, and larger the better they do. The effect's numbers get the
 * uncertainty that the scatter between discs shows. */
fg_status fg_search_confirm(fg_context *ctx, const fg_edge_fit *edge_fit, fg_effect_found *effect,
                            const double *residual_um, double *confirmed);

#endif
