/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/score_many.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_fft_real.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "table_loop/between.h"
#include "table_loop/bins.h"

/* Steps of a coordinate; powers of two for the transform. A cycle has at least 16 of them, so that
 * 99 % of its explained sum is kept. */
enum { STEPS_MIN = 2048, STEPS_MAX = 8192, STEPS_A_HALF_CYCLE = 8 };

typedef struct many {
  fg_score_workspace *workspace;
  size_t n, rank;
  double *vectors; /* (rank + 1) × n: of the null, and the residual */
  size_t *first;   /* candidates + 1: their versions */
} many;

static const fg_loop_candidate *candidate_of(const many *m, size_t c) {
  return &m->workspace->candidate[c];
}

/* Returns true when the best of a candidate's versions can be found over binned sums: for
 * independent rows, and, where neighbours are correlated, for a basis that is smooth along their
 * order. */
static bool in_steps(const many *m, size_t c) {
  const fg_loop_candidate *candidate = candidate_of(m, c);
  const fg_loop_coordinate *at = &m->workspace->training->problem->coordinate[candidate->a];
  const fg_engine_noise noise = m->workspace->noise[0];
  if (m->first[c + 1] - m->first[c] < 2 || candidate->effect->pair || !(at->high > at->low))
    return false;
  return noise.lambda == 0 && noise.outer == 0 && (noise.rho == 0 || at->roles & FG_LOOP_ORDER);
}

static double half_cycles(const fg_loop_coordinate *at, double period) {
  return 2 * (at->high - at->low) / period;
}

/* Returns true for a cycle whose start values are half a cycle apart. */
static bool is_cycle(const many *m, size_t c, size_t steps) {
  const fg_loop_candidate *candidate = candidate_of(m, c);
  const fg_loop_coordinate *at = &m->workspace->training->problem->coordinate[candidate->a];
  if (!candidate->effect->cycle) return false;
  for (size_t v = m->first[c]; v < m->first[c + 1]; v++) {
    double half = half_cycles(at, m->workspace->shape[v][0]);
    if (fabs(half - round(half)) > 1e-6 || half < 1 || 2 * half > (double)steps) return false;
  }
  return true;
}

static size_t count_steps(const many *m, size_t coordinate) {
  const fg_loop_coordinate *at = &m->workspace->training->problem->coordinate[coordinate];
  size_t steps = STEPS_MIN;
  for (size_t c = 0; c < m->workspace->candidates; c++) {
    const fg_loop_candidate *candidate = candidate_of(m, c);
    if (candidate->a != coordinate || !candidate->effect->cycle) continue;
    for (size_t v = m->first[c]; v < m->first[c + 1]; v++)
      while (steps < STEPS_MAX &&
             (double)steps < STEPS_A_HALF_CYCLE * half_cycles(at, m->workspace->shape[v][0]))
        steps *= 2;
  }
  return steps;
}

typedef struct first_look {
  fg_engine_bins bins;
  double *columns; /* widest × steps */
  double *waves;   /* (rank + 2) × 2 steps: transforms of the vectors and of the weight; NULL: not
                      computed yet */
  fg_engine_gram gram;
} first_look;

static fg_status transform(fg_context *ctx, first_look *look) {
  size_t steps = look->bins.count, count = look->bins.rank + 2;
  FG_TRY(fg_memory_allocate(ctx, count, 2 * steps * sizeof *look->waves, (void **)&look->waves));
  for (size_t k = 0; k < count; k++) {
    double *wave = look->waves + k * 2 * steps;
    const double *from = k + 1 < count ? look->bins.vectors + k * steps : look->bins.weight;
    memcpy(wave, from, steps * sizeof *wave);
    if (gsl_fft_real_radix2_transform(wave, 1, 2 * steps) != GSL_SUCCESS)
      return fg_fail(ctx, FG_ERR_NUMERIC, "no transform over %zu steps", 2 * steps);
  }
  return FG_OK;
}

/* The gram of cos and sin of h half cycles over the steps, their phase counted from the first. */
static void cycle_gram(first_look *look, size_t h) {
  size_t steps = look->bins.count, all = 2 * steps, rank = look->bins.rank;
  fg_engine_gram *gram = &look->gram;
  gram->count = 2;
  gram->rank = rank;
  for (size_t k = 0; k <= rank; k++) {
    const double *wave = look->waves + k * all;
    gram->cross[k] = wave[h];
    gram->cross[rank + 1 + k] = -wave[all - h];
  }
  const double *weight = look->waves + (rank + 1) * all;
  gram->own[0] = (weight[0] + weight[2 * h]) / 2;
  gram->own[FG_LOOP_COLUMNS] = 2 * h < steps ? -weight[all - 2 * h] / 2 : 0;
  gram->own[FG_LOOP_COLUMNS + 1] = (weight[0] - weight[2 * h]) / 2;
}

static void put_version(fg_score_workspace *workspace, size_t v, fg_engine_beside_null beside) {
  workspace->version[v].rank = beside.rank;
  workspace->version[v].length = beside.length;
  workspace->version[v].share = beside.share;
  workspace->gain[v] = beside.gain;
}

