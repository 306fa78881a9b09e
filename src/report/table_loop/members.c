/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "foilgauge/loop/1" of tables: the document's rows. Rows of a table are numbered from its first
 * data row, 1. */
#include "report/table_loop/members.h"
#include "report/table_loop/influence_members.h"
#include "report/table_loop/scale_members.h"

#include <math.h>
#include <stdlib.h>

#include "core/file.h"
#include "foilgauge/words.h"
#include "report/table_loop/checks.h"
#include "report/table_loop/claim_members.h"
#include "report/table_loop/family_members.h"
#include "report/table_loop/next.h"
#include "report/table_loop/reading.h"
#include "report/table_loop/suspect_members.h"

/* Finding that no listed effect explains: a curve, or that of a failed residual test. */
typedef struct loop_finding {
  int kind; /* of fg_loop_finding_kinds */
  char coordinate[FG_LOOP_WORDS];
  const double (*shape)[2];
  size_t points;
  double rms, p_value;
  const size_t *nearest; /* rows of the problem */
  size_t nearest_count;
} loop_finding;

/* The report with what its rows need beside it. */
typedef struct loop_whole {
  fg_loop_report report; /* first: the whole of subjects */
  fg_loop_table_spec spec;
  fg_loop_result result; /* owns nothing */
  char *summary;
  fg_loop_input table;
  size_t rows, held_out, groups;
  const char *noise_model, *excluded;
  double range_rows; /* after which a correlation has fallen to 1/e */
  double ratio_cross_validated, ratio_noise_floor;
  loop_finding finding;
} loop_whole;

static const loop_whole *whole_of(const fg_subject *subject) {
  return subject->whole;
}

/* Inputs: the first is the table. */
static bool find_loop_input(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_loop_report *report = list->whole;
  element->object = i ? &report->input[i - 1] : &whole_of(list)->table;
  return i <= report->inputs;
}

static bool is_table(const fg_subject *input) {
  return input->index == 0;
}

static bool is_source(const fg_subject *input) {
  return input->index > 0;
}

static double count_rows(const fg_subject *subject) {
  return (double)whole_of(subject)->rows;
}

static double count_held_out(const fg_subject *subject) {
  return (double)whole_of(subject)->held_out;
}

enum { LISTED_HELD_OUT = 1000 }; /* rows; more are only counted */

static bool find_held_out(const fg_subject *list, size_t i, fg_subject *element) {
  const loop_whole *whole = list->whole;
  const bool *held_out = whole->report.problem->problem.held_out;
  element->object = held_out && held_out[i % whole->rows] ? whole : NULL;
  return held_out && whole->held_out <= LISTED_HELD_OUT && i < whole->rows;
}

static double find_held_out_row(const fg_subject *element) {
  return (double)whole_of(element)->report.problem->row[element->index] + 1;
}

static const fg_member held_out_rows[] = {{FG_COUNT_BY(NULL, find_held_out_row), .lowest = 1}};
static const fg_members held_out_members = FG_MEMBERS(held_out_rows);

static const fg_member input_rows[] = {
    {FG_STRING("path", fg_loop_input, path), .options = FG_MEMBER_NEVER_NULL},
    {FG_STRING("sha256", fg_loop_input, sha256), .options = FG_MEMBER_EMPTY_IS_NULL,
     .words = "null: a scan that could not be read"},
    {FG_COUNT_BY("rows", count_rows),
     .words = "of the table, those of the search and held-out ones", .present = is_table},
    {FG_COUNT_BY("rows_kept_aside", count_held_out), .words = "held-out rows", .present = is_table},
    {FG_LIST_BY("kept_aside", find_held_out, &held_out_members),
     .options = FG_MEMBER_LIST_ON_LINE | FG_MEMBER_ENDS_BELOW, .present = is_table,
     .words = "their numbers; empty above 1000"},
};
static const fg_members input_members = FG_MEMBERS(input_rows);

