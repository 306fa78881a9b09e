/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Score workspace: candidates whitened, projected and orthonormal, for scoring many responses. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "core/parallel.h"
#include "table_loop/between.h"
#include "table_loop/score_many.h"

static size_t candidate_versions(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                                 double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  memset(starts, 0, sizeof(double[FG_LOOP_STARTS][FG_LOOP_SHAPES]));
  return candidate->effect->starts ? candidate->effect->starts(problem, candidate, starts) : 1;
}

static fg_status list_versions(fg_context *ctx, fg_score_workspace *workspace) {
  const fg_loop_problem *problem = workspace->training->problem;
  double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES];
  size_t room[2] = {0};
  for (size_t c = 0; c < workspace->candidates; c++) {
    size_t here = candidate_versions(problem, &workspace->candidate[c], starts);
    size_t columns = fg_engine_candidate_columns(problem, &workspace->candidate[c]);
    size_t all = workspace->versions + here;
    FG_TRY(fg_memory_reserve(ctx, all, sizeof *workspace->version, &room[0],
                             (void **)&workspace->version));
    FG_TRY(fg_memory_reserve(ctx, all, sizeof *workspace->shape, &room[1],
                             (void **)&workspace->shape));
    for (size_t s = 0; s < here; s++) {
      workspace->version[workspace->versions] = (fg_engine_version){.candidate = c, .start = s};
      workspace->version[workspace->versions].first = workspace->columns;
      memcpy(workspace->shape[workspace->versions++], starts[s], sizeof starts[s]);
      workspace->columns += columns;
    }
    if (columns > workspace->widest) workspace->widest = columns;
  }
  return FG_OK;
}

/* Thins the noise models: an effect reduces correlation more often than it adds to it, so the
 * models are those around the null's best, then steps down to none. */
static void thin_noises(fg_score_workspace *workspace, size_t best) {
  size_t kept = 0;
  for (size_t j = 0; j < workspace->noises; j++) {
    bool near = j + 1 >= best && j <= best + 1, below = j + 1 < best && (best - j) % 2 == 1;
    if (!near && !below && workspace->noise[j].rho != 0) continue;
    workspace->noise[kept] = workspace->noise[j];
    workspace->weight[kept++] = workspace->weight[j];
  }
  workspace->noises = kept;
}

/* Returns true when no other noise model lies between two in either parameter. */
static bool next_to(const fg_score_workspace *workspace, fg_engine_noise a, fg_engine_noise b) {
  for (size_t k = 0; k < workspace->noises; k++) {
    fg_engine_noise c = workspace->noise[k];
    if ((c.rho - a.rho) * (c.rho - b.rho) < 0 ||
        (c.lambda - a.lambda) * (c.lambda - b.lambda) < 0 ||
        (c.outer - a.outer) * (c.outer - b.outer) < 0)
      return false;
  }
  return true;
}

/* Thins two strata's models to the null's best and its neighbours. */
static void thin_strata(fg_score_workspace *workspace, size_t best) {
  bool near[FG_ENGINE_NOISES];
  size_t kept = 0;
  for (size_t j = 0; j < workspace->noises; j++)
    near[j] = next_to(workspace, workspace->noise[j], workspace->noise[best]);
  for (size_t j = 0; j < workspace->noises; j++) {
    if (!near[j]) continue;
    workspace->noise[kept] = workspace->noise[j];
    workspace->weight[kept++] = workspace->weight[j];
  }
  workspace->noises = kept;
}

static void find_neighbours(fg_score_workspace *workspace) {
  for (size_t j = 0; j < workspace->noises; j++)
    for (size_t k = 0; k < workspace->noises; k++)
      if (next_to(workspace, workspace->noise[j], workspace->noise[k]))
        workspace->near[j] |= (uint32_t)1 << k;
}

/* Computes weights of the noise models by residual likelihood: with S the residual sum and f the
 * dof, f log S - 2 log|W| + log|X'W'WX|, so that S exp(terms / f) is comparable. */
