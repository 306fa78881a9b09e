/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scores: a candidate's F ratio at its best version and noise, as a normal deviate. */
#include <math.h>

#include "table_loop/score_draws.h"

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

/* Rows within levels have dof of their own: where a candidate takes all, the levels' variance over
 * theirs may be any. */
static bool leaves_rows(const fg_score_workspace *workspace, const fg_engine_version *version) {
  size_t between = workspace->between_rank;
  return between == 0 || version->between || version->rank + between + 2 <= workspace->dof;
}

static bool can_be_scored(const fg_score_workspace *workspace, const fg_engine_version *version) {
  double min = version->between ? 1 : 2;
  if (!leaves_rows(workspace, version)) return false;
  return version->rank > 0 && fg_engine_version_dof(workspace, version) + min <=
                                  fg_engine_version_whole(workspace, version);
}

static double share_left(double whole, double gain) {
  return whole > 0 ? fmax(1 - gain / whole, FG_ENGINE_RATIO_MIN) : 1;
}

void fg_score_keep_version(const fg_score_workspace *workspace, size_t v, size_t j,
                           fg_score_sums sums, double gain, fg_engine_score *score) {
  const fg_engine_version *version = &workspace->version[v];
  fg_engine_score *best = &score[version->candidate];
  double weighted = share_left(sums.rss, gain) * sums.rss * workspace->weight[j];
  if (!(weighted < best->ratio) || !can_be_scored(workspace, version)) return;
  double own = version->between ? share_left(sums.between, gain) : NAN;
  *best = (fg_engine_score){.ratio = weighted, .own = own, .version = v, .noise = j};
}

void fg_score_finish(const fg_score_workspace *workspace, double null, fg_engine_score *score) {
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

void fg_score_clear(size_t count, fg_engine_score *score) {
  for (size_t c = 0; c < count; c++)
    score[c] = (fg_engine_score){.ratio = INFINITY, .z = NAN};
}

void fg_score_workspace_score_data(const fg_score_workspace *workspace, fg_engine_score *score,
                                   size_t *null) {
  *null = 0;
  fg_score_clear(workspace->candidates, score);
  for (size_t j = 0; j < workspace->noises; j++) {
    const double *gain = workspace->gain + j * workspace->versions;
    if (workspace->rss[j] * workspace->weight[j] < workspace->rss[*null] * workspace->weight[*null])
      *null = j;
    for (size_t v = 0; v < workspace->versions; v++)
      fg_score_keep_version(workspace, v, j,
                            (fg_score_sums){workspace->rss[j], workspace->between_rss[j]}, gain[v],
                            score);
  }
  fg_score_finish(workspace, workspace->rss[*null] * workspace->weight[*null], score);
}
