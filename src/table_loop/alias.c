/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Alias classes. A rival belongs to the winner's class when the winner's gain beside it is not
 * significant. If the rival is the true effect, that gain is noise, so the class misses the true
 * effect with the probability of the test alone. */
#include "table_loop/alias.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/text.h"
#include "table_loop/between.h"

/* P-value at which the winner stays although a simpler candidate exists. */
#define SIMPLER_P FG_LOOP_ACCEPT_P

/* Minimum share of the winner's explained sum for a member of a class. */
#define MIN_SHARE 0.4
/* P-value at which the additional part of a larger basis is suggested by the data. */
#define SUGGESTED_P 0.1

/* Share of the winner's explained sum below which a rival is not tried, for many rows: it would not
 * reach MIN_SHARE, and the winner's gain beside it would be significant. */
#define TRIED_SHARE 0.2

static bool far_behind(const fg_engine_training *training, const fg_engine_stand *winner,
                       const fg_engine_stand *rival) {
  return training->n > FG_ENGINE_SMALL_ROWS && rival->share > 0 &&
         rival->share < TRIED_SHARE * winner->share;
}

static const double pair_loss = 0.1; /* a sum of two must explain all but this */
enum { PAIR_POOL = 10 };

/* Whitened residual and columns of a training at one noise. */
typedef struct alias_workspace {
  const fg_engine_training *training;
  fg_engine_noise noise;
  size_t n;
  fg_engine_span null; /* with room for more columns */
  double *y, *columns, *unit;
  double rss, dof;
  double *between; /* differences between groups beside the null: groups × n */
  size_t groups;
  double groups_rss;
  bool constant; /* in groups: the columns added last */
} alias_workspace;

static fg_status open_workspace(fg_context *ctx, const fg_engine_training *training,
                                fg_engine_noise noise, alias_workspace *workspace) {
  size_t n = training->n;
  *workspace = (alias_workspace){.training = training, .noise = noise, .n = n};
  FG_TRY(fg_engine_span_open(ctx, training, noise, 3 * FG_LOOP_COLUMNS, &workspace->null));
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *workspace->y, (void **)&workspace->y));
  FG_TRY(fg_memory_allocate(ctx, n, 2 * FG_LOOP_COLUMNS * sizeof *workspace->y,
                            (void **)&workspace->columns));
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *workspace->y, (void **)&workspace->unit));
  memcpy(workspace->y, training->y, n * sizeof *workspace->y);
  fg_engine_whiten(training, noise, workspace->y);
  workspace->rss =
      fg_engine_project_out(n, workspace->null.basis, workspace->null.rank, workspace->y);
  workspace->dof = (double)n - (double)workspace->null.rank;
  FG_TRY(fg_engine_between_basis(ctx, training, noise, &workspace->null, &workspace->between,
                                 &workspace->groups));
  workspace->groups_rss = fg_engine_along(n, workspace->between, workspace->groups, workspace->y);
  return FG_OK;
}

static void close_workspace(alias_workspace *workspace) {
  fg_engine_span_close(&workspace->null);
  free(workspace->y);
  free(workspace->columns);
  free(workspace->unit);
  free(workspace->between);
}

/* Adds the candidate's columns behind those already there; returns how many are new. */
static fg_status extend(fg_context *ctx, alias_workspace *workspace, const fg_engine_stand *stand,
                        size_t rank, size_t *added) {
  const fg_loop_problem *problem = workspace->training->problem;
  size_t count = fg_engine_candidate_columns(problem, &stand->candidate);
  FG_TRY(fg_engine_gather(ctx, workspace->training, &stand->candidate, stand->shape,
                          workspace->columns));
  workspace->constant =
      workspace->groups > 0 &&
      fg_engine_constant_in_levels(workspace->training, workspace->columns, count);
  for (size_t k = 0; k < count; k++)
    fg_engine_whiten(workspace->training, workspace->noise, workspace->columns + k * workspace->n);
  *added = fg_engine_orthonormal(workspace->n, workspace->null.basis, rank, workspace->columns,
                                 count, workspace->null.basis + rank * workspace->n, NULL);
  return FG_OK;
}

