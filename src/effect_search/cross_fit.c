/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effect_search/cross_fit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "effect_search/iterate.h"
#include "effect_search/joint_fit.h"
#include "effect_search/policy.h"

enum { FOLDS_MAX = 5, FOLDS_MIN = 2 };

/* Several times the length over which neighbours share noise, and less than a curve is fine. */
#define STRETCH_MM 0.6

typedef struct cross_fit {
  const fg_edge_fit *edge_fit;
  const fg_effect_set *set;
  const fg_search_bars *barred;
  fg_cross_fit_unit unit;
  size_t folds;
  size_t *fold;               /* per row */
  double *before_um;          /* likewise */
  double *after_um;           /* every row from the search without its fold */
  bool cannot[FOLDS_MAX + 1]; /* too few rows, or a geometry that they do not determine */
} cross_fit;

/* A curve over places, or a jump or dent at one, which a single disc or bump may be all that shows.
 */
static bool lives_at_places(const fg_effect_set *set) {
  for (size_t e = 0; e < set->count; e++) {
    const fg_effect *kind = set->effects[e].kind;
    if (kind->jumps || (kind->midline && kind->shapes)) return true;
    if (fg_effect_is_free(kind) && kind->coordinate != FG_EFFECT_PHI &&
        kind->coordinate != FG_EFFECT_NORMAL)
      return true;
  }
  return false;
}

static fg_cross_fit_unit unit_of(const fg_edge_fit *edge_fit, const fg_effect_set *set) {
  if (lives_at_places(set)) return FG_CROSS_FIT_STRETCHES;
  return edge_fit->discs ? FG_CROSS_FIT_DISCS : FG_CROSS_FIT_BUMPS;
}

/* Bumps have turns of their own, and so have lands: every fold has both. */
static fg_status deal(fg_context *ctx, cross_fit *c) {
  const fg_edge_fit *edge_fit = c->edge_fit;
  size_t bumps = 0, others = 0, own = 0;
  c->unit = unit_of(edge_fit, c->set);
  FG_TRY(fg_memory_allocate(ctx, edge_fit->row_count, sizeof *c->fold, (void **)&c->fold));
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    const fg_edge_fit_row *row = &edge_fit->rows[i];
    if (!i || row->group != edge_fit->rows[i - 1].group) own = row->bump ? bumps++ : others++;
    c->fold[i] = c->unit == FG_CROSS_FIT_STRETCHES ? (size_t)fmax(0, row->s_mm / STRETCH_MM) : own;
  }
  size_t units = c->unit == FG_CROSS_FIT_DISCS ? others : bumps;
  c->folds = units < FOLDS_MAX && c->unit != FG_CROSS_FIT_STRETCHES ? units : FOLDS_MAX;
  for (size_t i = 0; i < edge_fit->row_count && c->folds; i++)
    c->fold[i] %= c->folds;
  return FG_OK;
}

/* Computes the residual of a set over all rows; without effects from known radii, which show a
 * scale. */
static fg_status find_residual(fg_context *ctx, const fg_edge_fit *edge_fit,
                               const fg_effect_set *set, double *residual_um) {
  fg_edge_fit all;
  FG_TRY(fg_edge_fit_subset(ctx, edge_fit, NULL, &all));
  if (!set->count && all.gauge_um > 0) fg_edge_fit_hold_radii(&all, true);
  fg_status status = fg_joint_fit_geometry(ctx, &all, set, residual_um);
  fg_edge_fit_free(&all);
  return status;
}

static const fg_effect_found *find_of_bumps(const fg_effect_set *set) {
  for (size_t e = 0; e < set->count; e++)
    if (set->effects[e].kind->coordinate == FG_EFFECT_INDEX) return &set->effects[e];
  return NULL;
}

/* Keeps effects of single bumps, with numbers fitted to the other rows. Their own test finds
 * smaller ones than the search can (scan_loop/single_bumps.c). */
static fg_status keep_single_bumps(fg_context *ctx, const cross_fit *c, fg_edge_fit *others,
                                   fg_effect_set *set) {
  const fg_effect_found *bumps = find_of_bumps(c->set);
  if (!bumps || find_of_bumps(set) || set->count == FG_EFFECT_SET_MAX) return FG_OK;
  set->effects[set->count++] = (fg_effect_found){.kind = bumps->kind, .columns = bumps->columns};
  return fg_joint_fit(ctx, others, set, NULL);
}

