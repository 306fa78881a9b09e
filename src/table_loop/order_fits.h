/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Amplitudes and phases of the orders of a cycle. */
#ifndef FG_TABLE_LOOP_ORDER_FITS_H
#define FG_TABLE_LOOP_ORDER_FITS_H

#include "table_loop/engine.h"

/* Columns of a fit that belong to a cycle: sine and cosine of its first order; the slope by its
 * base period, if that was moved. */
typedef struct fg_engine_cycle_place {
  size_t first, slope;
  bool moved;
  double variance;
} fg_engine_cycle_place;

/* `claim` has candidate, shape and coefficients. */
void fg_engine_describe_orders(const fg_loop_problem *problem, const fg_engine_fit *wide,
                               const fg_engine_cycle_place *place, fg_loop_claim *claim);

#endif
