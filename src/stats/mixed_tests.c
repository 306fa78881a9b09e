/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Variances and tests of a mixed model's estimates (Kenward and Roger 1997). */
#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>

#include "stats/mixed_model.h"

static double quadratic(const double *matrix, const double *row, size_t columns) {
  double sum = 0;
  for (size_t i = 0; i < columns; i++)
    for (size_t j = 0; j < columns && row[i] != 0; j++)
      sum += row[i] * matrix[i * columns + j] * row[j];
  return sum;
}

/* Returns the variance and its dof, 2 v² / var(v), with v by the unadjusted covariance: Kenward and
 * Roger's for a single contrast. */
double fg_mixed_variance(const fg_mixed_model *mixed, const double *row, bool run, double *dof) {
  double extra = run ? mixed->variance[0] + fmax(0, mixed->variance[1]) : 0, scatter = 0, slope[2];
  double variance = quadratic(mixed->covariance, row, mixed->columns) + extra;
  int varied = mixed->at_border ? 1 : 2; /* variances of a new run: a negative one is none */
  for (int i = 0; i < 2; i++)
    slope[i] = quadratic(mixed->slope[i], row, mixed->columns) + (run && i < varied ? 1 : 0);
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++)
      scatter += slope[i] * slope[j] * mixed->variances_covariance[i][j];
  *dof = 2 * variance * variance / scatter;
  return quadratic(mixed->adjusted, row, mixed->columns) + extra;
}

/* rows · matrix · rows', `rows` count × columns. */
static gsl_matrix *carry_to_rows(const double *matrix, size_t columns, const double *rows,
                                 size_t count) {
  gsl_matrix_const_view to = gsl_matrix_const_view_array(rows, count, columns);
  gsl_matrix_const_view from = gsl_matrix_const_view_array(matrix, columns, columns);
  gsl_matrix *half = gsl_matrix_alloc(count, columns), *whole = gsl_matrix_alloc(count, count);
  if (half && whole) {
    gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, &to.matrix, &from.matrix, 0, half);
    gsl_blas_dgemm(CblasNoTrans, CblasTrans, 1, half, &to.matrix, 0, whole);
  }
  gsl_matrix_free(half);
  return whole;
}

/* Scale of F and its degrees of freedom (Kenward and Roger 1997, section 3) of q coefficients. */
static void match_moments(double q, double a1, double a2, double *scale, double *dof) {
  double b = (a1 + 6 * a2) / (2 * q), g = ((q + 1) * a1 - (q + 4) * a2) / ((q + 2) * a2);
  double below = 3 * q + 2 * (1 - g);
  double v0 = 1 + g / below * b, v1 = 1 - (q - g) / below * b, v2 = 1 - (q + 2 - g) / below * b;
  double mean = 1 - a2 / q;
  double ratio = v0 / v2 / q * (mean / v1) * (mean / v1);
  *dof = 4 + (q + 2) / (q * ratio - 1);
  *scale = fabs(*dof - 2) < 0.01 ? 1 : *dof * mean / (*dof - 2);
}

static void sum_traces(const fg_mixed_model *mixed, const gsl_matrix *const product[2], double *a1,
                       double *a2) {
  double trace[2] = {0, 0};
  *a1 = *a2 = 0;
  for (int i = 0; i < 2; i++)
    for (size_t k = 0; k < product[i]->size1; k++)
      trace[i] += gsl_matrix_get(product[i], k, k);
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++) {
      *a1 += mixed->variances_covariance[i][j] * trace[i] * trace[j];
      *a2 += mixed->variances_covariance[i][j] * fg_mixed_trace_product(product[i], product[j]);
    }
}

static fg_status test_rows(fg_context *ctx, const fg_mixed_model *mixed, const double *rows,
                           size_t count, double *f, double *dof) {
  enum { COVARIANCE, ADJUSTED, SLOPE_0, SLOPE_1, PRODUCT_0, PRODUCT_1, PARTS };
  const double *const source[] = {mixed->covariance, mixed->adjusted, mixed->slope[0],
                                  mixed->slope[1],   mixed->slope[0], mixed->slope[1]};
  gsl_matrix *part[PARTS] = {0};
  gsl_vector *b = gsl_vector_alloc(count), *solved = gsl_vector_alloc(count);
  double a1, a2, scale, square = 0;
  fg_status status = FG_OK;
  for (int i = 0; i < PARTS; i++)
    if (!(part[i] = carry_to_rows(source[i], mixed->columns, rows, count)) || !b || !solved)
      FG_TRY_EXIT(fg_fail(ctx, FG_ERR_MEMORY, "out of memory"));
  *f = *dof = NAN;
  if (gsl_linalg_cholesky_decomp1(part[COVARIANCE]) != 0 ||
      gsl_linalg_cholesky_decomp1(part[ADJUSTED]) != 0)
    goto exit;
  gsl_linalg_cholesky_invert(part[COVARIANCE]);
  for (int i = 0; i < 2; i++)
    gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, part[COVARIANCE], part[SLOPE_0 + i], 0,
                   part[PRODUCT_0 + i]);
  const gsl_matrix *const product[2] = {part[PRODUCT_0], part[PRODUCT_1]};
  sum_traces(mixed, product, &a1, &a2);
  gsl_vector_const_view estimate = gsl_vector_const_view_array(mixed->estimate, mixed->columns);
  gsl_matrix_const_view to = gsl_matrix_const_view_array(rows, count, mixed->columns);
  gsl_blas_dgemv(CblasNoTrans, 1, &to.matrix, &estimate.vector, 0, b);
  gsl_linalg_cholesky_solve(part[ADJUSTED], b, solved);
  gsl_blas_ddot(b, solved, &square);
  match_moments((double)count, a1, a2, &scale, dof);
  *f = scale * square / (double)count;
exit:
  for (int i = 0; i < PARTS; i++)
    gsl_matrix_free(part[i]);
  gsl_vector_free(b);
  gsl_vector_free(solved);
  return status;
}

fg_status fg_mixed_test(fg_context *ctx, const fg_mixed_model *mixed, const double *rows,
                        size_t count, double *f, double *dof) {
  *f = *dof = NAN;
  return count ? test_rows(ctx, mixed, rows, count, f, dof) : FG_OK;
}
