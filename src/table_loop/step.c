/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One step of the loop: all candidates scored and assessed beside the effects accepted so far. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "effect/table_effects.h"
#include "table_loop/step.h"

/* Share of another candidate's explained sum from which one explains nearly as much. */
#define NEARLY 0.8

/* The null is drawn from the same numbers in every run: no verdict depends on a seed. */
#define FIXED_SEED 1

/* Draws of the null; fewer beside correlation, where each costs a factor of the number of noise
 * models, and where a step is not assessed. */
enum { DRAWS = 1999, DRAWS_CORRELATED = 799, DRAWS_UNJUDGED = 399 };

size_t fg_engine_wrong_rows(const fg_engine_run *run) {
  return run->candidates;
}

size_t fg_engine_exchanged_rows(const fg_engine_run *run) {
  return run->candidates + 1;
}

static fg_status fill_stands(fg_context *ctx, const fg_engine_run *run, fg_engine_step *step) {
  const fg_engine_judgement *judgement = &step->judgement;
  step->stands = run->candidates + 2;
  FG_TRY(fg_memory_allocate(ctx, step->stands, sizeof *step->stand, (void **)&step->stand));
  for (size_t c = 0; c < run->candidates; c++) {
    fg_engine_stand *stand = &step->stand[c];
    stand->candidate = run->candidate[c];
    stand->z = judgement->z[c];
    if (c >= run->means || !isfinite(stand->z)) continue;
    stand->share = 1 - judgement->score[c].ratio;
    memcpy(stand->shape, step->workspace.shape[judgement->score[c].version], sizeof stand->shape);
  }
  fg_engine_stand *wrong = &step->stand[fg_engine_wrong_rows(run)];
  fg_engine_stand *exchange = &step->stand[fg_engine_exchanged_rows(run)];
  wrong->z = exchange->z = NAN;
  wrong->candidate = step->outlier.candidate;
  exchange->candidate.effect = &fg_loop_outlier_effects()[1];
  if (step->outlier.known && step->outlier.ratio < 1)
    wrong->z = fg_engine_deviate(step->outlier.ratio, (double)step->outlier.candidate.rows,
                                 (double)step->workspace.dof);
  if (!judgement->has_exchange) return FG_OK;
  exchange->z = judgement->z[run->candidates];
  exchange->candidate.rows = 2;
  for (size_t k = 0; k < 2; k++)
    exchange->candidate.row[k] = step->training.row[judgement->exchanged[k]];
  return FG_OK;
}

fg_status fg_engine_step_open(fg_context *ctx, fg_engine_run *run, const fg_engine_set *set,
                              bool judged, fg_engine_step *step) {
  size_t draws = run->options.simulations;
  fg_status status = FG_OK;
  memset(step, 0, sizeof *step);
  FG_TRY_EXIT(fg_engine_training_build(ctx, run->problem, run->train, set, &step->training));
  if (!draws) draws = step->training.serial ? DRAWS_CORRELATED : DRAWS;
  if (!judged && draws > DRAWS_UNJUDGED) draws = DRAWS_UNJUDGED;
  step->workspace.watch =
      (fg_engine_watch){run->options.progress, run->options.progress_user, run->result->claims};
  FG_TRY_EXIT(
      fg_score_workspace_build(ctx, &step->training, run->candidate, run->means, &step->workspace));
  const double *share = run->share;
  const fg_engine_null null = {draws, FIXED_SEED, run->options.accept_p, share};
  const fg_engine_level level = {null.accept_p, share[FG_LOOP_KIND_ROWS]};
  FG_TRY_EXIT(fg_engine_judge(ctx, &step->workspace, run->candidate + run->means,
                              run->candidates - run->means, &null, &step->judgement));
  fg_engine_noise noise = step->workspace.noise[step->judgement.noise];
  if (judged)
    FG_TRY_EXIT(fg_engine_assess_outlier(ctx, &step->training, noise,
                                         &step->workspace.null[step->judgement.noise], level,
                                         &step->outlier));
  FG_TRY_EXIT(fill_stands(ctx, run, step));
exit:
  if (status != FG_OK) fg_engine_step_close(step);
  return status;
}

void fg_engine_step_close(fg_engine_step *step) {
  fg_engine_judgement_free(&step->judgement);
  fg_score_workspace_free(&step->workspace);
  fg_engine_training_free(&step->training);
  free(step->stand);
  step->stand = NULL;
}

double fg_engine_stand_p(const fg_engine_run *run, const fg_engine_step *step, size_t stand) {
  if (stand == fg_engine_wrong_rows(run)) return step->outlier.p_value;
  return step->judgement.p[stand < run->candidates ? stand : run->candidates];
}

bool fg_engine_nearly(const fg_engine_run *run, const fg_engine_step *step, size_t c,
                      size_t other) {
  const fg_engine_score *score = step->judgement.score;
  const fg_engine_version *version = step->workspace.version;
  if (c >= run->means) return false;
  if (fg_engine_version_dof(&step->workspace, &version[score[c].version]) >
      fg_engine_version_dof(&step->workspace, &version[score[other].version]))
    return false;
  return 1 - score[c].ratio > NEARLY * (1 - score[other].ratio);
}

bool fg_engine_set_holds(const fg_engine_set *set, const fg_loop_candidate *candidate) {
  for (size_t m = 0; m < set->count; m++)
    if (fg_engine_same_candidate(&set->candidate[m], candidate)) return true;
  return false;
}

void fg_engine_set_extend(const fg_engine_run *run, const fg_engine_stand *stand,
                          fg_engine_set *set) {
  *set = run->set;
  size_t at = set->count++;
  if (run->has_curve) { /* the curve stays last */
    set->candidate[at] = set->candidate[at - 1];
    memcpy(set->shape[at], set->shape[at - 1], sizeof set->shape[0]);
    at--;
  }
  set->candidate[at] = stand->candidate;
  memcpy(set->shape[at], stand->shape, sizeof stand->shape);
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
