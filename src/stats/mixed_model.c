/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stats/mixed_model.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/extended.h"
#include "core/memory.h"

/* Range and step of the search for the ratio, over ln(1 + n r), n the largest group. Beyond the
 * last value the runs would not scatter at all; before the first a group's mean would be known far
 * better than the runs imply. */
static const double STEP = 0.25, FIRST = -3, LAST = 25;
/* At this ratio a group's mean has a weight of 1e-6 among independent runs: the groups are
 * practically fixed. */
static const double FIXED = 14;
enum { HALVINGS = 60 };

typedef struct setting {
  size_t rows, rank, groups;
  size_t *column;   /* rank: of the model */
  double *root;     /* columns × rank: b = root · coordinates in Q */
  double *size;     /* groups: runs */
  double *sum;      /* groups × rank: s_g */
  double *residual; /* groups: sum of the least squares residuals */
  double squares, largest;
  gsl_matrix *a, *inverse; /* rank × rank: Q' W Q and its inverse */
  gsl_vector *shift;       /* rank: from least squares to the estimate, in Q */
} setting;

static double eigenvalue(const setting *s, size_t g, double ratio) {
  return 1 / (1 + s->size[g] * ratio);
}

/* `matrix` += sum of weight_g s_g s_g'. */
static void add_sums(const setting *s, const double *weight, gsl_matrix *matrix) {
  for (size_t g = 0; g < s->groups; g++) {
    gsl_vector_const_view sum = gsl_vector_const_view_array(s->sum + g * s->rank, s->rank);
    gsl_blas_dsyr(CblasLower, weight[g], &sum.vector, matrix);
  }
  for (size_t i = 0; i < s->rank; i++)
    for (size_t j = i + 1; j < s->rank; j++)
      gsl_matrix_set(matrix, i, j, gsl_matrix_get(matrix, j, i));
}

/* Estimate at a ratio: W = (I + r Z Z')^-1, of a group I - (1 - d) / n 1 1'. Returns the residual
 * sum of squares; NaN where the system cannot be solved. */
static double solve_at_ratio(const setting *s, double ratio, double *weight, double *determinant) {
  double squares = s->squares;
  gsl_vector_set_zero(s->shift);
  gsl_matrix_set_identity(s->a);
  for (size_t g = 0; g < s->groups; g++) {
    weight[g] = -(1 - eigenvalue(s, g, ratio)) / s->size[g];
    squares += weight[g] * s->residual[g] * s->residual[g];
    for (size_t k = 0; k < s->rank; k++)
      s->shift->data[k] += weight[g] * s->residual[g] * s->sum[g * s->rank + k];
  }
  add_sums(s, weight, s->a);
  gsl_matrix_memcpy(s->inverse, s->a);
  if (s->rank && gsl_linalg_cholesky_decomp1(s->inverse) != 0) return NAN;
  *determinant = 0;
  for (size_t k = 0; k < s->rank; k++)
    *determinant += 2 * log(gsl_matrix_get(s->inverse, k, k));
  double gain = 0;
  gsl_vector *right = gsl_vector_alloc(s->rank);
  if (!right) return NAN;
  gsl_vector_memcpy(right, s->shift);
  gsl_linalg_cholesky_svx(s->inverse, s->shift);
  gsl_blas_ddot(right, s->shift, &gain);
  gsl_vector_free(right);
  gsl_linalg_cholesky_invert(s->inverse);
  return squares - gain;
}

static double minus_two_log_likelihood(const setting *s, double ratio, double *weight) {
  double determinant, squares = solve_at_ratio(s, ratio, weight, &determinant);
  double value = (double)(s->rows - s->rank) * log(squares) + determinant;
  for (size_t g = 0; g < s->groups; g++)
    value -= log(eigenvalue(s, g, ratio));
  return value;
}

/* x' M y of two group sums. */
static double product_of_sums(const setting *s, const gsl_matrix *m, size_t g) {
  const double *sum = s->sum + g * s->rank;
  double total = 0;
  for (size_t i = 0; i < s->rank; i++)
    for (size_t j = 0; j < s->rank; j++)
      total += sum[i] * gsl_matrix_get(m, i, j) * sum[j];
  return total;
}

