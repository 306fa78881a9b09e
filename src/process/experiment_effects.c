/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every coefficient judged by its own error, and the tests that belong to designs. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/extended.h"
#include "core/memory.h"
#include "foilgauge/distribution.h"
#include "process/experiment_parts.h"
#include "stats/mixed_model.h"

/* Maximum number of runs for Box-Cox, which computes the residuals some 300 times. */
enum { BOX_COX_RUNS = 100000 };

/* Element (i, j) of (X'X)^-1, which needs no residual dof. */
static double inverse_at(const fg_regression *reg, size_t i, size_t j) {
  double sum = 0;
  for (size_t k = 0; k < reg->columns; k++)
    sum += reg->inverse_root[i * reg->columns + k].value *
           reg->inverse_root[j * reg->columns + k].value;
  return sum;
}

static bool is_whole_plot(const fg_experiment *e, size_t term) {
  if (!e->has_split_plot) return false;
  if (term == FG_MODEL_CONSTANT) return true;
  for (size_t t = 0; t < e->split_plot.terms; t++)
    if (!strcmp(e->split_plot.term[t].row.name, e->model.term_name[term]))
      return e->split_plot.term[t].whole_plot;
  return false;
}

/* Returns the standard deviation for testing a column, and its dof. */
static double error_of(const fg_experiment *e, bool whole_plot, double *dof) {
  const fg_split_plot *s = &e->split_plot;
  *dof = (double)e->regression.residual_dof;
  if (!e->has_split_plot) return e->regression.residual_dof ? e->regression.residual_sd : NAN;
  *dof = (double)(whole_plot ? s->plot_dof : s->run_dof);
  if (!(*dof > 0)) return NAN;
  return sqrt(whole_plot ? s->plot_ms : s->run_ms);
}

/* True for an analysis of variance by strata that tells the scatter. */
static bool has_strata(const fg_experiment *e) {
  return e->has_split_plot && e->split_plot.of_plots && !e->measurement.weight;
}

static bool is_block_term(const fg_experiment *e, size_t term) {
  return term != FG_MODEL_CONSTANT && e->block_variable < FG_FORMULA_VARIABLES &&
         e->model.formula.term[term].power[e->block_variable] > 0;
}

/* Returns variance and dof by restricted likelihood. Effects subtracted from the response before
 * lower the dof. */
static double mixed_variance(const fg_experiment *e, const double *row, bool run,
                             size_t dof_subtracted, double *dof) {
  double variance = fg_mixed_variance(e->split_plot.mixed, row, run, dof);
  double left = *dof - (double)dof_subtracted;
  if (!dof_subtracted) return variance;
  variance *= left > 0 ? *dof / left : NAN;
  *dof = left;
  return variance;
}

/* `row` is 0 and stays so. */
static void judge_mixed(const fg_experiment *e, size_t j, double *row,
                        fg_experiment_effect *effect) {
  const fg_split_plot *s = &e->split_plot;
  row[j] = 1;
  effect->standard_error = sqrt(mixed_variance(
      e, row, false, effect->whole_plot ? s->subtracted_from_plots : s->subtracted_from_runs,
      &effect->dof));
  row[j] = 0;
  if (s->mixed->fixed_groups && effect->whole_plot) effect->standard_error = effect->dof = NAN;
}

/* The fit of the experiment becomes that of the restricted likelihood. */
static void take_mixed_estimates(fg_experiment *e) {
  fg_regression *reg = &e->regression;
  for (size_t j = 0; j < reg->columns; j++) {
    if (reg->coefficient[j].aliased) continue;
    reg->coefficient[j].estimate = e->split_plot.mixed->estimate[j];
    reg->estimate_extended[j] = fg_extended_of(reg->coefficient[j].estimate);
  }
  for (size_t i = 0; i < reg->rows; i++) {
    double response = reg->fitted[i] + reg->residual[i];
    reg->fitted[i] = 0;
    for (size_t j = 0; j < reg->columns; j++)
      reg->fitted[i] += e->split_plot.mixed->estimate[j] * e->model.matrix[j * reg->rows + i].value;
    reg->residual[i] = response - reg->fitted[i];
  }
}

/* `row` is 0 and stays so. */
static void judge_by_strata(const fg_experiment *e, size_t j, double *row,
                            fg_experiment_effect *effect) {
  double direction[FG_MODEL_COLUMNS_MAX], variance = 0;
  row[j] = 1;
  effect->dof = fg_experiment_direction(e, row, direction);
  row[j] = 0;
  for (size_t k = 0; k < e->regression.columns; k++)
    variance += direction[k] * direction[k];
  effect->standard_error = sqrt(variance);
}

