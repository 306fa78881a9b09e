/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "grid_loop/search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "grid_loop/score.h"
#include "rows/edge_fit.h"

/* Chance that noise alone adds an effect, over all candidates; an effect stays where its square
 * over its variance exceeds this. */
#define CHANCE    1e-3
#define KEPT_CHI2 30.0
/* Of a wave of less than two pitches, which looks like what a map leaves: renders of smooth fields
 * have up to 65. */
#define KEPT_SHORT_CHI2 200.0
/* Longest ripple as a share of the region along y. */
#define WAVE_MAX_SHARE 0.9
/* Places on either side at which a shape is tried, and rounds of that, each closer. */
enum { SCAN_PLACES = 5, SCAN_ROUNDS = 4, LOOSE_ROUNDS = 4 };
/* Min width of chips, marks. */
#define MARKS_PER_CHIP 1.5
/* A shape that a linear step moves by more than this share of it is not told well enough. */
#define LOOSE_SHARE 0.2

/* Ratio of the axes, then shear: the effects that one ring cannot tell from its own form. */
void fg_grid_begin_effects(grid_problem *problem) {
  for (int scales = 0; scales <= problem->scale_known; scales++)
    for (const fg_effect *kind = fg_effect_first(); kind; kind = fg_effect_next(kind))
      if (scales ? kind->scales : kind->ring == FG_EFFECT_RING_OF_SCANNER)
        problem->model.effect[problem->model.effects++] = (grid_effect){.kind = kind};
}

size_t fg_grid_own_effects(const grid_problem *problem) {
  return problem->scale_known ? 3 : 2;
}

static bool is_in_model(const grid_problem *problem, const fg_effect *kind) {
  for (size_t e = 0; e < problem->model.effects; e++)
    if (problem->model.effect[e].kind == kind) return true;
  return false;
}

/* A name is not needed for what a map follows: of the effects that evidence alone asks for on
 * foils, these are the ones with jumps or waves. Ripples and steps may occur more than once. */
static bool is_candidate(const grid_problem *problem, const fg_effect *kind) {
  if (!kind->glass || fg_effect_is_free(kind) || kind->scales) return false;
  if (kind->columns > GRID_EFFECT_COLUMNS) return false;
  if (kind->by_evidence && !kind->jumps && kind->numbers != FG_EFFECT_WAVE) return false;
  return kind->sought == FG_EFFECT_PLACED || !is_in_model(problem, kind);
}

/* A start of a candidate, and how far from it its shapes may lie. */
static grid_effect candidate_of(const grid_problem *problem, const fg_effect *kind, size_t start,
                                double reach[FG_FIELD_SHAPES]) {
  const fg_field_frame *frame = &problem->model.frame;
  grid_effect candidate = {.kind = kind};
  reach[0] = reach[1] = 0;
  if (kind->polynomial != FG_EFFECT_NO_POLYNOMIAL) {
    candidate.shape[0] = frame->centre_mm[kind->axis];
  } else if (kind->grid) {
    fg_edge_fit no_edges = {.frame = *frame};
    kind->grid(&no_edges, start, kind->starts, candidate.shape, reach);
  } else if (kind->start) {
    candidate.shape[0] = kind->start(frame, start, kind->starts);
    double before = kind->start(frame, start ? start - 1 : 0, kind->starts);
    double after = kind->start(frame, start + 1 < kind->starts ? start + 1 : start, kind->starts);
    reach[0] = fmax(fabs(after - candidate.shape[0]), fabs(before - candidate.shape[0]));
  }
  return candidate;
}

/* A ripple is no shorter than the marks tell. A wave that is not the same along x (yaw, a ripple
 * that grows) has waves of other directions beside it, and what a map leaves looks like them from
 * two pitches on. A wave of which the region holds not one period belongs to a map. */