/* Sum of a group's residuals at the estimate. */
static double left_over(const setting *s, size_t g) {
  double left = s->residual[g];
  for (size_t k = 0; k < s->rank; k++)
    left -= s->sum[g * s->rank + k] * s->shift->data[k];
  return left;
}

/* Slope of the restricted log likelihood over the ratio, up to a positive factor. */
static double likelihood_slope(const setting *s, double ratio, double *weight) {
  double determinant, squares = solve_at_ratio(s, ratio, weight, &determinant), slope = 0;
  double scale = squares / (double)(s->rows - s->rank);
  for (size_t g = 0; g < s->groups; g++) {
    double d = eigenvalue(s, g, ratio), left = left_over(s, g);
    slope += d * d * (left * left / scale + product_of_sums(s, s->inverse, g)) - s->size[g] * d;
  }
  return slope;
}

static double ratio_at(const setting *s, double place) {
  return expm1(place) / s->largest;
}

/* The best of a grid, then the slope's zero beside it. */
static double find_ratio(const setting *s, double *weight) {
  double best = FIRST, min = INFINITY;
  for (double place = FIRST; place <= LAST; place += STEP) {
    double value = minus_two_log_likelihood(s, ratio_at(s, place), weight);
    if (!(value < min)) continue;
    min = value;
    best = place;
  }
  double low = fmax(FIRST, best - STEP), high = best + STEP;
  for (int i = 0; i < HALVINGS; i++) {
    double middle = (low + high) / 2;
    if (likelihood_slope(s, ratio_at(s, middle), weight) > 0)
      low = middle;
    else
      high = middle;
  }
  return ratio_at(s, (low + high) / 2);
}

/* Q' V^-1 ... V^-1 Q with `factors` of V^-1 and the middle ones multiplied by Z Z' `middles` times,
 * times s^(2 factors): along 1 the eigenvalue is d^factors n^middles. */
static void fill_product(const setting *s, double ratio, int factors, int middles, double *weight,
                         gsl_matrix *to) {
  gsl_matrix_set_zero(to);
  if (!middles) gsl_matrix_set_identity(to);
  for (size_t g = 0; g < s->groups; g++) {
    double d = eigenvalue(s, g, ratio), n = s->size[g];
    weight[g] = (pow(d, factors) * pow(n, middles) - (middles ? 0 : 1)) / n;
  }
  add_sums(s, weight, to);
}

/* tr(V^-1 V_i V^-1 V_j) s⁴ with Z Z' `middles` times. */
static double trace_of(const setting *s, double ratio, int middles) {
  double sum = 0;
  for (size_t g = 0; g < s->groups; g++) {
    double d = eigenvalue(s, g, ratio), n = s->size[g];
    sum += d * d * pow(n, middles) + (middles ? 0 : n - 1);
  }
  return sum;
}

double fg_mixed_trace_product(const gsl_matrix *a, const gsl_matrix *b) {
  double sum = 0;
  for (size_t i = 0; i < a->size1; i++)
    for (size_t j = 0; j < a->size2; j++)
      sum += gsl_matrix_get(a, i, j) * gsl_matrix_get(b, j, i);
  return sum;
}

/* c = a b */
static void multiply(const gsl_matrix *a, const gsl_matrix *b, gsl_matrix *c) {
  gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, a, b, 0, c);
}

/* From Q to the model's columns: root M root', times `scale`. */
static fg_status carry_over(fg_context *ctx, const setting *s, const gsl_matrix *m, double scale,
                            size_t columns, double **to) {
  double *half = NULL;
  FG_TRY(fg_memory_allocate(ctx, columns * columns, sizeof **to, (void **)to));
  FG_TRY(fg_memory_allocate(ctx, columns * s->rank, sizeof *half, (void **)&half));
  for (size_t j = 0; j < columns; j++)
    for (size_t k = 0; k < s->rank; k++)
      for (size_t l = 0; l < s->rank; l++)
        half[j * s->rank + k] += s->root[j * s->rank + l] * gsl_matrix_get(m, l, k);
  for (size_t i = 0; i < columns; i++)
    for (size_t j = 0; j < columns; j++)
      for (size_t k = 0; k < s->rank; k++)
        (*to)[i * columns + j] += scale * half[i * s->rank + k] * s->root[j * s->rank + k];
  free(half);
  return FG_OK;
}