static void fill_effect(const fg_experiment *e, size_t j, double *row,
                        fg_experiment_effect *effect) {
  const fg_regression *reg = &e->regression;
  const fg_coefficient *c = &reg->coefficient[j];
  *effect = (fg_experiment_effect){.block = is_block_term(e, c->term),
                                   .whole_plot = is_whole_plot(e, c->term),
                                   .u_measurement = NAN,
                                   .contrast = NAN,
                                   .lenth_p_value = NAN,
                                   .standard_error = c->standard_error,
                                   .t = c->t,
                                   .p_value = c->p_value,
                                   .low = c->low,
                                   .high = c->high};
  double variance = inverse_at(reg, j, j);
  double sd = error_of(e, effect->whole_plot, &effect->dof);
  effect->relative_pct = c->term == FG_MODEL_CONSTANT ? NAN : fg_doe_relative_effect_pct(reg, j);
  if (c->aliased) return;
  effect->contrast = c->estimate / sqrt(variance * (double)reg->rows);
  if (!e->has_split_plot && !e->measurement.weight) return;
  effect->standard_error = sd * sqrt(variance);
  if (has_strata(e)) judge_by_strata(e, j, row, effect);
  if (e->measurement.weight) {
    row[j] = 1;
    effect->dof = fg_experiment_weighted_dof(e, row);
    row[j] = 0;
  }
  if (e->split_plot.mixed) judge_mixed(e, j, row, effect);
  effect->t = c->estimate / effect->standard_error;
  effect->p_value = fg_distribution_t_two_sided(effect->t, effect->dof);
  double half =
      effect->standard_error * fg_distribution_t_quantile((1 + e->confidence) / 2, effect->dof);
  effect->low = c->estimate - half;
  effect->high = c->estimate + half;
}

/* b = G y with G = (X'WX)^-1 X'W, so u²(b_j) = sum_i G_ji² u_i². `row` holds row j of (X'X)^-1. */
static void propagate(const fg_experiment *e, size_t j, double *row, fg_experiment_effect *effect) {
  const fg_regression *reg = &e->regression;
  double sum = 0;
  for (size_t k = 0; k < reg->columns; k++)
    row[k] = inverse_at(reg, j, k);
  for (size_t i = 0; i < reg->rows; i++) {
    double gain = 0;
    for (size_t k = 0; k < reg->columns; k++)
      gain += row[k] * e->model.matrix[k * reg->rows + i].value;
    if (e->measurement.weight) gain *= e->measurement.weight[i];
    sum += gain * gain * e->measurement.u[i] * e->measurement.u[i];
  }
  effect->u_measurement = sqrt(sum);
}

static fg_status fill_effects(fg_context *ctx, fg_experiment *e) {
  size_t columns = e->regression.columns;
  double *row = NULL;
  FG_TRY(fg_memory_allocate(ctx, columns, sizeof *e->effect, (void **)&e->effect));
  FG_TRY(fg_memory_allocate(ctx, columns, sizeof *row, (void **)&row));
  for (size_t j = 0; j < columns; j++) {
    memset(row, 0, columns * sizeof *row);
    fill_effect(e, j, row, &e->effect[j]);
    if (e->measurement.u && !e->regression.coefficient[j].aliased)
      propagate(e, j, row, &e->effect[j]);
  }
  free(row);
  return FG_OK;
}

static fg_status note_measurement(fg_context *ctx, fg_experiment *e) {
  const fg_regression *reg = &e->regression;
  if (!e->measurement.u) return FG_OK;
  if (!reg->residual_dof)
    return fg_experiment_note(ctx, e,
                              "u_measurement is the part of a coefficient's standard error that "
                              "the measurement makes: the whole error is larger, by how much only "
                              "repeated runs can tell");
  if (!e->measurement.weight && e->measurement.u_rms > reg->residual_sd)
    return fg_experiment_note(ctx, e,
                              "the runs scatter less (%.3g) than the measurement's uncertainty "
                              "says (%.3g): by luck, or because the scans share an error; then the "
                              "constant is less certain than its interval says",
                              reg->residual_sd, e->measurement.u_rms);
  return FG_OK;
}

