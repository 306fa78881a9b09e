/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "grid_loop/solve.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "core/spread.h"

/* Prior sd of effects: a scanner's ratio and shear by some parts in a thousand, as amplitudes at
 * 18 mm; other effects by a millimetre. */
#define U_RATIO_MM (0.01 * FG_FIELD_HALF_MM)
#define U_OTHER_MM 1.0
#define U_POSE     1e3
/* A map has no straight part: that is scale, ratio, shear and pose. Weight of that. */
#define STRAIGHT_WEIGHT 1e6

/* ---- the prior ---- */

/* Adds weight × (Σ coefficient[k] × x[index[k]])². */
static void add_penalty(gsl_matrix *normal, const size_t *index, const double *coefficient,
                        size_t count, double weight) {
  for (size_t a = 0; a < count; a++)
    for (size_t b = 0; b < count; b++)
      *gsl_matrix_ptr(normal, index[a], index[b]) += weight * coefficient[a] * coefficient[b];
}

/* Bends of a map: second differences along x, along y, and mixed, per square of the spacing. Their
 * prior sd is such that a map of size `size` bends by its size within one spacing. */
static void add_bends(const fg_map_frame *frame, size_t first, double size, gsl_matrix *normal) {
  size_t nx = frame->side[0], ny = frame->side[1];
  double weight = 1 / (size * size);
  for (size_t j = 0; j < ny; j++)
    for (size_t i = 0; i < nx; i++) {
      size_t k = first + j * nx + i;
      static const double bend[3] = {1, -2, 1}, twist[4] = {1, -1, -1, 1};
      if (i + 2 < nx) add_penalty(normal, (size_t[]){k, k + 1, k + 2}, bend, 3, weight);
      if (j + 2 < ny) add_penalty(normal, (size_t[]){k, k + nx, k + 2 * nx}, bend, 3, weight);
      if (i + 1 < nx && j + 1 < ny)
        add_penalty(normal, (size_t[]){k, k + 1, k + nx, k + nx + 1}, twist, 4, 2 * weight);
    }
}

/* Keeps 1, x and y out of a component: splines at their knots sum to nothing with each. */
static void keep_straight_out(const fg_map_frame *frame, size_t first, gsl_matrix *normal) {
  size_t nx = frame->side[0], ny = frame->side[1], n = nx * ny;
  size_t index[FG_MAP_SIDE_MAX * FG_MAP_SIDE_MAX];
  double coefficient[FG_MAP_SIDE_MAX * FG_MAP_SIDE_MAX];
  for (int power = 0; power < 3; power++) {
    for (size_t k = 0; k < n; k++) {
      double x = (double)(k % nx) - 0.5 * (double)(nx - 1);
      double y = (double)(k / nx) - 0.5 * (double)(ny - 1);
      index[k] = first + k;
      coefficient[k] = (power == 0 ? 1 : power == 1 ? x : y) / sqrt((double)n);
    }
    add_penalty(normal, index, coefficient, n, STRAIGHT_WEIGHT);
  }
}

static void add_map_prior(const fg_map_frame *frame, size_t first, double size,
                          gsl_matrix *normal) {
  for (size_t component = 0; component < 2; component++) {
    size_t at = first + component * fg_map_splines(frame);
    add_bends(frame, at, size, normal);
    keep_straight_out(frame, at, normal);
  }
}

static void add_diagonal(gsl_matrix *normal, size_t at, double sd) {
  *gsl_matrix_ptr(normal, at, at) += 1 / (sd * sd);
}

static bool is_ratio(const fg_effect *kind) {
  return kind->polynomial == FG_EFFECT_LINEAR || kind->numbers == FG_EFFECT_RATIO;
}

