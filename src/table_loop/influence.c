/* SPDX-License-Identifier: GPL-3.0-or-later */
/* With C = (X'X)^-1, leverage h = x'Cx and residual e of a row, the parameters without it are
 * b - Cx e / (1 - h) (Belsley, Kuh and Welsch 1980). */
#include "table_loop/influence.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "core/memory.h"

/* Row that the fit follows whatever it says. */
#define LEVERAGE_MAX (1 - 1e-9)

typedef struct influence_fit {
  fg_engine_training training;
  fg_engine_fit fit;
  double *white;    /* columns × n, then n of the residual */
  double *x, *move; /* columns */
  double dof;
} influence_fit;

static fg_status open_fit(fg_context *ctx, const fg_engine_run *run, fg_engine_noise noise,
                          influence_fit *f) {
  fg_engine_training *training = &f->training;
  FG_TRY(fg_engine_training_build(ctx, run->problem, NULL, &run->set, training));
  FG_TRY(fg_engine_least_squares(ctx, training, noise, &f->fit));
  size_t n = training->n, columns = training->columns;
  FG_TRY(fg_memory_allocate(ctx, n, (columns + 1) * sizeof *f->white, (void **)&f->white));
  FG_TRY(fg_memory_allocate(ctx, columns + 1, 2 * sizeof *f->x, (void **)&f->x));
  f->move = f->x + columns + 1;
  f->dof = (double)n - (double)f->fit.rank;
  memcpy(f->white, training->x, n * columns * sizeof *f->white);
  fg_engine_fit_residual(training, &f->fit, f->white + n * columns);
  for (size_t k = 0; k <= columns; k++)
    fg_engine_whiten(training, noise, f->white + k * n);
  return FG_OK;
}

static void close_fit(influence_fit *f) {
  fg_engine_fit_free(&f->fit);
  fg_engine_training_free(&f->training);
  free(f->white);
  free(f->x);
}

/* Fills f->move with Cx of row i; returns its leverage. */
static double lever_row(influence_fit *f, size_t i) {
  size_t n = f->training.n, columns = f->training.columns;
  double leverage = 0;
  for (size_t k = 0; k < columns; k++)
    f->x[k] = f->white[k * n + i];
  for (size_t k = 0; k < columns; k++) {
    f->move[k] = 0;
    for (size_t m = 0; m < columns; m++)
      f->move[k] += f->fit.inverse[k * columns + m] * f->x[m];
    leverage += f->move[k] * f->x[k];
  }
  return leverage;
}

static bool is_constant(const influence_fit *f, size_t k) {
  const fg_loop_problem *problem = f->training.problem;
  for (size_t i = 1; i < problem->rows; i++)
    if (problem->jacobian[k * problem->rows + i] != problem->jacobian[k * problem->rows])
      return false;
  return true;
}

/* The declared parameter that the row moves most, in standard errors without it. The constant,
 * which follows the slopes, is named only where it is alone. */
static void choose_parameter(const influence_fit *f, double step, double sd,
                             fg_loop_influence *influence) {
  size_t columns = f->training.columns;
  for (size_t k = 0; k < f->training.problem->parameters; k++) {
    if (f->training.problem->parameters > 1 && is_constant(f, k)) continue;
    double u = sd * sqrt(f->fit.inverse[k * columns + k]);
    double shift = u > 0 ? f->move[k] * step / u : 0;
    if (fabs(shift) <= fabs(influence->dfbetas)) continue;
    influence->parameter = k;
    influence->dfbetas = shift;
    influence->change = f->move[k] * step;
  }
}

static fg_loop_influence influence_of(influence_fit *f, size_t i) {
  size_t n = f->training.n;
  double leverage = lever_row(f, i), residual = f->white[f->training.columns * n + i];
  fg_loop_influence influence = {.row = f->training.row[i], .leverage = leverage};
  double kept = 1 - leverage, left = f->fit.rss - residual * residual / kept;
  if (!(leverage < LEVERAGE_MAX) || !(left > 0)) return influence;
  double sd = sqrt(left / (f->dof - 1));
  influence.studentised = residual / (sd * sqrt(kept));
  influence.cook =
      residual * residual / kept * leverage / kept / (double)f->fit.rank / (f->fit.rss / f->dof);
  choose_parameter(f, residual / kept, sd, &influence);
  return influence;
}

/* Keeps the largest, in order. */
static void keep_influence(fg_loop_result *result, const fg_loop_influence *influence) {
  size_t k = result->influences;
  if (k == FG_LOOP_INFLUENCES) {
    if (!(influence->cook > result->influence[--k].cook)) return;
  } else {
    result->influences++;
  }
  for (; k > 0 && result->influence[k - 1].cook < influence->cook; k--)
    result->influence[k] = result->influence[k - 1];
  result->influence[k] = *influence;
}

fg_status fg_engine_find_influence(fg_context *ctx, fg_engine_run *run, fg_engine_noise noise) {
  influence_fit f = {0};
  fg_status status = FG_OK;
  if (!fg_engine_independent(noise) || !run->worth || !run->problem->parameter_name) return FG_OK;
  FG_TRY_EXIT(open_fit(ctx, run, noise, &f));
  if (!(f.dof > 1) || !(f.fit.rss > 0) || !f.fit.rank) goto exit;
  double limit = gsl_cdf_fdist_Pinv(0.5, (double)f.fit.rank, f.dof);
  for (size_t i = 0; i < f.training.n; i++) {
    fg_loop_influence influence = influence_of(&f, i);
    if (!(influence.cook > limit) || influence.dfbetas == 0) continue;
    influence.without = run->result->parameter[influence.parameter] - influence.change;
    keep_influence(run->result, &influence);
  }
exit:
  close_fit(&f);
  return status;
}
