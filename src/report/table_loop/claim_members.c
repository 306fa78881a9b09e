/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/table_loop/claim_members.h"

#include <math.h>
#include <string.h>

#include "page/page.h"
#include "report/table_loop/checks.h"
#include "report/table_loop/cycle_words.h"
#include "report/table_loop/reading.h"

static const fg_loop_report *report_of(const fg_subject *subject) {
  return subject->whole;
}

static const fg_loop_problem *problem_of(const fg_subject *subject) {
  return &report_of(subject)->problem->problem;
}

static const fg_loop_candidate *candidate_of(const fg_subject *claim) {
  return &((const fg_loop_claim *)claim->object)->candidate;
}

static double find_row_number(const fg_subject *row) {
  return (double)report_of(row)->problem->row[*(const size_t *)row->object] + 1;
}

static const fg_member row_rows[] = {{FG_COUNT_BY(NULL, find_row_number), .lowest = 1}};
const fg_members fg_loop_row_members = FG_MEMBERS(row_rows);

static const fg_member point_rows[] = {{.kind = FG_MEMBER_RANGE, .u_offset = sizeof(double)}};
const fg_members fg_loop_point_members = FG_MEMBERS(point_rows);

bool fg_loop_find_parameter(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = list->whole;
  return i < problem_of(list)->parameters;
}

static const char *find_parameter_name(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return problem_of(subject)->parameter_name[subject->index];
}

static double find_parameter_value(const fg_subject *subject) {
  return report_of(subject)->result->parameter[subject->index];
}

static double find_parameter_u(const fg_subject *subject) {
  return report_of(subject)->result->parameter_u[subject->index];
}

static const fg_member parameter_rows[] = {
    {FG_TEXT_BY("name", find_parameter_name), .options = FG_MEMBER_NEVER_NULL},
    {FG_NUMBER_BY("value", find_parameter_value), .u = find_parameter_u,
     .words = "fitted with all effects found"},
};
const fg_members fg_loop_parameter_members = FG_MEMBERS(parameter_rows);

/* Effects that a claim cannot be told from. */
static const char *find_alias_id(const fg_subject *alias, char *buffer) {
  (void)buffer;
  return ((const fg_loop_alias *)alias->object)->candidate.effect->id;
}

static const fg_member alias_rows[] = {
    {FG_TEXT("name", fg_loop_alias, name), .words = "with its columns"},
    {FG_TEXT_BY("id", find_alias_id), .options = FG_MEMBER_NEVER_NULL},
    {FG_FLAG("sum_of_two", fg_loop_alias, sum)},
    {FG_NUMBER("correlation", fg_loop_alias, correlation),
     .words = "of its best fit with the claim's, both beside the declared model"},
    {FG_NUMBER("loss", fg_loop_alias, loss),
     .words = "share of what the claim explains that it does not"},
};
const fg_members fg_loop_alias_members = FG_MEMBERS(alias_rows);

/* Claims. */
static bool is_of_rows(const fg_subject *claim) {
  return candidate_of(claim)->effect->outlier != FG_LOOP_NOT_OUTLIER;
}

static const char *find_claim_id(const fg_subject *claim, char *buffer) {
  (void)buffer;
  return candidate_of(claim)->effect->id;
}

static const char *find_claim_level(const fg_subject *claim, char *buffer) {
  (void)buffer;
  return problem_of(claim)->level;
}

static const char *claim_coordinate_at(const fg_subject *claim, size_t i) {
  const fg_loop_candidate *candidate = candidate_of(claim);
  if (is_of_rows(claim) || i > candidate->effect->pair) return NULL;
  return problem_of(claim)->coordinate[i ? candidate->b : candidate->a].name;
}

/* Returns the factor from the coefficient to a slope per unit of its column, or to a share of the
 * arc length; NaN for other bases. */
static double natural_unit(const fg_loop_report *report, const fg_loop_claim *claim) {
  const fg_loop_coordinate *at = &report->problem->problem.coordinate[claim->candidate.a];
  if (claim->candidate.effect->from_zero) return 1 / fmax(fabs(at->low), fabs(at->high));
  if (claim->candidate.effect->slope) return 2 / (at->high - at->low);
  return NAN;
}

static void write_claim_rows(fg_json *json, const fg_subject *subject) {
  const fg_loop_candidate *candidate = candidate_of(subject);
  bool pair = candidate->effect->outlier == FG_LOOP_EXCHANGED_ROWS;
  char name[32];
  for (size_t k = 0; k < (pair ? 2 : candidate->rows); k++) {
    snprintf(name, sizeof name, pair ? "second_row" : "row_%zu", k + 1);
    fg_json_number(json, k ? name : "row",
                   (double)report_of(subject)->problem->row[candidate->row[k]] + 1);
  }
}

