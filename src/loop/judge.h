/* P-values of all candidates of a bench, and of lone rows. */
#ifndef FG_LOOP_JUDGE_H
#define FG_LOOP_JUDGE_H

#include "loop/engine.h"

/* Simulated p-values are multiplied by this: listed effects, lone rows and curves are three
 * families that are judged one after the other. */
enum { LOOP_FAMILIES = 3 };

typedef struct loop_judgement {
  size_t candidates;
  loop_score *score;     /* candidates */
  double *p_flip;        /* candidates */
  double *p_simulated;   /* NaN in large frames */
  double *f_critical;    /* F ratio that would just pass, as max-T asks; infinity: none does */
  size_t null_noise;     /* best noise of the null, index into the bench's */
  double smallest_p;     /* of flips */
} loop_judgement;

fg_status loop_judge(fg_context *ctx, loop_bench *bench, size_t draws, uint64_t seed,
                     loop_judgement *judgement);
void loop_judgement_free(loop_judgement *judgement);

/* The best outlier and the best exchange of two rows. */
typedef struct loop_lone {
  fg_loop_candidate candidate;
  bool known;           /* there is one */
  double ratio;         /* residual sum after / before */
  double p_value;       /* against heavy tails, families counted */
  double f_critical;    /* as above, one freedom */
  double length;        /* mean |M W e|² of a row */
} loop_lone;

fg_status loop_judge_lone(fg_context *ctx, const loop_frame *frame, loop_noise noise, size_t draws,
                          uint64_t seed, loop_lone lone[2]);

#endif