/* All versions of a candidate over sums; all but the best lose their rank. */
static fg_status look_at(fg_context *ctx, const many *m, size_t c, first_look *look) {
  fg_score_workspace *workspace = m->workspace;
  const fg_loop_candidate *candidate = candidate_of(m, c);
  const fg_loop_coordinate *at = &workspace->training->problem->coordinate[candidate->a];
  bool cycle = is_cycle(m, c, look->bins.count);
  size_t best = m->first[c];
  if (cycle && !look->waves) FG_TRY(transform(ctx, look));
  for (size_t v = m->first[c]; v < m->first[c + 1]; v++) {
    if (cycle)
      cycle_gram(look, (size_t)round(half_cycles(at, workspace->shape[v][0])));
    else
      fg_engine_bins_gram(&look->bins, candidate, workspace->shape[v], look->columns, &look->gram);
    put_version(workspace, v, fg_engine_gram_solve(&look->gram));
    if (workspace->version[v].rank && workspace->gain[v] > workspace->gain[best]) best = v;
  }
  for (size_t v = m->first[c]; v < m->first[c + 1]; v++)
    if (v != best) workspace->version[v].rank = 0;
  return FG_OK;
}

/* Scores, over binned sums, all candidates of one coordinate. */
static fg_status score_binned(fg_context *ctx, void *shared, size_t coordinate) {
  const many *m = shared;
  fg_score_workspace *workspace = m->workspace;
  first_look look = {0};
  bool any = false;
  fg_status status = FG_OK;
  for (size_t c = 0; c < workspace->candidates; c++)
    any |= candidate_of(m, c)->a == coordinate && in_steps(m, c);
  if (!any) return FG_OK;
  size_t steps = count_steps(m, coordinate), cross = FG_LOOP_COLUMNS * (m->rank + 1);
  FG_TRY_EXIT(fg_engine_bins_open(ctx, workspace->training, coordinate, steps, m->vectors, m->rank,
                                  &look.bins));
  FG_TRY_EXIT(fg_memory_allocate(ctx, steps, workspace->widest * sizeof *look.columns,
                                 (void **)&look.columns));
  FG_TRY_EXIT(fg_memory_allocate(ctx, cross, sizeof *look.gram.cross, (void **)&look.gram.cross));
  for (size_t c = 0; c < workspace->candidates; c++)
    if (candidate_of(m, c)->a == coordinate && in_steps(m, c))
      FG_TRY_EXIT(look_at(ctx, m, c, &look));
exit:
  fg_engine_bins_close(&look.bins);
  free(look.columns);
  free(look.waves);
  free(look.gram.cross);
  return status;
}

/* Scores the remaining versions of a candidate on all rows. */
static fg_status score_candidate(fg_context *ctx, void *shared, size_t c) {
  const many *m = shared;
  fg_score_workspace *workspace = m->workspace;
  const fg_loop_candidate *candidate = candidate_of(m, c);
  size_t count = fg_engine_candidate_columns(workspace->training->problem, candidate);
  bool looked = in_steps(m, c);
  double *columns = NULL;
  fg_engine_gram gram = {0};
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, m->n, (count + 1) * sizeof *columns, (void **)&columns));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, count + 1, (m->rank + 1) * sizeof *gram.cross, (void **)&gram.cross));
  for (size_t v = m->first[c]; v < m->first[c + 1]; v++) {
    if (looked && !workspace->version[v].rank) continue;
    FG_TRY_EXIT(
        fg_engine_gather(ctx, workspace->training, candidate, workspace->shape[v], columns));
    workspace->version[v].between =
        workspace->between_rank > 0 &&
        fg_engine_constant_in_levels(workspace->training, columns, count);
    for (size_t k = 0; k < count; k++)
      fg_engine_whiten(workspace->training, workspace->noise[0], columns + k * m->n);
    fg_engine_gram_take(m->n, columns, count, NULL, m->vectors, m->rank, &gram);
    put_version(workspace, v, fg_engine_gram_solve(&gram));
  }
exit:
  free(columns);
  free(gram.cross);
  return status;
}

fg_status fg_score_workspace_fill_many(fg_context *ctx, fg_score_workspace *workspace,
                                       const double *residual) {
  const fg_engine_span *null = &workspace->null[0];
  many m = {.workspace = workspace, .n = null->n, .rank = null->rank};
  size_t size = null->n * sizeof *m.vectors,
         coordinates = workspace->training->problem->coordinates;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, null->rank + 1, size, (void **)&m.vectors));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, workspace->candidates + 1, sizeof *m.first, (void **)&m.first));
  memcpy(m.vectors, null->basis, null->rank * size);
  memcpy(m.vectors + null->rank * null->n, residual, size);
  for (size_t v = 0; v < workspace->versions; v++)
    m.first[workspace->version[v].candidate + 1] = v + 1;
  for (size_t c = 1; c <= workspace->candidates; c++)
    if (m.first[c] < m.first[c - 1]) m.first[c] = m.first[c - 1];
  FG_TRY_EXIT(fg_parallel_run(ctx, 0, coordinates, score_binned, &m));
  FG_TRY_EXIT(fg_parallel_run(ctx, 0, workspace->candidates, score_candidate, &m));
exit:
  free(m.vectors);
  free(m.first);
  return status;
}
