/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainties of the declared parameters before and after random levels were found: by rows, and
 * by the stratum in which each varies. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/text.h"
#include "table_loop/fit.h"
#include "table_loop/run.h"
#include "table_loop/step.h"

/* Change of an uncertainty from which on it is told. */
#define TOLD 1.1

static size_t levels_member(const fg_engine_set *set) {
  size_t m = 0;
  while (m < set->count && !fg_engine_is_levels(&set->candidate[m]))
    m++;
  return m;
}

/* The parameter whose uncertainty changes most; its logarithm of the change. */
static size_t max_changed(const fg_loop_problem *problem, const double *before, const double *after,
                          double *change) {
  size_t max = 0;
  *change = 0;
  for (size_t k = 0; k < problem->parameters; k++) {
    double ratio = before[k] > 0 && after[k] > 0 ? fabs(log(after[k] / before[k])) : 0;
    if (!(ratio > *change)) continue;
    *change = ratio;
    max = k;
  }
  return max;
}

/* Takes all random levels out of a set; their columns' names as one text. */
static fg_status take_levels_out(fg_context *ctx, const fg_loop_problem *problem,
                                 fg_engine_set *set, char **names) {
  for (size_t m = levels_member(set); m < set->count; m = levels_member(set)) {
    const char *name = problem->coordinate[set->candidate[m].a].name;
    FG_TRY(fg_text_append(ctx, names, "%s%s", *names ? " and " : "", name));
    fg_engine_set_remove(set, m);
  }
  return FG_OK;
}

/* Shares of two strata and of the rows in the variance of a response. */
static fg_status note_strata(fg_context *ctx, fg_engine_run *run, fg_engine_noise noise) {
  const fg_loop_problem *problem = run->problem;
  fg_engine_training training;
  const char *inner = NULL, *outer = NULL;
  FG_TRY(fg_engine_training_build(ctx, problem, run->train, &run->set, &training));
  for (size_t m = 0; training.outers && m < run->set.count; m++) {
    const fg_loop_candidate *levels = &run->set.candidate[m];
    if (!fg_engine_is_levels(levels)) continue;
    *(fg_engine_is_outer_levels(&training, levels) ? &outer : &inner) =
        problem->coordinate[levels->a].name;
  }
  fg_engine_training_free(&training);
  if (!outer) return FG_OK;
  double whole = 1 + noise.lambda + noise.outer;
  return fg_engine_note(ctx, run->result,
                        "%s within %s: of the variance that is left, %.0f %% lies between levels "
                        "of %s, %.0f %% between %s within one, %.0f %% within these.",
                        inner ? inner : "groups", outer, 100 * noise.outer / whole, outer,
                        100 * noise.lambda / whole, inner ? inner : "groups", 100 / whole);
}

static fg_status note_change(fg_context *ctx, fg_engine_run *run, const char *levels,
                             const double *before) {
  const fg_loop_problem *problem = run->problem;
  double change;
  size_t k = max_changed(problem, before, run->result->parameter_u, &change);
  int unit = run->units->response - run->units->column[k];
  if (!(change > log(TOLD))) return FG_OK;
  return fg_engine_note(ctx, run->result,
                        "Before the levels of %s were found, with every %s counted by itself, "
                        "%s had a standard uncertainty of %.3g; by the stratum in which it "
                        "varies it has %.3g.",
                        levels, problem->group_level ? "group" : "row", problem->parameter_name[k],
                        ldexp(before[k], unit), ldexp(run->result->parameter_u[k], unit));
}

fg_status fg_engine_note_levels(fg_context *ctx, fg_engine_run *run, fg_engine_noise noise) {
  const fg_loop_problem *problem = run->problem;
  fg_engine_noise rows = {0};
  fg_engine_set without = run->set;
  size_t count = problem->parameters;
  double *before = NULL;
  char *levels = NULL;
  fg_loop_claim unused[FG_LOOP_CLAIMS + 1] = {0};
  fg_status status = FG_OK;
  FG_TRY_EXIT(take_levels_out(ctx, problem, &without, &levels));
  if (!levels || count == 0 || !problem->parameter_name) goto exit;
  FG_TRY_EXIT(note_strata(ctx, run, noise));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, 2 * sizeof *before, (void **)&before));
  if (problem->group_level)
    FG_TRY_EXIT(
        fg_engine_fit_set(ctx, problem, run->train, &without, true, &rows, NULL, NULL, NULL));
  FG_TRY_EXIT(
      fg_engine_fit_claims(ctx, problem, NULL, &without, rows, unused, before + count, before));
  FG_TRY_EXIT(note_change(ctx, run, levels, before));
exit:
  free(before);
  free(levels);
  return status;
}
