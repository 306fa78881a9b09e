/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "grid_loop/solve.h"

#include <gsl/gsl_blas.h>
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
/* Of a loose shape, which the search has found: a share of it. */
#define U_SHAPE 0.1
/* Of a pitch of jumps, which lie between marks. */
#define U_JUMPS 0.02
#define U_POSE  1e3
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

/* Returns the column behind the effect's. */
static size_t add_effect_prior(const grid_effect *effect, size_t at, gsl_matrix *normal) {
  size_t columns = fg_grid_effect_columns(effect);
  for (size_t k = 0; k < columns; k++) {
    double sd = is_ratio(effect->kind) ? U_RATIO_MM : U_OTHER_MM;
    if (k >= effect->kind->columns)
      sd = (effect->kind->jumps ? U_JUMPS : U_SHAPE) *
           fmax(fabs(effect->shape[k - effect->kind->columns]), U_SHAPE);
    add_diagonal(normal, at + k, sd);
  }
  return at + columns;
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
  for (size_t e = 0; e < problem->model.effects; e++)
    at = add_effect_prior(&problem->model.effect[e], at, normal);
  if (problem->model.has_map)
    add_map_prior(&problem->model.map, columns->map, problem->model.map_size, normal);
  if (problem->model.has_board_map)
    add_map_prior(&problem->model.board_map, columns->board_map, problem->model.board_map_size,
                  normal);
}

/* ---- the rows ---- */

/* Sums over rows, without their variances: products of the columns with each other and with the
 * values. */
typedef struct grid_products {
  gsl_matrix *normal;
  gsl_vector *right;
  double square;
  size_t groups;
} grid_products;

/* Everything that a likelihood needs of the rows, whatever the sizes: sums over single rows, and,
 * of groups of n rows, over the groups' sums. */
typedef struct grid_sums {
  grid_products single, of_groups[FG_GRID_SCANS + 1];
  size_t columns, rows;
} grid_sums;

static void free_products(grid_products *products) {
  gsl_matrix_free(products->normal);
  gsl_vector_free(products->right);
}

static void free_grid_sums(grid_sums *sums) {
  free_products(&sums->single);
  for (size_t n = 0; n <= FG_GRID_SCANS; n++)
    free_products(&sums->of_groups[n]);
}

static fg_status allocate_products(fg_context *ctx, size_t columns, grid_products *products) {
  if (products->normal) return FG_OK;
  products->normal = gsl_matrix_calloc(columns, columns);
  products->right = gsl_vector_calloc(columns);
  if (products->normal && products->right) return FG_OK;
  return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu columns", columns);
}

static bool learns_from(const grid_row *row, grid_rows_used rows) {
  return row->used && !(rows == GRID_NOT_HELD_OUT && row->held_out);
}

static void add_outer(grid_products *products, const size_t *index, const double *value,
                      size_t count, double right) {
  for (size_t a = 0; a < count; a++) {
    if (value[a] == 0) continue;
    *gsl_vector_ptr(products->right, index[a]) += value[a] * right;
    double *row = gsl_matrix_ptr(products->normal, index[a], 0);
    for (size_t b = 0; b < count; b++)
      row[index[b]] += value[a] * value[b];
  }
  products->square += right * right;
  products->groups++;
}

/* The rows of one component of one mark, in all scans. */
static fg_status add_group(fg_context *ctx, const grid_problem *problem,
                           const grid_columns *columns, size_t first, size_t last,
                           grid_rows_used rows, grid_sums *sums) {
  enum { ALL_MAX = 8 * GRID_ROW_MAX };
  size_t index[GRID_ROW_MAX], all[ALL_MAX], n = 0, joined = 0;
  double value[GRID_ROW_MAX], sum[ALL_MAX], right = 0;
  for (size_t i = first; i < last && joined + GRID_ROW_MAX <= ALL_MAX; i++) {
    if (!learns_from(&problem->rows[i], rows)) continue;
    size_t count = fg_grid_row_columns(problem, columns, &problem->rows[i], index, value);
    add_outer(&sums->single, index, value, count, problem->rows[i].value);
    right += problem->rows[i].value;
    n++;
    for (size_t k = 0; k < count; k++, joined++) {
      all[joined] = index[k];
      sum[joined] = value[k];
    }
  }
  sums->rows += n;
  if (!n) return FG_OK;
  FG_TRY(allocate_products(ctx, sums->columns, &sums->of_groups[n]));
  add_outer(&sums->of_groups[n], all, sum, joined, right);
  return FG_OK;
}