static void add_prior(const grid_problem *problem, const grid_columns *columns,
                      gsl_matrix *normal) {
  for (size_t k = columns->pose; k < columns->board; k++)
    add_diagonal(normal, k, U_POSE);
  for (size_t k = columns->board; k < columns->effect; k++) {
    size_t board = (k - columns->board) / GRID_AFFINE;
    bool scale = (k - columns->board) % GRID_AFFINE == 0;
    double sd = problem->board[board].u_scale;
    /* Each axis has that u: scale and ratio are half the sum and half the difference. */
    add_diagonal(normal, k, scale && !problem->scale_known ? 1 : sd * M_SQRT1_2);
  }
  size_t at = columns->effect;
  for (size_t e = 0; e < problem->effects; e++)
    for (size_t k = 0; k < problem->effect[e].kind->columns; k++)
      add_diagonal(normal, at++, is_ratio(problem->effect[e].kind) ? U_RATIO_MM : U_OTHER_MM);
  if (problem->has_map) add_map_prior(&problem->map, columns->map, problem->map_size, normal);
  if (problem->has_board_map)
    add_map_prior(&problem->board_map, columns->board_map, problem->board_map_size, normal);
}

/* ---- the rows ---- */

typedef struct grid_sums {
  gsl_matrix *normal;
  gsl_vector *right;
  double square, log_variance;
  size_t rows;
} grid_sums;

static bool learns_from(const grid_row *row, grid_rows_used rows) {
  return row->used && !(rows == GRID_NOT_HELD_OUT && row->held_out);
}

static void add_outer(grid_sums *sums, const size_t *index, const double *value, size_t count,
                      double right, double weight) {
  for (size_t a = 0; a < count; a++) {
    double scaled = weight * value[a];
    if (scaled == 0) continue;
    *gsl_vector_ptr(sums->right, index[a]) += scaled * right;
    double *row = gsl_matrix_ptr(sums->normal, index[a], 0);
    for (size_t b = 0; b < count; b++)
      row[index[b]] += scaled * value[b];
  }
  sums->square += weight * right * right;
}

/* The rows of one component of one mark: they share the board's mark, of variance b², beside their
 * own, s². (s² I + b² 1 1ᵀ)⁻¹ = I / s² - 1 1ᵀ b² / (s² (s² + n b²)). */
static void add_group(const grid_problem *problem, const grid_columns *columns, size_t first,
                      size_t last, grid_rows_used rows, grid_sums *sums) {
  size_t index[GRID_ROW_MAX], all[4 * GRID_ROW_MAX], n = 0, joined = 0;
  double value[GRID_ROW_MAX], sum[4 * GRID_ROW_MAX], right = 0;
  double s2 = problem->mark_sd * problem->mark_sd, b2 = problem->board_sd * problem->board_sd;
  for (size_t i = first; i < last; i++) {
    if (!learns_from(&problem->rows[i], rows)) continue;
    size_t count = fg_grid_row_columns(problem, columns, &problem->rows[i], index, value);
    add_outer(sums, index, value, count, problem->rows[i].value, 1 / s2);
    right += problem->rows[i].value;
    n++;
    for (size_t k = 0; k < count && joined < 4 * GRID_ROW_MAX; k++, joined++) {
      all[joined] = index[k];
      sum[joined] = value[k];
    }
  }
  if (!n) return;
  double total = s2 + (double)n * b2;
  sums->log_variance += (double)(n - 1) * log(s2) + log(total);
  sums->rows += n;
  if (b2 > 0) add_outer(sums, all, sum, joined, right, -b2 / (s2 * total));
}

static void add_rows(const grid_problem *problem, const grid_columns *columns, grid_rows_used rows,
                     grid_sums *sums) {
  for (size_t first = 0; first < problem->row_count;) {
    size_t last = first;
    while (last < problem->row_count && problem->rows[last].group == problem->rows[first].group)
      last++;
    add_group(problem, columns, first, last, rows, sums);
    first = last;
  }
}

/* ---- solving ---- */

static double log_determinant(const gsl_matrix *factor) {
  double sum = 0;
  for (size_t k = 0; k < factor->size1; k++)
    sum += 2 * log(gsl_matrix_get(factor, k, k));
  return sum;
}