/* Writes the parameters of an effect, whose names are the effect's: its coefficients per column,
 * its shapes, the scatter's number, the slope. */
static void write_claim_parameters(fg_json *json, const char *object, const fg_subject *subject) {
  const fg_loop_claim *claim = subject->object;
  const fg_loop_effect *effect = claim->candidate.effect;
  bool u = strcmp(object, "parameters") != 0;
  const double *coefficient = u ? claim->coefficient_u : claim->coefficient;
  double unit = natural_unit(report_of(subject), claim);
  char name[32];
  fg_json_object(json, object);
  for (size_t k = 0; k < claim->columns; k++) {
    snprintf(name, sizeof name, claim->columns > 1 ? "coefficient_%zu" : "coefficient", k + 1);
    fg_json_number(json, name, coefficient[k]);
  }
  for (size_t d = 0; d < effect->shapes; d++)
    fg_json_number(json, effect->shape_name[d], u ? claim->shape_u[d] : claim->shape[d]);
  if (effect->scatter != FG_LOOP_OF_THE_MEAN)
    fg_json_number(json,
                   effect->scatter == FG_LOOP_SERIAL   ? "correlation"
                   : effect->scatter == FG_LOOP_LEVELS ? "level_sd"
                                                       : "sd_ratio",
                   u ? claim->noise_value_u : claim->noise_value);
  if (isfinite(unit))
    fg_json_number(json, effect->from_zero ? "stretch" : "slope_per_unit", unit * coefficient[0]);
  if (!u && is_of_rows(subject)) write_claim_rows(json, subject);
  fg_json_object_end(json);
}

static bool has_row_names(const fg_subject *claim) {
  return report_of(claim)->row_name && is_of_rows(claim);
}

static const char *row_name_at(const fg_subject *claim, size_t i) {
  const fg_loop_candidate *candidate = candidate_of(claim);
  bool behind = i > (candidate->effect->outlier == FG_LOOP_EXCHANGED_ROWS);
  return behind ? NULL
                : report_of(claim)->row_name[report_of(claim)->problem->row[candidate->row[i]]];
}

const char *fg_loop_find_sentence(const fg_subject *claim, char buffer[FG_MEMBER_TEXT_MAX]) {
  fg_loop_claim_sentence(claim->whole, claim->object, buffer);
  return buffer;
}

static int find_confirmation(const fg_subject *claim) {
  int held_out = ((const fg_loop_claim *)claim->object)->held_out;
  return held_out < 0 ? 0 : held_out + 1;
}

static bool is_cycle(const fg_subject *claim) {
  return candidate_of(claim)->effect->cycle;
}

static int find_base_word(const fg_subject *claim) {
  return candidate_of(claim)->effect->held;
}

static const char *const base_words[] = {"sought", "known", NULL};
static const char *const levels[] = {"points", "bumps", "runs", NULL};
static const char *const claimed[] = {"found", "tied", NULL};
static const char *const confirmations[] = {"none kept aside", "not contradicted", "confirmed",
                                            NULL};

#define NUMBERS_BY_NAME                                                                            \
  "{\"type\": \"object\", \"additionalProperties\": {\"type\": [\"number\", \"null\"]}}"

/* Columns of people's tables. */
#define P_VALUE_COLUMN(rank_)                                                                      \
  { rank_, .heading = "p", .digits = 2, .min = 1e-12 }
#define ALIASES_COLUMN                                                                             \
  .name = "aliases", .kind = FG_MEMBER_STRING, .options = FG_MEMBER_NOT_IN_JSON,                   \
  .page = {.rank = 5, .heading = "could also be", .words = true}, .column = has_any_alias

/* Words first, the id small. */
static void put_effect_name(FILE *out, const char *words, const char *id) {
  fg_html_text(out, words);
  fputs(" <small>", out);
  fg_html_text(out, id);
  fputs("</small>", out);
}

static bool has_any_alias(const fg_subject *list) {
  const fg_loop_result *result = report_of(list)->result;
  size_t aliases = 0;
  for (size_t i = 0; i < result->claims; i++)
    aliases += result->claim[i].aliases;
  return aliases > 0;
}

static const char *find_claim_words(const fg_subject *claim, char *buffer) {
  fg_loop_claim_words(claim->whole, claim->object, buffer);
  return buffer;
}

