/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Alias class of a winner: candidates that explain the data as well, at the noise found beside the
 * winner. */
#ifndef FG_TABLE_LOOP_ALIAS_H
#define FG_TABLE_LOOP_ALIAS_H

#include "table_loop/engine.h"

/* P-value below which the winner's gain beside a rival is significant. */
#define FG_ENGINE_SHOWS 0.002

typedef struct fg_engine_stand {
  fg_loop_candidate candidate;
  double shape[FG_LOOP_SHAPES];
  double z;
  double share; /* of the null's residual sum that it explains; 0: unknown */
} fg_engine_stand;

/* Finds a simpler candidate in the winner's span beside which the winner gains nothing, or the
 * winner itself; index into `stand`. */
fg_status fg_engine_simplify(fg_context *ctx, const fg_engine_training *training,
                             fg_engine_noise noise, const fg_engine_stand *stand, size_t count,
                             size_t winner, size_t *simplest);

/* P-value, by F, of the gain of `other` beside `base`; 1 where it lies in base's span. */
fg_status fg_engine_beside(fg_context *ctx, const fg_engine_training *training,
                           fg_engine_noise noise, const fg_engine_stand *base,
                           const fg_engine_stand *other, double *p_value);

/* Fills the claim's class from `stand` (its own candidate is skipped). */
fg_status fg_engine_alias_class(fg_context *ctx, const fg_engine_training *training,
                                fg_engine_noise noise, const fg_engine_stand *stand, size_t count,
                                const fg_engine_stand *winner, fg_loop_claim *claim);

/* Adds a member to a claim's class. */
void fg_engine_add_alias(const fg_loop_problem *problem, const fg_loop_candidate *rival,
                         double correlation, double loss, fg_loop_claim *claim);

#endif