static bool is_no_ripple(const grid_problem *problem, const grid_effect *candidate) {
  double length = problem->model.frame.high_mm[1] - problem->model.frame.low_mm[1];
  double min = problem->min_wave_mm;
  if (candidate->kind->by_evidence) min = fmax(min, 2 * problem->board[0].pitch_mm);
  double wave = candidate->shape[0];
  bool alike = wave * problem->alike_from_per_mm < 1 && wave * problem->alike_to_per_mm > 1;
  return candidate->kind->numbers == FG_EFFECT_WAVE &&
         (wave < min || wave > WAVE_MAX_SHARE * length || alike);
}

/* Chips of about the marks' own pitch, each with one mark, show the marks a slow ramp or curve. */
static bool are_no_chips(const grid_problem *problem, const grid_effect *candidate) {
  return candidate->kind->jumps && candidate->kind->shapes == 2 &&
         candidate->shape[1] < MARKS_PER_CHIP * problem->board[0].pitch_mm;
}

static bool is_untold(const grid_problem *problem, const grid_effect *candidate) {
  return is_no_ripple(problem, candidate) || are_no_chips(problem, candidate);
}

/* Moves one shape to the best place of a few about it. Scores have jumps over the places of jumps,
 * so no descent would do. */
static void scan_shape(grid_score_work *work, size_t s, double reach, grid_effect *best,
                       double *score) {
  grid_effect about = *best;
  for (int i = -SCAN_PLACES; i <= SCAN_PLACES; i++) {
    grid_effect tried = about;
    tried.shape[s] += reach * i / SCAN_PLACES;
    if (!i || is_untold(work->problem, &tried)) continue;
    double own = fg_grid_score(work, &tried);
    if (own > *score) *best = tried, *score = own;
  }
}

/* Moves all shapes to the best place within their reach, closer from round to round. */
static void refine_shapes(grid_score_work *work, const double reach[FG_FIELD_SHAPES],
                          grid_effect *best, double *score) {
  double share = 1;
  for (int round = 0; round < SCAN_ROUNDS; round++, share /= SCAN_PLACES)
    for (int again = 0; again < (best->kind->shapes > 1 ? 2 : 1); again++)
      for (size_t s = 0; s < best->kind->shapes; s++)
        if (reach[s] > 0) scan_shape(work, s, share * reach[s], best, score);
}

/* Best candidate of one kind. */
static double search_kind(grid_score_work *work, const fg_effect *kind, grid_effect *best) {
  const grid_problem *problem = work->problem;
  size_t starts = kind->start || kind->grid ? kind->starts : 1;
  double score = -1, best_reach[FG_FIELD_SHAPES] = {0};
  for (size_t i = 0; i < starts; i++) {
    double reach[FG_FIELD_SHAPES];
    grid_effect candidate = candidate_of(problem, kind, i, reach);
    if (is_untold(problem, &candidate)) continue;
    double own = fg_grid_score(work, &candidate);
    if (own <= score) continue;
    score = own;
    *best = candidate;
    memcpy(best_reach, reach, sizeof reach);
  }
  if (score > 0) refine_shapes(work, best_reach, best, &score);
  return score;
}

/* Numbers cost as in Schwarz's criterion, so that a kind that contains another one is taken only
 * where its further numbers tell. */
static double number_cost(const grid_problem *problem, const fg_effect *kind) {
  return log((double)problem->row_count) * (double)(kind->columns + kind->shapes);
}

/* Best of all candidates: true when it stands out. */
static bool find_best_effect(grid_score_work *work, grid_effect *best) {
  double max_score = -1, max_left = -INFINITY, candidates = 0;
  for (const fg_effect *kind = fg_effect_first(); kind; kind = fg_effect_next(kind)) {
    grid_effect own;
    if (!is_candidate(work->problem, kind)) continue;
    candidates += kind->start || kind->grid ? (double)kind->starts : 1;
    double score = search_kind(work, kind, &own);
    double left = score - number_cost(work->problem, kind);
    if (score < 0 || left <= max_left) continue;
    max_score = score;
    max_left = left;
    *best = own;
  }
  return max_score > 2 * log(candidates / CHANCE) + 2 * ((double)best->kind->columns - 1);
}

