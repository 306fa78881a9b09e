/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cycles: several periods that are orders of one base are one effect. */
#ifndef FG_TABLE_LOOP_CYCLES_H
#define FG_TABLE_LOOP_CYCLES_H

#include "table_loop/step.h"

/* Returns true for an effect over the order, which any table has, false for one over a column. */
bool fg_engine_is_over_order(const fg_loop_problem *problem, const fg_loop_candidate *candidate);
/* Returns true for a cycle of several orders. */
bool fg_engine_has_orders(const fg_loop_candidate *candidate);
/* Gives a stand of a cycle the other cycles over its column that show most beside it, as orders of
 * one base; any other stand is copied. */
void fg_engine_cycle_with_others(const fg_engine_run *run, const fg_engine_step *step, size_t stand,
                                 fg_engine_stand *whole);
/* Replaces a cycle of any period by an order of the base that is known, where that explains as
 * much; and one over the order by one over a column. */
fg_status fg_engine_prefer_base(fg_context *ctx, const fg_engine_run *run,
                                const fg_engine_step *step, fg_engine_noise noise, size_t *winner);
/* Makes one claim of claims whose periods are orders of one base; refines its base. */
fg_status fg_engine_join_cycles(fg_context *ctx, fg_engine_run *run);

#endif
