/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/serial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "table_loop/noise_scores.h"

size_t fg_engine_serial_candidate(const fg_engine_run *run) {
  size_t c = run->means;
  while (c < run->candidates && !fg_engine_is_serial(&run->candidate[c]))
    c++;
  for (size_t m = 0; m < run->set.count; m++)
    if (fg_engine_is_serial(&run->set.candidate[m]) || fg_engine_is_levels(&run->set.candidate[m]))
      return run->candidates;
  return c;
}

/* -2 log likelihood, restricted or not, at the noise that is best by the restricted one. */
static fg_status likelihood(fg_context *ctx, const fg_engine_run *run, const fg_engine_set *set,
                            bool correlated, bool restricted, double *value) {
  fg_engine_training training;
  fg_engine_fit fit;
  fg_engine_noise noise = {0};
  FG_TRY(fg_engine_training_build(ctx, run->problem, run->train, set, &training));
  training.serial = correlated;
  fg_status status = fg_engine_choose_noise(ctx, &training, &noise);
  if (status == FG_OK) status = fg_engine_least_squares(ctx, &training, noise, &fit);
  if (status == FG_OK) {
    double n = (double)training.n - (restricted ? (double)fit.rank : 0);
    *value = n * log(fmax(fit.rss, 1e-300)) + fg_engine_log_det(&training, noise);
    if (restricted) *value += fit.log_det;
    fg_engine_fit_free(&fit);
  }
  fg_engine_training_free(&training);
  return status;
}

fg_status fg_engine_serial_gain(fg_context *ctx, const fg_engine_run *run, const fg_engine_set *set,
                                double *gain) {
  double without, with;
  FG_TRY(likelihood(ctx, run, set, false, true, &without));
  FG_TRY(likelihood(ctx, run, set, true, true, &with));
  *gain = without - with;
  return FG_OK;
}

fg_status fg_engine_spread_beside(fg_context *ctx, const fg_engine_run *run,
                                  const fg_engine_set *set, const fg_loop_candidate *spread,
                                  double *z) {
  fg_engine_training training;
  fg_engine_noise_scores scores = {0};
  fg_engine_span null = {0};
  fg_engine_noise noise = {0};
  double *work = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_engine_training_build(ctx, run->problem, run->train, set, &training));
  FG_TRY_EXIT(fg_engine_choose_noise(ctx, &training, &noise));
  FG_TRY_EXIT(fg_engine_span_open(ctx, &training, noise, 0, &null));
  FG_TRY_EXIT(fg_engine_noise_scores_open(ctx, &training, noise, &null, spread, 1, &scores));
  FG_TRY_EXIT(fg_memory_allocate(ctx, training.n, 2 * sizeof *work, (void **)&work));
  fg_engine_noise_scores_of(&scores, training.y, work, z);
exit:
  free(work);
  fg_engine_noise_scores_close(&scores);
  fg_engine_span_close(&null);
  fg_engine_training_free(&training);
  return status;
}

fg_status fg_engine_weigh_serial(fg_context *ctx, fg_engine_run *run, const fg_engine_stand *effect,
                                 size_t candidate, double level, fg_engine_serial_word *word) {
  size_t serial = fg_engine_serial_candidate(run);
  double alone, beside;
  *word = FG_ENGINE_EFFECT;
  if (serial == run->candidates || run->set.count >= FG_LOOP_CLAIMS) return FG_OK;
  FG_TRY(fg_engine_serial_gain(ctx, run, &run->set, &alone));
  if (alone < 1) return FG_OK; /* nothing in the order to be mistaken */
  const fg_engine_stand correlation = {.candidate = run->candidate[serial]};
  fg_engine_set with, correlated;
  fg_engine_step step;
  fg_engine_set_extend(run, effect, &with);
  fg_engine_set_extend(run, &correlation, &correlated);
  FG_TRY(fg_engine_serial_gain(ctx, run, &with, &beside));
  FG_TRY(fg_engine_step_open(ctx, run, &correlated, false, &step));
  double p = fg_engine_stand_p(run, &step, candidate);
  fg_engine_step_close(&step);
  if (p < level) return FG_OK;
  *word = beside > FG_ENGINE_SERIAL_NEEDED ? FG_ENGINE_CORRELATION : FG_ENGINE_EITHER;
  return FG_OK;
}

fg_status fg_engine_likelier(fg_context *ctx, const fg_engine_run *run,
                             const fg_engine_stand *effect, bool *likelier) {
  double one, other;
  fg_engine_set with;
  fg_engine_set_extend(run, effect, &with);
  FG_TRY(likelihood(ctx, run, &with, false, false, &one));
  FG_TRY(likelihood(ctx, run, &run->set, true, false, &other));
  double columns = (double)fg_engine_candidate_columns(run->problem, &effect->candidate);
  double more = columns + (double)effect->candidate.effect->shapes - 1;
  *likelier = one + 2 * more < other;
  return FG_OK;
}
