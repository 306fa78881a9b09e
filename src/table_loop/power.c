/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Smallest detectable amplitude by simulation, with the noise estimated anew in every draw, as in
 * the search. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/splitmix.h"
#include "table_loop/assess.h"

enum { DRAWS = 60, HALVINGS = 14 };
static const double wanted = 0.8;

/* Products with the workspace's columns at every noise: of each draw of noise, and of the effect.
 */
typedef struct power_workspace {
  const fg_score_workspace *workspace;
  size_t width;
  double *noise[FG_ENGINE_NOISES];  /* DRAWS × (width + 1), |We|² last */
  double *effect[FG_ENGINE_NOISES]; /* width + 1, |Wf|² last */
  double *cross[FG_ENGINE_NOISES];  /* DRAWS: (We)'(Wf) */
  double *draws;                    /* DRAWS × n, not whitened */
  double *white, *f;
} power_workspace;

static fg_status open_power(fg_context *ctx, const fg_score_workspace *workspace,
                            power_workspace *power) {
  size_t n = workspace->training->n;
  *power =
      (power_workspace){.workspace = workspace,
                        .width = workspace->rank + workspace->columns + workspace->between_rank};
  size_t row = (power->width + 1) * sizeof(double);
  for (size_t j = 0; j < workspace->noises; j++) {
    FG_TRY(fg_memory_allocate(ctx, DRAWS, row, (void **)&power->noise[j]));
    FG_TRY(fg_memory_allocate(ctx, 1, row, (void **)&power->effect[j]));
    FG_TRY(fg_memory_allocate(ctx, DRAWS, sizeof(double), (void **)&power->cross[j]));
  }
  FG_TRY(fg_memory_allocate(ctx, DRAWS, n * sizeof(double), (void **)&power->draws));
  FG_TRY(fg_memory_allocate(ctx, n, 2 * sizeof(double), (void **)&power->white));
  return fg_memory_allocate(ctx, workspace->training->problem->rows,
                            FG_LOOP_COLUMNS * sizeof(double), (void **)&power->f);
}

static void close_power(power_workspace *power) {
  for (size_t j = 0; j < FG_ENGINE_NOISES; j++) {
    free(power->noise[j]);
    free(power->effect[j]);
    free(power->cross[j]);
  }
  free(power->draws);
  free(power->white);
  free(power->f);
}

static void products(const power_workspace *power, size_t j, const double *white, double *sums) {
  const fg_score_workspace *workspace = power->workspace;
  memset(sums, 0, (power->width + 1) * sizeof *sums);
  for (size_t i = 0; i < workspace->training->n; i++) {
    const float *row = workspace->rows[j] + i * power->width;
    for (size_t k = 0; k < power->width; k++)
      sums[k] += row[k] * white[i];
    sums[power->width] += white[i] * white[i];
  }
}

static void draw_noise(power_workspace *power, fg_engine_noise noise, uint64_t seed) {
  const fg_score_workspace *workspace = power->workspace;
  size_t n = workspace->training->n;
  for (size_t b = 0; b < DRAWS; b++) {
    double *y = power->draws + b * n;
    for (size_t i = 0; i < n; i++)
      y[i] = fg_splitmix_normal(&seed);
    fg_engine_colour(workspace->training, noise, y);
    for (size_t j = 0; j < workspace->noises; j++) {
      memcpy(power->white, y, n * sizeof *y);
      fg_engine_whiten(workspace->training, workspace->noise[j], power->white);
      products(power, j, power->white, power->noise[j] + b * (power->width + 1));
    }
  }
}

/* Sets the effect to the columns of the middle version, the k-th weighted by k: neither the
 * clearest of many patterns nor one that the declared model absorbs. Half range 1. */
static fg_status set_effect(fg_context *ctx, power_workspace *power, size_t version) {
  const fg_score_workspace *workspace = power->workspace;
  const fg_engine_training *training = workspace->training;
  size_t n = training->n;
  double low = INFINITY, high = -INFINITY, *f = power->f, *other = power->white + n;
  FG_TRY(fg_engine_gather(ctx, training,
                          &workspace->candidate[workspace->version[version].candidate],
                          workspace->shape[version], f));
  const fg_loop_candidate *candidate = &workspace->candidate[workspace->version[version].candidate];
  size_t count = fg_engine_candidate_columns(training->problem, candidate);
  for (size_t i = 0; i < n; i++) {
    for (size_t k = 1; k < count; k++)
      f[i] += (double)(k + 1) * f[k * n + i];
    low = fmin(low, f[i]);
    high = fmax(high, f[i]);
  }
  double scale = candidate->effect->from_zero ? fmax(fabs(low), fabs(high)) : (high - low) / 2;
  for (size_t i = 0; i < n; i++)
    f[i] /= scale > 0 ? scale : 1;
  for (size_t j = 0; j < workspace->noises; j++) {
    memcpy(power->white, f, n * sizeof *f);
    fg_engine_whiten(training, workspace->noise[j], power->white);
    products(power, j, power->white, power->effect[j]);
    for (size_t b = 0; b < DRAWS; b++) {
      memcpy(other, power->draws + b * n, n * sizeof *other);
      fg_engine_whiten(training, workspace->noise[j], other);
      power->cross[j][b] = 0;
      for (size_t i = 0; i < n; i++)
        power->cross[j][b] += other[i] * power->white[i];
    }
  }
  return FG_OK;
}