static double explained(const alias_workspace *workspace, size_t from, size_t count) {
  return fg_engine_along(workspace->n, workspace->null.basis + from * workspace->n, count,
                         workspace->y);
}

static void fitted(const alias_workspace *workspace, size_t from, size_t count, double *fit) {
  memset(fit, 0, workspace->n * sizeof *fit);
  for (size_t k = from; k < from + count; k++) {
    double along = 0;
    for (size_t i = 0; i < workspace->n; i++)
      along += workspace->null.basis[k * workspace->n + i] * workspace->y[i];
    for (size_t i = 0; i < workspace->n; i++)
      fit[i] += along * workspace->null.basis[k * workspace->n + i];
  }
}

static double cosine(size_t n, const double *a, const double *b) {
  double aa = 0, bb = 0, ab = 0;
  for (size_t i = 0; i < n; i++) {
    aa += a[i] * a[i];
    bb += b[i] * b[i];
    ab += a[i] * b[i];
  }
  return aa > 0 && bb > 0 ? ab / sqrt(aa * bb) : 0;
}

typedef struct alias_test {
  size_t rank, more;    /* of the rival; of the winner beside it */
  double gain, p_value; /* of the rival; of the winner's surplus */
  double correlation;
} alias_test;

/* Computes residual sum and dof beside the null and `count` columns, before the winner. For a
 * winner constant in groups they are those of the groups: the columns count by their part between
 * groups. */
static void error_beside(const alias_workspace *workspace, size_t count, double gain, double *unit,
                         double *left, double *dof) {
  *left = workspace->rss - gain;
  *dof = workspace->dof - (double)count;
  if (!workspace->constant) return;
  size_t within = fg_engine_orthonormal(workspace->n, workspace->between, workspace->groups,
                                        workspace->null.basis + workspace->null.rank * workspace->n,
                                        count, unit, NULL);
  *left = workspace->groups_rss + fg_engine_along(workspace->n, unit, within, workspace->y) - gain;
  *dof = (double)(workspace->groups + within) - (double)count;
}

/* The winner beside one rival, or a sum of two. */
static fg_status compare_with_rival(fg_context *ctx, alias_workspace *workspace,
                                    const fg_engine_stand *winner, const fg_engine_stand *rival,
                                    const fg_engine_stand *second, const double *winner_fit,
                                    alias_test *test) {
  size_t more = 0;
  double shapes = (double)rival->candidate.effect->shapes;
  FG_TRY(extend(ctx, workspace, rival, workspace->null.rank, &test->rank));
  if (second) {
    FG_TRY(extend(ctx, workspace, second, workspace->null.rank + test->rank, &more));
    test->rank += more;
    shapes += (double)second->candidate.effect->shapes;
  }
  test->gain = explained(workspace, workspace->null.rank, test->rank);
  fitted(workspace, workspace->null.rank, test->rank, workspace->unit);
  test->correlation = winner_fit ? cosine(workspace->n, winner_fit, workspace->unit) : 0;
  FG_TRY(extend(ctx, workspace, winner, workspace->null.rank + test->rank, &test->more));
  double surplus = explained(workspace, workspace->null.rank + test->rank, test->more);
  double k = (double)test->more + (double)winner->candidate.effect->shapes;
  double left, dof;
  error_beside(workspace, test->rank, test->gain, workspace->columns, &left, &dof);
  left -= surplus;
  dof -= shapes + k;
  test->p_value = 1;
  if (test->more > 0 && dof >= 1 && left > 0)
    test->p_value = gsl_cdf_fdist_Q(surplus / k / (left / dof), k, dof);
  else if (test->more > 0)
    test->p_value = left > 0 ? 1 : 0;
  return FG_OK;
}

