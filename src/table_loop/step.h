/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of one step of a run. */
#ifndef FG_TABLE_LOOP_STEP_H
#define FG_TABLE_LOOP_STEP_H

#include "table_loop/run.h"

/* Training set, score workspace and scores of the null with everything accepted so far. */
typedef struct fg_engine_step {
  fg_engine_training training;
  fg_score_workspace workspace;
  fg_engine_judgement judgement;
  fg_engine_outlier outlier;
  fg_engine_stand *stand; /* candidates; outlier rows; the exchange */
  size_t stands;
} fg_engine_step;

/* Returns the index of the first stand of outlier rows. */
size_t fg_engine_wrong_rows(const fg_engine_run *run);
size_t fg_engine_exchanged_rows(const fg_engine_run *run);

fg_status fg_engine_step_open(fg_context *ctx, fg_engine_run *run, const fg_engine_set *set,
                              bool judged, fg_engine_step *step);
void fg_engine_step_close(fg_engine_step *step);

/* Returns true when a candidate explains nearly as much as another with no more numbers. */
bool fg_engine_nearly(const fg_engine_run *run, const fg_engine_step *step, size_t candidate,
                      size_t other);
/* P-value of a stand over everything that the step looked for. */
double fg_engine_stand_p(const fg_engine_run *run, const fg_engine_step *step, size_t stand);

bool fg_engine_set_holds(const fg_engine_set *set, const fg_loop_candidate *candidate);
/* Copies the run's set with one more effect; its curve, if any, stays last. */
void fg_engine_set_extend(const fg_engine_run *run, const fg_engine_stand *stand,
                          fg_engine_set *set);
void fg_engine_set_remove(fg_engine_set *set, size_t member);
/* Removes a claim from the run's set and its result. */
void fg_engine_drop_claim(fg_engine_run *run, size_t claim);

#endif