static const fg_member declared_rows[] = {
    {FG_STRING("response", loop_whole, spec.response), .options = FG_MEMBER_NEVER_NULL,
     .words = "column"},
    {FG_STRING("model", loop_whole, spec.model), .options = FG_MEMBER_NEVER_NULL,
     .words = "formula, or arc_length"},
    {FG_STRING("offset", loop_whole, spec.offset),
     .words = "column of predictions, taken from the response before the model is fitted"},
    {FG_STRING("group", loop_whole, spec.group), .words = "column; null: each row is its own"},
    {FG_COUNT("groups", loop_whole, groups), .words = "drawn independently"},
};
static const fg_members declared_members = FG_MEMBERS(declared_rows);

static const fg_member noise_rows[] = {
    {FG_NUMBER("sd", loop_whole, result.noise.sd),
     .words = "of one row, its group's level included"},
    {FG_NUMBER("correlation", loop_whole, result.noise.rho),
     .words = "of neighbours along the order"},
    {FG_NUMBER("group_to_row_variance", loop_whole, result.noise.lambda),
     .words = "variance of the groups' level over that of a row"},
    {FG_STRING("form", loop_whole, noise_model), .options = FG_MEMBER_NEVER_NULL,
     .words = "noise model of the rows' scatter"},
    {FG_NUMBER("range_rows", loop_whole, range_rows),
     .options = FG_MEMBER_NEVER_NULL | FG_MEMBER_NOT_NEGATIVE,
     .words = "rows after which a correlation has fallen to 1/e"},
};
static const fg_members noise_members = FG_MEMBERS(noise_rows);

static const char *no_foil_at(const fg_subject *subject, size_t i) {
  (void)subject;
  (void)i;
  return NULL;
}

static const fg_member error_rows[] = {
    {FG_NUMBER("rms", fg_loop_error, rms)},
    {FG_NUMBER("held_out_rms", fg_loop_error, held_out_rms),
     .words =
         "of held-out rows; without any, of each fold of groups with the whole search repeated "
         "without it"},
    {FG_NUMBER("cross_validated_rms", fg_loop_error, cross_validated_rms),
     .words = "of each group, predicted from the others with the effects found in all"},
    {FG_NUMBER("robust_sd", fg_loop_error, robust_sd)},
    {FG_NUMBER("p95", fg_loop_error, p95), .words = "95th percentile of the sizes"},
    {FG_NUMBER("maximum", fg_loop_error, maximum)},
    {FG_TEXTS_BY("foils", no_foil_at), .schema = "{\"type\": \"array\", \"maxItems\": 0}",
     .words = "empty: of scans only"},
};
static const fg_members error_members = FG_MEMBERS_DEFINED(error_rows, "error");

static const fg_member ratio_rows[] = {
    {FG_NUMBER("rms", loop_whole, result.ratio_rms)},
    {FG_NUMBER("held_out", loop_whole, result.ratio_held_out), .words = "of held_out_rms"},
    {FG_NUMBER("cross_validated", loop_whole, ratio_cross_validated),
     .words = "of cross_validated_rms"},
    {FG_RANGE("interval_95", loop_whole, result.ratio_interval[0], result.ratio_interval[1]),
     .words = "of the rms's ratio, 95 %"},
    {FG_NUMBER("after_to_noise_floor", loop_whole, ratio_noise_floor),
     .words = "rms after the loop over the noise floor"},
};
static const fg_members ratio_members = FG_MEMBERS(ratio_rows);

static fg_subject find_unattributed(const fg_subject *subject) {
  const loop_finding *finding = &whole_of(subject)->finding;
  return (fg_subject){.object = finding->kind < 0 ? NULL : finding, .whole = subject->whole};
}

static const fg_member finding_rows[] = {
    {FG_WORD("kind", loop_finding, kind, fg_loop_finding_kinds),
     .words = "a curve over the coordinate, or the residual test that fails"},
    {FG_TEXT("coordinate", loop_finding, coordinate),
     .words = "column; of a test it may be several"},
    {FG_LIST("shape", loop_finding, shape, points, &fg_loop_point_members),
     .words = "the curve: coordinate and value, straight between them; empty for a test"},
    {FG_NUMBER("rms", loop_finding, rms), .words = "of the curve, or of the deviation tested"},
    {FG_NUMBER("p_value", loop_finding, p_value)},
    {FG_LIST("nearest", loop_finding, nearest, nearest_count, &fg_loop_row_members),
     .words = "rows that it moves most; of settings one row each"},
};
static const fg_members finding_members = FG_MEMBERS(finding_rows);

