/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "foilgauge/doe/1": inputs, coefficients, analysis of variance, tests, runs. */
#include "report/doe/members.h"

#include <math.h>
#include <stdlib.h>

#include "core/file.h"

static double mean_square(double sum, size_t dof) {
  return dof ? sum / (double)dof : NAN;
}

void fg_doe_whole_of(const fg_experiment_report *report, const fg_sentences *conclusions,
                     fg_doe_whole *whole) {
  static char residual[] = "residual", lack[] = "lack of fit", pure[] = "pure error",
              total[] = "total", model[] = "model";
  const fg_experiment *e = report->experiment;
  const fg_regression *r = &e->regression;
  size_t dof = r->rank - r->constant;
  *whole = (fg_doe_whole){
      .report = report,
      .e = e,
      .best = fg_experiment_best(e),
      .conclusions = conclusions,
      .model = {model, dof, r->model_ss, mean_square(r->model_ss, dof),
                r->model_ss / (double)dof / (r->residual_sd * r->residual_sd), r->model_p_value},
      .error = {{residual, r->residual_dof, r->residual_ss,
                 mean_square(r->residual_ss, r->residual_dof), NAN, NAN},
                {lack, r->lack_dof, r->lack_ss, mean_square(r->lack_ss, r->lack_dof), r->lack_f,
                 r->lack_p_value},
                {pure, r->pure_dof, r->pure_ss, mean_square(r->pure_ss, r->pure_dof), NAN, NAN},
                {total, r->residual_dof + dof, r->total_ss, NAN, NAN, NAN}},
  };
}

/* Inputs: the run sheet, then the model, then the scans. */
static bool find_input(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_experiment_report *report = fg_doe_whole_at(list)->report;
  element->object = i == 1 && !report->model_path ? NULL : report;
  return i < 2 + report->scans;
}

static const fg_experiment_scan *scan_of(const fg_subject *input) {
  return &fg_doe_whole_at(input)->report->scan[input->index - 2];
}

static bool is_scan(const fg_subject *input) {
  return input->index >= 2;
}

static const char *find_input_path(const fg_subject *input, char *buffer) {
  const fg_experiment_report *report = fg_doe_whole_at(input)->report;
  (void)buffer;
  return is_scan(input) ? scan_of(input)->path : input->index ? report->model_path : report->path;
}

static const char *find_input_sha256(const fg_subject *input, char *buffer) {
  const fg_experiment_report *report = fg_doe_whole_at(input)->report;
  (void)buffer;
  if (is_scan(input)) return scan_of(input)->sha256;
  return input->index ? report->model_sha256 : report->sha256;
}

static fg_subject find_scan(const fg_subject *input) {
  return (fg_subject){.object = is_scan(input) ? scan_of(input) : NULL, .whole = input->whole};
}

static const fg_member scan_rows[] = {
    {FG_COUNT("row", fg_experiment_scan, run), .lowest = 1, .words = "of the run sheet"},
    {FG_NUMBER("value", fg_experiment_scan, value), .words = "null: not measured"},
    {FG_NUMBER("u", fg_experiment_scan, u), .words = "standard uncertainty, of the scan alone"},
    {FG_STRING("error", fg_experiment_scan, error), .words = "reason why it was not measured"},
};
static const fg_members scan_members = FG_MEMBERS(scan_rows);

static const fg_member input_rows[] = {
    {FG_TEXT_BY("path", find_input_path), .options = FG_MEMBER_NEVER_NULL},
    {FG_TEXT_BY("sha256", find_input_sha256), .options = FG_MEMBER_EMPTY_IS_NULL},
    {FG_SAME(&scan_members), .part = find_scan},
};
static const fg_members input_members = FG_MEMBERS_DEFINED(input_rows, "input");

/* Effects that a loop's model has subtracted. */
static const fg_member subtracted_effect_rows[] = {
    {FG_TEXT("id", fg_subtracted_effect, id), .words = "of the effect"},
    {FG_TEXT("words", fg_subtracted_effect, words)},
    {FG_FLAG("taken_out", fg_subtracted_effect, applied),
     .words = "false: it concerns rows of the table it was found in"},
    {FG_NUMBER_U("amplitude", fg_subtracted_effect, amplitude, u_amplitude),
     .words = "half its range in its own data"},
    {FG_COUNT("parameters", fg_subtracted_effect, parameters), .words = "estimated for it"},
    {FG_RANGE("range", fg_subtracted_effect, low, high),
     .words = "of the part subtracted from these runs"},
};
static const fg_members subtracted_effect_members = FG_MEMBERS(subtracted_effect_rows);

