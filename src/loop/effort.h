/* What a search costs, estimated before it starts. */
#ifndef FG_LOOP_EFFORT_H
#define FG_LOOP_EFFORT_H

#include "loop/engine.h"

typedef struct loop_effort {
  size_t rows, candidates;
  double seconds, bytes; /* of one core; at the worst: five effects are found */
} loop_effort;

void loop_effort_estimate(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                          size_t candidates, loop_effort *effort);
/* FG_ERR_DATA with the limit, the reason and the way out; a limit of 0 is none. */
fg_status loop_effort_check(fg_context *ctx, const loop_effort *effort, double minutes,
                            double mebibytes);

#endif