static fg_subject find_scale(const fg_subject *subject) {
  const fg_loop_response_scale *scale = &whole_of(subject)->result.scale;
  bool told = scale->known && scale->chosen != 1;
  return (fg_subject){.object = told ? scale : NULL, .whole = subject->whole};
}

static const fg_member advice_rows[] = {
    {FG_TEXT("advice", fg_loop_advice, text), .words = "measurement that tells explanations apart"},
    {FG_NUMBER("runs", fg_loop_advice, runs),
     .words = "number at either setting that a power of 80 % needs; null: no number suffices"},
};
static const fg_members advice_members = FG_MEMBERS(advice_rows);

/* The report. */
static int find_domain(const fg_subject *subject) {
  (void)subject;
  return 0;
}

static bool find_next_step(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = list->whole;
  return i < fg_loop_next_count(list->whole);
}

static const char *find_step_words(const fg_subject *step, char *buffer) {
  fg_loop_next_step(step->whole, step->index, buffer);
  return buffer;
}

static const char *loop_note_at(const fg_subject *subject, size_t i) {
  const loop_whole *whole = subject->object;
  if (whole->report.said && i == 0) return whole->report.said;
  i -= whole->report.said != NULL;
  return i < whole->result.notes ? whole->result.note[i] : NULL;
}

static const char *const domains[] = {"table", NULL};

static const fg_member step_rows[] = {
    {FG_TEXT_BY(NULL, find_step_words), .options = FG_MEMBER_NEVER_NULL}};
static const fg_members step_members = FG_MEMBERS(step_rows);

static const fg_member loop_rows[] = {
    {FG_HEAD("foilgauge/loop/1")},
    {FG_WORD_BY("domain", find_domain, domains), .options = FG_MEMBER_NEVER_NULL},
    {FG_WORD("verdict", loop_whole, result.verdict, fg_loop_outcome_words),
     .words = "of the declared model"},
    {FG_STRING("summary", loop_whole, summary), .options = FG_MEMBER_NEVER_NULL,
     .words = "outcome in a sentence"},
    {FG_LIST_BY("inputs", find_loop_input, &input_members), .options = FG_MEMBER_ENDS_BELOW,
     .line = is_source, .lowest = 1,
     .words = "the table, with its rows (for a lot its results, for runs the sheet); then its "
              "sources: a lot's manifest and recipe, the scans of the runs"},
    {FG_GROUP("declared", &declared_members), .words = "the declared model"},
    {FG_SEED("seed", loop_whole, report.seed), .words = "of held-out rows that a share chooses"},
    {FG_NUMBER("noise_floor", loop_whole, result.noise_floor),
     .words = "standard deviation of a row's noise, in the response's unit"},
    {FG_NUMBER("family_p_value", loop_whole, result.family_p), .lowest = 0, .highest = 1,
     .words = "smallest p-value of all candidates of the first step"},
    {FG_OBJECT("family_shares", loop_whole, result, &fg_loop_share_members),
     .options = FG_MEMBER_ON_LINE,
     .words = "of each kind of candidate in the error rate, whatever the number of its candidates"},
    {FG_GROUP("noise", &noise_members), .words = "scatter that the search assumed"},
    {FG_OBJECT("before", loop_whole, result.before, &error_members),
     .words = "error of the declared model, in the response's unit"},
    {FG_ARRAY("claims", loop_whole, result.claim, result.claims, &fg_loop_claim_members),
     .lowest = 0, .highest = FG_LOOP_CLAIMS, .words = "effects found"},
    {FG_LIST_BY("suspects", fg_loop_find_suspect, &fg_loop_suspect_members),
     .options = FG_MEMBER_ENDS_BELOW, .highest = FG_LOOP_SUSPECTS,
     .words = "effects that are suspected, not proven (p over everything up to 0.1), the clearest "
              "first; only where nothing is claimed"},
    {FG_PART("unattributed", find_unattributed, &finding_members),
     .words = "deviation that no listed effect explains; null: none"},
    {FG_LIST_BY("battery", fg_loop_find_check, &fg_loop_check_members),
     .words = "residual tests, beside all claims; the verdict clean needs that all are passed. A "
              "test that the table does not offer is left out"},
    {FG_OBJECT("after", loop_whole, result.after, &error_members),
     .words = "error with the effects found"},
    {FG_GROUP("error_ratio", &ratio_members), .words = "error after over error before"},
    {FG_LIST_BY("declared_parameters", fg_loop_find_parameter, &fg_loop_parameter_members),
     .options = FG_MEMBER_ON_LINE | FG_MEMBER_ENDS_BELOW, .words = "of the declared model"},
    {FG_PART("response_scale", find_scale, &fg_loop_scale_members),
     .words =
         "power of the response on which effects add; null: not known, or the response itself"},
    {FG_ARRAY("influence", loop_whole, result.influence, result.influences,
              &fg_loop_influence_members),
     .highest = FG_LOOP_INFLUENCES,
     .words = "rows that lead the fit beside everything found: Cook's distance beyond the median "
              "of F; the largest first"},
    {FG_LIST("rejected", loop_whole, result.rejected, result.rejects, &fg_loop_rejected_members),
     .options = FG_MEMBER_ON_LINE | FG_MEMBER_ENDS_BELOW,
     .words = "candidates that are not claimed"},
    {FG_ARRAY("separating_measurement", loop_whole, result.advice, result.advices, &advice_members),
     .words = "for each claim that is tied"},
    {FG_LIST_BY("next_steps", find_next_step, &step_members),
     .words = "what to do about each finding"},
    {FG_STRING("not_candidates", loop_whole, excluded),
     .words = "columns that no effect may use, with the reason; null: none"},
    {FG_TEXTS_BY("notes", loop_note_at), .words = "what else to know"},
};
static const fg_members loop_members = FG_MEMBERS(loop_rows);

