/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coefficients, aliases and the condition number, from R and its inverse. */
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>

#include "core/extended.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/distribution.h"
#include "stats/regression_parts.h"

/* b = R^-1 z. */
static fg_extended estimate(const fg_orthogonal *s, size_t j) {
  fg_extended sum = {0, 0};
  for (size_t k = j; k < s->columns; k++)
    sum = fg_extended_add(sum, fg_extended_multiply(s->inverse[j * s->columns + k], s->z[k]));
  return sum;
}

/* The squared length of column j, without the part along the constant. */
static fg_extended spread(const fg_orthogonal *s, bool constant, size_t j) {
  fg_extended sum = {0, 0};
  for (size_t i = constant ? 1 : 0; i <= j; i++)
    sum = fg_extended_add(sum, fg_extended_square(s->r[i * s->columns + j]));
  return sum;
}

static void fill_coefficient(const fg_fit *fit, const fg_regression *reg, size_t j,
                             fg_coefficient *c) {
  const fg_orthogonal *s = &fit->solution;
  const fg_extended *u = s->inverse + j * s->columns;
  fg_extended variance = fg_extended_dot(u, u, s->columns);
  double dof = (double)reg->residual_dof;
  c->estimate = reg->estimate_extended[j].value;
  c->standard_error = reg->residual_sd * fg_extended_sqrt(variance).value;
  c->t = c->standard_error > 0 || isnan(c->standard_error)
             ? c->estimate / c->standard_error
             : (c->estimate == 0 ? NAN : copysign(INFINITY, c->estimate));
  c->p_value = fg_distribution_t_two_sided(c->t, dof);
  double half = c->standard_error * fg_distribution_t_quantile((1 + reg->confidence) / 2, dof);
  c->low = c->estimate - half;
  c->high = c->estimate + half;
  bool is_constant = c->term == FG_MODEL_CONSTANT;
  c->vif = is_constant ? NAN : fg_extended_multiply(variance, spread(s, reg->constant, j)).value;
}

fg_status fg_regression_coefficients(fg_context *ctx, const fg_fit *fit, fg_regression *reg) {
  const fg_orthogonal *s = &fit->solution;
  size_t n = s->columns;
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *reg->coefficient, (void **)&reg->coefficient));
  FG_TRY(
      fg_memory_allocate(ctx, n, sizeof *reg->estimate_extended, (void **)&reg->estimate_extended));
  FG_TRY(fg_memory_allocate(ctx, n * n, sizeof *reg->inverse_root, (void **)&reg->inverse_root));
  for (size_t i = 0; i < n * n; i++)
    reg->inverse_root[i] = s->inverse[i];
  for (size_t j = 0; j < n; j++) {
    fg_coefficient *c = &reg->coefficient[j];
    *c = (fg_coefficient){.term = fit->model->column[j].term, .aliased = s->aliased[j]};
    c->estimate = c->standard_error = c->t = c->p_value = c->low = c->high = c->vif = NAN;
    FG_TRY(fg_text_print(ctx, &c->name, "%s", fit->model->column[j].name));
    if (c->aliased) continue;
    reg->estimate_extended[j] = estimate(s, j);
    fill_coefficient(fit, reg, j, c);
  }
  return FG_OK;
}

/* x_j = sum a_i x_i with a = R^-1 (Q' x_j); coefficients of rounding size are left out. */
static fg_status fill_alias(fg_context *ctx, const fg_orthogonal *s, size_t j, fg_alias *alias) {
  size_t n = s->columns;
  double whole = sqrt(spread(s, false, j).value);
  alias->column = j;
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *alias->with, (void **)&alias->with));
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *alias->factor, (void **)&alias->factor));
  for (size_t a = 0; a < s->rank; a++) {
    size_t i = s->kept[a];
    fg_extended factor = {0, 0};
    double size = 0;
    for (size_t k = i; k < j; k++) {
      fg_extended step = fg_extended_multiply(s->inverse[i * n + k], s->r[k * n + j]);
      factor = fg_extended_add(factor, step);
      size += fabs(step.value);
    }
    double part = fabs(factor.value) * sqrt(spread(s, false, i).value);
    if (fabs(factor.value) <= 1e-9 * size || part <= 1e-20 * whole) continue;
    alias->with[alias->count] = i;
    alias->factor[alias->count++] = factor.value;
  }
  return FG_OK;
}

static fg_status note_alias(fg_context *ctx, fg_regression *reg, const fg_alias *alias) {
  char *text = NULL;
  fg_status status = FG_OK;
  if (!alias->count)
    return fg_regression_note(ctx, reg,
                              "%s is 0 in every run: nothing is known of it, and it counts as 0",
                              reg->coefficient[alias->column].name);
  for (size_t i = 0; i < alias->count && status == FG_OK; i++)
    status = fg_text_append(ctx, &text, "%s%.6g × %s", i ? " + " : "", alias->factor[i],
                            reg->coefficient[alias->with[i]].name);
  if (status == FG_OK)
    status = fg_regression_note(
        ctx, reg,
        "%s cannot be told apart from others (it is %s): it is left out, and the "
        "coefficients of those stand for both: predictions hold where that is so",
        reg->coefficient[alias->column].name, text);
  free(text);
  return status;
}

fg_status fg_regression_aliases(fg_context *ctx, const fg_fit *fit, fg_regression *reg) {
  const fg_orthogonal *s = &fit->solution;
  FG_TRY(fg_memory_allocate(ctx, s->columns - s->rank, sizeof *reg->alias, (void **)&reg->alias));
  for (size_t j = 0; j < s->columns; j++) {
    if (!s->aliased[j]) continue;
    fg_alias *alias = &reg->alias[reg->aliases++];
    FG_TRY(fill_alias(ctx, s, j, alias));
    FG_TRY(note_alias(ctx, reg, alias));
  }
  return FG_OK;
}

fg_status fg_regression_condition(fg_context *ctx, const fg_fit *fit, fg_regression *reg) {
  const fg_orthogonal *s = &fit->solution;
  fg_status status = FG_OK;
  reg->condition_number = NAN;
  if (!s->rank) return FG_OK;
  gsl_matrix *r = gsl_matrix_calloc(s->rank, s->rank), *v = gsl_matrix_alloc(s->rank, s->rank);
  gsl_vector *values = gsl_vector_alloc(s->rank);
  if (!r || !v || !values) FG_TRY_EXIT(fg_fail(ctx, FG_ERR_MEMORY, "out of memory"));
  for (size_t b = 0; b < s->rank; b++) {
    double length = sqrt(spread(s, false, s->kept[b]).value);
    for (size_t a = 0; a <= b; a++)
      gsl_matrix_set(r, a, b, s->r[s->kept[a] * s->columns + s->kept[b]].value / length);
  }
  /* One-sided Jacobi: small singular values keep their relative accuracy. */
  if (gsl_linalg_SV_decomp_jacobi(r, v, values) != 0)
    FG_TRY_EXIT(fg_fail(ctx, FG_ERR_NUMERIC, "the singular values did not converge"));
  reg->condition_number = gsl_vector_max(values) / gsl_vector_min(values);
exit:
  gsl_matrix_free(r);
  gsl_matrix_free(v);
  gsl_vector_free(values);
  return status;
}
