/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scores of the data for tables of many rows. */
#ifndef FG_TABLE_LOOP_SCORE_MANY_H
#define FG_TABLE_LOOP_SCORE_MANY_H

#include "table_loop/engine.h"

/* Fills the workspace's versions and their gains at its one noise. For a candidate with many start
 * values, the best is found over binned sums and scored on all rows; the others get rank 0.
 * `residual`: of the response beside the null, whitened. */
fg_status fg_score_workspace_fill_many(fg_context *ctx, fg_score_workspace *workspace,
                                       const double *residual);

#endif