static void put_claim_name(FILE *out, const fg_subject *claim) {
  char words[FG_MEMBER_TEXT_MAX];
  put_effect_name(out, find_claim_words(claim, words),
                  ((const fg_loop_claim *)claim->object)->name);
}

static const char *find_claim_size(const fg_subject *claim, char *buffer) {
  fg_loop_claim_size(claim->whole, claim->object, buffer);
  return buffer;
}

static void put_aliases(FILE *out, const fg_subject *subject) {
  const fg_loop_claim *claim = subject->object;
  char words[2 * FG_LOOP_WORDS];
  for (size_t k = 0; k < claim->aliases; k++) {
    fg_loop_alias_words(subject->whole, &claim->alias[k], words);
    put_effect_name(out, words, claim->alias[k].name);
  }
}

static const char *look_at_claim(const fg_subject *claim) {
  (void)claim;
  return "words claimed";
}

static const fg_member claim_rows[] = {
    {FG_TEXT_BY("effect", find_claim_words), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .heading = "effect", .words = true}, .markup = put_claim_name},
    {FG_TEXT_BY("size", find_claim_size), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 3, .heading = "difference, or what\nwould have shown", .words = true}},
    {ALIASES_COLUMN, .markup = put_aliases},
    {FG_TEXT_BY("id", find_claim_id), .options = FG_MEMBER_NEVER_NULL, .words = "effect"},
    {FG_TEXT("name", fg_loop_claim, name), .words = "effect with its columns"},
    {FG_TEXT_BY("level", find_claim_level), .options = FG_MEMBER_NEVER_NULL, .choices = levels,
     .words = "kind of the rows"},
    {FG_WORD("verdict", fg_loop_claim, verdict, claimed),
     .words = "tied: the data cannot tell it from those of alias_class",
     .page = {.rank = 2, .heading = "verdict", .words = true}, .look = look_at_claim},
    {FG_TEXTS_BY("coordinates", claim_coordinate_at), .words = "columns that it acts on"},
    {FG_ARRAY("rows", fg_loop_claim, candidate.row, candidate.rows, &fg_loop_row_members),
     .present = is_of_rows, .words = "of wrong or exchanged responses"},
    {FG_WRITTEN("parameters", write_claim_parameters, NUMBERS_BY_NAME),
     .words = "coefficients, and the numbers of its shape"},
    {FG_WRITTEN("uncertainty", write_claim_parameters, NUMBERS_BY_NAME),
     .words = "their standard uncertainties"},
    {FG_ARRAY("orders", fg_loop_claim, order, orders, &fg_loop_order_members), .present = is_cycle,
     .words = "of a cycle"},
    {FG_WORD_BY("base_period", find_base_word, base_words), .present = is_cycle,
     .options = FG_MEMBER_NEVER_NULL,
     .words = "known: declared, or a turn of an angle; sought: as uncertain as the rows leave it"},
    {FG_TEXTS_BY("row_names", row_name_at), .present = has_row_names,
     .words = "of a claim about single rows, where rows have names: foil and bump of a lot, run of "
              "a sheet"},
    {FG_TEXT_BY("sentence", fg_loop_find_sentence), .options = FG_MEMBER_NEVER_NULL,
     .words = "effect on the response, as a difference between two places, with U (95 %)"},
    {FG_NUMBER_U("amplitude", fg_loop_claim, amplitude, amplitude_u),
     .words = "half the range of the effect over the rows"},
    {FG_RANGE("amplitude_interval_95", fg_loop_claim, interval[0], interval[1]),
     .words = "of the amplitude"},
    {FG_NUMBER("p_value", fg_loop_claim, p_value), .words = "over all candidates together",
     .page = P_VALUE_COLUMN(4)},
    {FG_NUMBER("retained_share", fg_loop_claim, retained_share),
     .words = "share of the effect that the declared model does not take up"},
    {FG_NUMBER_U("cross_validated_gain", fg_loop_claim, cv_gain, cv_gain_se),
     .words = "by which the error of left-out groups falls; null for single rows"},
    {FG_WORD_BY("kept_aside", find_confirmation, confirmations), .options = FG_MEMBER_NEVER_NULL,
     .words = "the effect on held-out rows"},
    {FG_ARRAY("alias_class", fg_loop_claim, alias, aliases, &fg_loop_alias_members),
     .options = FG_MEMBER_ON_LINE | FG_MEMBER_ENDS_BELOW,
     .words = "effects that could take its place without a loss that the data show"},
    {FG_COUNT("aliases_not_listed", fg_loop_claim, aliases_unlisted), .words = "further ones"},
};
const fg_members fg_loop_claim_members = FG_MEMBERS(claim_rows);

