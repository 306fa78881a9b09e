#include "loop/effort.h"

/* Measured (reports/loop_limits.md): seconds of one core per product of what dominates, bytes per
 * row and per cell. */
static const double per_product = 1e-10, per_projected = 1e-9, per_row = 2400, per_cell = 26;

enum { DRAWS = 1999, LEVEL_NOISES = 6, CORRELATED = 5, STEPS = 8, FOLDS = 5, FITS = 60 };

static double count_columns(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                            size_t candidates) {
  double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES], columns = (double)problem->parameters;
  for (size_t c = 0; c < candidates; c++) {
    const fg_loop_effect *effect = candidate[c].effect;
    size_t versions = effect->starts ? effect->starts(problem, &candidate[c], starts) : 1;
    columns += (double)versions * (double)fg_engine_candidate_columns(problem, &candidate[c]);
  }
  return columns;
}

/* Few rows: every candidate is scored in every draw at every noise model; beside correlation, in
 * fewer draws, at more of them. The search is made again without each fold. */
static void estimate_small(const fg_loop_problem *problem, double rows, double columns,
                           fg_engine_effort *effort) {
  double noises = problem->group_level ? LEVEL_NOISES : 1;
  double looks = problem->correlated ? 1 + CORRELATED : 1;
  effort->seconds = (1 + FOLDS) * STEPS * DRAWS * noises * looks * rows * columns * per_product;
  effort->bytes = 8 * (noises * looks * rows * columns + DRAWS * (double)effort->candidates);
}

/* Large ones: it is projected beside the null, once a step. The null is fitted again wherever the
 * shapes of what was found are refined. */
static void estimate_large(const fg_loop_problem *problem, double rows, double columns,
                           fg_engine_effort *effort) {
  double null = (double)problem->parameters + 2 * FG_LOOP_CLAIMS;
  double projected = rows * columns * (30 + 2 * null);
  double fitted = FITS * rows * null * null * 4;
  effort->seconds = STEPS * (projected + fitted) * per_projected;
  effort->bytes = 8 * rows * 5 * FG_LOOP_COLUMNS;
}

void fg_engine_effort_estimate(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                               size_t candidates, fg_engine_effort *effort) {
  double columns = count_columns(problem, candidate, candidates), all = (double)problem->rows;
  size_t rows = 0;
  for (size_t i = 0; i < problem->rows; i++)
    rows += !problem->aside || !problem->aside[i];
  *effort = (fg_engine_effort){.rows = problem->rows, .candidates = candidates};
  if (rows <= FG_ENGINE_SMALL_ROWS)
    estimate_small(problem, (double)rows, columns, effort);
  else
    estimate_large(problem, (double)rows, columns, effort);
  effort->bytes +=
      all * (per_row + per_cell * (double)(problem->coordinates + problem->parameters));
}

fg_status fg_engine_effort_check(fg_context *ctx, const fg_engine_effort *effort, double minutes,
                                 double mebibytes) {
  double needed = effort->seconds / 60, memory = effort->bytes / (1 << 20);
  if (!(minutes > 0 && needed > minutes) && !(mebibytes > 0 && memory > mebibytes)) return FG_OK;
  return fg_fail(ctx, FG_ERR_DATA,
                 "%zu rows with %zu candidate effects may take %.3g minutes and %.3g MiB; the "
                 "limit is %.3g minutes and %.3g MiB. Leave out columns that cannot be causes, "
                 "take a part of the rows or the means of groups, or raise the limit (--minutes, "
                 "--memory)",
                 effort->rows, effort->candidates, needed, memory, minutes, mebibytes);
}
