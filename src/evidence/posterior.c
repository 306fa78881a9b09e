/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/posterior.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"

/* Solves transpose(lower) x = v in place. */
static void solve_backward(size_t n, const double *lower, double *v) {
  for (size_t i = n; i-- > 0;) {
    for (size_t k = i + 1; k < n; k++)
      v[i] -= lower[k * n + i] * v[k];
    v[i] /= lower[i * n + i];
  }
}

/* Inverse of a lower triangular matrix, transposed, so that its columns are contiguous; `inverse`
 * is zero. */
static void invert_lower(size_t n, const double *lower, double *inverse) {
  for (size_t c = 0; c < n; c++) {
    double *column = inverse + c * n;
    column[c] = 1 / lower[c * n + c];
    for (size_t i = c + 1; i < n; i++)
      column[i] = -fg_dot_in_lanes(lower + i * n + c, column + c, i - c) / lower[i * n + i];
  }
}

static void fill_covariance(size_t n, const double *inverse, const double *root, double *to) {
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k <= i; k++) {
      double sum = fg_dot_in_lanes(inverse + i * n + i, inverse + k * n + i, n - i);
      to[i * n + k] = to[k * n + i] = root[i] * root[k] * sum;
    }
}

fg_status fg_evidence_find_posterior(fg_context *ctx, fg_evidence_search *s,
                                     const fg_evidence_model *model, fg_evidence_posterior *p) {
  fg_evidence_factor f;
  double *inverse = NULL;
  fg_status status = FG_OK;
  *p = (fg_evidence_posterior){.count = 0};
  FG_TRY(fg_evidence_factor_open(ctx, &s->problem, &s->scatter, model, &f));
  size_t n = p->count = f.count;
  memcpy(p->column, f.column, n * sizeof *p->column);
  FG_TRY_EXIT(fg_memory_allocate(ctx, n + 1, sizeof *p->mean, (void **)&p->mean));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n * n + 1, sizeof *p->covariance, (void **)&p->covariance));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n * n + 1, sizeof *inverse, (void **)&inverse));
  memcpy(p->mean, f.solved, n * sizeof *p->mean);
  solve_backward(n, f.lower, p->mean);
  for (size_t i = 0; i < n; i++)
    p->mean[i] *= f.root[i];
  invert_lower(n, f.lower, inverse);
  fill_covariance(n, inverse, f.root, p->covariance);
exit:
  free(inverse);
  fg_evidence_factor_close(&f);
  if (status != FG_OK) fg_evidence_posterior_close(p);
  return status;
}

void fg_evidence_posterior_close(fg_evidence_posterior *p) {
  free(p->mean);
  free(p->covariance);
  p->mean = p->covariance = NULL;
  p->count = 0;
}

size_t fg_evidence_first_of(const fg_evidence_search *s, const fg_evidence_model *model, size_t k) {
  size_t at = fg_evidence_common_columns(&s->scatter);
  for (size_t i = 0; i < k; i++)
    at += model->part[i]->count;
  return at;
}

fg_status fg_evidence_find_misfit(fg_context *ctx, fg_evidence_search *s, double *misfit_um) {
  fg_evidence_problem *p = &s->problem;
  fg_evidence_posterior posterior;
  double *left = NULL, square = 0;
  fg_status status = FG_OK;
  *misfit_um = 0;
  FG_TRY(fg_evidence_find_posterior(ctx, s, &s->models[0], &posterior));
  FG_TRY_EXIT(fg_memory_allocate(ctx, p->rows, sizeof *left, (void **)&left));
  memcpy(left, p->residual, p->rows * sizeof *left);
  for (size_t c = 0; c < posterior.count; c++) {
    const double *column = p->values + posterior.column[c] * p->rows;
    for (size_t i = 0; i < p->rows; i++)
      left[i] -= posterior.mean[c] * column[i];
  }
  square = fg_dot(left, left, p->rows) / (double)(p->rows > p->rank ? p->rows - p->rank : 1);
  *misfit_um =
      p->noise_um * sqrt(square * fg_edge_fit_integral(p->edge_fit, p->row, p->rows, left));
exit:
  free(left);
  fg_evidence_posterior_close(&posterior);
  return status;
}