/* Rejected candidates. */
static const char *find_rejected_id(const fg_subject *rejected, char *buffer) {
  (void)buffer;
  return ((const fg_loop_rejected *)rejected->object)->candidate.effect->id;
}

static int find_rejection(const fg_subject *rejected) {
  return (int)((const fg_loop_rejected *)rejected->object)->verdict - FG_LOOP_ABSENT;
}

static const char *find_rejected_words(const fg_subject *subject, char *buffer) {
  const fg_loop_rejected *rejected = subject->object;
  fg_loop_candidate_words(subject->whole, &rejected->candidate, buffer);
  return buffer;
}

static void put_rejected_name(FILE *out, const fg_subject *subject) {
  char words[FG_MEMBER_TEXT_MAX];
  put_effect_name(out, find_rejected_words(subject, words),
                  ((const fg_loop_rejected *)subject->object)->name);
}

static const char *find_rejected_verdict(const fg_subject *rejected, char *buffer) {
  (void)buffer;
  return fg_loop_rejected_word(rejected->object);
}

static double find_shows(const fg_subject *subject) {
  const fg_loop_rejected *rejected = subject->object;
  return fg_loop_readable_size(&rejected->candidate, rejected->smallest_detectable);
}

static void put_shows(FILE *out, const fg_subject *rejected) {
  double shows = find_shows(rejected);
  if (isfinite(shows)) fprintf(out, "≥ %.3g", shows);
  if (!isfinite(shows)) fputs("–", out);
}

static const char *find_no_alias(const fg_subject *rejected, char *buffer) {
  (void)rejected;
  (void)buffer;
  return NULL;
}

static const fg_member rejected_rows[] = {
    {FG_TEXT_BY("effect", find_rejected_words), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 1, .words = true}, .markup = put_rejected_name,
     .terminal = {.rank = 1, .heading = "not claimed", .words = true}},
    {FG_TEXT_BY("verdict_words", find_rejected_verdict), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 2, .words = true},
     .terminal = {.rank = 2, .heading = "verdict", .words = true}},
    {FG_NUMBER_BY("would_show", find_shows), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 3, .words = true}, .markup = put_shows,
     .terminal = {.rank = 4, .heading = "would show", .digits = 3}},
    {ALIASES_COLUMN, .text = find_no_alias},
    {FG_TEXT_BY("id", find_rejected_id), .options = FG_MEMBER_NEVER_NULL, .words = "effect"},
    {FG_TEXT("name", fg_loop_rejected, name), .words = "effect with its columns"},
    {FG_WORD_BY("verdict", find_rejection, fg_loop_verdict_words + FG_LOOP_ABSENT),
     .options = FG_MEMBER_NEVER_NULL,
     .words = "absent: it would have shown at the size that matters; inconclusive: only a larger "
              "one would have; absorbed: the declared model takes it up"},
    {FG_NUMBER("would_explain", fg_loop_rejected, would_explain),
     .words = "share of the residual sum that it explains alone"},
    {FG_NUMBER("p_value", fg_loop_rejected, p_value), .words = "over all candidates together",
     .page = P_VALUE_COLUMN(4), .terminal = P_VALUE_COLUMN(3)},
    {FG_NUMBER("retained_share", fg_loop_rejected, retained_share),
     .words = "share of the effect that the declared model does not take up"},
    {FG_NUMBER("smallest_amplitude", fg_loop_rejected, smallest_detectable),
     .words = "found with a power of 80 %; null: none would be"},
};
const fg_members fg_loop_rejected_members = FG_MEMBERS(rejected_rows);

/* Residual tests: the index is the test's. */
bool fg_loop_find_check(const fg_subject *list, size_t i, fg_subject *element) {
  const fg_loop_checked *check = report_of(list)->result->check;
  if (i >= FG_LOOP_CHECKS) return false;
  element->object = check[i].done ? &check[i] : NULL;
  return true;
}

static int find_test(const fg_subject *check) {
  return (int)check->index;
}

static bool is_lack_of_fit(const fg_subject *check) {
  return check->index < FG_LOOP_CHECK_LAGS;
}

static bool is_of_lags(const fg_subject *check) {
  return !is_lack_of_fit(check);
}

static bool is_of_one_lag(const fg_subject *check) {
  return check->index == FG_LOOP_CHECK_ONE_LAG;
}

