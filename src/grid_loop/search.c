/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "grid_loop/search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

/* Chance that noise alone adds an effect, over all candidates; an effect stays where its square
 * over its variance exceeds this. */
#define CHANCE    1e-3
#define KEPT_CHI2 30.0
enum { REFINEMENTS = 24 };

/* Ratio of the axes, then shear: the effects that one ring cannot tell from its own form. */
void fg_grid_begin_effects(grid_problem *problem) {
  for (int scales = 0; scales <= problem->scale_known; scales++)
    for (const fg_effect *kind = fg_effect_first(); kind; kind = fg_effect_next(kind))
      if (scales ? kind->scales : kind->ring == FG_EFFECT_RING_OF_SCANNER)
        problem->effect[problem->effects++] = (grid_effect){.kind = kind};
}

size_t fg_grid_own_effects(const grid_problem *problem) {
  return problem->scale_known ? 3 : 2;
}

static bool is_in_model(const grid_problem *problem, const fg_effect *kind) {
  for (size_t e = 0; e < problem->effects; e++)
    if (problem->effect[e].kind == kind) return true;
  return false;
}

/* Ripples and steps may occur more than once. */
static bool is_candidate(const grid_problem *problem, const fg_effect *kind) {
  if (!kind->glass || fg_effect_is_free(kind) || kind->scales || kind->by_evidence) return false;
  if (kind->columns > 2 || kind->shapes > 1) return false;
  return kind->sought == FG_EFFECT_PLACED || !is_in_model(problem, kind);
}

/* Everything that scoring needs of the present model. */
typedef struct score_work {
  const grid_problem *problem;
  const grid_solution *solution;
  double variance;   /* of a row */
  double *projected; /* owned; one per column of the model */
} score_work;

/* Products of the candidate's columns: with each other, with the residual, with the model. */
static void project_candidate(score_work *work, const grid_effect *candidate, double own[2][2],
                              double right[2], double *cross) {
  const grid_problem *problem = work->problem;
  size_t index[GRID_ROW_MAX], count = work->solution->columns.count;
  double value[GRID_ROW_MAX];
  memset(cross, 0, 2 * count * sizeof *cross);
  memset(own, 0, 4 * sizeof(double));
  right[0] = right[1] = 0;
  for (size_t i = 0; i < problem->row_count; i++) {
    const grid_row *row = &problem->rows[i];
    fg_point d[FG_FIELD_COLUMNS];
    double c[2] = {0};
    if (!row->used) continue;
    candidate->kind->glass(&problem->frame, candidate->shape, row->at, d);
    for (size_t k = 0; k < candidate->kind->columns; k++)
      c[k] = row->direction.x * d[k].x + row->direction.y * d[k].y;
    if (c[0] == 0 && c[1] == 0) continue;
    size_t n = fg_grid_row_columns(problem, &work->solution->columns, row, index, value);
    for (int k = 0; k < 2; k++) {
      right[k] += c[k] * work->solution->residual[i];
      own[k][0] += c[k] * c[0];
      own[k][1] += c[k] * c[1];
      for (size_t j = 0; j < n; j++)
        cross[(size_t)k * count + index[j]] += c[k] * value[j];
    }
  }
}

/* The sum of squares that a candidate takes from the residual beside the model, in variances. */
static double score_candidate(score_work *work, const grid_effect *candidate) {
  size_t count = work->solution->columns.count;
  double own[2][2], right[2], *cross = work->projected;
  project_candidate(work, candidate, own, right, cross);
  double left[2][2], s2 = work->variance;
  double mark2 = work->problem->mark_sd * work->problem->mark_sd;
  for (int a = 0; a < 2; a++)
    for (int b = 0; b < 2; b++) {
      double taken = 0;
      for (size_t i = 0; i < count; i++) {
        const double *row = gsl_matrix_const_ptr(work->solution->covariance, i, 0);
        double with = 0, ci = cross[(size_t)a * count + i];
        if (ci == 0) continue;
        for (size_t j = 0; j < count; j++)
          with += row[j] * cross[(size_t)b * count + j];
        taken += ci * with;
      }
      left[a][b] = own[a][b] - taken / mark2;
    }
  if (candidate->kind->columns == 1)
    return left[0][0] > 1e-9 * own[0][0] ? right[0] * right[0] / (left[0][0] * s2) : 0;
  double det = left[0][0] * left[1][1] - left[0][1] * left[1][0];
  if (!(det > 1e-9 * own[0][0] * own[1][1])) return 0;
  return (left[1][1] * right[0] * right[0] - 2 * left[0][1] * right[0] * right[1] +
          left[0][0] * right[1] * right[1]) /
         (det * s2);
}