static fg_status note_mixed(fg_context *ctx, fg_experiment *e) {
  const fg_split_plot *s = &e->split_plot;
  if (s->mixed)
    FG_TRY(fg_experiment_note(
        ctx, e,
        "%s: analysed by restricted likelihood, with Kenward and Roger's degrees of freedom",
        s->balanced ? "the settings differ from whole plot to whole plot"
                    : "the whole plots hold different numbers of runs"));
  if (s->mixed && s->at_border)
    FG_TRY(fg_experiment_note(ctx, e,
                              "the whole plots scatter no more than the runs within them explain: "
                              "their own variance is estimated as 0, the least there is, and may "
                              "be larger; more whole plots would tell"));
  if (!s->mixed && !s->balanced)
    FG_TRY(
        fg_experiment_note(ctx, e,
                           "the whole plots hold different numbers of runs, and nothing is left "
                           "to tell the scatter by: what is said of the effects is approximate"));
  return FG_OK;
}

static fg_status make_split_plot(fg_context *ctx, fg_experiment *e) {
  fg_formula formula = {0};
  if (!e->whole_plot) return FG_OK;
  FG_TRY(fg_formula_parse(ctx, e->formula, &formula));
  fg_status status =
      fg_split_plot_analyse(ctx, &e->table, &formula, e->response, e->whole_plot, &e->split_plot);
  fg_formula_free(&formula);
  FG_TRY(status);
  e->has_split_plot = true;
  if (e->subtracted.dof)
    FG_TRY(fg_split_plot_subtract_dof(ctx, &e->table, e->whole_plot, e->subtracted.dof,
                                      e->subtracted.sum, &e->split_plot));
  if (!e->split_plot.plot_dof)
    FG_TRY(fg_experiment_note(ctx, e,
                              "%zu whole plots leave no freedom for their error: what is constant "
                              "within them has no standard error; repeat whole plots",
                              e->split_plot.plots));
  if (!e->split_plot.run_dof)
    FG_TRY(fg_experiment_note(ctx, e, "no freedom is left for the error within whole plots"));
  return note_mixed(ctx, e);
}

static bool is_of_interest(const fg_experiment *e, size_t j) {
  const fg_coefficient *c = &e->regression.coefficient[j];
  return c->term != FG_MODEL_CONSTANT && !c->aliased && !e->effect[j].block;
}

static fg_status make_lenth(fg_context *ctx, fg_experiment *e) {
  double *contrast = NULL;
  size_t count = 0;
  FG_TRY(fg_memory_allocate(ctx, e->regression.columns, sizeof *contrast, (void **)&contrast));
  for (size_t j = 0; j < e->regression.columns; j++)
    if (is_of_interest(e, j)) contrast[count++] = e->effect[j].contrast;
  e->has_lenth = count >= 3;
  if (e->has_lenth) {
    fg_status status = fg_lenth_compute(ctx, contrast, count, e->confidence, &e->lenth);
    free(contrast);
    FG_TRY(status);
    e->has_lenth = e->lenth.pseudo_standard_error > 0;
  } else {
    free(contrast);
  }
  for (size_t j = 0; e->has_lenth && j < e->regression.columns; j++)
    if (is_of_interest(e, j))
      e->effect[j].lenth_p_value = fg_lenth_p_value(&e->lenth, e->effect[j].contrast);
  if (e->regression.residual_dof || count >= 3) return FG_OK;
  return fg_experiment_note(ctx, e,
                            "fewer than three effects are too few for Lenth's method: leave terms "
                            "out, or repeat runs");
}

static fg_status make_box_cox(fg_context *ctx, fg_experiment *e) {
  const fg_extended *y = NULL;
  fg_context quiet = {0};
  FG_TRY(fg_table_numbers(ctx, &e->table, e->response, &y));
  if (!e->regression.residual_dof || e->table.rows > BOX_COX_RUNS || e->measurement.weight)
    return FG_OK;
  if (!(e->regression.residual_ss > 1e-24 * e->regression.total_ss)) return FG_OK;
  for (size_t i = 0; i < e->table.rows; i++)
    if (!(y[i].value > 0)) return FG_OK;
  e->has_box_cox = fg_box_cox_compute(&quiet, &e->model, y, &e->box_cox) == FG_OK;
  return FG_OK;
}

static bool has_words(const fg_experiment *e) {
  for (size_t v = 0; v < e->model.formula.variables; v++)
    if (e->model.levels[v].count) return true;
  return false;
}

/* The comparison of centre runs with corners knows the numbers alone: differences between blocks or
 * other words would be taken for curvature, or for its error. */