static const fg_member subtracted_rows[] = {
    {FG_COUNT("freedom", fg_experiment, subtracted.dof),
     .words = "degrees of freedom of the residual that paid for it"},
    {FG_LIST("effects", fg_experiment, subtracted.effects, subtracted.count,
             &subtracted_effect_members)},
};
static const fg_members subtracted_members = FG_MEMBERS(subtracted_rows);

static fg_subject find_subtracted(const fg_subject *s) {
  const fg_experiment *e = fg_doe_experiment_at(s);
  return (fg_subject){.object = e->subtracted.count ? e : NULL, .whole = s->whole};
}

/* Factors. */
static double find_low(const fg_subject *s) {
  const fg_factor *factor = s->object;
  return factor->coded ? fg_factor_real(factor, -1) : NAN;
}

static double find_high(const fg_subject *s) {
  const fg_factor *factor = s->object;
  return factor->coded ? fg_factor_real(factor, 1) : NAN;
}

static const double *list_real_range(const fg_subject *s, double *buffer, size_t *count) {
  const fg_factor *factor = s->object;
  buffer[0] = fg_factor_real(factor, factor->lowest);
  buffer[1] = fg_factor_real(factor, factor->highest);
  *count = 2;
  return buffer;
}

static const fg_member factor_rows[] = {
    {FG_STRING("name", fg_factor, name), .options = FG_MEMBER_NEVER_NULL, .words = "of its column"},
    {FG_FLAG("coded", fg_factor, coded), .words = "false: -1 and +1 are real values"},
    {FG_NUMBER_BY("low", find_low), .words = "real value of -1"},
    {FG_NUMBER_BY("high", find_high), .words = "real value of +1"},
    {FG_NUMBERS_BY("range", list_real_range), .lowest = 2, .highest = 2, .words = "of the data"},
    {FG_RANGE("range_coded", fg_factor, lowest, highest), .words = "of the data, coded"},
};
static const fg_members factor_members = FG_MEMBERS(factor_rows);

static bool find_factor(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = &fg_doe_experiment_at(list)->factor[i];
  return i < fg_doe_experiment_at(list)->factors;
}

/* A coefficient: fg_experiment_effect, its index the column's. */
bool fg_doe_coefficient_at(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = &fg_doe_experiment_at(list)->effect[i];
  return i < fg_doe_experiment_at(list)->regression.columns;
}

static const fg_coefficient *coefficient_of(const fg_subject *s) {
  return &fg_doe_experiment_at(s)->regression.coefficient[s->index];
}

static const char *find_coefficient_name(const fg_subject *s, char *buffer) {
  (void)buffer;
  return coefficient_of(s)->name;
}

static double is_aliased(const fg_subject *s) {
  return coefficient_of(s)->aliased;
}

static double find_estimate(const fg_subject *s) {
  return coefficient_of(s)->estimate;
}

static double find_vif(const fg_subject *s) {
  return coefficient_of(s)->vif;
}

const char *const fg_doe_stratum_words[] = {"runs", "whole plots", NULL};

static int find_stratum(const fg_subject *s) {
  if (!fg_doe_experiment_at(s)->has_split_plot) return -1;
  return ((const fg_experiment_effect *)s->object)->whole_plot;
}

static const char *find_p_words(const fg_subject *s, char *buffer) {
  fg_p_value_text(buffer, fg_experiment_p_value(fg_doe_experiment_at(s), s->index));
  return buffer;
}

static bool is_p_of_error(const fg_subject *list) {
  return fg_doe_experiment_at(list)->regression.residual_dof > 0;
}

static bool is_p_of_lenth(const fg_subject *list) {
  return !is_p_of_error(list);
}