static fg_status weigh_noises(fg_context *ctx, fg_score_workspace *workspace) {
  const fg_engine_training *training = workspace->training;
  double terms[FG_ENGINE_NOISES], best = INFINITY, sums[FG_ENGINE_NOISES];
  workspace->noises = fg_engine_noise_grid(training, workspace->noise);
  for (size_t j = 0; j < workspace->noises; j++) {
    fg_engine_fit fit;
    FG_TRY(fg_engine_least_squares(ctx, training, workspace->noise[j], &fit));
    terms[j] = fg_engine_log_det(training, workspace->noise[j]) + fit.log_det;
    sums[j] = fit.rss;
    workspace->dof = training->n > fit.rank ? training->n - fit.rank : 0;
    fg_engine_fit_free(&fit);
  }
  double dof = workspace->dof ? (double)workspace->dof : 1;
  for (size_t j = 0; j < workspace->noises; j++)
    best = fmin(best, terms[j]);
  for (size_t j = 0; j < workspace->noises; j++)
    workspace->weight[j] = exp((terms[j] - best) / dof);
  size_t chosen = 0;
  for (size_t j = 1; j < workspace->noises; j++)
    if (sums[j] * workspace->weight[j] < sums[chosen] * workspace->weight[chosen]) chosen = j;
  if (training->n <= FG_ENGINE_SMALL_ROWS) {
    if (training->serial && !training->levels) thin_noises(workspace, chosen);
    if (training->outers) thin_strata(workspace, chosen);
    return FG_OK;
  }
  workspace->noise[0] = workspace->noise[chosen];
  workspace->weight[0] = 1;
  workspace->noises = 1;
  return FG_OK;
}

/* Whitens the version's columns and makes them orthonormal beside the null: at most
 * workspace->widest × n. */
static void version_basis(const fg_score_workspace *workspace, size_t v, size_t j, double *columns,
                          double *unit) {
  const fg_engine_training *training = workspace->training;
  fg_engine_version *version = &workspace->version[v];
  const fg_loop_candidate *candidate = &workspace->candidate[version->candidate];
  size_t n = training->n, count = fg_engine_candidate_columns(training->problem, candidate);
  double lengths[FG_LOOP_COLUMNS], whole = 0;
  for (size_t k = 0; k < count; k++) {
    fg_engine_whiten(training, workspace->noise[j], columns + k * n);
    whole += fg_dot_in_lanes(columns + k * n, columns + k * n, n);
  }
  version->rank = fg_engine_orthonormal(n, workspace->null[j].basis, workspace->null[j].rank,
                                        columns, count, unit, lengths);
  version->length = 0;
  for (size_t k = 0; k < count; k++)
    version->length += lengths[k] / (double)count;
  version->share = whole > 0 ? version->length * (double)count / whole : 0;
}

/* Draws are scored in single precision. */
static void put_rows(size_t n, size_t width, size_t first, const double *columns, size_t count,
                     float *rows) {
  for (size_t k = 0; k < count; k++)
    for (size_t i = 0; i < n; i++)
      rows[i * width + first + k] = (float)columns[k * n + i];
}

typedef struct filling {
  fg_score_workspace *workspace;
  const double *residual; /* noises × n */
} filling;

/* Versions that one thread makes at a time. */
enum { VERSIONS_AT_ONCE = 16 };

/* Fills a version at every noise model; its members stay those of the first. `work` has room for
 * three times its columns. */
static fg_status fill_version(fg_context *ctx, const filling *f, size_t v, double *work) {
  fg_score_workspace *workspace = f->workspace;
  const fg_engine_training *training = workspace->training;
  fg_engine_version *version = &workspace->version[v];
  const fg_loop_candidate *candidate = &workspace->candidate[version->candidate];
  size_t n = training->n, count = fg_engine_candidate_columns(training->problem, candidate);
  size_t width = training->columns + workspace->columns + workspace->between_rank;
  double *columns = work + n * workspace->widest, *unit = columns + n * workspace->widest;
  FG_TRY(fg_engine_gather(ctx, training, candidate, workspace->shape[v], work));
  version->between =
      workspace->between_rank > 0 && fg_engine_constant_in_levels(training, work, count);
  for (size_t j = workspace->noises; j-- > 0;) {
    memcpy(columns, work, n * count * sizeof *work);
    version_basis(workspace, v, j, columns, unit);
    workspace->gain[j * workspace->versions + v] =
        fg_engine_along(n, unit, version->rank, f->residual + j * n);
    put_rows(n, width, training->columns + version->first, unit, version->rank, workspace->rows[j]);
  }
  return FG_OK;
}