fg_status fg_engine_beside(fg_context *ctx, const fg_engine_training *training,
                           fg_engine_noise noise, const fg_engine_stand *base,
                           const fg_engine_stand *other, double *p_value) {
  alias_workspace workspace = {0};
  alias_test test = {0};
  fg_status status = open_workspace(ctx, training, noise, &workspace);
  if (status == FG_OK) status = compare_with_rival(ctx, &workspace, other, base, NULL, NULL, &test);
  *p_value = test.p_value;
  close_workspace(&workspace);
  return status;
}

fg_status fg_engine_simplify(fg_context *ctx, const fg_engine_training *training,
                             fg_engine_noise noise, const fg_engine_stand *stand, size_t count,
                             size_t winner, size_t *simplest) {
  alias_workspace workspace = {0};
  size_t rank = 0, inside;
  double best = -INFINITY;
  fg_status status = FG_OK;
  *simplest = winner;
  FG_TRY_EXIT(open_workspace(ctx, training, noise, &workspace));
  FG_TRY_EXIT(extend(ctx, &workspace, &stand[winner], workspace.null.rank, &rank));
  size_t whole = rank + stand[winner].candidate.effect->shapes;
  for (size_t c = 0; c < count; c++) {
    alias_test test;
    if (c == winner || !isfinite(stand[c].z) || fg_engine_is_curve(&stand[c].candidate) ||
        fg_engine_is_noise(&stand[c].candidate) || far_behind(training, &stand[winner], &stand[c]))
      continue;
    FG_TRY_EXIT(extend(ctx, &workspace, &stand[winner], workspace.null.rank, &rank));
    FG_TRY_EXIT(extend(ctx, &workspace, &stand[c], workspace.null.rank + rank, &inside));
    if (inside > 0) continue;
    FG_TRY_EXIT(compare_with_rival(ctx, &workspace, &stand[winner], &stand[c], NULL, NULL, &test));
    if (test.rank + stand[c].candidate.effect->shapes >= whole || test.p_value < SIMPLER_P)
      continue;
    if (stand[c].z > best) {
      best = stand[c].z;
      *simplest = c;
    }
  }
exit:
  close_workspace(&workspace);
  return status;
}

static void add_alias(const fg_loop_problem *problem, const fg_engine_stand *rival,
                      const fg_engine_stand *second, const alias_test *test, double winner_gain,
                      fg_loop_claim *claim) {
  char name[FG_LOOP_NAME], other[FG_LOOP_NAME];
  if (claim->aliases == FG_LOOP_ALIASES) {
    claim->aliases_unlisted++;
    return;
  }
  fg_loop_alias *alias = &claim->alias[claim->aliases++];
  *alias = (fg_loop_alias){.candidate = rival->candidate, .sum = second != NULL};
  fg_engine_candidate_name(problem, &rival->candidate, name);
  if (second) {
    alias->second = second->candidate;
    fg_engine_candidate_name(problem, &second->candidate, other);
    fg_text_clip(alias->name, sizeof alias->name, "%s + %s", name, other);
  } else {
    fg_text_clip(alias->name, sizeof alias->name, "%s", name);
  }
  alias->correlation = test->correlation;
  alias->loss = winner_gain > 0 ? 1 - test->gain / winner_gain : 0;
}

void fg_engine_add_alias(const fg_loop_problem *problem, const fg_loop_candidate *rival,
                         double correlation, double loss, fg_loop_claim *claim) {
  const fg_engine_stand stand = {.candidate = *rival};
  const alias_test test = {.correlation = correlation, .gain = 1 - loss};
  add_alias(problem, &stand, NULL, &test, 1, claim);
}

static int by_gain(const void *a, const void *b) {
  const fg_engine_stand *x = *(const fg_engine_stand *const *)a,
                        *y = *(const fg_engine_stand *const *)b;
  if (x->z != y->z) return x->z < y->z ? 1 : -1;
  return (x > y) - (x < y);
}

