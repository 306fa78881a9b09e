/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors of marks that no fit saw: of scans that only confirm (--hold-out), or, without any, of
 * every fifth mark in turn. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/small_solve.h"
#include "grid_loop/grid_loop.h"

/* Marks that are held out in turn, and from which number of marks on that is done. */
enum { FOLDS = 5, MARKS_TO_HOLD_OUT = 40 };

/* The same model without what the loop found: poses, and the scale where no pitch is stated. */
static grid_problem bare_problem(const grid_problem *problem) {
  grid_problem bare = *problem;
  bare.model.effects = 0;
  bare.model.has_map = bare.model.has_board_map = false;
  for (size_t i = 0; i < bare.board_count; i++)
    bare.board[i].u_scale = 1e-9;
  return bare;
}

/* Neighbours are in different folds. */
static void hold_out_fold(grid_problem *problem, int fold) {
  for (size_t i = 0; i < problem->row_count; i++) {
    grid_row *row = &problem->rows[i];
    double pitch = problem->board[row->board].pitch_mm;
    long place = lround(row->place.x / pitch) + 2 * lround(row->place.y / pitch);
    row->held_out = ((place % FOLDS) + FOLDS) % FOLDS == fold;
  }
}

static fg_status add_held_out(fg_context *ctx, const grid_problem *problem, double *square) {
  grid_solution solution;
  FG_TRY(fg_grid_solve(ctx, problem, GRID_NOT_HELD_OUT, &solution));
  for (size_t i = 0; i < problem->row_count; i++)
    if (problem->rows[i].held_out && problem->rows[i].used)
      *square += solution.residual[i] * solution.residual[i];
  fg_grid_solution_free(&solution);
  return FG_OK;
}

static double count_used(const grid_problem *problem) {
  double used = 0;
  for (size_t i = 0; i < problem->row_count; i++)
    used += problem->rows[i].used;
  return used;
}

static fg_status find_rms(fg_context *ctx, const grid_problem *problem, double *um) {
  grid_solution solution;
  double square = 0;
  FG_TRY(fg_grid_solve(ctx, problem, GRID_ALL_ROWS, &solution));
  for (size_t i = 0; i < problem->row_count; i++)
    if (problem->rows[i].used) square += solution.residual[i] * solution.residual[i];
  fg_grid_solution_free(&solution);
  *um = 1000 * sqrt(square / count_used(problem));
  return FG_OK;
}

/* ---- scans that only confirm ---- */

/* Sum of squares of a scan's rows, and their number. */
typedef struct held_out_sum {
  double square, rows;
} held_out_sum;

/* A scan's own unknowns: its pose, and scale, ratio and shear of a board that no other scan shows.
 */
enum { OWN = GRID_POSE + GRID_AFFINE };

/* Prior sd of an unknown of a board; 0: the board is known from other scans. */
static double board_prior(const grid_problem *problem, size_t scan, size_t unknown) {
  size_t board = problem->board_of[scan];
  for (size_t other = 0; other < scan; other++)
    if (problem->board_of[other] == board) return 0;
  if (unknown == GRID_POSE && !problem->scale_known) return 1;
  return problem->board[board].u_scale * M_SQRT1_2;
}

static bool is_in_region(const fg_field_frame *frame, fg_point at) {
  return at.x >= frame->low_mm[0] && at.x <= frame->high_mm[0] && at.y >= frame->low_mm[1] &&
         at.y <= frame->high_mm[1];
}

/* Of a row of the scan, the columns of its own unknowns. */
static void find_own_columns(const grid_problem *problem, const grid_columns *columns,
                             const grid_row *row, double own[OWN]) {
  size_t index[GRID_ROW_MAX];
  double value[GRID_ROW_MAX];
  fg_grid_row_columns(problem, columns, row, index, value);
  for (size_t k = 0; k < OWN; k++) /* they are the first of a row */
    own[k] = k >= GRID_POSE && board_prior(problem, row->scan, k) == 0 ? 0 : value[k];
}

/* Fits a scan's own unknowns to the residuals that the solution of the other scans leaves at its
 * marks. */
static bool fit_own(const grid_problem *problem, const grid_solution *solution, size_t scan,
                    double x[OWN]) {
  fg_normal_equations system;
  double own[OWN], weight = 1 / (problem->model.mark_sd * problem->model.mark_sd);
  fg_normal_clear(&system, OWN);
  for (size_t i = 0; i < problem->row_count; i++) {
    const grid_row *row = &problem->rows[i];
    if (row->scan != scan || !row->used || !is_in_region(&problem->model.frame, row->at)) continue;
    find_own_columns(problem, &solution->columns, row, own);
    fg_normal_add(&system, own, solution->residual[i], weight);
  }
  for (size_t k = GRID_POSE; k < OWN; k++) {
    double unit[OWN] = {0}, sd = board_prior(problem, scan, k);
    unit[k] = 1;
    fg_normal_add(&system, unit, 0, sd > 0 ? 1 / (sd * sd) : weight);
  }
  return fg_normal_solve(&system, 0, x, NULL);
}

