/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An experiment's analysis of variance, fit and tests as members. */
#include <math.h>

#include "foilgauge/design.h"
#include "report/design/members.h"
#include "report/doe/members.h"

/* Analysis of variance. */
static const fg_member anova_rows[] = {
    {FG_STRING("term", fg_anova_row, name), .options = FG_MEMBER_NEVER_NULL},
    {FG_COUNT("freedom", fg_anova_row, dof), .words = "degrees of freedom"},
    {FG_NUMBER("sum_of_squares", fg_anova_row, sum_of_squares)},
    {FG_NUMBER("mean_square", fg_anova_row, mean_square)},
    {FG_NUMBER("f", fg_anova_row, f)},
    {FG_NUMBER("p_value", fg_anova_row, p_value), FG_P_VALUE},
};
static const fg_members anova_members = FG_MEMBERS_DEFINED(anova_rows, "anova_row");

static bool find_model_row(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = &fg_doe_whole_at(list)->model;
  return i < 1;
}

static bool find_error_row(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = &fg_doe_whole_at(list)->error[i];
  return i < sizeof fg_doe_whole_at(list)->error / sizeof *fg_doe_whole_at(list)->error;
}

static const fg_member anova_parts_rows[] = {
    {FG_LIST("sequential", fg_regression, sequential, terms, &anova_members),
     .words = "each term after the ones above it"},
    {FG_LIST("partial", fg_regression, partial, terms, &anova_members),
     .words = "each term after all others, as the mean over the levels of words that it interacts "
              "with"},
    {FG_LIST_BY("model", find_model_row, &anova_members), .words = "all terms together"},
    {FG_LIST_BY("error", find_error_row, &anova_members),
     .words = "residual, lack of fit, pure error, total"},
};
static const fg_members anova_parts = FG_MEMBERS(anova_parts_rows);

static const fg_member fit_rows[] = {
    {FG_COUNT("runs", fg_regression, rows)},
    {FG_COUNT("rank", fg_regression, rank), .words = "of the model's matrix"},
    {FG_COUNT("residual_freedom", fg_regression, residual_dof), .words = "degrees of freedom"},
    {FG_NUMBER("residual_sd", fg_regression, residual_sd)},
    {FG_NUMBER("r2", fg_regression, r2)},
    {FG_NUMBER("adjusted_r2", fg_regression, adjusted_r2)},
    {FG_NUMBER("predicted_r2", fg_regression, predicted_r2)},
    {FG_NUMBER("press", fg_regression, press), .words = "sum of squares of left-out residuals"},
    {FG_NUMBER("adequate_precision", fg_regression, adequate_precision),
     .words = "range of the fitted values over their mean standard error"},
    {FG_NUMBER("condition_number", fg_regression, condition_number),
     .words = "of the matrix with columns of equal length"},
};
static const fg_members fit_members = FG_MEMBERS(fit_rows);

/* Measurement of the responses. */
static fg_subject find_measurement(const fg_subject *s) {
  const fg_experiment *e = fg_doe_experiment_at(s);
  return (fg_subject){.object = e->measurement.u ? e : NULL, .whole = s->whole};
}

static double is_weighted(const fg_subject *s) {
  return fg_doe_experiment_at(s)->measurement.weight != NULL;
}

static double find_measured_share(const fg_subject *s) {
  const fg_experiment *e = fg_doe_experiment_at(s);
  return e->measurement.u_rms * e->measurement.u_rms /
         (e->regression.residual_sd * e->regression.residual_sd);
}

static const fg_member measurement_rows[] = {
    {FG_NUMBER("u_rms", fg_experiment, measurement.u_rms), .words = "of the runs' uncertainties"},
    {FG_FLAG_BY("weighted", is_weighted), .words = "runs have weights by their uncertainties"},
    {FG_NUMBER("process_sd", fg_experiment, measurement.process_sd),
     .words = "scatter besides the measurement's; null: not separated"},
    {FG_NUMBER_BY("share_of_residual_variance", find_measured_share)},
};
static const fg_members measurement_members = FG_MEMBERS(measurement_rows);

static bool is_calibration_stated(const fg_subject *s) {
  const fg_experiment_report *report = fg_doe_whole_at(s)->report;
  return report->design && report->design->calibration.stated;
}