/* Number of a map's columns with a prior of its size. */
static double map_rank(bool has, const fg_map_frame *frame) {
  return has ? 2 * ((double)fg_map_splines(frame) - 3) : 0;
}

static fg_status fill_residual(fg_context *ctx, const grid_problem *problem,
                               grid_solution *solution) {
  size_t index[GRID_ROW_MAX];
  double value[GRID_ROW_MAX];
  FG_TRY(fg_memory_allocate(ctx, problem->row_count, sizeof *solution->residual,
                            (void **)&solution->residual));
  for (size_t i = 0; i < problem->row_count; i++) {
    size_t n = fg_grid_row_columns(problem, &solution->columns, &problem->rows[i], index, value);
    double fitted = 0;
    for (size_t k = 0; k < n; k++)
      fitted += value[k] * gsl_vector_get(solution->estimate, index[k]);
    solution->residual[i] = problem->rows[i].value - fitted;
  }
  return FG_OK;
}

static fg_status factor_and_solve(fg_context *ctx, const grid_problem *problem, grid_sums *sums,
                                  grid_solution *solution) {
  double dot = 0;
  if (gsl_linalg_cholesky_decomp1(sums->normal))
    return fg_fail(ctx, FG_ERR_NUMERIC, "the grids' model has no single solution");
  gsl_linalg_cholesky_solve(sums->normal, sums->right, solution->estimate);
  for (size_t k = 0; k < sums->right->size; k++)
    dot += gsl_vector_get(sums->right, k) * gsl_vector_get(solution->estimate, k);
  solution->minus_log_likelihood =
      0.5 *
      (log_determinant(sums->normal) + sums->log_variance + sums->square - dot +
       map_rank(problem->has_map, &problem->map) * 2 * log(problem->map_size) +
       map_rank(problem->has_board_map, &problem->board_map) * 2 * log(problem->board_map_size));
  return FG_OK;
}

static fg_status allocate_solution(fg_context *ctx, size_t n, grid_sums *sums,
                                   grid_solution *solution) {
  fg_numerics_start();
  solution->covariance = sums->normal = gsl_matrix_calloc(n, n);
  solution->estimate = gsl_vector_calloc(n);
  sums->right = gsl_vector_calloc(n);
  if (sums->normal && solution->estimate && sums->right) return FG_OK;
  return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu columns", n);
}

static fg_status solve_sums_of_grid(fg_context *ctx, const grid_problem *problem,
                                    grid_rows_used rows, grid_solution *solution) {
  grid_sums sums = {0};
  fg_status status = FG_OK;
  *solution = (grid_solution){.columns = fg_grid_columns(problem)};
  FG_TRY_EXIT(allocate_solution(ctx, solution->columns.count, &sums, solution));
  add_rows(problem, &solution->columns, rows, &sums);
  add_prior(problem, &solution->columns, sums.normal);
  FG_TRY_EXIT(factor_and_solve(ctx, problem, &sums, solution));
exit:
  gsl_vector_free(sums.right);
  return status;
}

fg_status fg_grid_solve(fg_context *ctx, const grid_problem *problem, grid_rows_used rows,
                        grid_solution *solution) {
  fg_status status = FG_OK;
  FG_TRY_EXIT(solve_sums_of_grid(ctx, problem, rows, solution));
  gsl_linalg_cholesky_invert(solution->covariance);
  FG_TRY_EXIT(fill_residual(ctx, problem, solution));
exit:
  if (status != FG_OK) fg_grid_solution_free(solution);
  return status;
}

void fg_grid_solution_free(grid_solution *solution) {
  gsl_matrix_free(solution->covariance);
  gsl_vector_free(solution->estimate);
  free(solution->residual);
  *solution = (grid_solution){0};
}

/* ---- sizes ---- */

enum { SIZE_ROUNDS = 3, SIZE_STEPS = 9, TURNS_OF_SIZES = 2 };
#define SIZE_FACTOR 1.9
#define SIZE_MIN_MM 1e-6
#define OUTLIER_SD  6.0

