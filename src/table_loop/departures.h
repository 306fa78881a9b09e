/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Levels of a column that the declared model uses as a number: their departures from its terms.
 *
 * Levels hold every curve over their column, the declared one too. Which part of their sum is the
 * declared parameters' is then no question to the data, and a fit that leaves out a column splits
 * it by chance. Here the declared terms take all that they can (least squares over the rows), and
 * the effect is the remainder. */
#ifndef FG_TABLE_LOOP_DEPARTURES_H
#define FG_TABLE_LOOP_DEPARTURES_H

#include "table_loop/engine.h"

/* Rewrites coefficients and their covariance for all levels of the set; predictions stay. */
fg_status fg_engine_take_departures(fg_context *ctx, const fg_engine_training *training,
                                    const fg_engine_set *set, fg_engine_fit *fit);

#endif
