/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scale of every row's scatter where it varies: sd = exp(z'g), by the likelihood of the squared
 * residuals (a gamma model with logarithmic link: Smyth 1989), in turns with the mean. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>

#include "core/memory.h"
#include "table_loop/engine.h"

/* Bounds of a scale: a level whose rows agree by chance must not dominate the fit. */
#define SCALE_MAX 12
enum { TURNS = 3, STEPS = 12 };

typedef struct scale_workspace {
  fg_engine_training *training;
  size_t n, columns;
  double *z; /* columns × n; the first is 1 */
  double *eta, *square, *work;
  gsl_matrix *cross;
  gsl_vector *right, *gamma;
} scale_workspace;

static size_t spread_columns(const fg_loop_problem *problem, const fg_engine_set *set) {
  size_t count = 0;
  for (size_t m = 0; set && m < set->count; m++)
    if (set->candidate[m].effect->scatter == FG_LOOP_SPREAD)
      count += fg_engine_candidate_columns(problem, &set->candidate[m]);
  return count;
}

static void close_workspace(scale_workspace *workspace) {
  free(workspace->z);
  free(workspace->eta);
  gsl_matrix_free(workspace->cross);
  gsl_vector_free(workspace->right);
  gsl_vector_free(workspace->gamma);
}

static fg_status open_workspace(fg_context *ctx, const fg_engine_set *set,
                                scale_workspace *workspace) {
  size_t n = workspace->n, at = 1;
  FG_TRY(fg_memory_allocate(ctx, n, workspace->columns * sizeof *workspace->z,
                            (void **)&workspace->z));
  FG_TRY(fg_memory_allocate(ctx, n, 3 * sizeof *workspace->eta, (void **)&workspace->eta));
  workspace->square = workspace->eta + n;
  workspace->work = workspace->eta + 2 * n;
  workspace->cross = gsl_matrix_alloc(workspace->columns, workspace->columns);
  workspace->right = gsl_vector_alloc(workspace->columns);
  workspace->gamma = gsl_vector_alloc(workspace->columns);
  if (!workspace->cross || !workspace->right || !workspace->gamma)
    return fg_fail(ctx, FG_ERR_MEMORY, "no memory for the size of the scatter");
  for (size_t i = 0; i < n; i++)
    workspace->z[i] = 1;
  for (size_t m = 0; m < set->count; m++) {
    if (set->candidate[m].effect->scatter != FG_LOOP_SPREAD) continue;
    FG_TRY(fg_engine_gather(ctx, workspace->training, &set->candidate[m], set->shape[m],
                            workspace->z + at * n));
    at += fg_engine_candidate_columns(workspace->training->problem, &set->candidate[m]);
  }
  return FG_OK;
}

/* Squares of the residuals beside the mean's columns, of groups about their own level. */
static fg_status fill_squares(fg_context *ctx, scale_workspace *workspace) {
  const fg_engine_training *t = workspace->training;
  fg_engine_fit fit;
  double sum = 0;
  FG_TRY(fg_engine_least_squares(ctx, t, (fg_engine_noise){0}, &fit));
  fg_engine_fit_residual(t, &fit, workspace->work);
  fg_engine_fit_free(&fit);
  for (size_t b = 0; b < t->levels; b++) {
    double mean = 0, count = (double)(t->level_start[b + 1] - t->level_start[b]);
    for (size_t i = t->level_start[b]; i < t->level_start[b + 1]; i++)
      mean += workspace->work[fg_engine_level_row(t, i)] / count;
    for (size_t i = t->level_start[b]; i < t->level_start[b + 1]; i++)
      workspace->work[fg_engine_level_row(t, i)] -= mean;
  }
  for (size_t i = 0; i < t->n; i++) {
    workspace->square[i] = workspace->work[i] * workspace->work[i];
    sum += workspace->square[i];
  }
  for (size_t i = 0; sum > 0 && i < t->n; i++)
    workspace->square[i] *= (double)t->n / sum;
  return FG_OK;
}

/* One step of scoring: eta is the logarithm of the variance. */
static bool step(scale_workspace *workspace) {
  size_t n = workspace->n, columns = workspace->columns;
  for (size_t j = 0; j < columns; j++) {
    double right = 0;
    for (size_t i = 0; i < n; i++)
      right +=
          workspace->z[j * n + i] *
          (workspace->eta[i] + fmin(workspace->square[i] / exp(workspace->eta[i]), SCALE_MAX) - 1);
    gsl_vector_set(workspace->right, j, right);
    for (size_t k = 0; k < columns; k++) {
      double cross = 0;
      for (size_t i = 0; i < n; i++)
        cross += workspace->z[j * n + i] * workspace->z[k * n + i];
      gsl_matrix_set(workspace->cross, j, k, cross + (j == k ? 1e-9 * (double)n : 0));
    }
  }
  if (gsl_linalg_cholesky_decomp1(workspace->cross) != GSL_SUCCESS) return false;
  gsl_linalg_cholesky_solve(workspace->cross, workspace->right, workspace->gamma);
  double max = 2 * log(SCALE_MAX);
  for (size_t i = 0; i < n; i++) {
    double eta = 0;
    for (size_t j = 0; j < columns; j++)
      eta += gsl_vector_get(workspace->gamma, j) * workspace->z[j * n + i];
    workspace->eta[i] = fmin(fmax(eta, -max), max);
  }
  return true;
}

static void take_scale(scale_workspace *workspace) {
  double sum = 0, *scale = workspace->training->scale;
  for (size_t i = 0; i < workspace->n; i++)
    sum += exp(workspace->eta[i]) / (double)workspace->n;
  for (size_t i = 0; i < workspace->n; i++)
    scale[i] = exp(workspace->eta[i] / 2) / sqrt(sum);
}

fg_status fg_engine_estimate_scale(fg_context *ctx, fg_engine_training *training,
                                   const fg_engine_set *set) {
  scale_workspace workspace = {.training = training, .n = training->n};
  fg_status status = FG_OK;
  size_t columns = spread_columns(training->problem, set);
  if (columns == 0) return FG_OK;
  workspace.columns = columns + 1;
  FG_TRY_EXIT(open_workspace(ctx, set, &workspace));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, workspace.n, sizeof *training->scale, (void **)&training->scale));
  for (size_t i = 0; i < workspace.n; i++)
    training->scale[i] = 1;
  for (int turn = 0; turn < TURNS; turn++) {
    bool holds = true;
    FG_TRY_EXIT(fill_squares(ctx, &workspace));
    for (int k = 0; k < STEPS && holds; k++)
      holds = step(&workspace);
    if (holds) take_scale(&workspace);
  }
exit:
  close_workspace(&workspace);
  return status;
}
