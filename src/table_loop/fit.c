/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "table_loop/departures.h"

static fg_status criterion(fg_context *ctx, const fg_engine_training *training,
                           fg_engine_noise noise, double *value) {
  fg_engine_fit fit;
  FG_TRY(fg_engine_least_squares(ctx, training, noise, &fit));
  double dof = (double)training->n - (double)fit.rank;
  *value = dof * log(fit.rss) + fg_engine_log_det(training, noise) + fit.log_det;
  fg_engine_fit_free(&fit);
  return FG_OK;
}

#define RHO_MAX 0.985

/* Takes a step again and again, as long as it gains: of rho to add, of the others a factor. */
static fg_status go_on(fg_context *ctx, const fg_engine_training *training, fg_engine_noise move,
                       double *best, fg_engine_noise *noise) {
  enum { STEPS = 40 };
  for (int step = 0; step < STEPS; step++) {
    double rho = fmax(fmin(noise->rho + move.rho, RHO_MAX), -RHO_MAX), value;
    const fg_engine_noise tried = {rho, noise->lambda * move.lambda, noise->outer * move.outer};
    FG_TRY(criterion(ctx, training, tried, &value));
    if (!(value < *best)) break;
    *best = value;
    *noise = tried;
  }
  return FG_OK;
}

/* A variance between 0 and the grid's next value: factors do not leave 0. */
static fg_status leave_zero(fg_context *ctx, const fg_engine_training *training, double *best,
                            fg_engine_noise *noise) {
  const double small = 0.05;
  for (int outer = 0; outer <= 1; outer++) {
    fg_engine_noise tried = *noise;
    double *at = outer ? &tried.outer : &tried.lambda, value;
    if (*at > 0) continue;
    *at = small;
    FG_TRY(criterion(ctx, training, tried, &value));
    if (!(value < *best)) continue;
    *best = value;
    *noise = tried;
  }
  return FG_OK;
}

/* Between the points of the grid, and beyond its ends: steps that shrink, in rho and in the
 * logarithms of the variances. */
static fg_status polish(fg_context *ctx, const fg_engine_training *training, double best,
                        fg_engine_noise *noise) {
  enum { ROUNDS = 4, FINE_ROUNDS = 8 };
  double rho_step = 0.1, factor = exp(0.4);
  if (training->outers) FG_TRY(leave_zero(ctx, training, &best, noise));
  int rounds = training->level_row || training->outers ? FINE_ROUNDS : ROUNDS;
  for (int round = 0; round < rounds; round++) {
    for (int sign = 1; training->serial && sign >= -1; sign -= 2)
      FG_TRY(go_on(ctx, training, (fg_engine_noise){sign * rho_step, 1, 1}, &best, noise));
    for (int sign = 1; training->levels && sign >= -1; sign -= 2) {
      double by = sign > 0 ? factor : 1 / factor;
      FG_TRY(go_on(ctx, training, (fg_engine_noise){0, by, 1}, &best, noise));
      if (training->outers) FG_TRY(go_on(ctx, training, (fg_engine_noise){0, 1, by}, &best, noise));
    }
    rho_step /= 2;
    factor = sqrt(factor);
  }
  return FG_OK;
}

/* The noise model with the largest residual likelihood. */
fg_status fg_engine_choose_noise(fg_context *ctx, const fg_engine_training *training,
                                 fg_engine_noise *noise) {
  fg_engine_noise grid[FG_ENGINE_NOISES];
  double best = INFINITY, value;
  size_t count = fg_engine_noise_grid(training, grid);
  *noise = grid[0];
  for (size_t j = 0; j < count; j++) {
    FG_TRY(criterion(ctx, training, grid[j], &value));
    if (!(value < best)) continue;
    best = value;
    *noise = grid[j];
  }
  return training->serial || training->levels ? polish(ctx, training, best, noise) : FG_OK;
}

typedef struct folding {
  const fg_engine_training *whole;
  const fg_engine_set *set;
  fg_engine_noise noise;
  size_t folds;
  double *residual;
} folding;

/* Fitted without a fold; the residuals of the fold. */
static fg_status fit_fold(fg_context *ctx, void *shared, size_t fold) {
  const folding *all = shared;
  const fg_engine_training *whole = all->whole;
  fg_engine_training training = {0};
  fg_engine_fit fit = {0};
  bool *keep = NULL;
  double *residual = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, whole->problem->rows, sizeof *keep, (void **)&keep));
  FG_TRY_EXIT(fg_memory_allocate(ctx, whole->n, sizeof *residual, (void **)&residual));
  for (size_t i = 0; i < whole->n; i++)
    keep[whole->row[i]] = whole->group[i] % all->folds != fold;
  FG_TRY_EXIT(fg_engine_training_build(ctx, whole->problem, keep, all->set, &training));
  FG_TRY_EXIT(fg_engine_least_squares(ctx, &training, all->noise, &fit));
  fg_engine_fit_residual(whole, &fit, residual);
  for (size_t i = 0; i < whole->n; i++)
    if (whole->group[i] % all->folds == fold) all->residual[i] = residual[i];
