/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "foilgauge/loop/1": the loop's report. Rows are numbered as in the table, the first data row 1.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/file.h"
#include "core/json_writer.h"
#include "foilgauge/loop.h"
#include "foilgauge/words.h"
#include "report/table_loop/checks.h"
#include "report/table_loop/next.h"
#include "report/table_loop/reading.h"

static void write_error(fg_json *json, const char *name, const fg_loop_error *error) {
  fg_json_object(json, name);
  fg_json_number(json, "rms", error->rms);
  fg_json_number(json, "held_out_rms", error->held_out_rms);
  fg_json_number(json, "cross_validated_rms", error->cross_validated_rms);
  fg_json_number(json, "robust_sd", error->robust_sd);
  fg_json_number(json, "p95", error->p95);
  fg_json_number(json, "maximum", error->maximum);
  fg_json_array(json, "foils");
  fg_json_array_end(json);
  fg_json_object_end(json);
}

static bool is_outlier(const fg_loop_claim *claim) {
  return claim->candidate.effect->outlier != FG_LOOP_NOT_OUTLIER;
}

/* Returns the factor from the coefficient to a slope per unit of its column, or to a share of the
 * arc length; NaN for other bases. */
static double natural_unit(const fg_loop_report *report, const fg_loop_claim *claim) {
  const fg_loop_coordinate *at = &report->problem->problem.coordinate[claim->candidate.a];
  if (claim->candidate.effect->from_zero) return 1 / fmax(fabs(at->low), fabs(at->high));
  if (claim->candidate.effect->slope) return 2 / (at->high - at->low);
  return NAN;
}

/* Names of the parameters of an effect: its shapes, and its coefficients per column. */
static void write_parameters(fg_json *json, const fg_loop_report *report,
                             const fg_loop_claim *claim, bool uncertainty) {
  const fg_loop_effect *effect = claim->candidate.effect;
  const double *coefficient = uncertainty ? claim->coefficient_u : claim->coefficient;
  const double *shape = uncertainty ? claim->shape_u : claim->shape;
  char name[32];
  fg_json_object(json, uncertainty ? "uncertainty" : "parameters");
  for (size_t k = 0; k < claim->columns; k++) {
    snprintf(name, sizeof name, claim->columns > 1 ? "coefficient_%zu" : "coefficient", k + 1);
    fg_json_number(json, name, coefficient[k]);
  }
  for (size_t d = 0; d < effect->shapes; d++)
    fg_json_number(json, effect->shape_name[d], shape[d]);
  if (effect->scatter != FG_LOOP_OF_THE_MEAN)
    fg_json_number(json, effect->scatter == FG_LOOP_SERIAL ? "correlation" : "sd_ratio",
                   uncertainty ? claim->noise_value_u : claim->noise_value);
  double unit = natural_unit(report, claim);
  if (isfinite(unit))
    fg_json_number(json, effect->from_zero ? "stretch" : "slope_per_unit", unit * coefficient[0]);
  if (!uncertainty && is_outlier(claim)) {
    bool pair = effect->outlier == FG_LOOP_EXCHANGED_ROWS;
    fg_json_integer(json, "row", (int64_t)report->problem->row[claim->candidate.row[0]] + 1);
    for (size_t k = 1; !pair && k < claim->candidate.rows; k++) {
      snprintf(name, sizeof name, "row_%zu", k + 1);
      fg_json_integer(json, name, (int64_t)report->problem->row[claim->candidate.row[k]] + 1);
    }
    if (pair)
      fg_json_integer(json, "second_row",
                      (int64_t)report->problem->row[claim->candidate.row[1]] + 1);
  }
  fg_json_object_end(json);
}

/* Writes the names of the rows of a claim about single rows, if they have names. */
static void write_row_names(fg_json *json, const fg_loop_report *report,
                            const fg_loop_claim *claim) {
  if (!report->row_name || !is_outlier(claim)) return;
  size_t rows = claim->candidate.effect->outlier == FG_LOOP_EXCHANGED_ROWS ? 2 : 1;
  fg_json_array(json, "row_names");
  for (size_t i = 0; i < rows; i++)
    fg_json_string(json, NULL, report->row_name[report->problem->row[claim->candidate.row[i]]]);
  fg_json_array_end(json);
}

