/* The engine's own units: the response and each declared column divided by a power of two, so that
 * the largest is about 1 and no square over- or underflows. Powers of two round nothing: what is
 * found does not depend on the unit that the data came in. */
#ifndef FG_LOOP_UNITS_H
#define FG_LOOP_UNITS_H

#include "foilgauge/loop.h"

typedef struct loop_units {
  fg_loop_problem problem; /* in the engine's units; the rest is the caller's */
  int response;            /* one engine's unit is 2^response of the caller's */
  int *column;             /* parameters: the same of the declared columns */
} loop_units;

/* FG_ERR_DATA: a response or a declared column that is not finite. Free with loop_units_close. */
fg_status loop_units_open(fg_context *ctx, const fg_loop_problem *problem, loop_units *units);
/* Every number of a result back in the caller's units. */
void loop_units_restore(const loop_units *units, fg_loop_result *result);
void loop_units_close(loop_units *units);

#endif
