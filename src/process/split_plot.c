/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two strata: whole plots, and runs within them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/extended.h"
#include "core/memory.h"
#include "core/text.h"
#include "foilgauge/distribution.h"
#include "foilgauge/doe.h"
#include "stats/mixed_model.h"
#include "stats/regression_parts.h"

/* A term is of the whole plot when all its columns are constant within every plot. */
static bool is_constant_within(const fg_model *model, const fg_levels *plots, size_t term,
                               double *first, bool *seen) {
  for (size_t j = 0; j < model->columns; j++) {
    if (model->column[j].term != term) continue;
    memset(seen, 0, plots->count * sizeof *seen);
    for (size_t i = 0; i < model->rows; i++) {
      size_t plot = plots->index[i];
      double value = model->matrix[j * model->rows + i].value;
      if (seen[plot] && fabs(value - first[plot]) > 1e-9 * fmax(1, fabs(value))) return false;
      seen[plot] = true;
      first[plot] = value;
    }
  }
  return true;
}

/* Order of the columns: whole-plot terms, then one indicator per plot, then the others. So the
 * plots explain the remainder after the whole-plot terms, and the sequential squares are the
 * strata. */
typedef struct strata {
  const fg_model *model;
  const fg_levels *plots;
  bool *whole; /* by term */
  fg_model joint;
  char plots_name[16]; /* of the joint term */
} strata;

enum { TERM_PLOTS = 0 }; /* joint term 0 is the plots; term t of the model is t + 1 */

static void copy_columns(strata *s, bool whole, bool constant) {
  const fg_model *m = s->model;
  for (size_t j = 0; j < m->columns; j++) {
    size_t term = m->column[j].term;
    bool is_constant = term == FG_MODEL_CONSTANT;
    if (is_constant != constant || (!is_constant && s->whole[term] != whole)) continue;
    size_t to = s->joint.columns++;
    s->joint.column[to] = (fg_model_column){.name = m->column[j].name,
                                            .term = is_constant ? FG_MODEL_CONSTANT : term + 1};
    memcpy(s->joint.matrix + to * m->rows, m->matrix + j * m->rows, m->rows * sizeof *m->matrix);
  }
}

static void add_plots(strata *s) {
  for (size_t p = 0; p < s->plots->count; p++) {
    size_t to = s->joint.columns++;
    s->joint.column[to] = (fg_model_column){.name = s->plots->name[p], .term = TERM_PLOTS};
    for (size_t i = 0; i < s->model->rows; i++)
      s->joint.matrix[to * s->model->rows + i] =
          fg_extended_of(s->plots->index[i] == p ? 1.0 : 0.0);
  }
}

/* The joint model borrows names; only its own arrays are freed. */
static fg_status join_terms(fg_context *ctx, strata *s) {
  const fg_model *m = s->model;
  size_t columns = m->columns + s->plots->count, terms = m->formula.terms + 1;
  s->joint = (fg_model){.rows = m->rows};
  s->joint.formula.constant = m->formula.constant;
  s->joint.formula.terms = terms;
  FG_TRY(fg_memory_allocate(ctx, columns, sizeof *s->joint.column, (void **)&s->joint.column));
  FG_TRY(fg_memory_allocate(ctx, terms, sizeof *s->joint.term_name, (void **)&s->joint.term_name));
  FG_TRY(fg_memory_allocate(ctx, columns * m->rows, sizeof *s->joint.matrix,
                            (void **)&s->joint.matrix));
  s->joint.term_name[TERM_PLOTS] = s->plots_name;
  for (size_t t = 1; t < terms; t++)
    s->joint.term_name[t] = m->term_name[t - 1];
  copy_columns(s, true, true);
  copy_columns(s, true, false);
  add_plots(s);
  copy_columns(s, false, false);
  return FG_OK;
}

static fg_status add_term(fg_context *ctx, const fg_anova_row *from, bool whole,
                          fg_split_plot *result) {
  fg_split_plot_term *to = &result->term[result->terms++];
  *to = (fg_split_plot_term){.row = *from, .whole_plot = whole};
  to->row.name = NULL;
  return fg_text_print(ctx, &to->row.name, "%s", from->name);
}

static void judge_terms(fg_split_plot *result) {
  if (result->mixed) return;
  for (size_t t = 0; t < result->terms; t++) {
    fg_split_plot_term *term = &result->term[t];
    double error = term->whole_plot ? result->plot_ms : result->run_ms;
    size_t dof = term->whole_plot ? result->plot_dof : result->run_dof;
    term->row.f = term->row.mean_square / error;
    term->error_dof = (double)dof;
    term->row.p_value = fg_distribution_f_upper(term->row.f, (double)term->row.dof, (double)dof);
  }
}

static void find_variance(size_t rows, fg_split_plot *result) {
  if (result->mixed) return;
  double runs_per_plot = (double)rows / (double)result->plots;
  double excess = result->plot_ms - result->run_ms;
  result->plot_variance = isnan(excess) ? NAN : fmax(0, excess / runs_per_plot);
  result->run_variance = result->run_ms;
  result->at_border = excess <= 0;
}