static fg_subject find_calibration(const fg_subject *s) {
  return (fg_subject){
      .object = is_calibration_stated(s) ? &fg_doe_whole_at(s)->report->design->calibration : NULL};
}

static fg_subject find_design_of_runs(const fg_subject *s) {
  return (fg_subject){.object = fg_doe_whole_at(s)->report->design};
}

static double find_u_calibration(const fg_subject *s) {
  return is_calibration_stated(s) ? fg_doe_whole_at(s)->report->u_calibration : NAN;
}

/* Aliases: a column, and the columns that it is a sum of. */
static const fg_alias *alias_of(const fg_subject *s) {
  return s->object;
}

static const char *find_alias_name(const fg_subject *s, char *buffer) {
  (void)buffer;
  return fg_doe_experiment_at(s)->regression.coefficient[alias_of(s)->column].name;
}

static bool find_alias_part(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = list->object;
  return i < alias_of(list)->count;
}

static const char *find_alias_part_name(const fg_subject *s, char *buffer) {
  (void)buffer;
  return fg_doe_experiment_at(s)->regression.coefficient[alias_of(s)->with[s->index]].name;
}

static double find_alias_times(const fg_subject *s) {
  return alias_of(s)->factor[s->index];
}

static const fg_member alias_part_rows[] = {
    {FG_TEXT_BY("name", find_alias_part_name), .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER_BY("times", find_alias_times), .options = FG_MEMBER_NEVER_NULL},
};
static const fg_members alias_part_members = FG_MEMBERS(alias_part_rows);

static const fg_member alias_rows[] = {
    {FG_TEXT_BY("name", find_alias_name), .options = FG_MEMBER_NEVER_NULL},
    {FG_LIST_BY("is", find_alias_part, &alias_part_members), .options = FG_MEMBER_ON_LINE,
     .words = "the columns that it is a sum of"},
};
static const fg_members alias_members = FG_MEMBERS(alias_rows);

/* A test that the experiment may lack: null. */
#define TEST_PART(function, has, part)                                                             \
  static fg_subject function(const fg_subject *s) {                                                \
    const fg_experiment *e = fg_doe_experiment_at(s);                                              \
    return (fg_subject){.object = e->has ? &e->part : NULL, .whole = s->whole};                    \
  }
TEST_PART(find_lenth, has_lenth, lenth)
TEST_PART(find_box_cox, has_box_cox, box_cox)
TEST_PART(find_curvature, has_curvature, curvature)
TEST_PART(find_split_plot, has_split_plot, split_plot)

static const fg_member lenth_rows[] = {
    {FG_NUMBER("pseudo_standard_error", fg_lenth, pseudo_standard_error)},
    {FG_NUMBER("margin", fg_lenth, margin), .words = "of error of one effect"},
    {FG_NUMBER("simultaneous_margin", fg_lenth, simultaneous_margin), .words = "of all together"},
    {FG_NUMBER("freedom", fg_lenth, dof), .words = "effects over 3"},
};
static const fg_members lenth_members = FG_MEMBERS(lenth_rows);

static const fg_member box_cox_rows[] = {
    {FG_NUMBER("lambda", fg_box_cox, lambda), .words = "power of the response that fits best"},
    {FG_RANGE("interval", fg_box_cox, low, high), .words = "95 %"},
};
static const fg_members box_cox_members = FG_MEMBERS(box_cox_rows);

static const fg_member curvature_rows[] = {
    {FG_COUNT("corners", fg_curvature, corners), .words = "runs at corners"},
    {FG_COUNT("centres", fg_curvature, centres), .words = "runs at the centre"},
    {FG_NUMBER("corner_mean", fg_curvature, corner_mean)},
    {FG_NUMBER("centre_mean", fg_curvature, centre_mean)},
    {FG_NUMBER("sum_of_squares", fg_curvature, sum_of_squares)},
    {FG_COUNT("error_freedom", fg_curvature, error_dof)},
    {FG_NUMBER("f", fg_curvature, f)},
    {FG_NUMBER("p_value", fg_curvature, p_value), FG_P_VALUE},
};
static const fg_members curvature_members = FG_MEMBERS(curvature_rows);

static const char *find_whole_plot_column(const fg_subject *s, char *buffer) {
  (void)buffer;
  return fg_doe_experiment_at(s)->whole_plot;
}

static double is_balanced(const fg_subject *s) {
  return ((const fg_split_plot *)s->object)->balanced != 0;
}

