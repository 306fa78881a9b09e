/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scores: a candidate's F ratio at its best version and noise, of one response or of a batch of
 * draws, as a normal deviate. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "table_loop/engine.h"

double fg_engine_version_dof(const fg_score_workspace *workspace,
                             const fg_engine_version *version) {
  const fg_loop_effect *effect = workspace->candidate[version->candidate].effect;
  return (double)version->rank + (double)effect->shapes;
}

double fg_engine_version_whole(const fg_score_workspace *workspace,
                               const fg_engine_version *version) {
  return (double)(version->between ? workspace->between_rank : workspace->dof);
}

/* Wilson and Hilferty's normal deviate of an F ratio: close enough to compare candidates of
 * different dof, and monotone, so p-values from simulation stay exact. */
double fg_engine_deviate(double ratio, double k, double dof) {
  double nu = dof - k, f = (1 / ratio - 1) * nu / k;
  double root = cbrt(f), a = 2 / (9 * nu), b = 2 / (9 * k);
  return ((1 - a) * root - (1 - b)) / sqrt(a * root * root + b);
}

double fg_engine_deviate_to_f(double z, double k, double nu) {
  double low = 0, high = 1e9;
  for (int i = 0; i < 100; i++) {
    double f = sqrt((low + 1e-6) * high);
    double ratio = 1 / (1 + f * k / nu);
    if (fg_engine_deviate(ratio, k, nu + k) < z)
      low = f;
    else
      high = f;
  }
  return high < 0.99e9 ? high : INFINITY;
}

/* Residual sums at one noise model. */
typedef struct residual_sums {
  double rss, between; /* without any candidate: of rows, and of differences between groups */
} residual_sums;

static bool can_be_scored(const fg_score_workspace *workspace, const fg_engine_version *version) {
  double min = version->between ? 1 : 2;
  return version->rank > 0 && fg_engine_version_dof(workspace, version) + min <=
                                  fg_engine_version_whole(workspace, version);
}

static double share_left(double whole, double gain) {
  return whole > 0 ? fmax(1 - gain / whole, FG_ENGINE_RATIO_MIN) : 1;
}

/* Stores the version's score if it is the candidate's best; `gain` is its reduction of the residual
 * sum. */
static void keep_version(const fg_score_workspace *workspace, size_t v, size_t j,
                         residual_sums sums, double gain, fg_engine_score *score) {
  const fg_engine_version *version = &workspace->version[v];
  fg_engine_score *best = &score[version->candidate];
  double weighted = share_left(sums.rss, gain) * sums.rss * workspace->weight[j];
  if (!(weighted < best->ratio) || !can_be_scored(workspace, version)) return;
  double own = version->between ? share_left(sums.between, gain) : NAN;
  *best = (fg_engine_score){.ratio = weighted, .own = own, .version = v, .noise = j};
}

static void finish_scores(const fg_score_workspace *workspace, double null,
                          fg_engine_score *score) {
  for (size_t c = 0; c < workspace->candidates; c++) {
    if (!isfinite(score[c].ratio)) {
      score[c].z = NAN;
      continue;
    }
    const fg_engine_version *version = &workspace->version[score[c].version];
    score[c].ratio = fmin(score[c].ratio / null, 1);
    if (!version->between) score[c].own = score[c].ratio;
    score[c].z = fg_engine_deviate(score[c].own, fg_engine_version_dof(workspace, version),
                                   fg_engine_version_whole(workspace, version));
  }
}

static void clear_scores(size_t count, fg_engine_score *score) {
  for (size_t c = 0; c < count; c++)
    score[c] = (fg_engine_score){.ratio = INFINITY, .z = NAN};
}

void fg_score_workspace_score_data(const fg_score_workspace *workspace, fg_engine_score *score,
                                   size_t *null) {
  *null = 0;
  clear_scores(workspace->candidates, score);
  for (size_t j = 0; j < workspace->noises; j++) {
    const double *gain = workspace->gain + j * workspace->versions;
    if (workspace->rss[j] * workspace->weight[j] < workspace->rss[*null] * workspace->weight[*null])
      *null = j;
    for (size_t v = 0; v < workspace->versions; v++)
      keep_version(workspace, v, j, (residual_sums){workspace->rss[j], workspace->between_rss[j]},
                   gain[v], score);
  }
  finish_scores(workspace, workspace->rss[*null] * workspace->weight[*null], score);
}
/* Responses of a batch interleaved, so that every column of the workspace is read once for all. */
typedef struct response_batch {
  size_t count;
  float *white; /* n × FG_ENGINE_BATCH */
  float *sums;  /* the workspace's width × FG_ENGINE_BATCH */
  double *one;  /* n */
  double rss[FG_ENGINE_BATCH], lowest[FG_ENGINE_BATCH];
} response_batch;