fg_status fg_split_plot_subtract_dof(fg_context *ctx, const fg_table *table, const char *plot,
                                     size_t dof, const double *subtracted, fg_split_plot *result) {
  fg_levels plots = {0};
  double *first = NULL;
  bool whole = true;
  FG_TRY(fg_table_levels(ctx, table, plot, true, &plots));
  fg_status status = fg_memory_allocate(ctx, plots.count, sizeof *first, (void **)&first);
  for (size_t i = 0; status == FG_OK && i < table->rows; i++)
    first[plots.index[i]] = subtracted[i];
  for (size_t i = 0; status == FG_OK && i < table->rows; i++)
    whole = whole && subtracted[i] == first[plots.index[i]];
  free(first);
  fg_levels_free(&plots);
  FG_TRY(status);
  size_t *left = whole ? &result->plot_dof : &result->run_dof;
  if (*left && *left <= dof)
    return fg_fail(ctx, FG_ERR_DATA,
                   "%zu parameters were taken out before, and the error of the %s has %zu degrees "
                   "of freedom: none is left to judge by; add runs",
                   dof, whole ? "whole plots" : "runs", *left);
  if (*left) *left -= dof;
  *(whole ? &result->subtracted_from_plots : &result->subtracted_from_runs) += dof;
  if (result->plot_dof) result->plot_ms = result->plot_ss / (double)result->plot_dof;
  if (result->run_dof) result->run_ms = result->run_ss / (double)result->run_dof;
  find_variance(table->rows, result);
  judge_terms(result);
  return FG_OK;
}

static fg_status read_strata(fg_context *ctx, const strata *s, const fg_regression *reg,
                             fg_split_plot *result) {
  const fg_anova_row *plots = &reg->sequential[TERM_PLOTS];
  size_t terms = s->model->formula.terms;
  result->plots = s->plots->count;
  result->plot_dof = plots->dof;
  result->plot_ss = plots->sum_of_squares;
  result->plot_ms = plots->dof ? plots->mean_square : NAN;
  result->run_dof = reg->residual_dof;
  result->run_ss = reg->residual_ss;
  result->run_ms = reg->residual_sd * reg->residual_sd;
  find_variance(reg->rows, result);
  FG_TRY(fg_memory_allocate(ctx, terms, sizeof *result->term, (void **)&result->term));
  for (int whole = 1; whole >= 0; whole--)
    for (size_t t = 0; t < terms; t++)
      if (s->whole[t] == whole) FG_TRY(add_term(ctx, &reg->sequential[t + 1], whole, result));
  judge_terms(result);
  return FG_OK;
}

/* Fills `rows` with the means of the term's coefficients over the levels of the words that it
 * interacts with, and returns their number. */
static size_t fill_means(const fg_model *model, const fg_regression *ols, const char *term,
                         double *rows) {
  size_t count = 0, columns = model->columns;
  for (size_t j = 0; j < columns; j++) {
    if (model->column[j].term == FG_MODEL_CONSTANT || ols->coefficient[j].aliased ||
        strcmp(model->term_name[model->column[j].term], term) != 0)
      continue;
    for (size_t k = 0; k < columns; k++)
      rows[count * columns + k] =
          ols->coefficient[k].aliased ? 0 : fg_model_share_in_mean(model, j, k);
    count++;
  }
  return count;
}

/* The term beside all others, as fg_regression's partial row. */
static fg_status test_term(fg_context *ctx, const fg_model *model, const fg_mixed_model *mixed,
                           const fg_regression *ols, double *rows, fg_split_plot_term *term) {
  size_t count = fill_means(model, ols, term->row.name, rows);
  term->row.dof = count;
  term->row.sum_of_squares = term->row.mean_square = NAN;
  FG_TRY(fg_mixed_test(ctx, mixed, rows, count, &term->row.f, &term->error_dof));
  term->row.p_value = fg_distribution_f_upper(term->row.f, (double)count, term->error_dof);
  return FG_OK;
}

static fg_status test_terms(fg_context *ctx, const fg_model *model, const fg_regression *ols,
                            fg_split_plot *result) {
  double *rows = NULL;
  FG_TRY(fg_memory_allocate(ctx, model->columns * model->columns, sizeof *rows, (void **)&rows));
  fg_status status = FG_OK;
  for (size_t t = 0; t < result->terms && status == FG_OK; t++) {
    fg_split_plot_term *term = &result->term[t];
    if (term->whole_plot && result->mixed->fixed_groups)
      term->row.f = term->row.p_value = term->row.sum_of_squares = term->row.mean_square =
          term->error_dof = NAN;
    else
      status = test_term(ctx, model, result->mixed, ols, rows, term);
  }
  free(rows);
  return status;
}

/* Fits by restricted likelihood where the strata are not orthogonal, if the scatter has enough dof.
 */