static void write_table_claim(fg_json *json, const fg_loop_report *report,
                              const fg_loop_claim *claim) {
  static const char *const held_out[] = {"none kept aside", "not contradicted", "confirmed"};
  fg_json_object(json, NULL);
  fg_json_string(json, "id", claim->candidate.effect->id);
  fg_json_string(json, "name", claim->name);
  fg_json_string(json, "level", report->problem->problem.level);
  fg_json_string(json, "verdict", fg_loop_verdict_word(claim->verdict));
  fg_json_array(json, "coordinates");
  if (!is_outlier(claim)) {
    const fg_loop_coordinate *at = report->problem->problem.coordinate;
    fg_json_string(json, NULL, at[claim->candidate.a].name);
    if (claim->candidate.effect->pair) fg_json_string(json, NULL, at[claim->candidate.b].name);
  }
  fg_json_array_end(json);
  if (is_outlier(claim)) {
    fg_json_array(json, "rows");
    for (size_t k = 0; k < claim->candidate.rows; k++)
      fg_json_integer(json, NULL, (int64_t)report->problem->row[claim->candidate.row[k]] + 1);
    fg_json_array_end(json);
  }
  write_parameters(json, report, claim, false);
  write_parameters(json, report, claim, true);
  write_row_names(json, report, claim);
  char sentence[2 * FG_LOOP_WORDS];
  fg_loop_claim_sentence(report, claim, sentence);
  fg_json_string(json, "sentence", sentence);
  fg_json_number(json, "amplitude", claim->amplitude);
  fg_json_number(json, "u_amplitude", claim->amplitude_u);
  fg_json_numbers(json, "amplitude_interval_95", claim->interval, 2);
  fg_json_number(json, "p_value", claim->p_value);
  fg_json_number(json, "retained_share", claim->retained_share);
  fg_json_number(json, "cross_validated_gain", claim->cv_gain);
  fg_json_number(json, "u_cross_validated_gain", claim->cv_gain_se);
  fg_json_string(json, "kept_aside", held_out[claim->held_out < 0 ? 0 : claim->held_out + 1]);
  fg_json_array(json, "alias_class");
  for (size_t i = 0; i < claim->aliases; i++) {
    fg_json_object(json, NULL);
    fg_json_line(json);
    fg_json_string(json, "name", claim->alias[i].name);
    fg_json_string(json, "id", claim->alias[i].candidate.effect->id);
    fg_json_bool(json, "sum_of_two", claim->alias[i].sum);
    fg_json_number(json, "correlation", claim->alias[i].correlation);
    fg_json_number(json, "loss", claim->alias[i].loss);
    fg_json_line_end(json);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
  fg_json_integer(json, "aliases_not_listed", (int64_t)claim->aliases_unlisted);
  fg_json_object_end(json);
}

static void write_row_index(fg_json *json, const fg_loop_report *report, size_t row) {
  fg_json_integer(json, NULL, (int64_t)report->problem->row[row] + 1);
}

/* The tests of the whole residual; those that the table offers none of are not there. */
static void write_residual_tests(fg_json *json, const fg_loop_report *report) {
  char words[FG_LOOP_WORDS];
  fg_json_array(json, "battery");
  for (size_t k = 0; k < FG_LOOP_CHECKS; k++) {
    const fg_loop_checked *check = &report->result->check[k];
    if (!check->done) continue;
    fg_loop_check_words(report, (fg_loop_check)k, words);
    fg_json_object(json, NULL);
    fg_json_string(json, "test", fg_loop_check_id((fg_loop_check)k));
    fg_json_string(json, "asks", words);
    fg_json_number(json, "statistic", check->statistic);
    if (k < FG_LOOP_CHECK_LAGS)
      fg_json_numbers(json, "degrees_of_freedom", check->dof, 2);
    else
      fg_json_integer(json, "lag", (int64_t)check->lag);
    if (k == FG_LOOP_CHECK_ONE_LAG) fg_json_number(json, "correlation", check->correlation);
    fg_json_number(json, "p_value", check->p_value);
    fg_json_number(json, "level", check->level);
    fg_json_bool(json, "passed", !check->failed);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

/* Writes the finding of the failed test, unless a curve describes it. */
static void write_failed(fg_json *json, const fg_loop_report *report) {
  const fg_loop_result *result = report->result;
  const fg_loop_checked *failed = &result->check[result->failed];
  char names[FG_LOOP_WORDS];
  fg_loop_failed_coordinate(report, names);
  fg_json_object(json, "unattributed");
  fg_json_string(json, "kind", fg_loop_check_id(result->failed));
  fg_json_string(json, "coordinate", names);
  fg_json_array(json, "shape");
  fg_json_array_end(json);
  fg_json_number(json, "rms", failed->rms);
  fg_json_number(json, "p_value", failed->p_value);
  fg_json_array(json, "nearest");
  for (size_t i = 0; i < failed->worst_count; i++)
    write_row_index(json, report, failed->worst[i]);
  fg_json_array_end(json);
  fg_json_object_end(json);
}

static void write_curve(fg_json *json, const fg_loop_report *report) {
  const fg_loop_result *result = report->result;
  const fg_loop_curve *curve = &result->curve;
  if (!result->has_curve) {
    fg_json_string(json, "unattributed", NULL);
    return;
  }
  fg_json_object(json, "unattributed");
  fg_json_string(json, "kind", "curve");
  fg_json_string(json, "coordinate", curve->name);
  fg_json_array(json, "shape");
  for (size_t i = 0; i < curve->count; i++)
    fg_json_numbers(json, NULL, curve->shape[i], 2);
  fg_json_array_end(json);
  fg_json_number(json, "rms", curve->rms);
  fg_json_number(json, "p_value", curve->p_value);
  fg_json_array(json, "nearest");
  for (size_t i = 0; i < curve->nearest_count; i++)
    write_row_index(json, report, curve->nearest[i]);
  fg_json_array_end(json);
  fg_json_object_end(json);
}

static void write_table_rejected(fg_json *json, const fg_loop_rejected *one) {
  fg_json_object(json, NULL);
  fg_json_line(json);
  fg_json_string(json, "id", one->candidate.effect->id);
  fg_json_string(json, "name", one->name);
  fg_json_string(json, "verdict", fg_loop_verdict_word(one->verdict));
  fg_json_number(json, "would_explain", one->would_explain);
  fg_json_number(json, "p_value", one->p_value);
  fg_json_number(json, "retained_share", one->retained_share);
  fg_json_number(json, "smallest_amplitude", one->smallest_detectable);
  fg_json_line_end(json);
  fg_json_object_end(json);
}

enum { LISTED_HELD_OUT = 1000 }; /* rows; more are only counted */

static void write_table_inputs(fg_json *json, const fg_loop_report *report) {
  const fg_loop_problem *problem = &report->problem->problem;
  size_t held_out = 0;
  for (size_t i = 0; i < problem->rows; i++)
    held_out += problem->held_out && problem->held_out[i];
  fg_json_array(json, "inputs");
  fg_json_object(json, NULL);
  fg_json_string(json, "path", report->path);
  fg_json_string(json, "sha256", report->sha256);
  fg_json_integer(json, "rows", (int64_t)problem->rows);
  fg_json_integer(json, "rows_kept_aside", (int64_t)held_out);
  fg_json_array(json, "kept_aside");
  fg_json_line(json);
  for (size_t i = 0; held_out <= LISTED_HELD_OUT && i < problem->rows; i++)
    if (problem->held_out && problem->held_out[i])
      fg_json_integer(json, NULL, (int64_t)report->problem->row[i] + 1);
  fg_json_line_end(json);
  fg_json_array_end(json);
  fg_json_object_end(json);
  for (size_t i = 0; i < report->inputs; i++) {
    fg_json_object(json, NULL);
    fg_json_line(json);
    fg_json_string(json, "path", report->input[i].path);
    fg_json_string(json, "sha256", *report->input[i].sha256 ? report->input[i].sha256 : NULL);
    fg_json_line_end(json);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
  fg_json_object(json, "declared");
  fg_json_string(json, "response", report->spec->response);
  fg_json_string(json, "model", report->spec->model);
  fg_json_string(json, "offset", report->spec->offset);
  fg_json_string(json, "group", report->spec->group);
  fg_json_integer(json, "groups", (int64_t)problem->groups);
  fg_json_object_end(json);
  fg_json_integer(json, "seed", (int64_t)report->seed);
}

static void write_model(fg_json *json, const fg_loop_report *report) {
  const fg_loop_problem *problem = &report->problem->problem;
  fg_json_array(json, "declared_parameters");
  for (size_t k = 0; k < problem->parameters; k++) {
    fg_json_object(json, NULL);
    fg_json_line(json);
    fg_json_string(json, "name", problem->parameter_name[k]);
    fg_json_number(json, "value", report->result->parameter[k]);
    fg_json_number(json, "u_value", report->result->parameter_u[k]);
    fg_json_line_end(json);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

static void write_findings(fg_json *json, const fg_loop_report *report) {
  const fg_loop_result *result = report->result;
  write_error(json, "before", &result->before);
  fg_json_array(json, "claims");
  for (size_t i = 0; i < result->claims; i++)
    write_table_claim(json, report, &result->claim[i]);
  fg_json_array_end(json);
  if (result->fails && !result->has_curve)
    write_failed(json, report);
  else
    write_curve(json, report);
  write_residual_tests(json, report);
  write_error(json, "after", &result->after);
  fg_json_object(json, "error_ratio");
  fg_json_number(json, "rms", result->ratio_rms);
  fg_json_number(json, "held_out", result->ratio_held_out);
  fg_json_number(json, "cross_validated",
                 result->after.cross_validated_rms / result->before.cross_validated_rms);
  fg_json_numbers(json, "interval_95", result->ratio_interval, 2);
  fg_json_number(json, "after_to_noise_floor", result->after.rms / result->noise_floor);
  fg_json_object_end(json);
  write_model(json, report);
  fg_json_array(json, "rejected");
  for (size_t i = 0; i < result->rejects; i++)
    write_table_rejected(json, &result->rejected[i]);
  fg_json_array_end(json);
  fg_json_array(json, "separating_measurement");
  for (size_t i = 0; i < result->advices; i++) {
    fg_json_object(json, NULL);
    fg_json_string(json, "advice", result->advice[i].text);
    fg_json_number(json, "runs", result->advice[i].runs);
    fg_json_object_end(json);
  }
  fg_json_array_end(json);
}

static void write_next(fg_json *json, const fg_loop_report *report) {
  char step[FG_LOOP_STEP];
  fg_json_array(json, "next_steps");
  for (size_t i = 0; i < fg_loop_next_count(report); i++) {
    fg_loop_next_step(report, i, step);
    fg_json_string(json, NULL, step);
  }
  fg_json_array_end(json);
}

/* Rows after which a correlation has fallen to 1/e. */
static double range_of(double rho) {
  return rho > 0 ? -1 / log(rho) : 0;
}

fg_status fg_loop_write_json(fg_context *ctx, const fg_loop_report *report, FILE *out) {
  const fg_loop_result *result = report->result;
  char *sentence = NULL;
  fg_json json;
  FG_TRY(fg_loop_sentence(ctx, report, &sentence));
  fg_json_begin(&json, out);
  fg_json_object(&json, NULL);
  fg_json_string(&json, "schema", "foilgauge/loop/1");
  fg_json_string(&json, "version", FOILGAUGE_VERSION);
  fg_json_string(&json, "domain", "table");
  fg_json_string(&json, "verdict", fg_loop_outcome_word(result->verdict));
  fg_json_string(&json, "summary", sentence);
  write_table_inputs(&json, report);
  fg_json_number(&json, "noise_floor", result->noise_floor);
  fg_json_number(&json, "family_p_value", result->family_p);
  fg_json_object(&json, "noise");
  fg_json_number(&json, "sd", result->noise.sd);
  fg_json_number(&json, "correlation", result->noise.rho);
  fg_json_number(&json, "group_to_row_variance", result->noise.lambda);
  fg_json_string(&json, "form", fg_loop_noise_model(result));
  fg_json_number(&json, "range_rows", range_of(result->noise.rho));
  fg_json_object_end(&json);
  write_findings(&json, report);
  write_next(&json, report);
  fg_json_string(&json, "not_candidates", report->problem->excluded);
  fg_json_array(&json, "notes");
  if (report->said) fg_json_string(&json, NULL, report->said);
  for (size_t i = 0; i < result->notes; i++)
    fg_json_string(&json, NULL, result->note[i]);
  fg_json_array_end(&json);
  fg_json_object_end(&json);
  fg_json_end(&json);
  free(sentence);
  return fg_stream_finish(ctx, out, "the loop's report");
}