static const char *look_at_coefficient(const fg_subject *s) {
  const fg_experiment *e = fg_doe_experiment_at(s);
  bool on = fg_experiment_of_interest(e, s->index) &&
            fg_experiment_p_value(e, s->index) < 1 - e->confidence;
  return on ? "on" : NULL;
}

static const fg_member coefficient_rows[] = {
    {FG_TEXT_BY("name", find_coefficient_name), .options = FG_MEMBER_NEVER_NULL,
     .words = "of the term", .page = {.rank = 1, .heading = "term"},
     .terminal = {.rank = 1, .heading = "coefficient", .words = true}},
    {FG_FLAG_BY("aliased", is_aliased), .words = "cannot be told from others: it has no numbers"},
    {FG_NUMBER_BY("estimate", find_estimate),
     .words = "change of the response over half the range of a factor", .heading = "estimate",
     .page = {.rank = 1, .digits = 5}, .terminal = {.rank = 1, .digits = 4}},
    {FG_NUMBER("relative_effect_pct", fg_experiment_effect, relative_pct),
     .words = "over the constant", .heading = "relative\n%", .page = {.rank = 1, .digits = 4},
     .terminal = {.rank = 1, .digits = 4}},
    {FG_NUMBER("standard_error", fg_experiment_effect, standard_error),
     .heading = "standard\nerror", .page = {.rank = 1, .digits = 4},
     .terminal = {.rank = 1, .digits = 4}},
    {FG_NUMBER("t", fg_experiment_effect, t), .words = "Student's", .heading = "t",
     .page = {.rank = 3, .digits = 4}, .terminal = {.rank = 3, .digits = 4}},
    {FG_NUMBER("freedom", fg_experiment_effect, dof), .words = "degrees of freedom of its error"},
    {FG_NUMBER("p_value", fg_experiment_effect, p_value), FG_P_VALUE},
    {FG_TEXT_BY("p_value", find_p_words), .options = FG_MEMBER_NOT_IN_JSON, .heading = "p",
     .page = {.rank = 3}, .terminal = {.rank = 3}, .column = is_p_of_error},
    {FG_TEXT_BY("lenth_p_value", find_p_words), .options = FG_MEMBER_NOT_IN_JSON,
     .heading = "p\n(Lenth)", .page = {.rank = 3}, .terminal = {.rank = 3},
     .column = is_p_of_lenth},
    {FG_RANGE("interval", fg_experiment_effect, low, high), .words = "at the report's confidence"},
    {FG_NUMBER("low", fg_experiment_effect, low), .options = FG_MEMBER_NOT_IN_JSON,
     .heading = "interval\nfrom", .page = {.rank = 4, .digits = 4},
     .terminal = {.rank = 4, .digits = 4}},
    {FG_NUMBER("high", fg_experiment_effect, high), .options = FG_MEMBER_NOT_IN_JSON,
     .heading = "\nto", .page = {.rank = 4, .digits = 4}, .terminal = {.rank = 4, .digits = 4}},
    {FG_NUMBER_BY("vif", find_vif), .words = "variance inflation factor", .heading = "VIF",
     .page = {.rank = 5, .digits = 4}},
    {FG_NUMBER("u_measurement", fg_experiment_effect, u_measurement),
     .options = FG_MEMBER_NOT_NEGATIVE, .words = "part of the standard error by the measurement",
     .heading = "of it\nmeasurement", .page = {.rank = 2, .digits = 3}},
    {FG_NUMBER("contrast", fg_experiment_effect, contrast),
     .words = "estimate as in an orthogonal design of this size"},
    {FG_NUMBER("lenth_p_value", fg_experiment_effect, lenth_p_value), FG_P_VALUE,
     .words = "null without Lenth's test"},
    {FG_WORD_BY("stratum", find_stratum, fg_doe_stratum_words),
     .words = "scatter it is tested against; null: no whole plots"},
};
const fg_members fg_doe_coefficient_members = {.rows = coefficient_rows,
                                               .count = sizeof coefficient_rows /
                                                        sizeof *coefficient_rows,
                                               .definition = "coefficient",
                                               .look = look_at_coefficient};

static double find_confidence(const fg_subject *s) {
  return fg_doe_experiment_at(s)->confidence;
}

static const char *find_formula(const fg_subject *s, char *buffer) {
  (void)buffer;
  return fg_doe_experiment_at(s)->formula;
}

