/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scores of the data where rows are many. */
#ifndef FG_TABLE_LOOP_SCORE_MANY_H
#define FG_TABLE_LOOP_SCORE_MANY_H

#include "table_loop/engine.h"

/* Fills the bench's versions and their gains at its one noise. Of a candidate with many start
 * values the best is found over sums in steps of its coordinate, and scored on all rows; the others
 * have rank 0 from then on. `residual`: what the null leaves of the response, whitened. */
fg_status fg_score_workspace_fill_many(fg_context *ctx, fg_score_workspace *workspace,
                                       const double *residual);

#endif