static grid_effect candidate_of(const grid_problem *problem, const fg_effect *kind, size_t start) {
  grid_effect candidate = {.kind = kind};
  if (kind->polynomial != FG_EFFECT_NO_POLYNOMIAL)
    candidate.shape[0] = problem->frame.centre_mm[kind->axis];
  else if (kind->start)
    candidate.shape[0] = kind->start(&problem->frame, start, kind->starts);
  return candidate;
}

/* Moves the shape to the best place between its neighbours, by thirds. */
static void refine_shape(score_work *work, double low, double high, grid_effect *best,
                         double *score) {
  for (int round = 0; round < REFINEMENTS; round++) {
    grid_effect a = *best, b = *best;
    a.shape[0] = low + 0.382 * (high - low);
    b.shape[0] = high - 0.382 * (high - low);
    double of_a = score_candidate(work, &a), of_b = score_candidate(work, &b);
    if (of_a > *score) *best = a, *score = of_a;
    if (of_b > *score) *best = b, *score = of_b;
    if (of_a > of_b)
      high = b.shape[0];
    else
      low = a.shape[0];
  }
}

/* A ripple of which the marks show less than two places a period could be another one; one that is
 * longer than half the region belongs to a map. */
static bool is_no_ripple(const grid_problem *problem, const grid_effect *candidate) {
  double length = problem->frame.high_mm[1] - problem->frame.low_mm[1];
  return candidate->kind->numbers == FG_EFFECT_WAVE &&
         (candidate->shape[0] < 2 * problem->board[0].pitch_mm ||
          candidate->shape[0] > 0.5 * length);
}

/* Best candidate of one kind. */
static double search_kind(score_work *work, const fg_effect *kind, grid_effect *best) {
  const grid_problem *problem = work->problem;
  size_t starts = kind->start ? kind->starts : 1, at = 0;
  double score = -1;
  for (size_t i = 0; i < starts; i++) {
    grid_effect candidate = candidate_of(problem, kind, i);
    if (is_no_ripple(problem, &candidate)) continue;
    double own = score_candidate(work, &candidate);
    if (own <= score) continue;
    score = own;
    *best = candidate;
    at = i;
  }
  if (!kind->start || score < 0) return score;
  double low = kind->start(&problem->frame, at ? at - 1 : 0, starts);
  double high = kind->start(&problem->frame, at + 1 < starts ? at + 1 : at, starts);
  refine_shape(work, low, high, best, &score);
  return score;
}

static double variance_of(const grid_problem *problem, const grid_solution *solution) {
  double square = 0, n = 0;
  for (size_t i = 0; i < problem->row_count; i++) {
    if (!problem->rows[i].used) continue;
    square += solution->residual[i] * solution->residual[i];
    n++;
  }
  return square / fmax(1, n - (double)solution->columns.board_map);
}

/* Best of all candidates: true when it stands out. */
static bool find_best_effect(score_work *work, grid_effect *best) {
  double max_score = -1, candidates = 0;
  for (const fg_effect *kind = fg_effect_first(); kind; kind = fg_effect_next(kind)) {
    grid_effect own;
    if (!is_candidate(work->problem, kind)) continue;
    candidates += kind->start ? (double)kind->starts : 1;
    double score = search_kind(work, kind, &own);
    if (score <= max_score) continue;
    max_score = score;
    *best = own;
  }
  return max_score > 2 * log(candidates / CHANCE) + 2 * ((double)best->kind->columns - 1);
}

fg_status fg_grid_add_effects(fg_context *ctx, grid_problem *problem) {
  fg_status status = FG_OK;
  double kept = problem->board_sd;
  problem->board_sd = 0; /* rows count alone in scores */
  for (bool found = true; found && problem->effects < GRID_EFFECTS_MAX && status == FG_OK;) {
    grid_solution solution;
    grid_effect best = {0};
    status = fg_grid_solve(ctx, problem, GRID_ALL_ROWS, &solution);
    if (status != FG_OK) break;
    score_work work = {.problem = problem, .solution = &solution};
    work.variance = variance_of(problem, &solution);
    status = fg_memory_allocate(ctx, 2 * solution.columns.count, sizeof(double),
                                (void **)&work.projected);
    found = status == FG_OK && find_best_effect(&work, &best);
    if (found) problem->effect[problem->effects++] = best;
    free(work.projected);
    fg_grid_solution_free(&solution);
  }
  problem->board_sd = kept;
  return status;
}

