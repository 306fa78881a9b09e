/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Internal units of the engine: the response and each declared column are divided by a power of
 * two, so that the largest is about 1 and no square over- or underflows. Powers of two round
 * nothing, so the result does not depend on the data's unit. */
#ifndef FG_TABLE_LOOP_UNITS_H
#define FG_TABLE_LOOP_UNITS_H

#include "foilgauge/loop.h"

typedef struct fg_engine_units {
  fg_loop_problem problem; /* in the engine's units; shared members are the caller's */
  int response;            /* one engine's unit is 2^response of the caller's */
  int *column;             /* parameters: exponents of the declared columns */
} fg_engine_units;

/* FG_ERR_DATA: a response or a declared column that is not finite. Free with fg_engine_units_close.
 */
fg_status fg_engine_units_open(fg_context *ctx, const fg_loop_problem *problem,
                               fg_engine_units *units);
/* Every number of a result back in the caller's units. */
void fg_engine_units_restore(const fg_engine_units *units, fg_loop_result *result);
void fg_engine_units_close(fg_engine_units *units);

#endif