/* Versions of one candidate, which lie together. */
typedef struct versions_of {
  size_t first, count;
} versions_of;

static versions_of find_versions(const fg_score_workspace *workspace, size_t c) {
  versions_of own = {workspace->versions, 0};
  for (size_t v = 0; v < workspace->versions; v++)
    if (workspace->version[v].candidate == c && !own.count++) own.first = v;
  return own;
}

/* Returns the version in the middle, which stands for all. */
static size_t middle_of(versions_of own) {
  return own.first + own.count / 2;
}

typedef struct draw_sums {
  double null, with; /* weighted residual sums: without the candidate, with its best version */
  double own;        /* with over without, between groups */
} draw_sums;

static double squares(const double *e, const double *f, double a, size_t from, size_t count) {
  double sum = 0;
  for (size_t k = from; k < from + count; k++)
    sum += (e[k] + a * f[k]) * (e[k] + a * f[k]);
  return sum;
}

/* Of noise + a f at one noise model. */
static draw_sums residual_sums(const power_workspace *power, versions_of own, size_t b, size_t j,
                               double a) {
  const fg_score_workspace *workspace = power->workspace;
  const double *e = power->noise[j] + b * (power->width + 1), *f = power->effect[j];
  double rss = e[power->width] + 2 * a * power->cross[j][b] + a * a * f[power->width], gain = 0;
  rss -= squares(e, f, a, 0, workspace->rank);
  for (size_t v = own.first; v < own.first + own.count; v++) {
    const fg_engine_version *version = &workspace->version[v];
    gain = fmax(gain, squares(e, f, a, workspace->rank + version->first, version->rank));
  }
  double between = squares(e, f, a, workspace->rank + workspace->columns, workspace->between_rank);
  return (draw_sums){rss * workspace->weight[j],
                     fmax(rss - gain, 1e-12 * rss) * workspace->weight[j],
                     between > 0 ? fmax(1 - gain / between, 1e-12) : 1};
}

static double share_found(const power_workspace *power, versions_of own, double critical,
                          double a) {
  const fg_score_workspace *workspace = power->workspace;
  const fg_engine_version *version = &workspace->version[middle_of(own)];
  double k = fg_engine_version_dof(workspace, version);
  size_t found = 0;
  for (size_t b = 0; b < DRAWS; b++) {
    draw_sums best = {INFINITY, INFINITY, 1};
    for (size_t j = 0; j < workspace->noises; j++) {
      draw_sums one = residual_sums(power, own, b, j, a);
      best.null = fmin(best.null, one.null);
      if (!(one.with < best.with)) continue;
      best.with = one.with;
      best.own = one.own;
    }
    double ratio = version->between ? best.own : best.with / best.null;
    found += fg_engine_deviate(ratio, k, fg_engine_version_whole(workspace, version)) >= critical;
  }
  return (double)found / DRAWS;
}

static fg_status one_amplitude(fg_context *ctx, power_workspace *power, size_t c, double critical,
                               double *amplitude) {
  const fg_score_workspace *workspace = power->workspace;
  versions_of own = find_versions(workspace, c);
  *amplitude = NAN;
  if (own.count == 0) return FG_OK;
  const fg_engine_version *version = &workspace->version[middle_of(own)];
  double k = fg_engine_version_dof(workspace, version);
  if (version->rank == 0 || k + 2 > fg_engine_version_whole(workspace, version)) return FG_OK;
  FG_TRY(set_effect(ctx, power, middle_of(own)));
  double low = 1e-3, high = 1e3;
  if (share_found(power, own, critical, high) < wanted) return FG_OK;
  for (int i = 0; i < HALVINGS; i++) {
    double between = sqrt(low * high);
    if (share_found(power, own, critical, between) < wanted)
      low = between;
    else
      high = between;
  }
  *amplitude = high;
  return FG_OK;
}

fg_status fg_engine_smallest_amplitudes(fg_context *ctx, const fg_score_workspace *workspace,
                                        const fg_engine_judgement *judgement, uint64_t seed,
                                        double *amplitude) {
  power_workspace power;
  fg_status status = FG_OK;
  FG_TRY_EXIT(open_power(ctx, workspace, &power));
  draw_noise(&power, workspace->noise[judgement->noise], seed);
  for (size_t c = 0; c < workspace->candidates; c++)
    FG_TRY_EXIT(one_amplitude(ctx, &power, c, judgement->z_critical[c], &amplitude[c]));
exit:
  close_power(&power);
  return status;
}
