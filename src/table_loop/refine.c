/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Refinement of the shapes of a set's effects to the smallest residual sum. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "table_loop/bins.h"
#include "table_loop/fit.h"
#include "table_loop/step.h"

fg_status fg_engine_residual_sum(fg_context *ctx, const fg_loop_problem *problem, const bool *keep,
                                 fg_engine_noise noise, const fg_engine_set *set, double *rss) {
  fg_engine_training training;
  fg_engine_fit fit;
  FG_TRY(fg_engine_training_build(ctx, problem, keep, set, &training));
  fg_status status = fg_engine_least_squares(ctx, &training, noise, &fit);
  if (status == FG_OK) {
    *rss = fit.rss;
    fg_engine_fit_free(&fit);
  }
  fg_engine_training_free(&training);
  return status;
}

static void neighbours(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                       size_t dimension, double value, double *low, double *high) {
  double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES];
  size_t count = candidate->effect->starts(problem, candidate, starts);
  *low = value / 2;
  *high = value * 2;
  for (size_t i = 0; i < count; i++) {
    double start = starts[i][dimension];
    if (start < value * 0.999 && start > *low) *low = start;
    if (start > value * 1.001 && start < *high) *high = start;
  }
}

/* Longest period of a cycle over that from which it is sought: eight places that close a circle
 * return after 8/7 of their range, and a longer one is a bend. Without a limit a period doubles
 * with every round of refinement. */
#define LONGEST_CYCLE 1.15

static double longest_period(const fg_loop_problem *problem, const fg_loop_candidate *candidate) {
  double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES], longest = 0;
  size_t count = candidate->effect->starts(problem, candidate, starts), lowest = 1;
  for (size_t i = 0; i < count; i++)
    longest = fmax(longest, starts[i][0]);
  while (lowest < FG_LOOP_ORDER_MAX && !fg_loop_has_order(candidate, lowest))
    lowest++;
  return LONGEST_CYCLE * longest * (double)lowest;
}

/* Half a cycle of the highest order, over the range, on both sides. On even places the shortest
 * period, two places, stays: near it sine and cosine are collinear, and a beat of large amplitudes
 * follows whatever the neighbours of an alternation do. */
static void cycle_neighbours(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                             double value, double *low, double *high) {
  const fg_loop_coordinate *at = &problem->coordinate[candidate->a];
  size_t highest = 1;
  for (size_t k = 1; k <= FG_LOOP_ORDER_MAX; k++)
    if (fg_loop_has_order(candidate, k)) highest = k;
  double cycles = (at->high - at->low) / value, half = 0.5 / (double)highest;
  double room =
      at->even ? 0.5 * (at->high - at->low) / at->spacing / (double)highest - cycles : cycles;
  *low = value * cycles / (cycles + fmin(half, fmax(room - half, 0)));
  *high = value * cycles / fmax(cycles - (room < half ? 0 : half), cycles / 2);
  *high = fmax(fmin(*high, longest_period(problem, candidate)), value);
}

/* One shape of one member of a set; the others are held. */
typedef struct moving {
  const fg_loop_problem *problem;
  const bool *keep;
  fg_engine_noise noise;
  fg_engine_set *set;
  size_t member;
  /* For many rows: the set without the member, and the vectors that the member is multiplied with.
   */
  fg_engine_training training;
  fg_engine_span null;
  fg_engine_bins bins;
  fg_engine_gram gram;
  double *vectors, *columns, rss;
  bool many, in_steps;
} moving;

static fg_status on_all_rows(fg_context *ctx, moving *m, double *rss) {
  const fg_loop_candidate *candidate = &m->set->candidate[m->member];
  size_t n = m->training.n, count = fg_engine_candidate_columns(m->problem, candidate);
  FG_TRY(fg_engine_gather(ctx, &m->training, candidate, m->set->shape[m->member], m->columns));
  for (size_t k = 0; k < count; k++)
    fg_engine_whiten(&m->training, m->noise, m->columns + k * n);
  fg_engine_gram_take(n, m->columns, count, NULL, m->vectors, m->null.rank, &m->gram);
  *rss = m->rss - fg_engine_gram_solve(&m->gram).gain;
  return FG_OK;
}

/* The residual sum at the shape that the set has now. */
static fg_status residual_sum_at(fg_context *ctx, moving *m, double *rss) {
  if (!m->many) return fg_engine_residual_sum(ctx, m->problem, m->keep, m->noise, m->set, rss);
  if (!m->in_steps) return on_all_rows(ctx, m, rss);
  fg_engine_bins_gram(&m->bins, &m->set->candidate[m->member], m->set->shape[m->member], m->columns,
                      &m->gram);
  *rss = m->rss - fg_engine_gram_solve(&m->gram).gain;
  return FG_OK;
}

/* Steps of the coordinate that a shape is moved over. */
enum { STEPS = 8192 };

