/* SPDX-License-Identifier: GPL-3.0-or-later */
/* P-values for few bumps without assumptions on their scatter. For trends over the number, the
 * numbers of a foil's bumps are permuted (exact if the bumps are exchangeable); for stretch, the
 * signs of their residuals are flipped. Sign flips are weak for trends: of nine bumps beside a
 * mean, they leave a trend half of its size. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/splitmix.h"
#include "scan_loop/bumps.h"

enum { DRAWS = 1999 };

/* Decay lengths of part.lip_decay, in bumps; 0: a straight line. */
static const double lengths[] = {0, 0.6, 1.2, 2.4, 4};
enum { LENGTHS = sizeof lengths / sizeof *lengths };

typedef struct trend_workspace {
  size_t n, *first, foils; /* first row of each foil, and n */
  double *shape[LENGTHS];  /* each foil's mean taken out, of length 1 */
} trend_workspace;

static void centre(const trend_workspace *workspace, double *v) {
  for (size_t f = 0; f < workspace->foils; f++) {
    double mean = 0;
    size_t from = workspace->first[f], to = workspace->first[f + 1];
    for (size_t i = from; i < to; i++)
      mean += v[i] / (double)(to - from);
    for (size_t i = from; i < to; i++)
      v[i] -= mean;
  }
}

static fg_status open_trends(fg_context *ctx, const double *number, const size_t *series, size_t n,
                             trend_workspace *workspace) {
  workspace->n = n;
  FG_TRY(fg_memory_allocate(ctx, n + 1, sizeof *workspace->first, (void **)&workspace->first));
  for (size_t i = 0; i < n; i++)
    if (!i || series[i] != series[i - 1]) workspace->first[workspace->foils++] = i;
  workspace->first[workspace->foils] = n;
  for (size_t k = 0; k < LENGTHS; k++) {
    double *v, size = 0;
    FG_TRY(fg_memory_allocate(ctx, n, sizeof *v, (void **)&workspace->shape[k]));
    v = workspace->shape[k];
    for (size_t i = 0; i < n; i++)
      v[i] = lengths[k] > 0 ? exp(-(number[i] - 1) / lengths[k]) : number[i];
    centre(workspace, v);
    for (size_t i = 0; i < n; i++)
      size += v[i] * v[i];
    for (size_t i = 0; i < n && size > 0; i++)
      v[i] /= sqrt(size);
  }
  return FG_OK;
}

static double best_trend(const trend_workspace *workspace, const double *residual) {
  double best = 0;
  for (size_t k = 0; k < LENGTHS; k++) {
    double sum = 0;
    for (size_t i = 0; i < workspace->n; i++)
      sum += workspace->shape[k][i] * residual[i];
    best = fmax(best, sum * sum);
  }
  return best;
}

static void shuffle(const trend_workspace *workspace, uint64_t *seed, double *v) {
  for (size_t f = 0; f < workspace->foils; f++)
    for (size_t i = workspace->first[f + 1] - 1; i > workspace->first[f]; i--) {
      size_t from = workspace->first[f], span = i - from + 1;
      size_t k = from + (size_t)(fg_splitmix_uniform(seed) * (double)span);
      double value = v[i];
      v[i] = v[k];
      v[k] = value;
    }
}

static double trend_p(const trend_workspace *workspace, double *residual, uint64_t seed) {
  centre(workspace, residual);
  double observed = best_trend(workspace, residual) * (1 - 1e-9);
  size_t beyond = 1;
  for (size_t d = 0; d < DRAWS; d++) {
    shuffle(workspace, &seed, residual);
    beyond += best_trend(workspace, residual) >= observed;
  }
  return (double)beyond / (DRAWS + 1);
}

/* |sum| with the signs of the bits that are set turned round. */
static double signed_sum(const double *product, size_t n, uint64_t signs) {
  double sum = 0;
  for (size_t i = 0; i < n; i++)
    sum += i < 64 && signs >> i & 1 ? -product[i] : product[i];
  return fabs(sum);
}

/* All patterns where they are few (a pattern and its mirror image are one), else random ones. */
static double sign_p(double *product, size_t n, uint64_t seed) {
  enum { FEW = 12 };
  double observed = signed_sum(product, n, 0) * (1 - 1e-9);
  size_t draws = n <= FEW ? ((size_t)1 << (n - 1)) - 1 : DRAWS, beyond = 1;
  for (size_t d = 1; d <= draws; d++) {
    uint64_t signs = d;
    for (size_t i = 0; n > FEW && i < n; i++) /* each draw flips the one before it anew */
      if (fg_splitmix_next(&seed) >> 63) product[i] = -product[i];
    beyond += signed_sum(product, n, n > FEW ? 0 : signs) >= observed;
  }
  return (double)beyond / (double)(draws + 1);
}

fg_status fg_scan_loop_bumps_null_p(fg_context *ctx, const fg_loop_problem *problem,
                                    const fg_loop_claim *claim, uint64_t seed, double *p_value) {
  const fg_loop_coordinate *at = &problem->coordinate[claim->candidate.a];
  fg_status status = FG_OK;
  trend_workspace workspace = {0};
  double *residual = NULL, *value;
  size_t *series = NULL, n = 0;
  FG_TRY_EXIT(fg_memory_allocate(ctx, problem->rows, 2 * sizeof *residual, (void **)&residual));
  FG_TRY_EXIT(fg_memory_allocate(ctx, problem->rows, sizeof *series, (void **)&series));
  value = residual + problem->rows;
  for (size_t i = 0; i < problem->rows; i++) {
    if (problem->held_out[i]) continue;
    residual[n] = problem->residual[i];
    value[n] = at->value[i];
    series[n++] = problem->series[i];
  }
  if (at->roles & FG_LOOP_SENSITIVITY) {
    for (size_t i = 0; i < n; i++)
      value[i] *= residual[i];
    *p_value = sign_p(value, n, seed);
    goto exit;
  }
  FG_TRY_EXIT(open_trends(ctx, value, series, n, &workspace));
  *p_value = trend_p(&workspace, residual, seed);
exit:
  for (size_t k = 0; k < LENGTHS; k++)
    free(workspace.shape[k]);
  free(workspace.first);
  free(residual);
  free(series);
  return status;
}
