/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors on rows that took no part: the whole search, again without each fold of groups. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "table_loop/run.h"

/* Folds of whole groups, in turn over their order, and draws of their nulls: few suffice, because a
 * fold's search decides nothing but its own prediction. */
enum { FOLDS = 5, DRAWS = 119 };
/* Number of folds for many rows: fewer suffice, and each costs a search. */
enum { MANY_ROWS = 20000, FOLDS_OF_MANY = 2 };

/* Predicts a row from the kept rows on both sides of it, where neighbours are correlated. */
static double expected(const fg_engine_training *all, const bool *keep, const double *residual,
                       double rho, size_t block, size_t i) {
  size_t before = i, after = i, end = all->start[block + 1];
  while (before > all->start[block] && (before == i || !keep[all->row[before]]))
    before--;
  while (after < end && (after == i || !keep[all->row[after]]))
    after++;
  bool left = before < i && keep[all->row[before]], right = after < end;
  double a = left ? pow(rho, (double)(i - before)) : 0;
  double b = right ? pow(rho, (double)(after - i)) : 0;
  double whole = 1 - a * a * b * b, sum = 0;
  double own = all->scale ? all->scale[i] : 1;
  if (left)
    sum += a * (1 - b * b) / whole * residual[before] / (all->scale ? all->scale[before] : 1);
  if (right)
    sum += b * (1 - a * a) / whole * residual[after] / (all->scale ? all->scale[after] : 1);
  return own * sum;
}

static fg_status take_out_neighbours(fg_context *ctx, const fg_engine_run *fold, double rho,
                                     double *residual) {
  fg_engine_training all;
  double *plain = NULL;
  FG_TRY(fg_engine_training_build(ctx, fold->problem, NULL, &fold->set, &all));
  fg_status status = fg_memory_allocate(ctx, all.n, sizeof *plain, (void **)&plain);
  if (status == FG_OK) {
    memcpy(plain, residual, all.n * sizeof *plain);
    for (size_t b = 0; b < all.blocks; b++)
      for (size_t i = all.start[b]; i < all.start[b + 1]; i++)
        if (!fold->train[all.row[i]]) residual[i] -= expected(&all, fold->train, plain, rho, b, i);
  }
  free(plain);
  fg_engine_training_free(&all);
  return status;
}

/* Computes residuals of the held-out rows, without effects and with those of the fold's own search.
 */
static fg_status predict_fold(fg_context *ctx, fg_engine_run *fold, double *before, double *after) {
  const fg_engine_set none = {0};
  fg_engine_noise noise = {0};
  FG_TRY(
      fg_engine_fit_set(ctx, fold->problem, fold->train, &none, false, &noise, before, NULL, NULL));
  FG_TRY(fg_engine_search(ctx, fold));
  FG_TRY(fg_engine_fit_set(ctx, fold->problem, fold->train, &fold->set, true, &noise, after, NULL,
                           NULL));
  return noise.rho != 0 ? take_out_neighbours(ctx, fold, noise.rho, after) : FG_OK;
}

/* Leaves out an outlier response, which is no value to predict, and puts exchanged responses back.
 */
static void correct_outlier(const fg_engine_run *run, double *residual) {
  const double *response = run->problem->response;
  for (size_t m = 0; m < run->set.count; m++) {
    const fg_loop_candidate *candidate = &run->set.candidate[m];
    if (fg_engine_is_exchange(candidate)) {
      double change = response[candidate->row[1]] - response[candidate->row[0]];
      residual[candidate->row[0]] += change;
      residual[candidate->row[1]] -= change;
    } else if (fg_engine_is_outlier(candidate)) {
      for (size_t k = 0; k < candidate->rows; k++)
        residual[candidate->row[k]] = NAN;
    }
  }
}

/* Returns true when the sum of the groups' gains exceeds its own standard error. */
static bool beyond_chance(const double *gain, size_t groups) {
  double sum = 0, squares = 0, count = (double)groups;
  for (size_t g = 0; g < groups; g++)
    sum += gain[g];
  for (size_t g = 0; g < groups; g++)
    squares += (gain[g] - sum / count) * (gain[g] - sum / count);
  return sum > sqrt(squares / (count - 1) * count);
}

typedef struct folding {
  const fg_engine_run *run;
  size_t folds;
  double *residual; /* folds × 2 × rows: before and after */
} folding;

/* The whole search without one fold. */
static fg_status fit_fold(fg_context *ctx, void *shared, size_t f) {
  const folding *all = shared;
  const fg_loop_problem *problem = all->run->problem;
  size_t rows = problem->rows;
  double *residual = all->residual + f * 2 * rows;
  fg_engine_run fold = *all->run;
  fg_loop_result *found = NULL;
  bool *train = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, sizeof *train, (void **)&train));
  FG_TRY_EXIT(fg_memory_allocate(ctx, 1, sizeof *found, (void **)&found));
  fold.result = found;
  fold.train = train;
  fold.set.count = 0;
  fold.has_curve = false;
  fold.options.progress = NULL;
  fold.options.simulations = DRAWS;
  for (size_t i = 0; i < rows; i++)
    train[i] = problem->group[i] % all->folds != f;
  FG_TRY_EXIT(predict_fold(ctx, &fold, residual, residual + rows));
  correct_outlier(all->run, residual + rows);
exit:
  free(train);
  free(found);
  return status;
}

size_t fg_engine_folds(size_t rows) {
  return rows > MANY_ROWS ? FOLDS_OF_MANY : FOLDS;
}

fg_status fg_engine_cross_fit(fg_context *ctx, const fg_engine_run *run, double *before_rms,
                              double *after_rms, bool *fell) {
  const fg_loop_problem *problem = run->problem;
  size_t rows = problem->rows, folds = fg_engine_folds(rows);
  double *residual = NULL, *gain = NULL, sum[2] = {0};
  size_t right = 0;
  fg_status status = FG_OK;
  *before_rms = *after_rms = NAN;
  *fell = false;
  if (folds > problem->groups) folds = problem->groups;
  if (folds < 2) return FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, 2 * folds * sizeof *residual, (void **)&residual));
  FG_TRY_EXIT(fg_memory_allocate(ctx, problem->groups, sizeof *gain, (void **)&gain));
  folding all = {run, folds, residual};
  FG_TRY_EXIT(fg_parallel_run(ctx, 0, folds, fit_fold, &all));
  for (size_t f = 0; f < folds; f++)
    for (size_t i = 0; i < rows; i++) {
      if (problem->group[i] % folds != f) continue;
      const double *own = residual + f * 2 * rows + i;
      double before = own[0] * own[0], after = own[rows] * own[rows];
      gain[problem->group[i]] += before - (isnan(after) ? 0 : after);
      sum[0] += before;
      if (isnan(after)) continue;
      sum[1] += after;
      right++;
    }
  *before_rms = sqrt(sum[0] / (double)rows);
  *after_rms = sqrt(sum[1] / (double)right);
  *fell = beyond_chance(gain, problem->groups);
exit:
  free(residual);
  free(gain);
  return status;
}