static fg_status open_many(fg_context *ctx, moving *m) {
  const fg_loop_candidate *candidate = &m->set->candidate[m->member];
  const fg_loop_coordinate *at = &m->problem->coordinate[candidate->a];
  size_t count = fg_engine_candidate_columns(m->problem, candidate);
  fg_engine_set others = *m->set;
  fg_engine_set_remove(&others, m->member);
  FG_TRY(fg_engine_training_build(ctx, m->problem, m->keep, &others, &m->training));
  FG_TRY(fg_engine_span_open(ctx, &m->training, m->noise, 0, &m->null));
  size_t n = m->training.n, rank = m->null.rank, longest = n > STEPS ? n : STEPS;
  size_t size = sizeof *m->vectors;
  FG_TRY(fg_memory_allocate(ctx, n, (rank + 1) * size, (void **)&m->vectors));
  FG_TRY(fg_memory_allocate(ctx, longest, (count + 1) * size, (void **)&m->columns));
  FG_TRY(fg_memory_allocate(ctx, count + 1, (rank + 1) * size, (void **)&m->gram.cross));
  double *residual = m->vectors + rank * n;
  memcpy(m->vectors, m->null.basis, n * rank * size);
  memcpy(residual, m->training.y, n * size);
  fg_engine_whiten(&m->training, m->noise, residual);
  m->rss = fg_engine_project_out(n, m->null.basis, rank, residual);
  m->in_steps = fg_engine_independent(m->noise) && !candidate->effect->pair && at->high > at->low &&
                n > STEPS;
  if (!m->in_steps) return FG_OK;
  return fg_engine_bins_open(ctx, &m->training, candidate->a, STEPS, m->vectors, rank, &m->bins);
}

static void close_many(moving *m) {
  fg_engine_bins_close(&m->bins);
  fg_engine_span_close(&m->null);
  fg_engine_training_free(&m->training);
  free(m->vectors);
  free(m->columns);
  free(m->gram.cross);
}

/* The sum over a cycle's base has many minima: the window closes around the deepest of a grid. */
static fg_status close_in(fg_context *ctx, moving *m, size_t dimension, double *low, double *high) {
  enum { GRID = 12 };
  double *shape = &m->set->shape[m->member][dimension], start = *shape, best = INFINITY, sum;
  double step = (*high - *low) / GRID, at = start;
  for (size_t i = 1; i < GRID; i++) {
    *shape = exp(*low + (double)i * step);
    FG_TRY(residual_sum_at(ctx, m, &sum));
    if (sum < best) at = *low + (double)i * step;
    best = fmin(best, sum);
  }
  *shape = start;
  *low = at - step;
  *high = at + step;
  return FG_OK;
}

/* Golden section in the logarithm; the result is used only if better than the start. */
static fg_status move_one(fg_context *ctx, moving *m, size_t dimension) {
  static const double golden = 0.61803398874989485;
  double *shape = &m->set->shape[m->member][dimension], start = *shape, at_start, low, high;
  double value[2], at[2];
  FG_TRY(residual_sum_at(ctx, m, &at_start));
  const fg_loop_candidate *candidate = &m->set->candidate[m->member];
  if (candidate->effect->cycle)
    cycle_neighbours(m->problem, candidate, start, &low, &high);
  else
    neighbours(m->problem, candidate, dimension, start, &low, &high);
  low = log(low);
  high = log(high);
  if (candidate->orders) FG_TRY(close_in(ctx, m, dimension, &low, &high));
  for (int i = 0; i < 2; i++) {
    at[i] = i ? low + golden * (high - low) : high - golden * (high - low);
    *shape = exp(at[i]);
    FG_TRY(residual_sum_at(ctx, m, &value[i]));
  }
  for (int step = 0; step < 18; step++) {
    int worse = value[0] < value[1];
    if (worse) {
      high = at[1];
      at[1] = at[0];
      value[1] = value[0];
      at[0] = high - golden * (high - low);
    } else {
      low = at[0];
      at[0] = at[1];
      value[0] = value[1];
      at[1] = low + golden * (high - low);
    }
    *shape = exp(at[!worse]);
    FG_TRY(residual_sum_at(ctx, m, &value[!worse]));
  }
  int best = value[1] < value[0];
  *shape = value[best] < at_start ? exp(at[best]) : start;
  return FG_OK;
}

static fg_status move_member(fg_context *ctx, moving *m) {
  const fg_loop_effect *effect = m->set->candidate[m->member].effect;
  double start[FG_LOOP_SHAPES], before, after;
  memcpy(start, m->set->shape[m->member], sizeof start);
  if (m->many) FG_TRY(open_many(ctx, m));
  for (size_t d = 0; d < effect->shapes; d++)
    FG_TRY(move_one(ctx, m, d));
  if (!m->in_steps) return FG_OK;
  FG_TRY(on_all_rows(ctx, m, &after)); /* narrower shapes need all rows: bins hide them */
  double moved[FG_LOOP_SHAPES];
  memcpy(moved, m->set->shape[m->member], sizeof moved);
  memcpy(m->set->shape[m->member], start, sizeof start);
  FG_TRY(on_all_rows(ctx, m, &before));
  if (after < before) memcpy(m->set->shape[m->member], moved, sizeof moved);
  return FG_OK;
}

static bool is_movable(const fg_engine_set *set, size_t member) {
  const fg_loop_effect *effect = set->candidate[member].effect;
  return effect->shapes && !effect->stepwise && !effect->held;
}

fg_status fg_engine_refine(fg_context *ctx, const fg_loop_problem *problem, const bool *keep,
                           fg_engine_noise noise, fg_engine_set *set) {
  size_t rows = 0, movable = 0;
  for (size_t i = 0; i < problem->rows; i++)
    rows += !keep || keep[i];
  for (size_t m = 0; m < set->count; m++)
    movable += is_movable(set, m);
  bool many = rows > FG_ENGINE_SMALL_ROWS;
  int rounds = many && movable < 2 ? 1 : 2; /* alone it has nothing to follow */
  for (int round = 0; round < rounds; round++)
    for (size_t m = 0; m < set->count; m++) {
      moving one = {problem, keep, noise, set, m, .many = many};
      if (!is_movable(set, m)) continue;
      fg_status status = move_member(ctx, &one);
      close_many(&one);
      FG_TRY(status);
    }
  return FG_OK;
}