static const char *const method_words[] = {"strata", "restricted_likelihood", NULL};

static int find_method(const fg_subject *s) {
  return ((const fg_split_plot *)s->object)->mixed != NULL;
}

static int find_term_stratum(const fg_subject *s) {
  return ((const fg_split_plot_term *)s->object)->whole_plot != 0;
}

static const fg_member term_rows[] = {
    {FG_WORD_BY("stratum", find_term_stratum, fg_doe_stratum_words),
     .options = FG_MEMBER_NEVER_NULL},
    {FG_SAME(&anova_members), .offset = offsetof(fg_split_plot_term, row)},
    {FG_NUMBER("error_freedom", fg_split_plot_term, error_dof)},
};
static const fg_members term_members = FG_MEMBERS(term_rows);

static const fg_member split_plot_rows[] = {
    {FG_TEXT_BY("column", find_whole_plot_column), .options = FG_MEMBER_NEVER_NULL,
     .words = "that names the whole plots"},
    {FG_COUNT("whole_plots", fg_split_plot, plots)},
    {FG_FLAG_BY("balanced", is_balanced), .words = "whole plots have one size"},
    {FG_COUNT("whole_plot_freedom", fg_split_plot, plot_dof)},
    {FG_NUMBER("whole_plot_mean_square", fg_split_plot, plot_ms)},
    {FG_COUNT("run_freedom", fg_split_plot, run_dof)},
    {FG_NUMBER("run_mean_square", fg_split_plot, run_ms)},
    {FG_WORD_BY("method", find_method, method_words), .options = FG_MEMBER_NEVER_NULL,
     .words = "strata: analysis of variance, exact where whole plots have one size and the factors "
              "within them are orthogonal to them; else restricted_likelihood, with Kenward and "
              "Roger's degrees of freedom"},
    {FG_NUMBER("whole_plot_variance", fg_split_plot, plot_variance)},
    {FG_FLAG("whole_plot_variance_at_border", fg_split_plot, at_border),
     .words = "it is estimated as 0, the least there is"},
    {FG_NUMBER("run_variance", fg_split_plot, run_variance)},
    {FG_LIST("terms", fg_split_plot, term, terms, &term_members)},
};
static const fg_members split_plot_members = FG_MEMBERS(split_plot_rows);

static fg_subject find_regression(const fg_subject *s) {
  return (fg_subject){.object = &fg_doe_experiment_at(s)->regression, .whole = s->whole};
}

static bool find_alias(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_regression *r = &fg_doe_experiment_at(list)->regression;
  element->object = &r->alias[i];
  return i < r->aliases;
}

static const fg_member analysis_rows[] = {
    {FG_PART("anova", find_regression, &anova_parts), .options = FG_MEMBER_NEVER_NULL,
     .words = "analysis of variance"},
    {FG_PART("fit", find_regression, &fit_members), .options = FG_MEMBER_NEVER_NULL},
    {FG_PART("measurement", find_measurement, &measurement_members),
     .words = "of the responses; null: their uncertainty is not known"},
    {FG_PART("calibration", find_calibration, &fg_calibration_used_members),
     .schema = FG_REF("design.schema.json#/$defs/calibration_used"),
     .words = "of the scanner, by the design that the scans were measured with; null: no scans, or "
              "none is stated"},
    {FG_PART("traceability", find_design_of_runs, &fg_traceability_members),
     .options = FG_MEMBER_NULLABLE, .words = "what lengths of the scans rest on; null: no scans"},
    {FG_NUMBER_BY("u_calibration", find_u_calibration),
     .words = "standard uncertainty of the level of all runs by the calibration: the same error in "
              "every scan, in no run's u and in no effect's interval"},
    {FG_LIST_BY("aliases", find_alias, &alias_members), .words = "columns that are sums of others"},
    {FG_PART("lenth", find_lenth, &lenth_members),
     .words = "Lenth's test of effects without residual degrees of freedom"},
    {FG_PART("box_cox", find_box_cox, &box_cox_members)},
    {FG_PART("curvature", find_curvature, &curvature_members),
     .words = "centre runs against the plane of the corners"},
    {FG_PART("split_plot", find_split_plot, &split_plot_members)},
};
const fg_members fg_doe_analysis_members = FG_MEMBERS(analysis_rows);
