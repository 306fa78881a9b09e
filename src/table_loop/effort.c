/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/effort.h"

#include "table_loop/run.h"

/* Measured (reports/loop_limits.md), of one core. Few rows: seconds per product with a draw. */
static const double per_product = 3e-11;
/* Cost constants for many rows: seconds of one search for five effects and a curve, in total, per
 * start value, per row, and per row and column; factor where groups share a level. Correlation of
 * neighbours adds half as much. Bytes of the program, per row and per cell. */
static const double per_search = 0.1, per_start = 7e-5, per_row = 6e-5, per_cell = 3.5e-7,
                    with_levels = 2.5;
static const double bytes_at_least = 2e7, bytes_a_row = 2000, bytes_a_cell = 26;

enum {
  DRAWS = 1999,
  LEVEL_NOISES = 3 /* six, which share half of the work */,
  CORRELATED = 5,
  STEPS = 8,
  FOLDS = 5
};

/* Sum of the columns of all candidates, each basis once and with all its start values. */
typedef struct sought {
  double columns, starts, all;
} sought;

static sought count_sought(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                           size_t candidates) {
  double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES];
  sought sum = {(double)problem->parameters, 0, (double)problem->parameters};
  for (size_t c = 0; c < candidates; c++) {
    const fg_loop_effect *effect = candidate[c].effect;
    double columns = (double)fg_engine_candidate_columns(problem, &candidate[c]);
    double versions = effect->starts ? (double)effect->starts(problem, &candidate[c], starts) : 1;
    sum.columns += columns;
    sum.starts += versions;
    sum.all += versions * columns;
  }
  return sum;
}

/* Estimates the effort for few rows: every candidate is scored in every draw at every noise model,
 * and beside correlation, in fewer draws, at more of them. The search is repeated without each
 * fold. */
static void estimate_small(const fg_loop_problem *problem, double rows, double columns,
                           fg_engine_effort *effort) {
  double noises = problem->group_level ? LEVEL_NOISES : 1;
  double looks = problem->correlated ? 1 + CORRELATED : 1;
  effort->seconds = (1 + FOLDS) * STEPS * DRAWS * noises * looks * rows * columns * per_product;
  effort->bytes = 8 * (noises * looks * rows * columns + DRAWS * (double)effort->candidates);
}

/* Estimates the effort for many rows: one search and one without each fold. Start values are tried
 * over binned sums, the best of them on all rows. */
static void estimate_large(const fg_loop_problem *problem, double rows, const sought *sum,
                           fg_engine_effort *effort) {
  double searches = (double)fg_engine_folds(problem->rows);
  effort->seconds = searches * (per_search + per_start * sum->starts +
                                rows * (per_row + per_cell * sum->columns));
  if (problem->group_level) effort->seconds *= with_levels;
}

void fg_engine_effort_estimate(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                               size_t candidates, fg_engine_effort *effort) {
  sought sum = count_sought(problem, candidate, candidates);
  double all = (double)problem->rows;
  size_t rows = 0;
  for (size_t i = 0; i < problem->rows; i++)
    rows += !problem->held_out || !problem->held_out[i];
  *effort = (fg_engine_effort){.rows = problem->rows, .candidates = candidates};
  if (rows <= FG_ENGINE_SMALL_ROWS)
    estimate_small(problem, (double)rows, sum.all, effort);
  else
    estimate_large(problem, (double)rows, &sum, effort);
  effort->bytes += bytes_at_least;
  effort->bytes += all * (bytes_a_row + bytes_a_cell * (double)problem->coordinates);
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
