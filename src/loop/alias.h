/* Who else could take the winner's place. Every test is made at two noise models, and the larger p
 * counts: too much correlation flatters columns without order, too little those with one. */
#ifndef FG_LOOP_ALIAS_H
#define FG_LOOP_ALIAS_H

#include "loop/engine.h"

typedef struct fg_engine_stand {
  fg_loop_candidate candidate;
  double shape[FG_LOOP_SHAPES];
  double z;
} fg_engine_stand;

/* A simpler candidate in the winner's span beside which the winner explains nothing more, or the
 * winner itself: index into `stand`. */
fg_status fg_engine_simplify(fg_context *ctx, const fg_engine_training *training,
                             const fg_engine_noise noise[2], const fg_engine_stand *stand,
                             size_t count, size_t winner, size_t *simplest);

/* Probability, by F, of what `other` explains beside `base`, were there nothing; 1 where it lies in
 * base's span. */
fg_status fg_engine_beside(fg_context *ctx, const fg_engine_training *training,
                           const fg_engine_noise noise[2], const fg_engine_stand *base,
                           const fg_engine_stand *other, double *p_value);

/* Fills the claim's class from `stand` (its own candidate is skipped). */
fg_status fg_engine_alias_class(fg_context *ctx, const fg_engine_training *training,
                                const fg_engine_noise noise[2], const fg_engine_stand *stand,
                                size_t count, const fg_engine_stand *winner, fg_loop_claim *claim);

#endif
