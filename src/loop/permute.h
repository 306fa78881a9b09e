/* P-values of all candidates of a bench, and of lone rows. */
#ifndef FG_LOOP_PERMUTE_H
#define FG_LOOP_PERMUTE_H

#include "loop/engine.h"

/* Simulated p-values are multiplied by this: listed effects, outliers, exchanges and curves are
 * four families judged one after the other, and there are second looks after every claim. */
enum { FG_ENGINE_FAMILIES = 5 };

typedef struct fg_engine_judgement {
  size_t candidates;
  fg_engine_score *score; /* candidates */
  double *p_flip;         /* candidates */
  double *p_simulated;    /* NaN where rows are many */
  double *f_critical;     /* F ratio that would just pass, as max-T asks; infinity: none does */
  double *z_critical;     /* deviate that would just pass; simulated */
  size_t null_noise;      /* best noise of the null, index into the bench's */
  size_t best_noise;      /* best noise with the best candidate */
  size_t cautious_noise;  /* the strongest correlation that the data do not rule out */
  double smallest_p;      /* of flips */
} fg_engine_judgement;

/* How the null is drawn, and the level at which an effect would be accepted. */
typedef struct fg_engine_null {
  size_t draws;
  uint64_t seed;
  double accept_p;
} fg_engine_null;

fg_status fg_engine_permute(fg_context *ctx, fg_engine_bench *bench, const fg_engine_null *null,
                            fg_engine_judgement *judgement);
void fg_engine_judgement_free(fg_engine_judgement *judgement);

/* Few rows: for every candidate the amplitude (half range; of unit variance of the rows' own
 * noise) that passes max-T in four draws of five; NaN where none does. Curves included. */
fg_status fg_engine_smallest_amplitudes(fg_context *ctx, const fg_engine_bench *bench,
                                        const fg_engine_judgement *judgement, uint64_t seed,
                                        double *amplitude);

/* The best outlier and the best exchange of two rows. */
typedef struct fg_engine_lone {
  fg_loop_candidate candidate;
  bool known;        /* there is one */
  double ratio;      /* residual sum after / before */
  double p_value;    /* against heavy tails, families counted */
  double f_critical; /* as above, one freedom */
  double length;     /* mean |M W e|² of a row */
} fg_engine_lone;

fg_status fg_engine_judge_lone(fg_context *ctx, const fg_engine_training *training,
                               fg_engine_noise noise, const fg_engine_null *null,
                               fg_engine_lone lone[2]);

#endif