static fg_status fill_versions(fg_context *ctx, void *shared, size_t item) {
  const filling *f = shared;
  const fg_score_workspace *workspace = f->workspace;
  size_t from = item * VERSIONS_AT_ONCE, to = from + VERSIONS_AT_ONCE;
  double *work = NULL;
  FG_TRY(fg_memory_allocate(ctx, workspace->training->n * (workspace->widest + 1), 3 * sizeof *work,
                            (void **)&work));
  fg_status status = FG_OK;
  for (size_t v = from; status == FG_OK && v < to && v < workspace->versions; v++)
    status = fill_version(ctx, f, v, work);
  free(work);
  return status;
}

/* Fills what one noise model has without candidates; `residual` gets the whitened response beside
 * the null. */
static fg_status fill_null(fg_context *ctx, fg_score_workspace *workspace, size_t j,
                           double *residual) {
  const fg_engine_training *training = workspace->training;
  size_t n = training->n, rank = training->columns;
  fg_status status = FG_OK;
  double *between = NULL;
  fg_engine_span *null = &workspace->null[j];
  FG_TRY_EXIT(fg_engine_span_open(ctx, training, workspace->noise[j], 0, null));
  FG_TRY_EXIT(fg_engine_between_basis(ctx, training, workspace->noise[j], null, &between,
                                      &workspace->between_rank));
  memcpy(residual, training->y, n * sizeof *residual);
  fg_engine_whiten(training, workspace->noise[j], residual);
  workspace->rss[j] = fg_engine_project_out(n, null->basis, null->rank, residual);
  workspace->between_rss[j] = fg_engine_along(n, between, workspace->between_rank, residual);
  if (n <= FG_ENGINE_SMALL_ROWS) {
    size_t behind = rank + workspace->columns, width = behind + workspace->between_rank;
    FG_TRY_EXIT(fg_memory_allocate(ctx, n, width * sizeof *workspace->rows[j] + 1,
                                   (void **)&workspace->rows[j]));
    put_rows(n, width, 0, null->basis, rank, workspace->rows[j]);
    put_rows(n, width, behind, between, workspace->between_rank, workspace->rows[j]);
  }
exit:
  free(between);
  return status;
}

static fg_status fill_workspace(fg_context *ctx, fg_score_workspace *workspace) {
  size_t n = workspace->training->n;
  size_t items = (workspace->versions + VERSIONS_AT_ONCE - 1) / VERSIONS_AT_ONCE;
  double *residual = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, n, workspace->noises * sizeof *residual, (void **)&residual));
  for (size_t j = workspace->noises; j-- > 0;)
    FG_TRY_EXIT(fill_null(ctx, workspace, j, residual + j * n));
  fg_score_workspace_tell(workspace, 0, 3);
  filling f = {workspace, residual};
  if (n <= FG_ENGINE_SMALL_ROWS)
    FG_TRY_EXIT(fg_parallel_run(ctx, 0, items, fill_versions, &f));
  else
    FG_TRY_EXIT(fg_score_workspace_fill_many(ctx, workspace, residual));
exit:
  free(residual);
  return status;
}

fg_status fg_score_workspace_build(fg_context *ctx, const fg_engine_training *training,
                                   const fg_loop_candidate *candidate, size_t candidates,
                                   fg_score_workspace *workspace) {
  fg_status status = FG_OK;
  const fg_engine_watch watch = workspace->watch;
  *workspace = (fg_score_workspace){
      .training = training, .candidate = candidate, .candidates = candidates, .watch = watch};
  workspace->rank = training->columns;
  FG_TRY_EXIT(list_versions(ctx, workspace));
  FG_TRY_EXIT(weigh_noises(ctx, workspace));
  find_neighbours(workspace);
  FG_TRY_EXIT(fg_memory_allocate(ctx, workspace->noises,
                                 (workspace->versions + 1) * sizeof *workspace->gain,
                                 (void **)&workspace->gain));
  FG_TRY_EXIT(fill_workspace(ctx, workspace));
exit:
  if (status != FG_OK) fg_score_workspace_free(workspace);
  return status;
}

void fg_score_workspace_tell(const fg_score_workspace *workspace, size_t done, size_t all) {
  const fg_engine_watch *watch = &workspace->watch;
  if (watch->show && all) watch->show(watch->user, watch->found, (double)done / (double)all);
}

void fg_score_workspace_free(fg_score_workspace *workspace) {
  for (size_t j = 0; j < FG_ENGINE_NOISES; j++) {
    free(workspace->rows[j]);
    fg_engine_span_close(&workspace->null[j]);
  }
  free(workspace->version);
  free(workspace->shape);
  free(workspace->gain);
  *workspace = (fg_score_workspace){0};
}
