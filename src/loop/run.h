/* One run of the loop: what is accepted so far, and the steps. */
#ifndef FG_LOOP_RUN_H
#define FG_LOOP_RUN_H

#include "loop/alias.h"
#include "loop/fit.h"
#include "loop/judge.h"
#include "loop/units.h"

typedef struct loop_run {
  const fg_loop_problem *problem; /* in the engine's units */
  const loop_units *units;
  fg_loop_options options;
  fg_loop_result *result;
  bool *train;
  fg_loop_candidate *candidate; /* listed effects first, then curves */
  size_t candidates;
  loop_set set; /* claims in the order of result->claim; the curve, if any, last */
  bool has_curve;
  double curve_p;
  size_t curve_at; /* coordinate */
  loop_noise noise;
  double sd; /* of the null at this step, whitened rows */
} loop_run;

/* The state of one step: frame, bench, scores of the null with everything accepted. */
typedef struct loop_step {
  loop_frame frame;
  loop_bench bench;
  loop_judgement judgement;
  loop_lone lone[2];
  loop_stand *stand; /* candidates and the two lone ones */
  size_t stands;
} loop_step;

fg_status loop_step_open(fg_context *ctx, loop_run *run, const loop_set *set, bool judged,
                         loop_step *step);
void loop_step_close(loop_step *step);

/* Tries to accept one effect; *accepted says whether there was one. */
fg_status loop_accept_one(fg_context *ctx, loop_run *run, bool *accepted, bool *last);
fg_status loop_swap(fg_context *ctx, loop_run *run);
fg_status loop_list_rejected(fg_context *ctx, loop_run *run);
fg_status loop_advise(fg_context *ctx, loop_run *run);
fg_status loop_finish(fg_context *ctx, loop_run *run);
fg_status loop_note(fg_context *ctx, fg_loop_result *result, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