enum { SLOPE_RUNS, SLOPE_GROUPS, PRODUCT, HELP, CORRECTION, MATRICES };

/* The expected information of the two variances (in units of s²), inverted. */
static bool invert_information(const double information[2][2], double inverse[2][2]) {
  double determinant =
      information[0][0] * information[1][1] - information[0][1] * information[1][0];
  if (!(determinant > 1e-10 * information[0][0] * information[1][1])) return false;
  inverse[0][0] = information[1][1] / determinant;
  inverse[1][1] = information[0][0] / determinant;
  inverse[0][1] = inverse[1][0] = -information[0][1] / determinant;
  return true;
}

/* In units where s² = 1. `m` has room for MATRICES; s->inverse is Phi. Kenward and Roger (1997),
 * with B_i = Q' V^-1 V_i V^-1 Q = -P_i and their Q_ij: information I_ij = (tr(V^-1 V_i V^-1 V_j)
 * - 2 tr(Phi Q_ij) + tr(Phi P_i Phi P_j)) / 2, the correction
 * 2 Phi sum of W_ij (Q_ij - P_i Phi P_j) Phi, and dPhi / dtheta_i = Phi B_i Phi. */
static bool correct_covariance(const setting *s, double ratio, double *weight,
                               gsl_matrix *const m[MATRICES], double w[2][2]) {
  double information[2][2];
  const gsl_matrix *phi = s->inverse;
  fill_product(s, ratio, 2, 0, weight, m[SLOPE_RUNS]);
  fill_product(s, ratio, 2, 1, weight, m[SLOPE_GROUPS]);
  for (int i = 0; i < 2; i++) { /* Phi B_i */
    multiply(phi, m[i], m[HELP]);
    gsl_matrix_memcpy(m[i], m[HELP]);
  }
  for (int i = 0; i < 2; i++)
    for (int j = 0; j <= i; j++) {
      fill_product(s, ratio, 3, i + j, weight, m[PRODUCT]);
      information[i][j] = information[j][i] =
          (trace_of(s, ratio, i + j) - 2 * fg_mixed_trace_product(phi, m[PRODUCT]) +
           fg_mixed_trace_product(m[i], m[j])) /
          2;
    }
  if (!invert_information((const double(*)[2])information, w)) return false;
  gsl_matrix_set_zero(m[CORRECTION]);
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) { /* Phi Q_ij - Phi P_i Phi P_j, then Phi behind */
      fill_product(s, ratio, 3, i + j, weight, m[PRODUCT]);
      multiply(phi, m[PRODUCT], m[HELP]);
      gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, -1, m[i], m[j], 1, m[HELP]);
      gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 2 * w[i][j], m[HELP], phi, 1, m[CORRECTION]);
    }
  for (int i = 0; i < 2; i++) { /* Phi B_i Phi */
    multiply(m[i], phi, m[HELP]);
    gsl_matrix_memcpy(m[i], m[HELP]);
  }
  return true;
}

/* With the ratio given the runs' variance is all that is estimated: Phi is its multiple. */
static void scale_only(const setting *s, gsl_matrix *const m[MATRICES], double w[2][2]) {
  gsl_matrix_memcpy(m[SLOPE_RUNS], s->inverse);
  gsl_matrix_set_zero(m[SLOPE_GROUPS]);
  gsl_matrix_set_zero(m[CORRECTION]);
  w[0][0] = 2 / (double)(s->rows - s->rank);
  w[0][1] = w[1][0] = w[1][1] = 0;
}

