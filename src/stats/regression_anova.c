/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sums of squares by term, sequential and partial; lack of fit against repeated runs. */
#include <math.h>
#include <stdlib.h>

#include "core/extended.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/distribution.h"
#include "stats/regression_parts.h"

static void finish_row(const fg_regression *reg, fg_anova_row *row) {
  double mean_square = reg->residual_sd * reg->residual_sd;
  if (!row->dof) {
    row->mean_square = row->f = row->p_value = NAN;
    return;
  }
  row->mean_square = row->sum_of_squares / (double)row->dof;
  row->f = row->mean_square / mean_square;
  row->p_value = fg_distribution_f_upper(row->f, (double)row->dof, (double)reg->residual_dof);
}

/* The columns of a term are neighbours; each adds z². */
static void sequential_row(const fg_fit *fit, size_t term, fg_anova_row *row) {
  const fg_orthogonal *s = &fit->solution;
  fg_extended sum = {0, 0};
  for (size_t k = 0; k < s->rank; k++) {
    if (fit->model->column[s->kept[k]].term != term) continue;
    sum = fg_extended_add(sum, fg_extended_square(s->z[s->kept[k]]));
    row->dof++;
  }
  row->sum_of_squares = sum.value;
}

/* b' C^-1 b by Cholesky, C = U U' restricted to the term's columns, in place. C is positive
 * definite, as the columns were kept. */
static fg_extended wald(fg_extended *c, fg_extended *b, size_t n) {
  fg_extended sum = {0, 0};
  for (size_t j = 0; j < n; j++) {
    for (size_t k = 0; k < j; k++) {
      b[j] = fg_extended_subtract(b[j], fg_extended_multiply(c[j * n + k], b[k]));
      for (size_t i = j; i < n; i++)
        c[i * n + j] =
            fg_extended_subtract(c[i * n + j], fg_extended_multiply(c[i * n + k], c[j * n + k]));
    }
    fg_extended root = fg_extended_sqrt(c[j * n + j]);
    for (size_t i = j; i < n; i++)
      c[i * n + j] = fg_extended_divide(c[i * n + j], root);
    b[j] = fg_extended_divide(b[j], root);
    sum = fg_extended_add(sum, fg_extended_square(b[j]));
  }
  return sum;
}

static bool has_part(const fg_model_column *column, const fg_part *part) {
  for (size_t k = 0; k < column->parts; k++)
    if (column->part[k].variable == part->variable && column->part[k].level == part->level &&
        column->part[k].power == part->power)
      return true;
  return false;
}

double fg_model_share_in_mean(const fg_model *model, size_t column, size_t other) {
  const fg_model_column *of = &model->column[column], *from = &model->column[other];
  double share = 1;
  size_t common = 0;
  for (size_t k = 0; k < from->parts; k++) {
    const fg_part *part = &from->part[k];
    if (has_part(of, part))
      common++;
    else if (part->level == FG_PART_NUMBER)
      return 0;
    else
      share /= (double)model->levels[part->variable].count;
  }
  return common == of->parts ? share : 0;
}

/* Adds up the coefficients, and rows of U of their covariance, to the mean over levels. */
static void average_over_levels(const fg_fit *fit, const fg_regression *reg, size_t column,
                                fg_extended *estimate, fg_extended *row) {
  const fg_orthogonal *s = &fit->solution;
  *estimate = (fg_extended){0, 0};
  for (size_t i = 0; i < s->columns; i++)
    row[i] = (fg_extended){0, 0};
  for (size_t k = 0; k < s->rank; k++) {
    size_t other = s->kept[k];
    double share = fg_model_share_in_mean(fit->model, column, other);
    if (share == 0) continue;
    fg_extended weight = fg_extended_of(share);
    *estimate =
        fg_extended_add(*estimate, fg_extended_multiply(weight, reg->estimate_extended[other]));
    for (size_t i = 0; i < s->columns; i++)
      row[i] =
          fg_extended_add(row[i], fg_extended_multiply(weight, s->inverse[other * s->columns + i]));
  }
}

/* Coefficients beside interactions with words are those of the first levels; the term is tested by
 * their means over all levels, as with contrasts that add up to zero. */
static fg_status partial_row(fg_context *ctx, const fg_fit *fit, const fg_regression *reg,
                             size_t term, fg_anova_row *row) {
  fg_status status = FG_OK;
  const fg_orthogonal *s = &fit->solution;
  size_t n = 0, *member = NULL;
  fg_extended *c = NULL, *b = NULL, *u = NULL;
  FG_TRY_EXIT(fg_memory_allocate(ctx, s->rank, sizeof *member, (void **)&member));
  for (size_t k = 0; k < s->rank; k++)
    if (fit->model->column[s->kept[k]].term == term) member[n++] = s->kept[k];
  FG_TRY_EXIT(fg_memory_allocate(ctx, n * n, sizeof *c, (void **)&c));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, sizeof *b, (void **)&b));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n * s->columns, sizeof *u, (void **)&u));
  for (size_t i = 0; i < n; i++)
    average_over_levels(fit, reg, member[i], &b[i], u + i * s->columns);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++)
      c[i * n + j] = fg_extended_dot(u + i * s->columns, u + j * s->columns, s->columns);
  row->dof = n;
  row->sum_of_squares = wald(c, b, n).value;
exit:
  free(member);
  free(c);
  free(b);
  free(u);
  return status;
}

