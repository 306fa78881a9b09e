/* With the others fitted, would another candidate serve better in a claim's place? */
#include <math.h>
#include <string.h>

#include "loop/step.h"

/* Beside the others a claim explains nothing any more below this deviate (one-sided 1 %), unless
 * another candidate reaches the second in its place. */
static const double OWN_Z = 2.33, BEST_Z = 4;

fg_status fg_engine_swap(fg_context *ctx, fg_engine_run *run) {
  for (size_t m = 0; m < run->result->claims && run->result->claims > 1; m++) {
    fg_engine_set others = run->set;
    fg_engine_step step;
    fg_loop_claim *claim = &run->result->claim[m];
    if (fg_engine_is_lone(&claim->candidate)) continue;
    fg_engine_set_remove(&others, m);
    FG_TRY(fg_engine_step_open(ctx, run, &others, false, &step));
    size_t best = 0, own = 0;
    for (size_t c = 0; c < run->candidates; c++) {
      if (fg_engine_same_candidate(&run->candidate[c], &claim->candidate)) own = c;
      if (fg_engine_is_curve(&run->candidate[c]) || !isfinite(step.stand[c].z)) continue;
      if (!isfinite(step.stand[best].z) || step.stand[c].z > step.stand[best].z) best = c;
    }
    fg_status status = FG_OK;
    if (!(step.stand[own].z > OWN_Z) && !(step.stand[best].z > BEST_Z)) {
      fg_engine_drop_claim(run, m--);
      fg_engine_step_close(&step);
      continue;
    }
    if (step.stand[best].z > step.stand[own].z)
      status = fg_engine_simplify(ctx, &step.training, fg_engine_step_noises(&step).at, step.stand,
                                  run->candidates, best, &best);
    if (status == FG_OK) {
      size_t chosen = step.stand[best].z > step.stand[own].z ? best : own;
      claim->candidate = run->candidate[chosen];
      claim->aliases = claim->aliases_unlisted = 0;
      fg_engine_candidate_name(run->problem, &claim->candidate, claim->name);
      run->set.candidate[m] = claim->candidate;
      memcpy(run->set.shape[m], step.stand[chosen].shape, sizeof run->set.shape[m]);
      status = fg_engine_alias_class(ctx, &step.training, fg_engine_step_noises(&step).at,
                                     step.stand, step.stands, &step.stand[chosen], claim);
      claim->verdict = claim->aliases ? FG_LOOP_TIED : FG_LOOP_FOUND;
    }
    fg_engine_step_close(&step);
    FG_TRY(status);
    FG_TRY(fg_engine_refine(ctx, run->problem, run->train, run->noise, &run->set));
  }
  return FG_OK;
}
