/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Residuals of the null model, each along its row's own error. */
#ifndef FG_TABLE_LOOP_NULL_RESIDUAL_H
#define FG_TABLE_LOOP_NULL_RESIDUAL_H

#include "table_loop/engine.h"

/* Computes the null's residual of a response along every row's own error, over its sd: whitened
 * rows of a group share their errors, and in another order a tail would be shrunk by the part that
 * its neighbours had. `white` has room for 3 n: the residuals, the shares of own error, and one
 * row. */
void fg_engine_null_residual(const fg_engine_training *training, fg_engine_noise noise,
                             const fg_engine_span *null, const double *y, double *white);

#endif
