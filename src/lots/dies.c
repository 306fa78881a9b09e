/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dies against each other. A difference of two dies is that of their lots as well unless lots hold
 * foils of both, so these are asked first; lots that have one die each are compared by their means,
 * lot to lot; where there are too few of these, the two cannot be told apart. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/text.h"
#include "lots/index.h"

typedef struct moments {
  double n, mean, squares;
} moments;

static moments find_foil_moments(const fg_index_lot *lot, const fg_index_stat *stat, size_t die) {
  moments m = {0, 0, 0};
  for (size_t i = 0; i < lot->foil_count; i++) {
    if (lot->die[i] != die || !isfinite(stat->foil[i])) continue;
    double step = stat->foil[i] - m.mean;
    m.n++;
    m.mean += step / m.n;
    m.squares += step * (stat->foil[i] - m.mean);
  }
  return m;
}

static void add_lot_mean(moments *m, double value) {
  double step = value - m->mean;
  m->n++;
  m->mean += step / m->n;
  m->squares += step * (value - m->mean);
}

/* Evidence of the lots about two dies. */
typedef struct tally {
  double weight, difference; /* sum of weights; weighted mean of the lots' differences */
  double squares, dof;       /* sums within lots and dies */
  size_t shared;             /* lots with foils of both */
  moments lots[2];           /* moments of the means of lots that hold one of them */
  size_t foils[2];
} tally;

static tally tally_lots(const fg_index *index, const fg_index_axis *axis, size_t a, size_t b) {
  tally t = {.weight = 0};
  for (size_t i = 0; i < index->read; i++) {
    const fg_index_lot *lot = &index->lots[i];
    const fg_index_stat *stat = fg_index_stat_of(axis, lot);
    if (!stat || !lot->foil_count) continue;
    const moments m[2] = {find_foil_moments(lot, stat, a), find_foil_moments(lot, stat, b)};
    t.foils[0] += (size_t)m[0].n;
    t.foils[1] += (size_t)m[1].n;
    if (m[0].n > 0 && m[1].n > 0) {
      double weight = 1 / (1 / m[0].n + 1 / m[1].n);
      t.shared++;
      t.weight += weight;
      t.difference += weight / t.weight * (m[0].mean - m[1].mean - t.difference);
      t.squares += m[0].squares + m[1].squares;
      t.dof += m[0].n + m[1].n - 2;
    } else if (m[0].n + m[1].n > 0) {
      int one = m[0].n > 0 ? 0 : 1;
      add_lot_mean(&t.lots[one], m[one].mean);
    }
  }
  return t;
}

static bool test_dies(const tally *t, fg_index_die_pair *result) {
  fg_index_pair *pair = &result->pair;
  result->lots = t->shared ? t->shared : (size_t)(t->lots[0].n + t->lots[1].n);
  if (t->shared && t->dof > 0 && t->squares > 0) {
    const double mean[2] = {t->difference, 0}, u[2] = {sqrt(t->squares / t->dof / t->weight), 0},
                 dof[2] = {t->dof, 1};
    fg_index_welch(pair, mean, u, dof);
    result->basis = FG_INDEX_WITHIN_LOTS;
    return true;
  }
  if (t->shared) return false; /* one foil each: no scatter to test against */
  result->basis = FG_INDEX_CONFOUNDED;
  pair->difference = t->lots[0].mean - t->lots[1].mean;
  pair->p = pair->u = pair->low = pair->high = pair->dof = NAN;
  if (t->lots[0].n < 2 || t->lots[1].n < 2 || !(t->lots[0].squares + t->lots[1].squares > 0))
    return t->lots[0].n > 0 && t->lots[1].n > 0;
  double mean[2], u[2], dof[2];
  for (int i = 0; i < 2; i++) {
    dof[i] = t->lots[i].n - 1;
    mean[i] = t->lots[i].mean;
    u[i] = sqrt(t->lots[i].squares / dof[i] / t->lots[i].n);
  }
  fg_index_welch(pair, mean, u, dof);
  result->basis = FG_INDEX_OVER_LOTS;
  return true;
}

static void swap_dies(fg_index_pair *pair) {
  double low = pair->low;
  size_t die = pair->a, foils = pair->foils_a;
  pair->a = pair->b;
  pair->b = die;
  pair->foils_a = pair->foils_b;
  pair->foils_b = foils;
  pair->difference = -pair->difference;
  pair->low = -pair->high;
  pair->high = -low;
}

static fg_status compare_two_dies(fg_context *ctx, fg_index *index, size_t axis, size_t a,
                                  size_t b) {
  const tally t = tally_lots(index, &index->axes[axis], a, b);
  fg_index_die_pair result = {.pair = {.axis = axis,
                                       .a = a,
                                       .b = b,
                                       .foils_a = t.foils[0],
                                       .foils_b = t.foils[1],
                                       .p_holm = NAN}};
  if (!test_dies(&t, &result)) return FG_OK;
  if (result.pair.difference < 0) swap_dies(&result.pair);
  FG_TRY(fg_memory_reserve(ctx, index->die_pair_count + 1, sizeof *index->die_pairs,
                           &index->die_pair_capacity, (void **)&index->die_pairs));
  index->die_pairs[index->die_pair_count++] = result;
  return FG_OK;
}

/* Sorts by p-value; untested pairs come last. */
static int compare_die_p(const void *left, const void *right) {
  const fg_index_die_pair *a = left, *b = right;
  if (isnan(a->pair.p) != isnan(b->pair.p)) return isnan(a->pair.p) ? 1 : -1;
  if (a->pair.p != b->pair.p && !isnan(a->pair.p)) return a->pair.p < b->pair.p ? -1 : 1;
  if (a->pair.axis != b->pair.axis) return a->pair.axis < b->pair.axis ? -1 : 1;
  if (a->pair.a != b->pair.a) return a->pair.a < b->pair.a ? -1 : 1;
  return a->pair.b < b->pair.b ? -1 : a->pair.b > b->pair.b;
}

static fg_status adjust_die_pairs(fg_context *ctx, fg_index *index) {
  double *p = NULL;
  size_t pairs = index->die_pair_count;
  FG_TRY(fg_memory_allocate(ctx, 2 * pairs, sizeof *p, (void **)&p));
  fg_sort_items(index->die_pairs, pairs, sizeof *index->die_pairs, compare_die_p);
  for (size_t i = 0; i < pairs; i++)
    p[i] = index->die_pairs[i].pair.p;
  fg_status status = fg_holm_adjust(ctx, p, pairs, p + pairs);
  for (size_t i = 0; i < pairs && status == FG_OK; i++) {
    index->die_pairs[i].pair.p_holm = p[pairs + i];
    index->dies_differing += p[pairs + i] < 1 - FG_INDEX_CONFIDENCE;
  }
  free(p);
  return status;
}

fg_status fg_index_compare_dies(fg_context *ctx, fg_index *index) {
  if (index->die_count > FG_INDEX_DIES_MAX)
    return fg_text_append(ctx, &index->notes,
                          "%zu dies: more than %d are not compared with each other\n",
                          index->die_count, FG_INDEX_DIES_MAX);
  for (size_t axis = 0; axis < index->axis_count; axis++) {
    const fg_index_axis *of = &index->axes[axis];
    if (of->scale == FG_INDEX_APART || of->same_as != FG_INDEX_NONE) continue;
    for (size_t a = 0; a < index->die_count; a++)
      for (size_t b = a + 1; b < index->die_count; b++)
        FG_TRY(compare_two_dies(ctx, index, axis, a, b));
  }
  return adjust_die_pairs(ctx, index);
}
