/* One step of the loop: everything scored and judged beside what is accepted so far. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "loop/step.h"

/* Draws of a simulated null: p-values down to 1 / (draws + 1). A step that is not judged needs
 * none, but the bench's choice of noise a few. */
enum { DRAWS_SMALL = 1999, DRAWS = 999, DRAWS_UNJUDGED = 20 };

static fg_status fill_stands(fg_context *ctx, const fg_engine_run *run, fg_engine_step *step) {
  FG_TRY(fg_memory_allocate(ctx, run->candidates + 2, sizeof *step->stand, (void **)&step->stand));
  for (size_t c = 0; c < run->candidates; c++) {
    const fg_engine_score *score = &step->judgement.score[c];
    fg_engine_stand *stand = &step->stand[step->stands++];
    stand->candidate = run->candidate[c];
    stand->z = score->z;
    memcpy(stand->shape, step->bench.shape[score->version], sizeof stand->shape);
  }
  for (size_t k = 0; k < 2; k++) {
    if (!step->lone[k].known || !(step->lone[k].ratio < 1)) continue;
    fg_engine_stand *stand = &step->stand[step->stands++];
    stand->candidate = step->lone[k].candidate;
    stand->z = fg_engine_deviate(step->lone[k].ratio, 1, (double)step->bench.freedom);
  }
  return FG_OK;
}

fg_status fg_engine_step_open(fg_context *ctx, fg_engine_run *run, const fg_engine_set *set,
                              bool judged, fg_engine_step *step) {
  size_t draws = run->options.simulations;
  fg_status status = FG_OK;
  memset(step, 0, sizeof *step);
  FG_TRY_EXIT(fg_engine_training_build(ctx, run->problem, run->train, set, &step->training));
  if (!draws) draws = step->training.n <= FG_ENGINE_SMALL_ROWS ? DRAWS_SMALL : DRAWS;
  if (!judged) draws = DRAWS_UNJUDGED;
  FG_TRY_EXIT(
      fg_engine_bench_build(ctx, &step->training, run->candidate, run->candidates, &step->bench));
  step->bench.watch =
      (fg_engine_watch){run->options.progress, run->options.progress_user, run->result->claims};
  fg_engine_null null = {draws, run->options.seed, run->options.accept_p};
  FG_TRY_EXIT(fg_engine_permute(ctx, &step->bench, &null, &step->judgement));
  fg_engine_noise noise = step->bench.noise[step->judgement.null_noise];
  null.seed++;
  if (judged) FG_TRY_EXIT(fg_engine_judge_lone(ctx, &step->training, noise, &null, step->lone));
  FG_TRY_EXIT(fill_stands(ctx, run, step));
exit:
  if (status != FG_OK) fg_engine_step_close(step);
  return status;
}

void fg_engine_step_close(fg_engine_step *step) {
  fg_engine_judgement_free(&step->judgement);
  fg_engine_bench_free(&step->bench);
  fg_engine_training_free(&step->training);
  free(step->stand);
  step->stand = NULL;
}

double fg_engine_total_p(const fg_engine_judgement *judgement, size_t c) {
  double simulated = judgement->p_simulated[c];
  return isfinite(simulated) ? fmax(simulated, judgement->p_flip[c]) : judgement->p_flip[c];
}

void fg_engine_set_remove(fg_engine_set *set, size_t member) {
  for (size_t k = member + 1; k < set->count; k++) {
    set->candidate[k - 1] = set->candidate[k];
    memcpy(set->shape[k - 1], set->shape[k], sizeof set->shape[k]);
  }
  set->count--;
}

void fg_engine_drop_claim(fg_engine_run *run, size_t m) {
  fg_loop_result *result = run->result;
  fg_engine_set_remove(&run->set, m);
  for (size_t k = m + 1; k < result->claims; k++)
    result->claim[k - 1] = result->claim[k];
  result->claims--;
}

fg_engine_noise_pair fg_engine_step_noises(const fg_engine_step *step) {
  const fg_engine_judgement *judgement = &step->judgement;
  return (fg_engine_noise_pair){
      {step->bench.noise[judgement->cautious_noise], step->bench.noise[judgement->best_noise]}};
}