static const char *find_question(const fg_subject *check, char *buffer) {
  fg_loop_check_words(check->whole, (fg_loop_check)check->index, buffer);
  return buffer;
}

static double is_passed(const fg_subject *check) {
  return !((const fg_loop_checked *)check->object)->failed;
}

static const char *find_answer(const fg_subject *check, char *buffer) {
  (void)buffer;
  return fg_loop_check_answer(check->object);
}

static const char *look_at_answer(const fg_subject *check) {
  return ((const fg_loop_checked *)check->object)->failed ? "words no" : "words";
}

static const fg_member check_rows[] = {
    {FG_TEXT_BY("answer", find_answer), .options = FG_MEMBER_NOT_IN_JSON,
     .page = {.rank = 2, .heading = "answer", .words = true}, .look = look_at_answer},
    {FG_WORD_BY("test", find_test, fg_loop_finding_kinds + 1), .options = FG_MEMBER_NEVER_NULL,
     .words = "lack_of_fit: rows of the same declared settings, an F ratio over their own scatter; "
              "lack_of_fit_all_columns: rows that agree in every recorded column; "
              "correlation_beyond_neighbours: rows 2 to lag apart, all together; "
              "correlation_at_one_lag: rows lag apart, the most alike or unlike"},
    {FG_TEXT_BY("asks", find_question), .options = FG_MEMBER_NEVER_NULL,
     .words = "question that a passed test answers with yes",
     .page = {.rank = 1, .heading = "test of all that is left", .words = true}},
    {FG_NUMBER("statistic", fg_loop_checked, statistic),
     .words = "F ratio, sum of squares of normal deviates, or the largest deviate"},
    {FG_RANGE("degrees_of_freedom", fg_loop_checked, dof[0], dof[1]),
     .options = FG_MEMBER_NEVER_NULL, .present = is_lack_of_fit, .words = "of the F ratio"},
    {FG_COUNT("lag", fg_loop_checked, lag), .present = is_of_lags, .lowest = 2},
    {FG_NUMBER("correlation", fg_loop_checked, correlation), .present = is_of_one_lag,
     .words = "at the lag"},
    {FG_NUMBER("p_value", fg_loop_checked, p_value), .options = FG_MEMBER_NEVER_NULL, .lowest = 0,
     .highest = 1, .page = P_VALUE_COLUMN(3)},
    {FG_NUMBER("level", fg_loop_checked, level), .options = FG_MEMBER_NEVER_NULL, .lowest = 0,
     .highest = 1, .words = "p-value below which it fails: its part of the level of all"},
    {FG_FLAG_BY("passed", is_passed)},
};
const fg_members fg_loop_check_members = FG_MEMBERS(check_rows);

/* Errors before and after, of people's tables alone. */
bool fg_loop_find_error(const fg_subject *list, size_t i, fg_subject *element) {
  element->object = (const fg_loop_error_row *)list->object + i;
  return i < list->index;
}

static bool is_with_after(const fg_subject *list) {
  return fg_loop_has_after(report_of(list)->result);
}

static bool is_before_alone(const fg_subject *list) {
  return !is_with_after(list);
}

static double find_error_ratio(const fg_subject *subject) {
  const fg_loop_error_row *row = subject->object;
  return row->after / row->before;
}

static const fg_member shown_error_rows[] = {
    {FG_STRING("error", fg_loop_error_row, name), .heading = "error",
     .page = {.rank = 1, .words = true}, .terminal = {.rank = 1, .words = true}},
    {FG_NUMBER("before", fg_loop_error_row, before), .heading = "before",
     .page = {.rank = 1, .digits = 4}, .terminal = {.rank = 1, .digits = 5},
     .column = is_with_after},
    {FG_NUMBER("size", fg_loop_error_row, before), .heading = "size",
     .page = {.rank = 1, .digits = 4}, .terminal = {.rank = 1, .digits = 5},
     .column = is_before_alone},
    {FG_NUMBER("after", fg_loop_error_row, after), .heading = "after",
     .page = {.rank = 1, .digits = 4}, .terminal = {.rank = 1, .digits = 5},
     .column = is_with_after},
    {FG_NUMBER_BY("ratio", find_error_ratio), .heading = "ratio",
     .page = {.rank = 1, .decimals = 3}, .terminal = {.rank = 1, .decimals = 3},
     .column = is_with_after},
};
const fg_members fg_loop_error_row_members = FG_MEMBERS(shown_error_rows);
