/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The loop on tables from end to end. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/text.h"
#include "effect/table_effects.h"
#include "table_loop/cycles.h"
#include "table_loop/effort.h"
#include "table_loop/response_scale.h"

static fg_status add_candidates(fg_context *ctx, fg_engine_run *run, const fg_loop_effect *effects,
                                size_t *capacity) {
  const fg_loop_problem *problem = run->problem;
  for (const fg_loop_effect *effect = effects; effect->id; effect++)
    for (size_t a = 0; a < problem->coordinates; a++)
      for (size_t b = effect->pair ? 0 : a; b < (effect->pair ? problem->coordinates : a + 1);
           b++) {
        if (!effect->accepts(problem, a, b)) continue;
        fg_loop_candidate candidate = {.effect = effect, .a = a, .b = b};
        size_t columns = fg_engine_candidate_columns(problem, &candidate);
        bool none =
            columns == 0 && effect->scatter != FG_LOOP_SERIAL && effect->scatter != FG_LOOP_LEVELS;
        if (none || columns > FG_LOOP_COLUMNS) continue;
        FG_TRY(fg_memory_reserve(ctx, run->candidates + 1, sizeof *run->candidate, capacity,
                                 (void **)&run->candidate));
        run->candidate[run->candidates++] = candidate;
      }
  return FG_OK;
}

static fg_status open_run(fg_context *ctx, const fg_engine_units *units,
                          const fg_loop_options *options, fg_loop_result *result,
                          fg_engine_run *run) {
  const fg_loop_problem *problem = &units->problem;
  size_t capacity = 0, rows = problem->rows;
  *run = (fg_engine_run){.problem = problem, .units = units, .options = *options, .result = result};
  run->options.matters = ldexp(options->matters, -units->response);
  if (!(run->options.accept_p > 0)) run->options.accept_p = FG_LOOP_ACCEPT_P;
  fg_loop_kind_shares(options->expected, run->share);
  memcpy(result->share, run->share, sizeof run->share);
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *run->train, (void **)&run->train));
  for (size_t i = 0; i < rows; i++)
    run->train[i] = !problem->held_out || !problem->held_out[i];
  FG_TRY(add_candidates(ctx, run, options->effects, &capacity));
  if (!problem->few) FG_TRY(add_candidates(ctx, run, fg_loop_curve_effects(), &capacity));
  run->means = run->candidates;
  if (!problem->few) FG_TRY(add_candidates(ctx, run, fg_loop_noise_effects(), &capacity));
  fg_engine_effort effort;
  fg_engine_effort_estimate(problem, run->candidate, run->candidates, &effort);
  FG_TRY(fg_engine_effort_check(ctx, &effort, options->minutes, options->mebibytes));
  size_t size = sizeof *result->before_fit;
  FG_TRY(fg_memory_allocate(ctx, rows, size, (void **)&result->before_fit));
  FG_TRY(fg_memory_allocate(ctx, rows, size, (void **)&result->after_fit));
  FG_TRY(fg_memory_allocate(ctx, rows, size, (void **)&result->effect_fit));
  FG_TRY(fg_memory_allocate(ctx, problem->parameters, size, (void **)&result->parameter));
  return fg_memory_allocate(ctx, problem->parameters, size, (void **)&result->parameter_u);
}

/* Notes declared columns that lie in the span of the others, within rounding. */
static fg_status note_aliased(fg_context *ctx, fg_engine_run *run, const fg_engine_fit *fit) {
  const fg_loop_problem *problem = run->problem;
  char *names = NULL;
  fg_status status = FG_OK;
  for (size_t k = 0; status == FG_OK && k < problem->parameters; k++)
    if (problem->parameter_name && !(fit->inverse[k * fit->columns + k] > 0))
      status = fg_text_append(ctx, &names, "%s%s", names ? ", " : "", problem->parameter_name[k]);
  if (status == FG_OK && names)
    status =
        fg_engine_note(ctx, run->result,
                       "These terms of the declared model cannot be told from its others, as far "
                       "as the digits of the table tell, and are left out: %s.",
                       names);
  free(names);
  return status;
}

