/* Who else could take the winner's place. Every test is made at two noise models, and the larger p
 * counts: too much correlation flatters columns without order, too little those with one. */
#ifndef FG_LOOP_ALIAS_H
#define FG_LOOP_ALIAS_H

#include "loop/engine.h"

typedef struct loop_stand {
  fg_loop_candidate candidate;
  double shape[FG_LOOP_SHAPES];
  double z;
} loop_stand;

/* A simpler candidate in the winner's span beside which the winner explains nothing more, or the
 * winner itself: index into `stand`. */
fg_status loop_simplify(fg_context *ctx, const loop_frame *frame, const loop_noise noise[2],
                        const loop_stand *stand, size_t count, size_t winner, size_t *simplest);

/* Probability, by F, of what `other` explains beside `base`, were there nothing; 1 where it lies in
 * base's span. */
fg_status loop_beside(fg_context *ctx, const loop_frame *frame, const loop_noise noise[2],
                      const loop_stand *base, const loop_stand *other, double *p_value);

/* Fills the claim's class from `stand` (its own candidate is skipped). */
fg_status loop_alias_class(fg_context *ctx, const loop_frame *frame, const loop_noise noise[2],
                           const loop_stand *stand, size_t count, const loop_stand *winner,
                           fg_loop_claim *claim);

#endif
