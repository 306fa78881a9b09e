/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Adding an accepted effect to a run's result and set. */
#ifndef FG_TABLE_LOOP_ACCEPT_CLAIM_H
#define FG_TABLE_LOOP_ACCEPT_CLAIM_H

#include "table_loop/step.h"

/* Fills candidate, name and p-value of a stand; the alias class stays empty. */
void fg_engine_describe_claim(const fg_engine_run *run, const fg_engine_step *step, size_t stand,
                              fg_loop_claim *claim);
/* Accepts a claim as tied when it has an alias class, else as found. */
void fg_engine_take(fg_engine_run *run, const fg_engine_stand *stand, fg_loop_claim *claim);
/* Accepts correlation or unequal spread: a finding about the noise, which every later step uses. It
 * may be tied with an effect of the mean: `p_value` is that effect's, or 1. */
/* Returns true for a candidate of the noise that is not in the set, nor excluded by one that is:
 * one column's levels are random, and no correlation stands beside them. */
bool fg_engine_may_join_noise(const fg_engine_run *run, size_t candidate);
/* Returns true for fixed levels of a column whose random levels may be claimed instead. */
bool fg_engine_is_random_factor(const fg_engine_run *run, size_t candidate);

fg_status fg_engine_take_noise(fg_context *ctx, fg_engine_run *run, const fg_engine_step *step,
                               size_t winner, double p_value, bool *accepted);

#endif