fg_status fg_grid_add_effects(fg_context *ctx, grid_problem *problem) {
  fg_status status = FG_OK;
  double kept = problem->model.board_sd;
  problem->model.board_sd = 0; /* rows count alone in scores */
  for (bool found = true; found && problem->model.effects < GRID_EFFECTS_MAX && status == FG_OK;) {
    grid_solution solution;
    grid_score_work work;
    grid_effect best = {0};
    status = fg_grid_solve(ctx, problem, GRID_ALL_ROWS, &solution);
    if (status != FG_OK) break;
    status = fg_grid_score_open(ctx, problem, &solution, &work);
    found = status == FG_OK && find_best_effect(&work, &best);
    if (found) problem->model.effect[problem->model.effects++] = best;
    fg_grid_score_close(&work);
    fg_grid_solution_free(&solution);
  }
  problem->model.board_sd = kept;
  return status;
}

static size_t first_column_of(const grid_problem *problem, const grid_solution *solution,
                              size_t effect) {
  size_t at = solution->columns.effect;
  for (size_t e = 0; e < effect; e++)
    at += fg_grid_effect_columns(&problem->model.effect[e]);
  return at;
}

double fg_grid_effect_chi2(const grid_problem *problem, const grid_solution *solution,
                           size_t effect) {
  size_t at = first_column_of(problem, solution, effect);
  double a = gsl_vector_get(solution->estimate, at);
  double aa = gsl_matrix_get(solution->covariance, at, at);
  if (problem->model.effect[effect].kind->columns == 1) return a * a / aa;
  double b = gsl_vector_get(solution->estimate, at + 1);
  double bb = gsl_matrix_get(solution->covariance, at + 1, at + 1);
  double ab = gsl_matrix_get(solution->covariance, at, at + 1), det = aa * bb - ab * ab;
  return (bb * a * a - 2 * ab * a * b + aa * b * b) / det;
}

/* Start of the search for a shape that lies next to one in force, with its reach. */
static void find_shape_reach(const grid_problem *problem, const grid_effect *effect,
                             double reach[FG_FIELD_SHAPES]) {
  double min = INFINITY;
  for (size_t i = 0; i < effect->kind->starts; i++) {
    double own[FG_FIELD_SHAPES];
    grid_effect start = candidate_of(problem, effect->kind, i, own);
    double off = fabs(start.shape[0] - effect->shape[0]) + fabs(start.shape[1] - effect->shape[1]);
    if (off >= min) continue;
    min = off;
    memcpy(reach, own, sizeof own);
  }
}

static fg_status refine_effect(fg_context *ctx, grid_problem *problem, size_t e) {
  grid_effect *effect = &problem->model.effect[e];
  grid_solution solution;
  grid_score_work work;
  double reach[FG_FIELD_SHAPES] = {0};
  grid_problem without = *problem;
  without.model.effects--;
  memmove(&without.model.effect[e], &without.model.effect[e + 1],
          (without.model.effects - e) * sizeof *without.model.effect);
  FG_TRY(fg_grid_solve(ctx, &without, GRID_ALL_ROWS, &solution));
  fg_status status = fg_grid_score_open(ctx, &without, &solution, &work);
  if (status == FG_OK) {
    double score = fg_grid_score(&work, effect);
    find_shape_reach(problem, effect, reach);
    refine_shapes(&work, reach, effect, &score);
    grid_effect best = *effect;
    /* Two shapes have many maxima, and the first best one was found without the other effects. */
    if (effect->kind->grid && search_kind(&work, effect->kind, &best) > score) *effect = best;
  }
  fg_grid_score_close(&work);
  fg_grid_solution_free(&solution);
  return status;
}

