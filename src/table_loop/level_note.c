/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainties of the declared parameters before and after random levels were found: by rows, and
 * by the stratum in which each varies. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
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

fg_status fg_engine_note_levels(fg_context *ctx, fg_engine_run *run) {
  const fg_loop_problem *problem = run->problem;
  const fg_engine_noise rows = {0};
  fg_engine_set without = run->set;
  size_t m = levels_member(&run->set), count = problem->parameters;
  double *before = NULL, change;
  if (m == run->set.count || count == 0 || !problem->parameter_name) return FG_OK;
  const char *levels = problem->coordinate[run->set.candidate[m].a].name;
  fg_loop_claim unused[FG_LOOP_CLAIMS + 1] = {0};
  fg_engine_set_remove(&without, m);
  FG_TRY(fg_memory_allocate(ctx, count, 2 * sizeof *before, (void **)&before));
  fg_status status =
      fg_engine_fit_claims(ctx, problem, NULL, &without, rows, unused, before + count, before);
  size_t k = max_changed(problem, before, run->result->parameter_u, &change);
  int unit = run->units->response - run->units->column[k];
  if (status == FG_OK && change > log(TOLD))
    status = fg_engine_note(ctx, run->result,
                            "Before the levels of %s were found, with every row counted by itself, "
                            "%s had a standard uncertainty of %.3g; by the stratum in which it "
                            "varies it has %.3g.",
                            levels, problem->parameter_name[k], ldexp(before[k], unit),
                            ldexp(run->result->parameter_u[k], unit));
  free(before);
  return status;
}