static fg_status fill_result(fg_context *ctx, const setting *s, double ratio, double *weight,
                             const fg_regression *ols, fg_mixed_model *mixed) {
  gsl_matrix *m[MATRICES] = {0};
  double w[2][2] = {{0}}, determinant, squares = solve_at_ratio(s, ratio, weight, &determinant);
  double scale = squares / (double)(s->rows - s->rank);
  fg_status status = FG_OK;
  for (int i = 0; i < MATRICES; i++)
    if (!(m[i] = gsl_matrix_alloc(s->rank, s->rank)))
      FG_TRY_EXIT(fg_fail(ctx, FG_ERR_MEMORY, "out of memory"));
  if (mixed->fixed_groups)
    scale_only(s, m, w);
  else if (!correct_covariance(s, ratio, weight, m, w))
    FG_TRY_EXIT(fg_fail(ctx, FG_ERR_NUMERIC,
                        "the scatter of the groups cannot be told from that of the runs in them"));
  mixed->variance[FG_MIXED_RUNS] = scale;
  mixed->variance[FG_MIXED_GROUPS] = scale * ratio;
  mixed->at_border = ratio <= 0;
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++)
      mixed->variances_covariance[i][j] = scale * scale * w[i][j];
  FG_TRY_EXIT(carry_over(ctx, s, s->inverse, scale, mixed->columns, &mixed->covariance));
  gsl_matrix_add(m[CORRECTION], s->inverse);
  FG_TRY_EXIT(carry_over(ctx, s, m[CORRECTION], scale, mixed->columns, &mixed->adjusted));
  for (int i = 0; i < 2; i++)
    FG_TRY_EXIT(carry_over(ctx, s, m[i], 1, mixed->columns, &mixed->slope[i]));
  for (size_t j = 0; j < mixed->columns; j++) {
    mixed->estimate[j] = ols->coefficient[j].aliased ? 0 : ols->coefficient[j].estimate;
    for (size_t k = 0; k < s->rank; k++)
      mixed->estimate[j] += s->root[j * s->rank + k] * s->shift->data[k];
  }
exit:
  for (int i = 0; i < MATRICES; i++)
    gsl_matrix_free(m[i]);
  return status;
}

/* s_g = Q_g' 1 with Q = X U: the sums of X's columns over the group, times U. */
static fg_status fill_sums(fg_context *ctx, const fg_model *model, const fg_levels *groups,
                           const fg_regression *ols, setting *s) {
  fg_extended *column = NULL;
  size_t rows = model->rows, columns = model->columns;
  FG_TRY(fg_memory_allocate(ctx, groups->count * columns, sizeof *column, (void **)&column));
  for (size_t j = 0; j < columns; j++)
    for (size_t i = 0; i < rows; i++) {
      fg_extended *to = &column[groups->index[i] * columns + j];
      *to = fg_extended_add(*to, model->matrix[j * rows + i]);
    }
  for (size_t g = 0; g < groups->count; g++)
    for (size_t k = 0; k < s->rank; k++) {
      fg_extended sum = {0, 0};
      for (size_t j = 0; j <= s->column[k]; j++)
        sum = fg_extended_add(sum,
                              fg_extended_multiply(column[g * columns + j],
                                                   ols->inverse_root[j * columns + s->column[k]]));
      s->sum[g * s->rank + k] = sum.value;
    }
  free(column);
  for (size_t i = 0; i < rows; i++) {
    s->size[groups->index[i]] += 1;
    s->residual[groups->index[i]] += ols->residual[i];
    s->squares += ols->residual[i] * ols->residual[i];
  }
  for (size_t g = 0; g < groups->count; g++)
    s->largest = fmax(s->largest, s->size[g]);
  return FG_OK;
}

static fg_status fill_setting(fg_context *ctx, const fg_model *model, const fg_levels *groups,
                              const fg_regression *ols, setting *s) {
  size_t columns = model->columns, k = 0;
  *s = (setting){.rows = model->rows, .rank = ols->rank, .groups = groups->count};
  FG_TRY(fg_memory_allocate(ctx, s->rank, sizeof *s->column, (void **)&s->column));
  FG_TRY(fg_memory_allocate(ctx, columns * s->rank, sizeof *s->root, (void **)&s->root));
  FG_TRY(fg_memory_allocate(ctx, s->groups, sizeof *s->size, (void **)&s->size));
  FG_TRY(fg_memory_allocate(ctx, s->groups, sizeof *s->residual, (void **)&s->residual));
  FG_TRY(fg_memory_allocate(ctx, s->groups * s->rank, sizeof *s->sum, (void **)&s->sum));
  for (size_t j = 0; j < columns; j++)
    if (!ols->coefficient[j].aliased) s->column[k++] = j;
  for (size_t j = 0; j < columns; j++)
    for (k = 0; k < s->rank; k++)
      s->root[j * s->rank + k] = ols->inverse_root[j * columns + s->column[k]].value;
  s->a = gsl_matrix_alloc(s->rank, s->rank);
  s->inverse = gsl_matrix_alloc(s->rank, s->rank);
  s->shift = gsl_vector_alloc(s->rank);
  if (!s->a || !s->inverse || !s->shift) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory");
  return fill_sums(ctx, model, groups, ols, s);
}

