/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scores of draws. First the residual sum of every draw without any candidate, at every noise
 * model: a few columns. Then the candidates, a few thousand columns, at the noise model where that
 * sum is lowest and at its neighbours on the grid: a candidate that explains no more than chance
 * moves the noise no farther. */
#include "table_loop/score_draws.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

/* Draws scored in one pass over the columns. */
enum { LANES = 16 };

typedef struct draw_pool {
  const fg_score_workspace *workspace;
  size_t count, n, width;
  const double *y;                /* count × n */
  double *rss;                    /* noises × count */
  double lowest[FG_ENGINE_BATCH]; /* weighted */
  size_t best[FG_ENGINE_BATCH];   /* noise where it is lowest */
  float *white;                   /* n × LANES, interleaved: a column is read once for all */
  float *sums;                    /* width × LANES */
  double *one;                    /* n */
  size_t draw[LANES], lanes;      /* draws of the pass */
  double square[LANES];           /* of each, whitened */
} draw_pool;

static void whiten_lanes(draw_pool *pool, size_t j) {
  const fg_score_workspace *workspace = pool->workspace;
  size_t n = pool->n;
  memset(pool->white, 0, n * LANES * sizeof *pool->white);
  for (size_t b = 0; b < pool->lanes; b++) {
    double square = 0;
    memcpy(pool->one, pool->y + pool->draw[b] * n, n * sizeof *pool->one);
    fg_engine_whiten(workspace->training, workspace->noise[j], pool->one);
    for (size_t i = 0; i < n; i++) {
      pool->white[i * LANES + b] = (float)pool->one[i];
      square += pool->one[i] * pool->one[i];
    }
    pool->square[b] = square;
  }
}

/* Block of columns whose sums stay in the nearest cache. */
enum { BLOCK = 64 };

/* One value of every draw of a pass. */
typedef float draw_lanes __attribute__((vector_size(LANES * sizeof(float)), aligned(4)));

/* Four rows at a time, so that a sum is loaded and stored once for all four. */
__attribute__((target_clones("avx2", "default"))) static void
products(size_t n, size_t stride, size_t width, const float *rows, const float *white,
         float *sums) {
  const draw_lanes *at = (const draw_lanes *)white;
  draw_lanes *sum = (draw_lanes *)sums;
  memset(sums, 0, width * sizeof *sum);
  for (size_t from = 0; from < width; from += BLOCK) {
    size_t to = from + BLOCK < width ? from + BLOCK : width, i = 0;
    for (; i + 4 <= n; i += 4) {
      const float *row = rows + i * stride;
      const float *second = row + stride, *third = second + stride, *fourth = third + stride;
      draw_lanes a = at[i], b = at[i + 1], c = at[i + 2], d = at[i + 3];
      for (size_t k = from; k < to; k++)
        sum[k] += row[k] * a + second[k] * b + third[k] * c + fourth[k] * d;
    }
    for (; i < n; i++)
      for (size_t k = from; k < to; k++)
        sum[k] += rows[i * stride + k] * at[i];
  }
}

static double sum_of_squares(const float *v, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += (double)v[i * LANES] * v[i * LANES];
  return sum;
}

/* Residual sums of all draws without any candidate. */
static void score_null(draw_pool *pool, size_t j) {
  const fg_score_workspace *workspace = pool->workspace;
  for (size_t first = 0; first < pool->count; first += LANES) {
    pool->lanes = pool->count - first < LANES ? pool->count - first : LANES;
    for (size_t b = 0; b < pool->lanes; b++)
      pool->draw[b] = first + b;
    whiten_lanes(pool, j);
    products(pool->n, pool->width, workspace->rank, workspace->rows[j], pool->white, pool->sums);
    for (size_t b = 0; b < pool->lanes; b++) {
      double *rss = &pool->rss[j * pool->count + first + b];
      *rss = pool->square[b] - sum_of_squares(pool->sums + b, workspace->rank);
      if (!(*rss * workspace->weight[j] < pool->lowest[first + b])) continue;
      pool->lowest[first + b] = *rss * workspace->weight[j];
      pool->best[first + b] = j;
    }
  }
}

/* Scores the candidates at one noise model, for the draws of a pass. */
static void score_pass(draw_pool *pool, size_t j, fg_engine_score *score) {
  const fg_score_workspace *workspace = pool->workspace;
  size_t rank = workspace->rank, between = workspace->columns;
  whiten_lanes(pool, j);
  products(pool->n, pool->width, pool->width - rank, workspace->rows[j] + rank, pool->white,
           pool->sums);
  for (size_t b = 0; b < pool->lanes; b++) {
    const float *sums = pool->sums + b;
    fg_score_sums whole = {pool->rss[j * pool->count + pool->draw[b]],
                           sum_of_squares(sums + between * LANES, workspace->between_rank)};
    for (size_t v = 0; v < workspace->versions; v++) {
      const fg_engine_version *version = &workspace->version[v];
      double gain = sum_of_squares(sums + version->first * LANES, version->rank);
      fg_score_keep_version(workspace, v, j, whole, gain,
                            score + pool->draw[b] * workspace->candidates);
    }
  }
}

/* Scores the candidates at one noise model, for every draw that has it near its own. */
static void score_near(draw_pool *pool, size_t j, fg_engine_score *score) {
  pool->lanes = 0;
  for (size_t b = 0; b < pool->count; b++) {
    if (pool->workspace->near[pool->best[b]] >> j & 1) pool->draw[pool->lanes++] = b;
    if (pool->lanes < LANES && !(pool->lanes && b + 1 == pool->count)) continue;
    score_pass(pool, j, score);
    pool->lanes = 0;
  }
}

static fg_status open_pool(fg_context *ctx, const fg_score_workspace *workspace, draw_pool *pool) {
  size_t lanes = LANES * sizeof *pool->white;
  pool->n = workspace->training->n;
  pool->width = workspace->rank + workspace->columns + workspace->between_rank;
  for (size_t b = 0; b < pool->count; b++)
    pool->lowest[b] = INFINITY;
  FG_TRY(fg_memory_allocate(ctx, workspace->noises, pool->count * sizeof *pool->rss,
                            (void **)&pool->rss));
  FG_TRY(fg_memory_allocate(ctx, pool->n, lanes, (void **)&pool->white));
  FG_TRY(fg_memory_allocate(ctx, pool->width + 1, lanes, (void **)&pool->sums));
  return fg_memory_allocate(ctx, pool->n, sizeof *pool->one, (void **)&pool->one);
}

fg_status fg_score_workspace_score(fg_context *ctx, const fg_score_workspace *workspace,
                                   size_t count, const double *y, fg_engine_score *score) {
  fg_status status = FG_OK;
  draw_pool pool = {.workspace = workspace, .count = count, .y = y};
  fg_score_clear(count * workspace->candidates, score);
  FG_TRY_EXIT(open_pool(ctx, workspace, &pool));
  for (size_t j = 0; j < workspace->noises; j++)
    score_null(&pool, j);
  for (size_t j = 0; j < workspace->noises; j++)
    score_near(&pool, j, score);
  for (size_t b = 0; b < count; b++)
    fg_score_finish(workspace, pool.lowest[b], score + b * workspace->candidates);
exit:
  free(pool.rss);
  free(pool.white);
  free(pool.sums);
  free(pool.one);
  return status;
}
