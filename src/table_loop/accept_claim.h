/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Taking what passed into a run's result and set. */
#ifndef FG_TABLE_LOOP_ACCEPT_CLAIM_H
#define FG_TABLE_LOOP_ACCEPT_CLAIM_H

#include "table_loop/step.h"

/* Candidate, name and p-value of a stand; no class yet. */
void fg_engine_describe_claim(const fg_engine_run *run, const fg_engine_step *step, size_t stand,
                              fg_loop_claim *claim);
/* Tied where it has a class, found where not. */
void fg_engine_take(fg_engine_run *run, const fg_engine_stand *stand, fg_loop_claim *claim);
/* Correlation or unequal spread: a finding about the noise, which everything after it has. It may
 * show by an effect that it stands for: `p_value` is that one's, or 1. */
fg_status fg_engine_take_noise(fg_context *ctx, fg_engine_run *run, const fg_engine_step *step,
                               size_t winner, double p_value, bool *accepted);

#endif