static size_t first_column_of(const grid_problem *problem, const grid_solution *solution,
                              size_t effect) {
  size_t at = solution->columns.effect;
  for (size_t e = 0; e < effect; e++)
    at += problem->effect[e].kind->columns;
  return at;
}

double fg_grid_effect_chi2(const grid_problem *problem, const grid_solution *solution,
                           size_t effect) {
  size_t at = first_column_of(problem, solution, effect);
  double a = gsl_vector_get(solution->estimate, at);
  double aa = gsl_matrix_get(solution->covariance, at, at);
  if (problem->effect[effect].kind->columns == 1) return a * a / aa;
  double b = gsl_vector_get(solution->estimate, at + 1);
  double bb = gsl_matrix_get(solution->covariance, at + 1, at + 1);
  double ab = gsl_matrix_get(solution->covariance, at, at + 1), det = aa * bb - ab * ab;
  return (bb * a * a - 2 * ab * a * b + aa * b * b) / det;
}

/* Start of the search for a shape that lies next to one in force. */
static size_t nearest_start(const grid_problem *problem, const grid_effect *effect) {
  size_t best = 0;
  double min = INFINITY;
  for (size_t i = 0; i < effect->kind->starts; i++) {
    double off =
        fabs(effect->kind->start(&problem->frame, i, effect->kind->starts) - effect->shape[0]);
    if (off < min) min = off, best = i;
  }
  return best;
}

static fg_status refine_effect(fg_context *ctx, grid_problem *problem, size_t e) {
  grid_effect kept = problem->effect[e];
  grid_solution solution;
  score_work work = {.problem = problem, .solution = &solution};
  grid_problem without = *problem;
  without.effects--;
  memmove(&without.effect[e], &without.effect[e + 1],
          (without.effects - e) * sizeof *without.effect);
  work.problem = &without;
  FG_TRY(fg_grid_solve(ctx, &without, GRID_ALL_ROWS, &solution));
  fg_status status =
      fg_memory_allocate(ctx, 2 * solution.columns.count, sizeof(double), (void **)&work.projected);
  if (status == FG_OK) {
    size_t at = nearest_start(problem, &kept), starts = kept.kind->starts;
    double low = kept.kind->start(&problem->frame, at ? at - 1 : 0, starts);
    double high = kept.kind->start(&problem->frame, at + 1 < starts ? at + 1 : at, starts);
    work.variance = variance_of(&without, &solution);
    double score = score_candidate(&work, &kept);
    refine_shape(&work, low, high, &problem->effect[e], &score);
  }
  free(work.projected);
  fg_grid_solution_free(&solution);
  return status;
}

fg_status fg_grid_refine_effects(fg_context *ctx, grid_problem *problem) {
  double kept = problem->board_sd;
  fg_status status = FG_OK;
  problem->board_sd = 0;
  for (size_t e = fg_grid_own_effects(problem); e < problem->effects && status == FG_OK; e++)
    if (problem->effect[e].kind->start) status = refine_effect(ctx, problem, e);
  problem->board_sd = kept;
  return status;
}

fg_status fg_grid_prune_effects(fg_context *ctx, grid_problem *problem) {
  size_t own = fg_grid_own_effects(problem);
  for (bool dropped = true; dropped;) {
    grid_solution solution;
    size_t weakest = 0;
    double min_chi2 = KEPT_CHI2;
    FG_TRY(fg_grid_solve(ctx, problem, GRID_ALL_ROWS, &solution));
    for (size_t e = own; e < problem->effects; e++) {
      double chi2 = fg_grid_effect_chi2(problem, &solution, e);
      if (chi2 < min_chi2) min_chi2 = chi2, weakest = e;
    }
    fg_grid_solution_free(&solution);
    dropped = weakest > 0;
    if (!dropped) break;
    problem->effects--;
    memmove(&problem->effect[weakest], &problem->effect[weakest + 1],
            (problem->effects - weakest) * sizeof *problem->effect);
  }
  return FG_OK;
}
