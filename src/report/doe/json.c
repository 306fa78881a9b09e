/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An experiment as JSON (reports/schema/doe.schema.json). */
#include <math.h>

#include "core/file.h"
#include "foilgauge/words.h"
#include "report/design/calibration_json.h"
#include "report/doe/json_parts.h"
#include "report/doe/words.h"
#include "report/measure/json.h"

static void put_interval(fg_json *json, const char *name, double low, double high) {
  const double pair[2] = {low, high};
  fg_json_numbers(json, name, pair, 2);
}

static void put_inputs(fg_json *json, const fg_experiment_report *report) {
  fg_json_array(json, "inputs");
  fg_json_object(json, NULL);
  fg_json_string(json, "path", report->path);
  fg_json_string(json, "sha256", report->sha256);
  fg_json_object_end(json);
  if (report->model_path) {
    fg_json_object(json, NULL);
    fg_json_string(json, "path", report->model_path);
    fg_json_string(json, "sha256", report->model_sha256);
    fg_json_object_end(json);
  }
  for (size_t i = 0; i < report->scans; i++) {
    const fg_experiment_scan *scan = &report->scan[i];
    fg_json_object(json, NULL);
    fg_json_string(json, "path", scan->path);
    fg_json_string(json, "sha256", scan->sha256[0] ? scan->sha256 : NULL);
    fg_json_integer(json, "row", (int64_t)scan->run);
    fg_json_number(json, "value", scan->value);
    fg_json_number(json, "u", scan->u);
    fg_json_string(json, "error", scan->error);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

static void put_factors(fg_json *json, const fg_experiment *e) {
  fg_json_array(json, "factors");
  for (size_t k = 0; k < e->factors; k++) {
    const fg_factor *f = &e->factor[k];
    fg_json_object(json, NULL);
    fg_json_string(json, "name", f->name);
    fg_json_bool(json, "coded", f->coded);
    fg_json_number(json, "low", f->coded ? fg_factor_real(f, -1) : NAN);
    fg_json_number(json, "high", f->coded ? fg_factor_real(f, 1) : NAN);
    put_interval(json, "range", fg_factor_real(f, f->lowest), fg_factor_real(f, f->highest));
    put_interval(json, "range_coded", f->lowest, f->highest);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

static void put_coefficients(fg_json *json, const fg_experiment *e) {
  fg_json_array(json, "coefficients");
  for (size_t j = 0; j < e->regression.columns; j++) {
    const fg_coefficient *c = &e->regression.coefficient[j];
    const fg_experiment_effect *effect = &e->effect[j];
    fg_json_object(json, NULL);
    fg_json_string(json, "name", c->name);
    fg_json_bool(json, "aliased", c->aliased);
    fg_json_number(json, "estimate", c->estimate);
    fg_json_number(json, "relative_effect_pct", effect->relative_pct);
    fg_json_number(json, "standard_error", effect->standard_error);
    fg_json_number(json, "t", effect->t);
    fg_json_number(json, "freedom", effect->dof);
    fg_json_number(json, "p_value", effect->p_value);
    put_interval(json, "interval", effect->low, effect->high);
    fg_json_number(json, "vif", c->vif);
    fg_json_number(json, "u_measurement", effect->u_measurement);
    fg_json_number(json, "contrast", effect->contrast);
    fg_json_number(json, "lenth_p_value", effect->lenth_p_value);
    fg_json_string(json, "stratum",
                   e->has_split_plot ? effect->whole_plot ? "whole plots" : "runs" : NULL);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

static void put_anova_row(fg_json *json, const fg_anova_row *row) {
  fg_json_string(json, "term", row->name);
  fg_json_integer(json, "freedom", (int64_t)row->dof);
  fg_json_number(json, "sum_of_squares", row->sum_of_squares);
  fg_json_number(json, "mean_square", row->mean_square);
  fg_json_number(json, "f", row->f);
  fg_json_number(json, "p_value", row->p_value);
}

static void put_anova_rows(fg_json *json, const char *name, const fg_anova_row *rows,
                           size_t count) {
  fg_json_array(json, name);
  for (size_t i = 0; i < count; i++) {
    fg_json_object(json, NULL);
    put_anova_row(json, &rows[i]);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

static double mean_square(double sum, size_t dof) {
  return dof ? sum / (double)dof : NAN;
}

static void put_anova(fg_json *json, const fg_regression *r) {
  const double model_dof = (double)(r->rank - r->constant);
  const fg_anova_row rows[] = {
      {(char[]){"residual"}, r->residual_dof, r->residual_ss,
       mean_square(r->residual_ss, r->residual_dof), NAN, NAN},
      {(char[]){"lack of fit"}, r->lack_dof, r->lack_ss, mean_square(r->lack_ss, r->lack_dof),
       r->lack_f, r->lack_p_value},
      {(char[]){"pure error"}, r->pure_dof, r->pure_ss, mean_square(r->pure_ss, r->pure_dof), NAN,
       NAN},
      {(char[]){"total"}, r->residual_dof + (size_t)model_dof, r->total_ss, NAN, NAN, NAN},
  };
  const fg_anova_row model = {(char[]){"model"},
                              (size_t)model_dof,
                              r->model_ss,
                              mean_square(r->model_ss, (size_t)model_dof),
                              r->model_ss / model_dof / (r->residual_sd * r->residual_sd),
                              r->model_p_value};
  fg_json_object(json, "anova");
  put_anova_rows(json, "sequential", r->sequential, r->terms);
  put_anova_rows(json, "partial", r->partial, r->terms);
  put_anova_rows(json, "model", &model, 1);
  put_anova_rows(json, "error", rows, sizeof rows / sizeof *rows);
  fg_json_object_end(json);
}

static void put_fit(fg_json *json, const fg_regression *r) {
  fg_json_object(json, "fit");
  fg_json_integer(json, "runs", (int64_t)r->rows);
  fg_json_integer(json, "rank", (int64_t)r->rank);
  fg_json_integer(json, "residual_freedom", (int64_t)r->residual_dof);
  fg_json_number(json, "residual_sd", r->residual_sd);
  fg_json_number(json, "r2", r->r2);
  fg_json_number(json, "adjusted_r2", r->adjusted_r2);
  fg_json_number(json, "predicted_r2", r->predicted_r2);
  fg_json_number(json, "press", r->press);
  fg_json_number(json, "adequate_precision", r->adequate_precision);
  fg_json_number(json, "condition_number", r->condition_number);
  fg_json_object_end(json);
}

static void put_aliases(fg_json *json, const fg_regression *r) {
  fg_json_array(json, "aliases");
  for (size_t i = 0; i < r->aliases; i++) {
    fg_json_object(json, NULL);
    fg_json_string(json, "name", r->coefficient[r->alias[i].column].name);
    fg_json_array(json, "is");
    for (size_t k = 0; k < r->alias[i].count; k++) {
      fg_json_object(json, NULL);
      fg_json_line(json);
      fg_json_string(json, "name", r->coefficient[r->alias[i].with[k]].name);
      fg_json_number(json, "times", r->alias[i].factor[k]);
      fg_json_object_end(json);
      fg_json_line_end(json);
    }
    fg_json_array_end(json);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

/* Writes null where the part could not be made. */
bool fg_doe_json_begin_part(fg_json *json, const char *name, bool has) {
  if (has)
    fg_json_object(json, name);
  else
    fg_json_string(json, name, NULL);
  return has;
}

static void put_tests(fg_json *json, const fg_experiment *e) {
  if (fg_doe_json_begin_part(json, "lenth", e->has_lenth)) {
    fg_json_number(json, "pseudo_standard_error", e->lenth.pseudo_standard_error);
    fg_json_number(json, "margin", e->lenth.margin);
    fg_json_number(json, "simultaneous_margin", e->lenth.simultaneous_margin);
    fg_json_number(json, "freedom", e->lenth.dof);
    fg_json_object_end(json);
  }
  if (fg_doe_json_begin_part(json, "box_cox", e->has_box_cox)) {
    fg_json_number(json, "lambda", e->box_cox.lambda);
    put_interval(json, "interval", e->box_cox.low, e->box_cox.high);
    fg_json_object_end(json);
  }
  if (fg_doe_json_begin_part(json, "curvature", e->has_curvature)) {
    fg_json_integer(json, "corners", (int64_t)e->curvature.corners);
    fg_json_integer(json, "centres", (int64_t)e->curvature.centres);
    fg_json_number(json, "corner_mean", e->curvature.corner_mean);
    fg_json_number(json, "centre_mean", e->curvature.centre_mean);
    fg_json_number(json, "sum_of_squares", e->curvature.sum_of_squares);
    fg_json_integer(json, "error_freedom", (int64_t)e->curvature.error_dof);
    fg_json_number(json, "f", e->curvature.f);
    fg_json_number(json, "p_value", e->curvature.p_value);
    fg_json_object_end(json);
  }
}

static void put_split_plot(fg_json *json, const fg_experiment *e) {
  const fg_split_plot *s = &e->split_plot;
  if (!fg_doe_json_begin_part(json, "split_plot", e->has_split_plot)) return;
  fg_json_string(json, "column", e->whole_plot);
  fg_json_integer(json, "whole_plots", (int64_t)s->plots);
  fg_json_bool(json, "balanced", s->balanced != 0);
  fg_json_integer(json, "whole_plot_freedom", (int64_t)s->plot_dof);
  fg_json_number(json, "whole_plot_mean_square", s->plot_ms);
  fg_json_integer(json, "run_freedom", (int64_t)s->run_dof);
  fg_json_number(json, "run_mean_square", s->run_ms);
  fg_json_string(json, "method", s->mixed ? "restricted_likelihood" : "strata");
  fg_json_number(json, "whole_plot_variance", s->plot_variance);
  fg_json_bool(json, "whole_plot_variance_at_border", s->at_border);
  fg_json_number(json, "run_variance", s->run_variance);
  fg_json_array(json, "terms");
  for (size_t t = 0; t < s->terms; t++) {
    fg_json_object(json, NULL);
    fg_json_string(json, "stratum", s->term[t].whole_plot ? "whole plots" : "runs");
    put_anova_row(json, &s->term[t].row);
    fg_json_number(json, "error_freedom", s->term[t].error_dof);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
  fg_json_object_end(json);
}

static void put_doe_point(fg_json *json, const fg_experiment *e, const double *x) {
  double real[FG_SURFACE_FACTORS];
  for (size_t k = 0; k < e->surface.factors; k++)
    real[k] = fg_factor_real(fg_surface_factor(e, k), x[k]);
  fg_json_numbers(json, "coded", x, e->surface.factors);
  fg_json_numbers(json, "real", real, e->surface.factors);
}

static void put_prediction(fg_json *json, const fg_prediction *p) {
  fg_json_number(json, "mean", p->mean);
  fg_json_number(json, "standard_error", p->standard_error);
  put_interval(json, "interval", p->low, p->high);
  put_interval(json, "confirmation_run_interval", p->run_low, p->run_high);
}

static void put_stationary(fg_json *json, const fg_experiment *e) {
  const fg_surface *s = &e->surface;
  fg_json_array(json, "axes");
  for (size_t k = 0; k < s->factors; k++)
    fg_json_string(json, NULL, fg_surface_factor(e, k)->name);
  fg_json_array_end(json);
  fg_json_string(json, "kind", fg_surface_kind_word(s->kind));
  fg_json_numbers(json, "eigenvalues", s->eigenvalue, s->factors);
  fg_json_array(json, "eigenvectors");
  for (size_t k = 0; k < s->factors; k++)
    fg_json_numbers(json, NULL, s->eigenvector[k], s->factors);
  fg_json_array_end(json);
  if (!fg_doe_json_begin_part(json, "stationary", s->has_stationary)) return;
  put_doe_point(json, e, s->stationary);
  fg_json_bool(json, "inside_region", e->stationary_inside);
  put_prediction(json, &e->stationary);
  fg_json_object_end(json);
}

static void put_levels(fg_json *json, const fg_experiment *e) {
  fg_json_object(json, "levels");
  for (size_t v = 0; v < e->model.formula.variables; v++)
    if (e->model.levels[v].count && v != e->block_variable)
      fg_json_string(json, e->model.formula.variable[v].name,
                     e->model.levels[v].name[(size_t)e->best_setting[v]]);
  fg_json_object_end(json);
}

static void put_optimum(fg_json *json, const fg_experiment *e) {
  fg_json_object(json, "optimum");
  fg_json_string(json, "goal", fg_goal_word(e->goal));
  fg_json_number(json, "target", e->goal == FG_GOAL_TARGET ? e->target : NAN);
  fg_json_array(json, "constraints");
  for (size_t i = 0; i < e->constraints; i++)
    fg_json_string(json, NULL, e->constraint[i]);
  fg_json_array_end(json);
  put_doe_point(json, e, e->optimum.x);
  put_levels(json, e);
  fg_json_bool(json, "on_border", e->optimum.on_border);
  put_prediction(json, &e->optimum.prediction);
  fg_json_object_end(json);
}

/* The best setting that can be made. */
static void put_rounded(fg_json *json, const fg_experiment *e) {
  if (!fg_doe_json_begin_part(json, "rounded", e->has_rounded)) return;
  fg_json_array(json, "steps");
  for (size_t k = 0; k < e->surface.factors; k++)
    fg_json_number(json, NULL, e->step[k] > 0 ? e->step[k] : NAN);
  fg_json_array_end(json);
  put_doe_point(json, e, e->rounded.x);
  fg_json_bool(json, "on_border", e->rounded.on_border);
  put_prediction(json, &e->rounded.prediction);
  fg_json_object_end(json);
}

static void put_ridge(fg_json *json, const fg_experiment *e) {
  fg_json_array(json, "ridge");
  for (size_t i = 0; i < FG_RIDGE_POINTS && e->ridge[FG_RIDGE_POINTS - 1].radius > 0; i++) {
    fg_json_object(json, NULL);
    fg_json_number(json, "radius", e->ridge[i].radius);
    put_doe_point(json, e, e->ridge[i].x);
    fg_json_bool(json, "inside_region", e->ridge[i].inside);
    put_prediction(json, &e->ridge[i].prediction);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

/* Writes the factors that cannot be told from noise. */
static void put_any(fg_json *json, const fg_experiment *e) {
  fg_json_array(json, "any");
  for (size_t i = 0; i < e->idles; i++) {
    fg_json_object(json, NULL);
    fg_json_string(json, "name", e->model.formula.variable[e->idle[i].variable].column);
    fg_json_integer(json, "terms", (int64_t)e->idle[i].columns);
    fg_json_number(json, "p_value", e->idle[i].p_value);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

/* Writes the surface of the model that has the best setting. */
static void put_surface(fg_json *json, const fg_experiment *whole) {
  const fg_experiment *e = fg_experiment_best(whole);
  if (!fg_doe_json_begin_part(json, "surface", e->has_surface)) return;
  fg_json_string(json, "formula", e->formula);
  put_any(json, whole);
  put_stationary(json, e);
  if (e->has_optimum) {
    put_optimum(json, e);
    put_rounded(json, e);
  }
  put_ridge(json, e);
  fg_json_object_end(json);
}

/* Settings that were asked for, in the order of `factors`. */
static void put_asked(fg_json *json, const fg_experiment *e) {
  double numbers[4][FG_FORMULA_VARIABLES];
  fg_json_array(json, "asked");
  for (size_t i = 0; i < e->askeds; i++) {
    const fg_asked *asked = &e->asked[i];
    for (size_t f = 0; f < e->factors; f++) {
      size_t v = e->factor[f].variable;
      numbers[0][f] = asked->setting[v];
      numbers[1][f] = fg_factor_real(&e->factor[f], asked->setting[v]);
      numbers[2][f] = fg_factor_real(&e->factor[f], asked->best_at[v]);
      numbers[3][f] = asked->best_mean[v];
    }
    fg_json_object(json, NULL);
    fg_json_string(json, "setting", asked->text);
    fg_json_numbers(json, "coded", numbers[0], e->factors);
    fg_json_numbers(json, "real", numbers[1], e->factors);
    put_prediction(json, &asked->prediction);
    fg_json_bool(json, "inside_runs", asked->inside);
    fg_json_numbers(json, "best_along_real", numbers[2], e->factors);
    fg_json_numbers(json, "best_along_mean", numbers[3], e->factors);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

static void put_doe_runs(fg_json *json, const fg_experiment_report *report) {
  const fg_experiment *e = report->experiment;
  const fg_regression *r = &e->regression;
  fg_json_array(json, "runs");
  for (size_t i = 0; i < r->rows; i++) {
    fg_json_object(json, NULL);
    fg_json_line(json);
    fg_json_integer(json, "row", (int64_t)(report->row ? report->row[i] : i + 1));
    fg_json_number(json, "response", r->fitted[i] + r->residual[i]);
    fg_json_number(json, "u", e->u ? e->u[i] : NAN);
    fg_json_number(json, "fitted", r->fitted[i]);
    fg_json_number(json, "residual", r->residual[i]);
    fg_json_number(json, "leverage", r->leverage[i]);
    fg_json_number(json, "internally_studentised", r->internal[i]);
    fg_json_number(json, "externally_studentised", r->external[i]);
    fg_json_number(json, "cook", r->cook[i]);
    fg_json_object_end(json);
    fg_json_line_end(json);
  }
  fg_json_array_end(json);
}

static void put_measurement(fg_json *json, const fg_experiment *e) {
  double sd = e->regression.residual_sd;
  if (!fg_doe_json_begin_part(json, "measurement", e->u != NULL)) return;
  fg_json_number(json, "u_rms", e->u_rms);
  fg_json_bool(json, "weighted", e->weight != NULL);
  fg_json_number(json, "process_sd", e->process_sd);
  fg_json_number(json, "share_of_residual_variance", e->u_rms * e->u_rms / (sd * sd));
  fg_json_object_end(json);
}

static void put_calibration(fg_json *json, const fg_experiment_report *report) {
  bool stated = report->design && report->design->calibration.stated;
  if (stated)
    fg_json_calibration_used(json, "calibration", &report->design->calibration);
  else
    fg_json_string(json, "calibration", NULL);
  fg_json_number(json, "u_calibration", stated ? report->u_calibration : NAN);
}

static fg_status put_report(fg_context *ctx, fg_json *json, const fg_experiment_report *report,
                            const fg_sentences *conclusions) {
  const fg_experiment *e = report->experiment;
  fg_json_head(json, "foilgauge/doe/1");
  put_inputs(json, report);
  fg_json_string(json, "response", e->response);
  fg_json_string(json, "sign", e->magnitude ? "magnitude" : "as-is");
  fg_json_string(json, "formula", e->formula);
  fg_json_string(json, "block", e->block);
  fg_json_number(json, "confidence", e->confidence);
  fg_json_string(json, "plan", report->plan_path);
  fg_json_string(json, "plan_note", report->plan_note);
  fg_json_strings(json, "conclusions", (const char *const *)conclusions->text, conclusions->count);
  fg_json_strings(json, "notes", (const char *const *)e->note, e->notes);
  fg_doe_json_taken(json, e);
  put_factors(json, e);
  put_coefficients(json, e);
  put_anova(json, &e->regression);
  put_fit(json, &e->regression);
  put_measurement(json, e);
  put_calibration(json, report);
  put_aliases(json, &e->regression);
  put_tests(json, e);
  put_split_plot(json, e);
  FG_TRY(fg_doe_json_order(ctx, json, report));
  put_surface(json, e);
  put_asked(json, e);
  put_doe_runs(json, report);
  return FG_OK;
}

fg_status fg_experiment_write_json(fg_context *ctx, const fg_experiment_report *report, FILE *out) {
  fg_sentences conclusions;
  fg_json json;
  FG_TRY(fg_experiment_conclusions(ctx, report, &conclusions));
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_status status = put_report(ctx, &json, report, &conclusions);
  fg_json_object_end(&json);
  fg_json_end(&json);
  fg_sentences_free(&conclusions);
  FG_TRY(status);
  return fg_stream_finish(ctx, out, "the JSON report");
}