fg_status fg_grid_refine_effects(fg_context *ctx, grid_problem *problem) {
  double kept = problem->model.board_sd;
  fg_status status = FG_OK;
  problem->model.board_sd = 0;
  for (size_t e = fg_grid_own_effects(problem); e < problem->model.effects && status == FG_OK; e++)
    if (problem->model.effect[e].kind->start || problem->model.effect[e].kind->grid)
      status = refine_effect(ctx, problem, e);
  problem->model.board_sd = kept;
  return status;
}

/* The place of a jump alone has no derivative, but the slope between jumps of one pitch has. The
 * middle of a polynomial is a matter of the axes. */
static bool can_be_loose(const fg_effect *kind) {
  if (kind->jumps) return kind->shapes == 2;
  return kind->shapes && kind->polynomial == FG_EFFECT_NO_POLYNOMIAL;
}

/* Moves a loose shape; false where it would leave its neighbourhood. */
static bool move_effect(grid_effect *effect, const double *estimate) {
  size_t own = effect->kind->columns, all = fg_grid_effect_columns(effect);
  for (size_t k = own; k < all; k++)
    if (fabs(estimate[k]) > LOOSE_SHARE * fabs(effect->shape[k - own])) return false;
  for (size_t k = own; k < all && !effect->kind->jumps; k++) /* marks would change sides */
    effect->shape[k - own] += estimate[k];
  memcpy(effect->amplitude_mm, estimate, own * sizeof *estimate);
  return true;
}

/* Moves loose shapes by the changes that the solution has for them; `fixed` becomes true for those
 * that do not converge.
 */
static void move_loose_shapes(grid_problem *problem, const grid_solution *solution, bool *fixed) {
  size_t at = solution->columns.effect;
  for (size_t e = 0; e < problem->model.effects; e++) {
    grid_effect *effect = &problem->model.effect[e];
    size_t all = fg_grid_effect_columns(effect);
    if (effect->kind->columns <= GRID_EFFECT_COLUMNS)
      fixed[e] |= !move_effect(effect, gsl_vector_const_ptr(solution->estimate, at));
    at += all;
  }
}

fg_status fg_grid_loosen_shapes(fg_context *ctx, grid_problem *problem) {
  bool fixed[GRID_EFFECTS_MAX] = {false};
  for (int round = 0; round < LOOSE_ROUNDS; round++) {
    grid_solution solution;
    FG_TRY(fg_grid_solve(ctx, problem, GRID_ALL_ROWS, &solution));
    move_loose_shapes(problem, &solution, fixed);
    fg_grid_solution_free(&solution);
    for (size_t e = fg_grid_own_effects(problem); e < problem->model.effects; e++)
      problem->model.effect[e].loose = can_be_loose(problem->model.effect[e].kind) && !fixed[e];
  }
  return FG_OK;
}

static double kept_chi2(const grid_problem *problem, size_t e) {
  const grid_effect *effect = &problem->model.effect[e];
  bool is_short =
      effect->kind->numbers == FG_EFFECT_WAVE && effect->shape[0] < 2 * problem->board[0].pitch_mm;
  return is_short ? KEPT_SHORT_CHI2 : KEPT_CHI2;
}

fg_status fg_grid_prune_effects(fg_context *ctx, grid_problem *problem) {
  size_t own = fg_grid_own_effects(problem);
  for (bool dropped = true; dropped;) {
    grid_solution solution;
    size_t weakest = 0;
    double min_share = 1;
    FG_TRY(fg_grid_solve(ctx, problem, GRID_ALL_ROWS, &solution));
    for (size_t e = own; e < problem->model.effects; e++) {
      double share = fg_grid_effect_chi2(problem, &solution, e) / kept_chi2(problem, e);
      if (share < min_share) min_share = share, weakest = e;
    }
    fg_grid_solution_free(&solution);
    dropped = weakest > 0;
    if (!dropped) break;
    problem->model.effects--;
    memmove(&problem->model.effect[weakest], &problem->model.effect[weakest + 1],
            (problem->model.effects - weakest) * sizeof *problem->model.effect);
  }
  return FG_OK;
}