/* The search on the rows of all other folds; of a set that it did not choose, its numbers. */
static fg_status search_without(fg_context *ctx, const cross_fit *c, size_t fold,
                                fg_effect_set *set) {
  const fg_edge_fit *edge_fit = c->edge_fit;
  bool *keep = NULL;
  double *residual_um = NULL;
  fg_edge_fit others = {0};
  const fg_iterate_request request = {&others, fg_search_policy_of(edge_fit), c->barred};
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, edge_fit->row_count, sizeof *keep, (void **)&keep));
  for (size_t i = 0; i < edge_fit->row_count; i++)
    keep[i] = c->fold[i] != fold;
  FG_TRY_EXIT(fg_edge_fit_subset(ctx, edge_fit, keep, &others));
  others.threads = 1; /* this is one of several threads */
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, others.row_count, sizeof *residual_um, (void **)&residual_um));
  FG_TRY_EXIT(c->barred ? fg_search_iterate_again(ctx, &request, set, residual_um)
                        : fg_joint_fit(ctx, &others, set, residual_um));
  FG_TRY_EXIT(keep_single_bumps(ctx, c, &others, set));
exit:
  free(keep);
  free(residual_um);
  fg_edge_fit_free(&others);
  return status;
}

static fg_status judge_fold(fg_context *ctx, cross_fit *c, size_t fold) {
  const fg_edge_fit *edge_fit = c->edge_fit;
  fg_effect_set set = *c->set;
  double *left = NULL;
  FG_TRY(search_without(ctx, c, fold, &set));
  FG_TRY(fg_memory_allocate(ctx, edge_fit->row_count, sizeof *left, (void **)&left));
  fg_status status = find_residual(ctx, edge_fit, &set, left);
  for (size_t i = 0; i < edge_fit->row_count && status == FG_OK; i++)
    if (c->fold[i] == fold) c->after_um[i] = left[i];
  free(left);
  return status;
}

/* Item 0: before; then fold by fold. */
static fg_status take_item(fg_context *ctx, void *shared, size_t item) {
  cross_fit *c = shared;
  const fg_effect_set none = {.count = 0};
  fg_status status =
      item ? judge_fold(ctx, c, item - 1) : find_residual(ctx, c->edge_fit, &none, c->before_um);
  if (status == FG_OK || status == FG_ERR_MEMORY) return status;
  c->cannot[item] = true;
  return FG_OK;
}

/* Returns true for two rows that were left out together and share an error. */
static bool are_one(const cross_fit *c, size_t a, size_t b) {
  return c->edge_fit->rows[a].group == c->edge_fit->rows[b].group && c->fold[a] == c->fold[b];
}

/* Mean squares, and how far their difference varies from unit to unit. */
static void sum_up_errors(const cross_fit *c, fg_cross_fit *result) {
  const fg_edge_fit *edge_fit = c->edge_fit;
  double before = 0, after = 0, weight = 0, square = 0, units = 0;
  for (size_t i = 0, to; i < edge_fit->row_count; i = to) {
    double own[2] = {0, 0};
    for (to = i; to < edge_fit->row_count && are_one(c, i, to); to++) {
      double w = edge_fit->rows[to].weight;
      own[0] += w * c->before_um[to] * c->before_um[to];
      own[1] += w * c->after_um[to] * c->after_um[to];
      weight += w;
    }
    before += own[0];
    after += own[1];
    square += (own[0] - own[1]) * (own[0] - own[1]);
    units++;
  }
  if (!(weight > 0)) return;
  double gain = before - after;
  double scatter = units / (units - 1) * (square - gain * gain / units);
  *result = (fg_cross_fit){.unit = c->unit,
                           .folds = c->folds,
                           .before_um = sqrt(before / weight),
                           .after_um = sqrt(after / weight),
                           .gain = gain / weight,
                           .u_gain = sqrt(fmax(scatter, 0)) / weight};
}

fg_status fg_search_cross_fit(fg_context *ctx, const fg_edge_fit *edge_fit,
                              const fg_effect_set *set, const fg_search_bars *barred,
                              unsigned threads, fg_cross_fit *result) {
  cross_fit c = {.edge_fit = edge_fit, .set = set, .barred = barred};
  size_t rows = edge_fit->row_count;
  fg_status status = FG_OK;
  bool cannot = false;
  *result = (fg_cross_fit){.before_um = NAN, .after_um = NAN, .gain = NAN, .u_gain = NAN};
  FG_TRY_EXIT(deal(ctx, &c));
  if (c.folds < FOLDS_MIN) goto exit;
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, sizeof *c.before_um, (void **)&c.before_um));
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, sizeof *c.after_um, (void **)&c.after_um));
  FG_TRY_EXIT(fg_parallel_run(ctx, threads, c.folds + 1, take_item, &c));
  for (size_t item = 0; item <= c.folds; item++)
    cannot = cannot || c.cannot[item];
  if (!cannot) sum_up_errors(&c, result);
exit:
  free(c.fold);
  free(c.before_um);
  free(c.after_um);
  return status;
}