static fg_status likelihood_of(fg_context *ctx, const grid_problem *problem, double *minus_log) {
  grid_solution solution;
  fg_status status = solve_sums_of_grid(ctx, problem, GRID_ALL_ROWS, &solution);
  *minus_log = solution.minus_log_likelihood;
  fg_grid_solution_free(&solution);
  if (status == FG_ERR_NUMERIC) *minus_log = INFINITY;
  return status == FG_ERR_NUMERIC ? FG_OK : status;
}

/* Moves one size to its most likely value: steps by a factor while they help, then a parabola's
 * half steps. */
static fg_status improve_size(fg_context *ctx, grid_problem *problem, double *size) {
  double best, factor = SIZE_FACTOR;
  FG_TRY(likelihood_of(ctx, problem, &best));
  for (int halving = 0; halving < 3; halving++, factor = sqrt(factor))
    for (int way = -1; way <= 1; way += 2)
      for (int step = 0; step < SIZE_STEPS; step++) {
        double kept = *size, other;
        *size = fmax(SIZE_MIN_MM, kept * (way > 0 ? factor : 1 / factor));
        FG_TRY(likelihood_of(ctx, problem, &other));
        if (other < best - 1e-3) {
          best = other;
          continue;
        }
        *size = kept;
        break;
      }
  return FG_OK;
}

/* Is any mark seen in two scans? */
static bool has_repeats(const grid_problem *problem) {
  for (size_t i = 1; i < problem->row_count; i++)
    if (problem->rows[i].group == problem->rows[i - 1].group) return true;
  return false;
}

static fg_status start_sizes(fg_context *ctx, grid_problem *problem, bool repeats) {
  grid_solution solution;
  double *sizes;
  problem->mark_sd = 0.01;
  problem->board_sd = 0;
  problem->map_size = problem->board_map_size = 0.01;
  FG_TRY(fg_grid_solve(ctx, problem, GRID_ALL_ROWS, &solution));
  fg_status status = fg_memory_allocate(ctx, problem->row_count, sizeof *sizes, (void **)&sizes);
  for (size_t i = 0; status == FG_OK && i < problem->row_count; i++)
    sizes[i] = fabs(solution.residual[i]);
  if (status == FG_OK)
    problem->mark_sd = fmax(SIZE_MIN_MM, fg_robust_sd(sizes, problem->row_count));
  free(sizes);
  fg_grid_solution_free(&solution);
  problem->board_sd = repeats ? problem->mark_sd : 0;
  return status;
}

static fg_status drop_outliers_of_grid(fg_context *ctx, grid_problem *problem) {
  grid_solution solution;
  FG_TRY(fg_grid_solve(ctx, problem, GRID_ALL_ROWS, &solution));
  double limit = OUTLIER_SD * hypot(problem->mark_sd, problem->board_sd);
  for (size_t i = 0; i < problem->row_count; i++)
    problem->rows[i].used = fabs(solution.residual[i]) <= limit;
  fg_grid_solution_free(&solution);
  return FG_OK;
}

fg_status fg_grid_find_sizes(fg_context *ctx, grid_problem *problem) {
  bool repeats = has_repeats(problem);
  if (!(problem->mark_sd > 0)) FG_TRY(start_sizes(ctx, problem, repeats));
  for (int round = 0; round < TURNS_OF_SIZES; round++) {
    FG_TRY(improve_size(ctx, problem, &problem->mark_sd));
    if (repeats) FG_TRY(improve_size(ctx, problem, &problem->board_sd));
    if (problem->has_map) FG_TRY(improve_size(ctx, problem, &problem->map_size));
    if (problem->has_board_map) FG_TRY(improve_size(ctx, problem, &problem->board_map_size));
    if (round == 0) FG_TRY(drop_outliers_of_grid(ctx, problem));
  }
  return FG_OK;
}
