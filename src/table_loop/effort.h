/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time and memory of a search, estimated before it starts. */
#ifndef FG_TABLE_LOOP_EFFORT_H
#define FG_TABLE_LOOP_EFFORT_H

#include "table_loop/engine.h"

typedef struct fg_engine_effort {
  size_t rows, candidates;
  double seconds, bytes; /* of one core, in the worst case of five effects found */
} fg_engine_effort;

void fg_engine_effort_estimate(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                               size_t candidates, fg_engine_effort *effort);
/* FG_ERR_DATA with the limit, the reason and the remedy; a limit of 0 means unlimited. */
fg_status fg_engine_effort_check(fg_context *ctx, const fg_engine_effort *effort, double minutes,
                                 double mebibytes);

#endif