static fg_status add_rows(fg_context *ctx, const grid_problem *problem, const grid_columns *columns,
                          grid_rows_used rows, grid_sums *sums) {
  *sums = (grid_sums){.columns = columns->count};
  FG_TRY(allocate_products(ctx, columns->count, &sums->single));
  for (size_t first = 0; first < problem->row_count;) {
    size_t last = first;
    while (last < problem->row_count && problem->rows[last].group == problem->rows[first].group)
      last++;
    FG_TRY(add_group(ctx, problem, columns, first, last, rows, sums));
    first = last;
  }
  return FG_OK;
}

static void add_weighted(const grid_products *from, double weight, gsl_matrix *normal,
                         gsl_vector *right, double *square) {
  size_t n = normal->size1;
  for (size_t i = 0; i < n; i++) {
    double *to = gsl_matrix_ptr(normal, i, 0);
    const double *row = gsl_matrix_const_ptr(from->normal, i, 0);
    for (size_t j = 0; j <= i; j++)
      to[j] += weight * row[j];
    *gsl_vector_ptr(right, i) += weight * gsl_vector_get(from->right, i);
  }
  *square += weight * from->square;
}

/* Rows of a group of n share the board's mark, of variance b², beside their own, s²:
 * (s² I + b² 1 1ᵀ)⁻¹ = I / s² - 1 1ᵀ b² / (s² (s² + n b²)). Returns the logarithm of the rows'
 * variances. */
static double weigh_rows(const grid_problem *problem, const grid_sums *sums, gsl_matrix *normal,
                         gsl_vector *right, double *square) {
  double s2 = problem->model.mark_sd * problem->model.mark_sd,
         b2 = problem->model.board_sd * problem->model.board_sd;
  double logarithm = (double)sums->rows * log(s2);
  *square = 0;
  add_weighted(&sums->single, 1 / s2, normal, right, square);
  for (size_t n = 1; n <= FG_GRID_SCANS && b2 > 0; n++) {
    const grid_products *groups = &sums->of_groups[n];
    double total = s2 + (double)n * b2;
    if (!groups->groups) continue;
    add_weighted(groups, -b2 / (s2 * total), normal, right, square);
    logarithm += (double)groups->groups * log(total / s2);
  }
  return logarithm;
}

/* ---- solving ---- */

/* Cholesky factor of the lower triangle, row by row; false: not positive definite. GSL's needs a
 * fast BLAS to be fast. */
static bool factor_rows(gsl_matrix *matrix) {
  size_t n = matrix->size1;
  for (size_t i = 0; i < n; i++) {
    double *row = gsl_matrix_ptr(matrix, i, 0);
    for (size_t j = 0; j < i; j++) {
      const double *other = gsl_matrix_const_ptr(matrix, j, 0);
      row[j] = (row[j] - fg_dot_in_lanes(row, other, j)) / other[j];
    }
    double left = row[i] - fg_dot_in_lanes(row, row, i);
    if (!(left > 0)) return false;
    row[i] = sqrt(left);
  }
  return true;
}

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

