/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two values of one row, each in the other's column. */
#ifndef FG_TABLE_LOOP_EXCHANGE_COLUMNS_H
#define FG_TABLE_LOOP_EXCHANGE_COLUMNS_H

#include "table_loop/run.h"

/* Makes an exchange of two columns of a single wrong row where the row then fits the others as they
 * fit each other, and both values lie in their new column's range; else leaves it. */
fg_status fg_engine_find_exchanged_columns(fg_context *ctx, const fg_engine_run *run,
                                           fg_engine_noise noise, fg_loop_candidate *candidate);

#endif