static held_out_sum sum_held_out(const grid_problem *problem, const grid_solution *solution,
                                 size_t scan) {
  held_out_sum sum = {0, 0};
  double x[OWN], own[OWN];
  if (!fit_own(problem, solution, scan, x)) return sum;
  for (size_t i = 0; i < problem->row_count; i++) {
    const grid_row *row = &problem->rows[i];
    if (row->scan != scan || !row->used || !is_in_region(&problem->model.frame, row->at)) continue;
    double residual = solution->residual[i];
    find_own_columns(problem, &solution->columns, row, own);
    for (size_t k = 0; k < OWN; k++)
      residual -= own[k] * x[k];
    sum.square += residual * residual;
    sum.rows++;
  }
  return sum;
}

static double rms_of_sum(held_out_sum sum) {
  return sum.rows > 0 ? 1000 * sqrt(sum.square / sum.rows) : NAN;
}

/* Adds the errors of all scans held out under a model; `um` gets those of each. */
static fg_status find_scans_held_out(fg_context *ctx, const fg_grid_loop *loop,
                                     const grid_problem *problem, double *all_um, double *um) {
  grid_solution solution;
  held_out_sum all = {0, 0};
  FG_TRY(fg_grid_solve(ctx, problem, GRID_NOT_HELD_OUT, &solution));
  for (size_t k = 0; k < loop->held_out_count; k++) {
    held_out_sum one = sum_held_out(problem, &solution, loop->scan_count + k);
    um[k] = rms_of_sum(one);
    all.square += one.square;
    all.rows += one.rows;
  }
  *all_um = rms_of_sum(all);
  fg_grid_solution_free(&solution);
  return FG_OK;
}

/* The loop's model over the rows of all scans. Outliers are those of the loop; of scans held out
 * the lattice's own. */
static void take_model(const grid_problem *from, size_t scans, grid_problem *to) {
  to->model = from->model;
  for (size_t i = 0; i < to->row_count; i++)
    to->rows[i].held_out = to->rows[i].scan >= scans;
}

static fg_status hold_out_scans(fg_context *ctx, fg_grid_loop *loop) {
  fg_grid_loop_result *result = &loop->result;
  size_t count = loop->held_out_count;
  double before[FG_GRID_SCANS], after[FG_GRID_SCANS];
  grid_problem whole = {0};
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_grid_problem_build(ctx, loop->measurements, loop->scan_count + count,
                                    &loop->options, &whole));
  take_model(&loop->problem, loop->scan_count, &whole);
  grid_problem bare = bare_problem(&whole);
  FG_TRY_EXIT(find_scans_held_out(ctx, loop, &bare, &result->held_out_before_um, before));
  FG_TRY_EXIT(find_scans_held_out(ctx, loop, &whole, &result->held_out_after_um, after));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *result->held_out, (void **)&result->held_out));
  result->held_out_scans = count;
  for (size_t k = 0; k < count; k++)
    result->held_out[k] =
        (fg_grid_held_out){.measurement = &loop->measurements[loop->scan_count + k],
                           .turn_deg = 90 * whole.turns[loop->scan_count + k],
                           .before_um = before[k],
                           .after_um = after[k]};
exit:
  fg_grid_problem_free(&whole);
  return status;
}

/* ---- marks in turn ---- */

static fg_status hold_out_in_turn(fg_context *ctx, fg_grid_loop *loop) {
  grid_problem *problem = &loop->problem;
  fg_grid_loop_result *result = &loop->result;
  double before = 0, after = 0;
  grid_problem bare = bare_problem(problem);
  if (result->marks < MARKS_TO_HOLD_OUT) return FG_OK;
  for (int fold = 0; fold < FOLDS; fold++) {
    hold_out_fold(problem, fold);
    FG_TRY(add_held_out(ctx, &bare, &before));
    FG_TRY(add_held_out(ctx, problem, &after));
  }
  result->held_out_before_um = 1000 * sqrt(before / count_used(problem));
  result->held_out_after_um = 1000 * sqrt(after / count_used(problem));
  return FG_OK;
}

fg_status fg_grid_loop_hold_out(fg_context *ctx, fg_grid_loop *loop) {
  fg_grid_loop_result *result = &loop->result;
  grid_problem bare = bare_problem(&loop->problem);
  FG_TRY(find_rms(ctx, &bare, &result->before_um));
  FG_TRY(find_rms(ctx, &loop->problem, &result->after_um));
  result->held_out_before_um = result->held_out_after_um = NAN;
  return loop->held_out_count ? hold_out_scans(ctx, loop) : hold_out_in_turn(ctx, loop);
}