/* Enough rows, and a residual that is more than rounding? */
static fg_status check_rows(fg_context *ctx, fg_engine_run *run, bool *worth) {
  fg_engine_training training;
  fg_engine_fit fit = {0};
  double size = 0;
  FG_TRY(fg_engine_training_build(ctx, run->problem, run->train, NULL, &training));
  fg_status status = fg_engine_least_squares(ctx, &training, (fg_engine_noise){0}, &fit);
  if (status == FG_OK && training.n < fit.rank + 3)
    status = fg_fail(ctx, FG_ERR_DATA,
                     "%zu rows for %zu parameters of the declared model leave %zu to judge it by; "
                     "the loop needs 3 at least: measure more rows, or declare fewer terms",
                     training.n, fit.rank, training.n - fit.rank);
  if (status == FG_OK) status = note_aliased(ctx, run, &fit);
  for (size_t i = 0; i < training.n; i++) {
    bool whole = run->problem->response && run->problem->origin == 0;
    double value = whole ? run->problem->response[training.row[i]] : training.y[i];
    size += value * value;
  }
  *worth = status == FG_OK && fit.rss > 1e-20 * size;
  if (status == FG_OK && !*worth)
    status =
        fg_engine_note(ctx, run->result,
                       "The declared model fits every row to the last digit: no residual is left "
                       "to look into.");
  fg_engine_fit_free(&fit);
  fg_engine_training_free(&training);
  return status;
}

fg_status fg_engine_search(fg_context *ctx, fg_engine_run *run) {
  bool accepted = true, last = false;
  while (!last && run->result->claims < FG_LOOP_CLAIMS) {
    FG_TRY(fg_engine_accept_one(ctx, run, &accepted, &last));
    FG_TRY(fg_engine_fit_set(ctx, run->problem, run->train, &run->set, true, &run->noise, NULL,
                             NULL, &run->sd));
    FG_TRY(fg_engine_refine(ctx, run->problem, run->train, run->noise, &run->set));
    FG_TRY(fg_engine_join_cycles(ctx, run));
  }
  FG_TRY(fg_engine_swap(ctx, run));
  return fg_engine_join_cycles(ctx, run);
}

/* Notes that the shortest cycles are left out where rows are many. */
static fg_status note_cycles(fg_context *ctx, const fg_engine_run *run) {
  for (size_t c = 0; c < run->means; c++) {
    const fg_loop_candidate *candidate = &run->candidate[c];
    const fg_loop_coordinate *at = &run->problem->coordinate[candidate->a];
    double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES];
    if (!candidate->effect->cycle || at->distinct <= FG_LOOP_STARTS) continue;
    size_t count = candidate->effect->starts(run->problem, candidate, starts);
    if (count < FG_LOOP_STARTS) continue;
    return fg_engine_note(ctx, run->result,
                          "Cycles over %s that are shorter than %.3g were not looked for.",
                          at->name, starts[count - 1][0]);
  }
  return FG_OK;
}

fg_status fg_loop_run(fg_context *ctx, const fg_loop_problem *problem,
                      const fg_loop_options *options, fg_loop_result *result) {
  fg_status status = FG_OK;
  fg_engine_run run = {0};
  fg_engine_units units = {0};
  memset(result, 0, sizeof *result);
  FG_TRY_EXIT(fg_engine_units_open(ctx, problem, &units));
  FG_TRY_EXIT(open_run(ctx, &units, options, result, &run));
  FG_TRY_EXIT(check_rows(ctx, &run, &run.worth));
  if (run.worth) FG_TRY_EXIT(note_cycles(ctx, &run));
  if (run.worth) FG_TRY_EXIT(fg_engine_search(ctx, &run));
  if (run.worth) FG_TRY_EXIT(fg_engine_accept_scale(ctx, &run));
  FG_TRY_EXIT(fg_engine_finish(ctx, &run));
  if (run.worth) FG_TRY_EXIT(fg_engine_list_rejected(ctx, &run));
  if (run.worth) FG_TRY_EXIT(fg_engine_advise(ctx, &run));
  fg_engine_units_restore(&units, result);
exit:
  fg_engine_units_close(&units);
  free(run.train);
  free(run.candidate);
  if (status != FG_OK) fg_loop_result_free(result);
  return status;
}