static double size_terms(const grid_problem *problem) {
  double sum = 0;
  if (problem->model.has_map)
    sum += map_rank(true, &problem->model.map) * 2 * log(problem->model.map_size);
  if (problem->model.has_board_map)
    sum += map_rank(true, &problem->model.board_map) * 2 * log(problem->model.board_map_size);
  return sum;
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

/* Estimates under the problem's sizes; `solution` gets the factor in place of the covariance. */
static fg_status solve_sums_of_grid(fg_context *ctx, const grid_problem *problem,
                                    const grid_sums *sums, grid_solution *solution) {
  size_t n = sums->columns;
  fg_status status = FG_OK;
  double square, dot = 0;
  *solution = (grid_solution){.columns = fg_grid_columns(problem)};
  gsl_vector *right = gsl_vector_calloc(n);
  solution->covariance = gsl_matrix_calloc(n, n);
  solution->estimate = gsl_vector_calloc(n);
  if (!right || !solution->covariance || !solution->estimate) {
    status = fg_fail(ctx, FG_ERR_MEMORY, "out of memory: %zu columns", n);
    goto exit;
  }
  double logarithm = weigh_rows(problem, sums, solution->covariance, right, &square);
  add_prior(problem, &solution->columns, solution->covariance);
  if (!factor_rows(solution->covariance)) {
    status = fg_fail(ctx, FG_ERR_NUMERIC, "the grids' model has no single solution");
    goto exit;
  }
  gsl_vector_memcpy(solution->estimate, right);
  gsl_blas_dtrsv(CblasLower, CblasNoTrans, CblasNonUnit, solution->covariance, solution->estimate);
  gsl_blas_ddot(solution->estimate, solution->estimate, &dot);
  gsl_blas_dtrsv(CblasLower, CblasTrans, CblasNonUnit, solution->covariance, solution->estimate);
  solution->minus_log_likelihood = 0.5 * (log_determinant(solution->covariance) + logarithm +
                                          square - dot + size_terms(problem));
exit:
  gsl_vector_free(right);
  return status;
}

/* The inverse of a factored matrix, in its place, both triangles. */
static void invert_factored(gsl_matrix *factor) {
  size_t n = factor->size1;
  for (size_t i = 0; i < n; i++)
    for (size_t j = i + 1; j < n; j++)
      gsl_matrix_set(factor, i, j, gsl_matrix_get(factor, j, i));
  gsl_linalg_cholesky_invert(factor);
}

fg_status fg_grid_solve(fg_context *ctx, const grid_problem *problem, grid_rows_used rows,
                        grid_solution *solution) {
  grid_columns columns = fg_grid_columns(problem);
  grid_sums sums;
  fg_status status = FG_OK;
  *solution = (grid_solution){0};
  fg_numerics_start();
  FG_TRY_EXIT(add_rows(ctx, problem, &columns, rows, &sums));
  FG_TRY_EXIT(solve_sums_of_grid(ctx, problem, &sums, solution));
  invert_factored(solution->covariance);
  FG_TRY_EXIT(fill_residual(ctx, problem, solution));
exit:
  free_grid_sums(&sums);
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

enum { SIZE_STEPS = 12, TURNS_OF_SIZES = 2 };
/* A size is sought in steps by the first factor, then about the best of three by a parabola. */
#define SIZE_FACTOR 2.0
#define SIZE_MIN_MM 1e-6
#define OUTLIER_SD  6.0

static fg_status find_likelihood_of_size(fg_context *ctx, const grid_problem *problem,
                                         const grid_sums *sums, double *minus_log) {
  grid_solution solution;
  fg_status status = solve_sums_of_grid(ctx, problem, sums, &solution);
  *minus_log = solution.minus_log_likelihood;
  fg_grid_solution_free(&solution);
  if (status == FG_ERR_NUMERIC) *minus_log = INFINITY;
  return status == FG_ERR_NUMERIC ? FG_OK : status;
}

/* Moves one size to its most likely value. */
static fg_status improve_size(fg_context *ctx, grid_problem *problem, const grid_sums *sums,
                              double *size) {
  double at[3], value[3];
  at[1] = *size;
  FG_TRY(find_likelihood_of_size(ctx, problem, sums, &value[1]));
  for (int side = 0; side < 3; side += 2) {
    *size = at[side] = fmax(SIZE_MIN_MM, at[1] * (side ? SIZE_FACTOR : 1 / SIZE_FACTOR));
    FG_TRY(find_likelihood_of_size(ctx, problem, sums, &value[side]));
  }
  for (int step = 0; step < SIZE_STEPS && fmin(value[0], value[2]) < value[1]; step++) {
    int side = value[0] < value[2] ? 0 : 2; /* the next three, one step that way */
    double factor = side ? SIZE_FACTOR : 1 / SIZE_FACTOR;
    at[2 - side] = at[1];
    value[2 - side] = value[1];
    at[1] = at[side];
    value[1] = value[side];
    *size = at[side] = fmax(SIZE_MIN_MM, at[1] * factor);
    if (at[side] == at[1]) break;
    FG_TRY(find_likelihood_of_size(ctx, problem, sums, &value[side]));
  }
  *size = at[1];
  double bend = value[0] - 2 * value[1] + value[2];
  if (isfinite(bend) && bend > 0 && at[0] < at[1])
    *size = at[1] * pow(SIZE_FACTOR, 0.5 * (value[0] - value[2]) / bend);
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
  problem->model.mark_sd = 0.01;
  problem->model.board_sd = 0;
  problem->model.map_size = problem->model.board_map_size = 0.01;
  FG_TRY(fg_grid_solve(ctx, problem, GRID_ALL_ROWS, &solution));
  fg_status status = fg_memory_allocate(ctx, problem->row_count, sizeof *sizes, (void **)&sizes);
  for (size_t i = 0; status == FG_OK && i < problem->row_count; i++)
    sizes[i] = fabs(solution.residual[i]);
  if (status == FG_OK)
    problem->model.mark_sd = fmax(SIZE_MIN_MM, fg_robust_sd(sizes, problem->row_count));
  free(sizes);
  fg_grid_solution_free(&solution);
  /* Without a mark that is seen twice the board's part is the stated one. */
  problem->model.board_sd = repeats ? problem->model.mark_sd : problem->design->u_place_mm;
  return status;
}

static fg_status drop_outliers_of_grid(fg_context *ctx, grid_problem *problem) {
  grid_solution solution;
  FG_TRY(fg_grid_solve(ctx, problem, GRID_ALL_ROWS, &solution));
  double limit = OUTLIER_SD * hypot(problem->model.mark_sd, problem->model.board_sd);
  for (size_t i = 0; i < problem->row_count; i++)
    problem->rows[i].used = fabs(solution.residual[i]) <= limit;
  fg_grid_solution_free(&solution);
  return FG_OK;
}

static fg_status improve_all_sizes(fg_context *ctx, grid_problem *problem, bool repeats) {
  grid_columns columns = fg_grid_columns(problem);
  grid_sums sums;
  fg_status status = FG_OK;
  FG_TRY_EXIT(add_rows(ctx, problem, &columns, GRID_ALL_ROWS, &sums));
  FG_TRY_EXIT(improve_size(ctx, problem, &sums, &problem->model.mark_sd));
  if (repeats) FG_TRY_EXIT(improve_size(ctx, problem, &sums, &problem->model.board_sd));
  if (problem->model.has_map)
    FG_TRY_EXIT(improve_size(ctx, problem, &sums, &problem->model.map_size));
  if (problem->model.has_board_map)
    FG_TRY_EXIT(improve_size(ctx, problem, &sums, &problem->model.board_map_size));
exit:
  free_grid_sums(&sums);
  return status;
}

fg_status fg_grid_find_sizes(fg_context *ctx, grid_problem *problem) {
  bool repeats = has_repeats(problem);
  if (!(problem->model.mark_sd > 0)) FG_TRY(start_sizes(ctx, problem, repeats));
  fg_status status = FG_OK;
  for (int round = 0; round < TURNS_OF_SIZES && status == FG_OK; round++) {
    status = improve_all_sizes(ctx, problem, repeats);
    if (status == FG_OK && round == 0) status = drop_outliers_of_grid(ctx, problem);
  }
  return status;
}