static fg_status fit_mixed(fg_context *ctx, const strata *s, const fg_extended *y,
                           fg_split_plot *result) {
  fg_regression ols = {0};
  fg_context unused = {0};
  bool orthogonal = true;
  fg_status status = FG_OK;
  if (!result->run_dof) return FG_OK;
  FG_TRY_EXIT(fg_regression_fit(ctx, s->model, y, NULL, &ols));
  FG_TRY_EXIT(fg_memory_allocate(ctx, s->model->columns * s->model->columns,
                                 sizeof *result->of_plots, (void **)&result->of_plots));
  FG_TRY_EXIT(fg_mixed_is_orthogonal(ctx, s->model, s->plots, &ols, &orthogonal, result->of_plots));
  if (orthogonal) goto exit;
  free(result->of_plots);
  result->of_plots = NULL;
  FG_TRY_EXIT(fg_memory_allocate(ctx, 1, sizeof *result->mixed, (void **)&result->mixed));
  status = fg_mixed_fit(&unused, s->model, s->plots, &ols, !result->plot_dof, result->mixed);
  if (status == FG_ERR_MEMORY) FG_TRY_EXIT(fg_fail(ctx, status, "out of memory"));
  if (status != FG_OK) { /* a fit without scatter */
    free(result->mixed);
    result->mixed = NULL;
    status = FG_OK;
    goto exit;
  }
  result->plot_variance = fmax(0, result->mixed->variance[FG_MIXED_GROUPS]);
  if (result->mixed->fixed_groups) result->plot_variance = NAN;
  result->run_variance = result->mixed->variance[FG_MIXED_RUNS];
  result->at_border = result->mixed->at_border;
  FG_TRY_EXIT(test_terms(ctx, s->model, &ols, result));
exit:
  fg_regression_free(&ols);
  return status;
}

static size_t plots_are_equal(const fg_levels *plots, double *count) {
  memset(count, 0, plots->count * sizeof *count);
  for (size_t i = 0; i < plots->rows; i++)
    count[plots->index[i]]++;
  for (size_t p = 1; p < plots->count; p++)
    if (count[p] != count[0]) return 0;
  return 1;
}

static fg_status mark_whole_terms(fg_context *ctx, strata *s, fg_split_plot *result) {
  double *first = NULL;
  bool *seen = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, s->plots->count, sizeof *first, (void **)&first));
  FG_TRY_EXIT(fg_memory_allocate(ctx, s->plots->count, sizeof *seen, (void **)&seen));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, s->model->formula.terms, sizeof *s->whole, (void **)&s->whole));
  for (size_t t = 0; t < s->model->formula.terms; t++)
    s->whole[t] = is_constant_within(s->model, s->plots, t, first, seen);
  result->balanced = plots_are_equal(s->plots, first);
exit:
  free(first);
  free(seen);
  return status;
}

fg_status fg_split_plot_analyse(fg_context *ctx, const fg_table *table, const fg_formula *formula,
                                const char *response, const char *plot, fg_split_plot *result) {
  fg_status status = FG_OK;
  fg_model model = {0};
  fg_levels plots = {0};
  fg_regression reg = {0};
  const fg_extended *y = NULL;
  strata s = {.model = &model, .plots = &plots, .plots_name = "(whole plots)"};
  *result = (fg_split_plot){0};
  FG_TRY_EXIT(fg_table_numbers(ctx, table, response, &y));
  FG_TRY_EXIT(fg_table_levels(ctx, table, plot, true, &plots));
  if (plots.count < 2 || plots.count == table->rows)
    FG_TRY_EXIT(fg_fail(ctx, FG_ERR_DATA,
                        "column '%s' names %zu whole plots for %zu runs: there must be at least "
                        "two, and one with more than one run",
                        plot, plots.count, table->rows));
  FG_TRY_EXIT(fg_model_build(ctx, table, formula, &model));
  FG_TRY_EXIT(fg_model_check_size(ctx, table->source, table->rows, model.columns + plots.count,
                                  plot, plots.count));
  FG_TRY_EXIT(mark_whole_terms(ctx, &s, result));
  FG_TRY_EXIT(join_terms(ctx, &s));
  FG_TRY_EXIT(fg_regression_fit(ctx, &s.joint, y, NULL, &reg));
  FG_TRY_EXIT(read_strata(ctx, &s, &reg, result));
  FG_TRY_EXIT(fit_mixed(ctx, &s, y, result));
exit:
  fg_regression_free(&reg);
  free(s.joint.column);
  free(s.joint.term_name);
  free(s.joint.matrix);
  free(s.whole);
  fg_model_free(&model);
  fg_levels_free(&plots);
  if (status != FG_OK) fg_split_plot_free(result);
  return status;
}

void fg_split_plot_free(fg_split_plot *result) {
  if (!result) return;
  for (size_t t = 0; t < result->terms; t++)
    free(result->term[t].row.name);
  free(result->term);
  free(result->of_plots);
  if (result->mixed) fg_mixed_free(result->mixed);
  free(result->mixed);
  *result = (fg_split_plot){0};
}