static void whiten_batch(const fg_score_workspace *workspace, fg_engine_noise noise,
                         const double *y, response_batch *batch) {
  size_t n = workspace->training->n;
  for (size_t b = 0; b < FG_ENGINE_BATCH; b++) {
    bool used = b < batch->count;
    batch->rss[b] = 0;
    if (used) {
      memcpy(batch->one, y + b * n, n * sizeof *batch->one);
      fg_engine_whiten(workspace->training, noise, batch->one);
    }
    for (size_t i = 0; i < n; i++) {
      batch->white[i * FG_ENGINE_BATCH + b] = used ? (float)batch->one[i] : 0;
      batch->rss[b] += used ? batch->one[i] * batch->one[i] : 0;
    }
  }
}

/* Block of columns whose sums stay in the nearest cache. */
enum { BLOCK = 64 };

/* One value of every response of a batch. */
typedef float batch_lane __attribute__((vector_size(FG_ENGINE_BATCH * sizeof(float)), aligned(4)));

/* Four rows at a time, so that a sum is loaded and stored once for all four. */
__attribute__((target_clones("avx2", "default"))) static void
products(size_t n, size_t width, const float *rows, const float *white, float *sums) {
  const batch_lane *at = (const batch_lane *)white;
  batch_lane *sum = (batch_lane *)sums;
  memset(sums, 0, width * sizeof *sum);
  for (size_t from = 0; from < width; from += BLOCK) {
    size_t to = from + BLOCK < width ? from + BLOCK : width, i = 0;
    for (; i + 4 <= n; i += 4) {
      const float *row = rows + i * width;
      batch_lane a = at[i], b = at[i + 1], c = at[i + 2], d = at[i + 3];
      for (size_t k = from; k < to; k++)
        sum[k] += row[k] * a + row[width + k] * b + row[2 * width + k] * c + row[3 * width + k] * d;
    }
    for (; i < n; i++)
      for (size_t k = from; k < to; k++)
        sum[k] += rows[i * width + k] * at[i];
  }
}

static double sum_of_squares(const float *v, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += (double)v[i * FG_ENGINE_BATCH] * v[i * FG_ENGINE_BATCH];
  return sum;
}

static void score_at(const fg_score_workspace *workspace, size_t j, const double *y,
                     response_batch *batch, fg_engine_score *score) {
  size_t between = workspace->rank + workspace->columns;
  whiten_batch(workspace, workspace->noise[j], y, batch);
  products(workspace->training->n, between + workspace->between_rank, workspace->rows[j],
           batch->white, batch->sums);
  for (size_t b = 0; b < batch->count; b++) {
    const float *sums = batch->sums + workspace->rank * FG_ENGINE_BATCH + b;
    residual_sums whole = {
        batch->rss[b] - sum_of_squares(batch->sums + b, workspace->rank),
        sum_of_squares(batch->sums + between * FG_ENGINE_BATCH + b, workspace->between_rank)};
    if (whole.rss * workspace->weight[j] < batch->lowest[b])
      batch->lowest[b] = whole.rss * workspace->weight[j];
    for (size_t v = 0; v < workspace->versions; v++) {
      const fg_engine_version *version = &workspace->version[v];
      double gain = sum_of_squares(sums + version->first * FG_ENGINE_BATCH, version->rank);
      keep_version(workspace, v, j, whole, gain, score + b * workspace->candidates);
    }
  }
}

fg_status fg_score_workspace_score(fg_context *ctx, const fg_score_workspace *workspace,
                                   size_t count, const double *y, fg_engine_score *score) {
  size_t n = workspace->training->n,
         width = workspace->rank + workspace->columns + workspace->between_rank;
  fg_status status = FG_OK;
  response_batch batch = {.count = count};
  clear_scores(count * workspace->candidates, score);
  size_t block = FG_ENGINE_BATCH * sizeof *batch.white;
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, block, (void **)&batch.white));
  FG_TRY_EXIT(fg_memory_allocate(ctx, width, block, (void **)&batch.sums));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, sizeof *batch.one, (void **)&batch.one));
  for (size_t b = 0; b < count; b++)
    batch.lowest[b] = INFINITY;
  for (size_t j = 0; j < workspace->noises; j++)
    score_at(workspace, j, y, &batch, score);
  for (size_t b = 0; b < count; b++)
    finish_scores(workspace, batch.lowest[b], score + b * workspace->candidates);
exit:
  free(batch.white);
  free(batch.sums);
  free(batch.one);
  return status;
}