static fg_status find_pairs(fg_context *ctx, alias_workspace *workspace,
                            const fg_engine_stand **pool, size_t pooled,
                            const fg_engine_stand *winner, const double *winner_fit, double gain,
                            size_t winner_rank, fg_loop_claim *claim) {
  for (size_t i = 0; i < pooled && i < PAIR_POOL; i++)
    for (size_t k = 0; k < i; k++) {
      alias_test test;
      FG_TRY(compare_with_rival(ctx, workspace, winner, pool[k], pool[i], winner_fit, &test));
      bool contains = test.more == 0 && test.rank > winner_rank;
      if (contains || test.p_value < FG_ENGINE_SHOWS || test.gain < (1 - pair_loss) * gain)
        continue;
      add_alias(workspace->training->problem, pool[k], pool[i], &test, gain, claim);
    }
  return FG_OK;
}

/* A basis that includes the winner's is no rival, unless the data suggest its additional part. */
static fg_status suggests_more(fg_context *ctx, alias_workspace *workspace,
                               const fg_engine_stand *rival, const fg_engine_stand *winner,
                               bool *contains) {
  alias_test test;
  FG_TRY(compare_with_rival(ctx, workspace, rival, winner, NULL, NULL, &test));
  *contains = test.p_value > SUGGESTED_P;
  return FG_OK;
}

/* A wrong row, and a cycle over a column whose period was sought, would fill up what another effect
 * leaves. */
static bool may_be_summed(const fg_loop_problem *problem, const fg_loop_candidate *candidate) {
  unsigned roles = problem->coordinate[candidate->a].roles;
  if (fg_engine_is_outlier(candidate)) return false;
  return !candidate->effect->cycle || roles & (FG_LOOP_ORDER | FG_LOOP_BUMP);
}

fg_status fg_engine_alias_class(fg_context *ctx, const fg_engine_training *training,
                                fg_engine_noise noise, const fg_engine_stand *stand, size_t count,
                                const fg_engine_stand *winner, fg_loop_claim *claim) {
  alias_workspace workspace = {0};
  const fg_engine_stand **pool = NULL;
  double *winner_fit = NULL;
  size_t rank = 0, pooled = 0, listed = 0;
  fg_status status = FG_OK;
  FG_TRY_EXIT(open_workspace(ctx, training, noise, &workspace));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count + 1, sizeof *pool, (void **)&pool));
  FG_TRY_EXIT(fg_memory_allocate(ctx, workspace.n, sizeof *winner_fit, (void **)&winner_fit));
  FG_TRY_EXIT(extend(ctx, &workspace, winner, workspace.null.rank, &rank));
  double gain = explained(&workspace, workspace.null.rank, rank);
  fitted(&workspace, workspace.null.rank, rank, winner_fit);
  for (size_t c = 0; c < count; c++)
    if (isfinite(stand[c].z) && !fg_engine_is_curve(&stand[c].candidate) &&
        !fg_engine_is_noise(&stand[c].candidate) && !far_behind(training, winner, &stand[c]) &&
        !fg_engine_same_candidate(&stand[c].candidate, &winner->candidate) &&
        !fg_engine_same_cycle(&stand[c].candidate, &winner->candidate))
      pool[listed++] = &stand[c];
  fg_sort_items(pool, listed, sizeof *pool, by_gain);
  for (size_t c = 0; c < listed; c++) {
    alias_test test;
    FG_TRY_EXIT(compare_with_rival(ctx, &workspace, winner, pool[c], NULL, winner_fit, &test));
    bool contains = test.more == 0 && test.rank > rank;
    if (contains) FG_TRY_EXIT(suggests_more(ctx, &workspace, pool[c], winner, &contains));
    if (test.gain < MIN_SHARE * gain) continue;
    if (!contains && test.p_value >= FG_ENGINE_SHOWS)
      add_alias(training->problem, pool[c], NULL, &test, gain, claim);
    else if (!contains && test.rank <= 2 && may_be_summed(training->problem, &pool[c]->candidate))
      pool[pooled++] = pool[c];
  }
  FG_TRY_EXIT(find_pairs(ctx, &workspace, pool, pooled, winner, winner_fit, gain, rank, claim));
exit:
  free(pool);
  free(winner_fit);
  close_workspace(&workspace);
  return status;
}