static fg_status make_curvature(fg_context *ctx, fg_experiment *e) {
  const char *names[FG_FORMULA_VARIABLES];
  fg_context quiet = {0};
  size_t count = 0;
  for (size_t k = 0; k < e->factors; k++)
    if (e->factor[k].coded) names[count++] = e->factor[k].name;
  if (!count || count < e->factors || e->measurement.weight || e->has_split_plot) return FG_OK;
  fg_status status =
      fg_curvature_compute(&quiet, &e->table, names, count, e->response, &e->curvature);
  if (status == FG_ERR_MEMORY) return fg_fail(ctx, status, "%s", quiet.message);
  e->has_curvature = status == FG_OK && !has_words(e);
  if (status != FG_OK || e->has_curvature) return FG_OK;
  return fg_experiment_note(ctx, e,
                            "the centre runs are not compared with the corners, as the blocks or "
                            "other words of the model may make the difference: the lack of fit, "
                            "which has them, tells of curvature where settings repeat");
}

fg_status fg_experiment_effects(fg_context *ctx, fg_experiment *e) {
  FG_TRY(make_split_plot(ctx, e));
  if (e->has_split_plot && e->split_plot.mixed) take_mixed_estimates(e);
  FG_TRY(fill_effects(ctx, e));
  FG_TRY(make_lenth(ctx, e));
  FG_TRY(make_box_cox(ctx, e));
  FG_TRY(make_curvature(ctx, e));
  return note_measurement(ctx, e);
}

/* The model row, averaged over the blocks. */
static fg_status average_row(fg_context *ctx, const fg_experiment *e, const double *setting,
                             double *row, double *one) {
  double full[FG_FORMULA_VARIABLES];
  size_t blocks = 1, columns = e->model.columns;
  memcpy(full, setting, e->model.formula.variables * sizeof *full);
  if (e->block_variable < FG_FORMULA_VARIABLES) blocks = e->model.levels[e->block_variable].count;
  memset(row, 0, columns * sizeof *row);
  for (size_t b = 0; b < blocks; b++) {
    if (e->block_variable < FG_FORMULA_VARIABLES) full[e->block_variable] = (double)b;
    FG_TRY(fg_model_row(ctx, &e->model, full, one));
    for (size_t j = 0; j < columns; j++)
      row[j] += one[j] / (double)blocks;
  }
  return FG_OK;
}

static void fill_intervals(const fg_experiment *e, double dof, double run_dof, fg_prediction *p) {
  double q = fg_distribution_t_quantile((1 + e->confidence) / 2, dof),
         run = fg_distribution_t_quantile((1 + e->confidence) / 2, run_dof);
  p->coverage_factor = q;
  p->dof = dof;
  p->run_dof = run_dof;
  p->low = p->mean - q * p->standard_error;
  p->high = p->mean + q * p->standard_error;
  p->run_low = p->mean - run * p->run_standard_error;
  p->run_high = p->mean + run * p->run_standard_error;
}

static void predict_mixed(const fg_experiment *e, const double *row, fg_prediction *p) {
  double dof, run_dof;
  *p = (fg_prediction){0};
  for (size_t j = 0; j < e->regression.columns; j++)
    p->mean += row[j] * e->split_plot.mixed->estimate[j];
  p->standard_error = sqrt(mixed_variance(e, row, false, e->subtracted.dof, &dof));
  p->run_standard_error = sqrt(mixed_variance(e, row, true, e->subtracted.dof, &run_dof));
  if (e->split_plot.mixed->fixed_groups) p->standard_error = p->run_standard_error = NAN;
  fill_intervals(e, dof, run_dof, p);
}

/* Parts of a variance by the strata, and its dof (Satterthwaite). */
typedef struct strata_variance {
  double plots, runs;
} strata_variance;

static double strata_dof(const fg_split_plot *s, strata_variance v) {
  double sum = 0;
  if (v.plots > 0) sum += v.plots * v.plots / (double)s->plot_dof;
  if (v.runs > 0) sum += v.runs * v.runs / (double)s->run_dof;
  return (v.plots + v.runs) * (v.plots + v.runs) / sum;
}

/* From U' row: the part that the whole plots make has their sd, the other one that of the runs. */
static strata_variance scale_by_strata(const fg_experiment *e, double *direction) {
  const fg_split_plot *s = &e->split_plot;
  size_t columns = e->regression.columns;
  double plots = 0, whole = 0, work[FG_MODEL_COLUMNS_MAX] = {0};
  for (size_t k = 0; k < columns; k++) {
    for (size_t l = 0; l < columns; l++)
      work[k] += s->of_plots[k * columns + l] * direction[l];
    plots += work[k] * work[k];
    whole += direction[k] * direction[k];
  }
  bool none = plots <= 1e-18 * whole, all = whole - plots <= 1e-9 * whole;
  double plot_sd = none ? 0 : sqrt(s->plot_ms), run_sd = all ? 0 : sqrt(s->run_ms);
  for (size_t k = 0; k < columns; k++)
    direction[k] = run_sd * (direction[k] - work[k]) + plot_sd * work[k];
  return (strata_variance){plot_sd * plot_sd * plots, run_sd * run_sd * (whole - plots)};
}

