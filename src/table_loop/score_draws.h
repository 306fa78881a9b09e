/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts of scoring that the data and the draws have in common. */
#ifndef FG_TABLE_LOOP_SCORE_DRAWS_H
#define FG_TABLE_LOOP_SCORE_DRAWS_H

#include "table_loop/engine.h"

/* Residual sums at one noise model. */
typedef struct fg_score_sums {
  double rss, between; /* without any candidate: of rows, and of differences between groups */
} fg_score_sums;

void fg_score_clear(size_t count, fg_engine_score *score);
/* Stores the version's score at noise model `noise` if it is the candidate's best; `gain` is its
 * reduction of the residual sum. */
void fg_score_keep_version(const fg_score_workspace *workspace, size_t version, size_t noise,
                           fg_score_sums sums, double gain, fg_engine_score *score);
/* Makes deviates of the best versions; `null` is the weighted residual sum without a candidate. */
void fg_score_finish(const fg_score_workspace *workspace, double null, fg_engine_score *score);

#endif
