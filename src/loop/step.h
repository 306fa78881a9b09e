/* One step of a run. */
#ifndef FG_LOOP_STEP_H
#define FG_LOOP_STEP_H

#include "loop/run.h"

/* The state of one step: training, bench, scores of the null with everything accepted. */
typedef struct fg_engine_step {
  fg_engine_training training;
  fg_engine_bench bench;
  fg_engine_judgement judgement;
  fg_engine_lone lone[2];
  fg_engine_stand *stand; /* candidates and the two lone ones */
  size_t stands;
} fg_engine_step;

fg_status fg_engine_step_open(fg_context *ctx, fg_engine_run *run, const fg_engine_set *set,
                              bool judged, fg_engine_step *step);
void fg_engine_step_close(fg_engine_step *step);

/* Of a candidate in this step: the larger of flips and, where there were any, simulations. */
double fg_engine_total_p(const fg_engine_judgement *judgement, size_t candidate);

typedef struct fg_engine_noise_pair {
  fg_engine_noise at[2];
} fg_engine_noise_pair;

/* The cautious noise of the step and the best. */
fg_engine_noise_pair fg_engine_step_noises(const fg_engine_step *step);

void fg_engine_set_remove(fg_engine_set *set, size_t member);
/* Takes a claim out of the run's set and its result. */
void fg_engine_drop_claim(fg_engine_run *run, size_t claim);

#endif