exit:
  free(keep);
  free(residual);
  fg_engine_fit_free(&fit);
  fg_engine_training_free(&training);
  return status;
}

fg_status fg_engine_cross_validate(fg_context *ctx, const fg_loop_problem *problem,
                                   const bool *keep, const fg_engine_set *set,
                                   fg_engine_noise noise, double *residual) {
  fg_engine_training training;
  FG_TRY(fg_engine_training_build(ctx, problem, keep, set, &training));
  folding all = {&training, set, noise, training.groups <= 30 ? training.groups : 10, residual};
  unsigned threads = training.n > FG_ENGINE_SMALL_ROWS ? 0 : 1; /* few rows are done sooner */
  fg_status status = fg_parallel_run(ctx, threads, all.folds, fit_fold, &all);
  fg_engine_training_free(&training);
  return status;
}

fg_status fg_engine_cross_validated_gain(fg_context *ctx, const fg_loop_problem *problem,
                                         const bool *keep, const fg_engine_set *before,
                                         const fg_engine_set *after, fg_engine_noise noise,
                                         double *gain, double *standard_error) {
  fg_status status = FG_OK;
  fg_engine_training training;
  double *residual = NULL, *sum = NULL, squares = 0;
  FG_TRY(fg_engine_training_build(ctx, problem, keep, before, &training));
  FG_TRY_EXIT(fg_memory_allocate(ctx, training.n, 2 * sizeof *residual, (void **)&residual));
  FG_TRY_EXIT(fg_memory_allocate(ctx, training.groups, sizeof *sum, (void **)&sum));
  FG_TRY_EXIT(fg_engine_cross_validate(ctx, problem, keep, before, noise, residual));
  FG_TRY_EXIT(fg_engine_cross_validate(ctx, problem, keep, after, noise, residual + training.n));
  fg_engine_whiten(&training, noise, residual);
  fg_engine_whiten(&training, noise, residual + training.n);
  *gain = 0;
  for (size_t i = 0; i < training.n; i++)
    sum[training.group[i]] +=
        residual[i] * residual[i] - residual[training.n + i] * residual[training.n + i];
  for (size_t g = 0; g < training.groups; g++)
    *gain += sum[g];
  double groups = (double)training.groups, mean = *gain / groups;
  for (size_t g = 0; g < training.groups; g++)
    squares += (sum[g] - mean) * (sum[g] - mean);
  *standard_error = sqrt(squares / (groups - 1) * groups);
exit:
  free(residual);
  free(sum);
  fg_engine_training_free(&training);
  return status;
}

static void add_effects(const fg_engine_training *training, const fg_engine_fit *fit,
                        double *effect) {
  size_t parameters = training->problem->parameters;
  memset(effect, 0, training->n * sizeof *effect);
  for (size_t k = parameters; k < training->columns; k++)
    for (size_t i = 0; i < training->n; i++)
      effect[i] += fit->beta[k] * training->x[k * training->n + i];
  for (size_t i = 0; i < training->n; i++)
    effect[i] += training->problem->residual[i] - training->y[i]; /* exchanged runs */
}

fg_status fg_engine_fit_set(fg_context *ctx, const fg_loop_problem *problem, const bool *keep,
                            const fg_engine_set *set, bool choose, fg_engine_noise *noise,
                            double *residual, double *effect, double *sd) {
  fg_status status = FG_OK;
  fg_engine_training training = {0}, all = {0};
  fg_engine_fit fit = {0};
  FG_TRY_EXIT(fg_engine_training_build(ctx, problem, keep, set, &training));
  FG_TRY_EXIT(fg_engine_training_build(ctx, problem, NULL, set, &all));
  if (choose) FG_TRY_EXIT(fg_engine_choose_noise(ctx, &training, noise));
  FG_TRY_EXIT(fg_engine_least_squares(ctx, &training, *noise, &fit));
  if (residual) fg_engine_fit_residual(&all, &fit, residual);
  FG_TRY_EXIT(fg_engine_take_departures(ctx, &training, set, &fit));
  if (effect) add_effects(&all, &fit, effect);
  double dof = training.n > fit.rank ? (double)(training.n - fit.rank) : NAN;
  if (sd) *sd = sqrt(fit.rss / dof * (1 + noise->lambda + noise->outer));
exit:
  fg_engine_fit_free(&fit);
  fg_engine_training_free(&training);
  fg_engine_training_free(&all);
  return status;
}