static const char *find_response(const fg_subject *s, char *buffer) {
  (void)buffer;
  return fg_doe_experiment_at(s)->response;
}

static const char *find_block(const fg_subject *s, char *buffer) {
  (void)buffer;
  return fg_doe_experiment_at(s)->block;
}

static const char *const sign_words[] = {"as-is", "magnitude", NULL};

static int find_sign(const fg_subject *s) {
  return fg_doe_experiment_at(s)->magnitude;
}

static const char *find_plan_path(const fg_subject *s, char *buffer) {
  (void)buffer;
  return fg_doe_whole_at(s)->report->plan_path;
}

static const char *find_plan_note(const fg_subject *s, char *buffer) {
  (void)buffer;
  return fg_doe_whole_at(s)->report->plan_note;
}

static const char *conclusion_at(const fg_subject *s, size_t i) {
  const fg_sentences *all = fg_doe_whole_at(s)->conclusions;
  return i < all->count ? all->text[i] : NULL;
}

static const char *note_at(const fg_subject *s, size_t i) {
  const fg_experiment *e = fg_doe_experiment_at(s);
  return i < e->notes ? e->note[i] : NULL;
}

static const fg_member report_rows[] = {
    {FG_HEAD("foilgauge/doe/1")},
    {FG_LIST_BY("inputs", find_input, &input_members), .lowest = 1,
     .words = "the run sheet, the loop's model, the scans"},
    {FG_TEXT_BY("response", find_response), .options = FG_MEMBER_NEVER_NULL, .words = "its column"},
    {FG_WORD_BY("sign", find_sign, sign_words), .options = FG_MEMBER_NEVER_NULL,
     .words = "magnitude: |response| is modelled, as in the thesis"},
    {FG_TEXT_BY("formula", find_formula), .options = FG_MEMBER_NEVER_NULL, .words = "of the model"},
    {FG_TEXT_BY("block", find_block), .words = "column that names the blocks; null: none"},
    {FG_NUMBER_BY("confidence", find_confidence), .options = FG_MEMBER_NEVER_NULL, .highest = 1,
     .words = "of every interval"},
    {FG_TEXT_BY("plan", find_plan_path),
     .words = "plan whose limits code the factors and whose steps round the best setting; null: "
              "none"},
    {FG_TEXT_BY("plan_note", find_plan_note),
     .words = "oddity of the plan: it is lost, or runs were made at other settings"},
    {FG_TEXTS_BY("conclusions", conclusion_at), .words = "in plain words"},
    {FG_TEXTS_BY("notes", note_at), .words = "results that could not be computed, with the reason"},
    {FG_PART("taken_out", find_subtracted, &subtracted_members),
     .words = "effects of a loop's model, subtracted from the response before the analysis; null: "
              "none"},
    {FG_LIST_BY("factors", find_factor, &factor_members), .words = "numeric ones"},
    {FG_LIST_BY("coefficients", fg_doe_coefficient_at, &fg_doe_coefficient_members), .lowest = 1},
    {FG_SAME(&fg_doe_analysis_members)},
    {FG_SAME(&fg_doe_result_members)},
};
static const fg_members report_members = FG_MEMBERS(report_rows);

const fg_document fg_doe_document = {
    .file = "doe",
    .title = "foilgauge report of an experiment",
    .description = "null is a value that is not known.",
    .made_by = "`foilgauge doe -o`",
    .members = &report_members,
};

fg_status fg_experiment_write_json(fg_context *ctx, const fg_experiment_report *report, FILE *out) {
  fg_sentences conclusions;
  fg_doe_whole whole;
  FG_TRY(fg_experiment_conclusions(ctx, report, &conclusions));
  fg_status status = FG_OK;
  fg_doe_whole_of(report, &conclusions, &whole);
  if (report->experiment->has_order && fg_order_seen(&report->experiment->order))
    status = fg_experiment_loop_command(ctx, report, &whole.command);
  if (status == FG_OK) fg_document_json(out, &report_members, &whole);
  if (status == FG_OK) status = fg_stream_finish(ctx, out, "the JSON report");
  free(whole.command);
  fg_sentences_free(&conclusions);
  return status;
}