static void setting_free(setting *s) {
  free(s->column);
  free(s->root);
  free(s->size);
  free(s->residual);
  free(s->sum);
  gsl_matrix_free(s->a);
  gsl_matrix_free(s->inverse);
  gsl_vector_free(s->shift);
}

fg_status fg_mixed_fit(fg_context *ctx, const fg_model *model, const fg_levels *groups,
                       const fg_regression *least_squares, bool fixed_groups,
                       fg_mixed_model *mixed) {
  setting s = {0};
  double *weight = NULL;
  fg_status status = FG_OK;
  *mixed = (fg_mixed_model){
      .columns = model->columns, .rank = least_squares->rank, .fixed_groups = fixed_groups};
  if (!least_squares->residual_dof || !(least_squares->residual_ss > 0))
    return fg_fail(ctx, FG_ERR_NUMERIC, "nothing is left of the runs to tell their scatter by");
  FG_TRY_EXIT(fill_setting(ctx, model, groups, least_squares, &s));
  FG_TRY_EXIT(fg_memory_allocate(ctx, s.groups, sizeof *weight, (void **)&weight));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, mixed->columns, sizeof *mixed->estimate, (void **)&mixed->estimate));
  double ratio = fixed_groups ? ratio_at(&s, FIXED) : find_ratio(&s, weight);
  FG_TRY_EXIT(fill_result(ctx, &s, ratio, weight, least_squares, mixed));
  if (fixed_groups) mixed->variance[FG_MIXED_GROUPS] = NAN;
exit:
  setting_free(&s);
  free(weight);
  if (status != FG_OK) fg_mixed_free(mixed);
  return status;
}

void fg_mixed_free(fg_mixed_model *mixed) {
  free(mixed->estimate);
  free(mixed->covariance);
  free(mixed->adjusted);
  for (int i = 0; i < FG_MIXED_VARIANCES; i++)
    free(mixed->slope[i]);
  *mixed = (fg_mixed_model){0};
}

fg_status fg_mixed_is_orthogonal(fg_context *ctx, const fg_model *model, const fg_levels *groups,
                                 const fg_regression *least_squares, bool *orthogonal,
                                 double *of_groups) {
  setting s = {0};
  fg_status status = FG_OK;
  *orthogonal = true;
  FG_TRY_EXIT(fill_setting(ctx, model, groups, least_squares, &s));
  for (size_t g = 1; g < s.groups; g++)
    *orthogonal = *orthogonal && s.size[g] == s.size[0];
  for (size_t k = 0; k < s.rank && *orthogonal; k++) {
    double length = 0, within = 0; /* squared: of Z Z' q_k, and of its part within the model */
    for (size_t g = 0; g < s.groups; g++)
      length += s.size[g] * s.sum[g * s.rank + k] * s.sum[g * s.rank + k];
    for (size_t l = 0; l < s.rank; l++) {
      double along = 0;
      for (size_t g = 0; g < s.groups; g++)
        along += s.sum[g * s.rank + k] * s.sum[g * s.rank + l];
      within += along * along;
    }
    *orthogonal = length - within <= 1e-9 * s.largest * s.largest;
  }
  for (size_t g = 0; g < s.groups && *orthogonal; g++)
    for (size_t k = 0; k < s.rank; k++)
      for (size_t l = 0; l < s.rank; l++)
        of_groups[s.column[k] * model->columns + s.column[l]] +=
            s.sum[g * s.rank + k] * s.sum[g * s.rank + l] / s.largest;
exit:
  setting_free(&s);
  return status;
}
