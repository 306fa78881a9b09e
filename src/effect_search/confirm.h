/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Confirmation of an effect from disc to disc. */
#ifndef FG_EFFECT_SEARCH_CONFIRM_H
#define FG_EFFECT_SEARCH_CONFIRM_H

#include "effect/set.h"

/* Says in `confirmed` (above 0: it is) how well discs confirm an effect of the set that left these
 * residuals, and gives its numbers the uncertainty that discs show. */
fg_status fg_search_confirm(fg_context *ctx, const fg_edge_fit *edge_fit, fg_effect_found *effect,
                            const double *residual_um, double *confirmed);

#endif