const fg_document fg_loop_document = {
    .file = "loop",
    .title = "foilgauge loop report",
    .description = "Of tables. null is a value that is not known.",
    .made_by = "`foilgauge loop --table`, `--lot` or `--doe` with `-o`",
    .members = &loop_members,
};

static loop_finding make_finding(const fg_loop_report *report) {
  const fg_loop_result *result = report->result;
  const fg_loop_curve *curve = &result->curve;
  const fg_loop_checked *failed = &result->check[result->failed];
  loop_finding finding = {.kind = -1};
  if (result->has_curve) {
    finding = (loop_finding){.kind = 0,
                             .shape = (const double(*)[2])curve->shape,
                             .points = curve->count,
                             .rms = curve->rms,
                             .p_value = curve->p_value,
                             .nearest = curve->nearest,
                             .nearest_count = curve->nearest_count};
    snprintf(finding.coordinate, sizeof finding.coordinate, "%s", curve->name);
  } else if (result->fails) {
    finding = (loop_finding){.kind = 1 + (int)result->failed,
                             .rms = failed->rms,
                             .p_value = failed->p_value,
                             .nearest = failed->worst,
                             .nearest_count = failed->worst_count};
    fg_loop_failed_coordinate(report, finding.coordinate);
  }
  return finding;
}

/* Derived numbers of the report; its result stays the owner of everything. */
static loop_whole make_whole(const fg_loop_report *report) {
  const fg_loop_problem *problem = &report->problem->problem;
  const fg_loop_result *result = report->result;
  double rho = result->noise.rho;
  loop_whole whole = {
      .report = *report,
      .spec = *report->spec,
      .result = *result,
      .table = {report->path, report->sha256},
      .rows = problem->rows,
      .groups = problem->groups,
      .noise_model = fg_loop_noise_model(result),
      .excluded = report->problem->excluded,
      .range_rows = rho > 0 ? -1 / log(rho) : 0,
      .ratio_cross_validated =
          result->after.cross_validated_rms / result->before.cross_validated_rms,
      .ratio_noise_floor = result->after.rms / result->noise_floor,
      .finding = make_finding(report),
  };
  for (size_t i = 0; problem->held_out && i < problem->rows; i++)
    whole.held_out += problem->held_out[i];
  return whole;
}

fg_status fg_loop_write_json(fg_context *ctx, const fg_loop_report *report, FILE *out) {
  loop_whole whole = make_whole(report);
  FG_TRY(fg_loop_sentence(ctx, report, &whole.summary));
  fg_document_json(out, &loop_members, &whole);
  free(whole.summary);
  return fg_stream_finish(ctx, out, "the loop's report");
}