/* U' (row × sd of each column's error). */
static double scale_by_columns(const fg_experiment *e, const double *row, double *direction) {
  const fg_regression *reg = &e->regression;
  double min_dof = INFINITY;
  for (size_t j = 0; j < reg->columns; j++) {
    double dof;
    if (reg->coefficient[j].aliased || row[j] == 0) continue;
    double sd = error_of(e, e->effect[j].whole_plot, &dof);
    min_dof = fmin(min_dof, dof);
    for (size_t k = 0; k < reg->columns; k++)
      direction[k] += reg->inverse_root[j * reg->columns + k].value * row[j] * sd;
  }
  return min_dof;
}

static strata_variance direction_by_strata(const fg_experiment *e, const double *row,
                                           double *direction) {
  const fg_regression *reg = &e->regression;
  memset(direction, 0, reg->columns * sizeof *direction);
  for (size_t j = 0; j < reg->columns; j++)
    for (size_t k = 0; k < reg->columns && row[j] != 0 && !reg->coefficient[j].aliased; k++)
      direction[k] += reg->inverse_root[j * reg->columns + k].value * row[j];
  return scale_by_strata(e, direction);
}

double fg_experiment_direction(const fg_experiment *e, const double *row, double *direction) {
  if (has_strata(e)) return strata_dof(&e->split_plot, direction_by_strata(e, row, direction));
  memset(direction, 0, e->regression.columns * sizeof *direction);
  return scale_by_columns(e, row, direction);
}

/* A new run of a new whole plot has the variance of the runs and that of the plots. */
static double run_dof_by_strata(const fg_experiment *e, const double *row, double *direction) {
  const fg_split_plot *s = &e->split_plot;
  strata_variance v = direction_by_strata(e, row, direction);
  double share = s->plot_variance > 0 ? (double)s->plots / (double)e->regression.rows : 0;
  v.plots += share > 0 ? share * s->plot_ms : 0;
  v.runs += (1 - share) * s->run_ms;
  return strata_dof(s, v);
}

static void predict_row(const fg_experiment *e, const double *row, double *direction,
                        fg_prediction *p) {
  const fg_regression *reg = &e->regression;
  double variance = 0, min_dof = fg_experiment_direction(e, row, direction);
  *p = (fg_prediction){0};
  for (size_t k = 0; k < reg->columns; k++) {
    variance += direction[k] * direction[k];
    if (!reg->coefficient[k].aliased) p->mean += row[k] * reg->coefficient[k].estimate;
  }
  double run_dof = min_dof;
  if (e->measurement.weight) run_dof = min_dof = fg_experiment_weighted_dof(e, row);
  if (has_strata(e)) run_dof = run_dof_by_strata(e, row, direction);
  double run_variance = reg->residual_sd * reg->residual_sd;
  if (e->has_split_plot) run_variance = e->split_plot.run_ms + e->split_plot.plot_variance;
  p->standard_error = sqrt(variance);
  p->run_standard_error = sqrt(variance + run_variance);
  fill_intervals(e, min_dof, run_dof, p);
}

fg_status fg_experiment_row(fg_context *ctx, const fg_experiment *e, const double *setting,
                            double *row) {
  double *one = NULL;
  FG_TRY(fg_memory_allocate(ctx, e->model.columns, sizeof *one, (void **)&one));
  fg_status status = average_row(ctx, e, setting, row, one);
  free(one);
  return status;
}

fg_status fg_experiment_predict(fg_context *ctx, const fg_experiment *e, const double *setting,
                                fg_prediction *prediction) {
  double *row = NULL;
  FG_TRY(fg_memory_allocate(ctx, 2 * e->model.columns, sizeof *row, (void **)&row));
  double *work = row + e->model.columns;
  fg_status status = average_row(ctx, e, setting, row, work);
  if (status == FG_OK && e->has_split_plot && e->split_plot.mixed)
    predict_mixed(e, row, prediction);
  else if (status == FG_OK)
    predict_row(e, row, work, prediction);
  free(row);
  return status;
}