fg_status fg_regression_anova(fg_context *ctx, const fg_fit *fit, fg_regression *reg) {
  size_t terms = fit->model->formula.terms;
  reg->terms = terms;
  FG_TRY(fg_memory_allocate(ctx, terms, sizeof *reg->sequential, (void **)&reg->sequential));
  FG_TRY(fg_memory_allocate(ctx, terms, sizeof *reg->partial, (void **)&reg->partial));
  for (size_t i = 0; i < terms; i++) {
    const char *name = fit->model->term_name[i];
    FG_TRY(fg_text_print(ctx, &reg->sequential[i].name, "%s", name));
    FG_TRY(fg_text_print(ctx, &reg->partial[i].name, "%s", name));
    sequential_row(fit, i, &reg->sequential[i]);
    FG_TRY(partial_row(ctx, fit, reg, i, &reg->partial[i]));
    finish_row(reg, &reg->sequential[i]);
    finish_row(reg, &reg->partial[i]);
  }
  return FG_OK;
}

/* Runs are repeats when their rows of the model matrix are equal. */
static int compare_runs(const void *a, const void *b, void *context) {
  const fg_model *model = context;
  size_t i = *(const size_t *)a, k = *(const size_t *)b;
  for (size_t j = 0; j < model->columns; j++) {
    const fg_extended *x = model->matrix + j * model->rows;
    if (x[i].value != x[k].value) return x[i].value < x[k].value ? -1 : 1;
    if (x[i].tail != x[k].tail) return x[i].tail < x[k].tail ? -1 : 1;
  }
  return 0;
}

/* Sum of squares of the runs about their weighted mean. */
static fg_extended squares_within(const fg_fit *fit, const size_t *runs, size_t count) {
  fg_extended sum = {0, 0}, weight = {0, 0}, squares = {0, 0};
  for (size_t i = 0; i < count; i++) {
    fg_extended w = fg_extended_of(fit->weights ? fit->weights[runs[i]] : 1);
    sum = fg_extended_add(sum, fg_extended_multiply(w, fit->response[runs[i]]));
    weight = fg_extended_add(weight, w);
  }
  fg_extended mean = fg_extended_divide(sum, weight);
  for (size_t i = 0; i < count; i++) {
    fg_extended w = fg_extended_of(fit->weights ? fit->weights[runs[i]] : 1);
    fg_extended deviation = fg_extended_subtract(fit->response[runs[i]], mean);
    squares = fg_extended_add(squares, fg_extended_multiply(w, fg_extended_square(deviation)));
  }
  return squares;
}

static fg_extended pure_error(const fg_fit *fit, const size_t *order, size_t rows, size_t *dof) {
  fg_extended pure = {0, 0};
  void *model = (void *)(size_t)fit->model;
  for (size_t start = 0, end = 0; start < rows; start = end) {
    for (end = start + 1; end < rows; end++)
      if (compare_runs(&order[start], &order[end], model) != 0) break;
    if (end == start + 1) continue;
    pure = fg_extended_add(pure, squares_within(fit, order + start, end - start));
    *dof += end - start - 1;
  }
  return pure;
}

/* Returns true when the subtracted effects differ between repeated runs. */
static bool differs_within(const fg_fit *fit, const size_t *order, size_t rows,
                           const double *taken) {
  void *model = (void *)(size_t)fit->model;
  for (size_t i = 1; taken && i < rows; i++)
    if (taken[order[i]] != taken[order[i - 1]] &&
        compare_runs(&order[i - 1], &order[i], model) == 0)
      return true;
  return false;
}

/* Lowers the dof of pure error or of lack of fit, which sum to the residual dof, for the subtracted
 * effects. */
static void subtract_pure(size_t paid, bool within, fg_regression *reg) {
  if (within) reg->pure_dof = reg->pure_dof > paid ? reg->pure_dof - paid : 0;
  if (reg->pure_dof > reg->residual_dof) reg->pure_dof = reg->residual_dof;
}

fg_status fg_regression_lack_of_fit(fg_context *ctx, const fg_fit *fit,
                                    const fg_regression_options *options, fg_regression *reg) {
  size_t *order = NULL, rows = reg->rows;
  reg->lack_ss = reg->pure_ss = reg->lack_f = reg->lack_p_value = NAN;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *order, (void **)&order));
  for (size_t i = 0; i < rows; i++)
    order[i] = i;
  qsort_r(order, rows, sizeof *order, compare_runs, (void *)(size_t)fit->model);
  fg_extended pure = pure_error(fit, order, rows, &reg->pure_dof);
  subtract_pure(options->dof_subtracted, differs_within(fit, order, rows, options->subtracted),
                reg);
  free(order);
  if (!reg->pure_dof) return FG_OK;
  const fg_extended *e = fit->solution.residual;
  reg->lack_dof = reg->residual_dof - reg->pure_dof;
  reg->pure_ss = pure.value;
  fg_extended lack = fg_extended_subtract(fg_extended_dot(e, e, rows), pure);
  reg->lack_ss = reg->lack_dof ? fmax(0, lack.value) : 0;
  if (!reg->lack_dof) return FG_OK;
  reg->lack_f = reg->lack_ss / (double)reg->lack_dof / (reg->pure_ss / (double)reg->pure_dof);
  reg->lack_p_value =
      fg_distribution_f_upper(reg->lack_f, (double)reg->lack_dof, (double)reg->pure_dof);
  return FG_OK;
}
