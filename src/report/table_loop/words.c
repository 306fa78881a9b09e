/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Candidates, claims and alias classes of the loop on tables, in words for people. */
#include "report/table_loop/words.h"

#include <math.h>
#include <string.h>

#include "core/text.h"
#include "report/table_loop/cycle_words.h"

fg_loop_number fg_loop_number_text(const char *format, double value) {
  fg_loop_number out;
  if (isfinite(value))
    snprintf(out.text, sizeof out.text, format, value);
  else
    snprintf(out.text, sizeof out.text, "-");
  return out;
}

/* P-value below which further digits have no meaning. */
#define P_MIN 1e-12

fg_loop_number fg_loop_p_text(double p) {
  return fg_loop_number_text(p < P_MIN ? "p < %.0e" : "p = %.2g", fmax(p, P_MIN));
}

static void append_words(char *text, const char *words) {
  size_t used = strlen(text);
  fg_text_clip(text + used, FG_LOOP_WORDS - used, "%s", words);
}

/* "row 3", "rows 2, 5 and 54", or the rows' own names. */
static void list_rows(const fg_loop_report *report, const fg_loop_candidate *candidate,
                      char text[FG_LOOP_WORDS]) {
  size_t count = candidate->effect->outlier == FG_LOOP_EXCHANGED_ROWS ? 2 : candidate->rows;
  for (size_t k = 0; k < count; k++) {
    size_t row = report->problem->row[candidate->row[k]];
    char number[32];
    if (k) append_words(text, k + 1 == count ? " and " : ", ");
    if (!k && !report->row_name) append_words(text, count > 1 ? "rows " : "row ");
    snprintf(number, sizeof number, "%zu", row + 1);
    append_words(text, report->row_name ? report->row_name[row] : number);
  }
}

void fg_loop_rows_words(const fg_loop_report *report, const fg_loop_candidate *candidate,
                        char text[FG_LOOP_WORDS]) {
  *text = 0;
  list_rows(report, candidate, text);
}

/* "weight and height": the columns that hold each other's value. */
static void append_columns(const fg_loop_report *report, const fg_loop_candidate *candidate,
                           char text[FG_LOOP_WORDS]) {
  const fg_loop_coordinate *at = report->problem->problem.coordinate;
  append_words(text, at[candidate->a].name);
  append_words(text, " and ");
  append_words(text, at[candidate->b].name);
}

static void outlier_words(const fg_loop_report *report, const fg_loop_candidate *candidate,
                          char text[FG_LOOP_WORDS]) {
  bool exchange = candidate->effect->outlier == FG_LOOP_EXCHANGED_ROWS;
  if (!exchange && !candidate->rows) {
    append_words(text, candidate->effect->words);
    return;
  }
  if (candidate->effect->pair) {
    append_words(text, "an exchange of ");
    append_columns(report, candidate, text);
    append_words(text, " in ");
    list_rows(report, candidate, text);
    return;
  }
  append_words(text, exchange              ? "an exchange of "
                     : candidate->rows > 1 ? "wrong responses in "
                                           : "a wrong response in ");
  list_rows(report, candidate, text);
}

void fg_loop_candidate_words(const fg_loop_report *report, const fg_loop_candidate *candidate,
                             char text[FG_LOOP_WORDS]) {
  *text = 0;
  if (candidate->effect->accepts)
    fg_loop_effect_words(&report->problem->problem, candidate, text, FG_LOOP_WORDS);
  else
    outlier_words(report, candidate, text);
}

void fg_loop_alias_words(const fg_loop_report *report, const fg_loop_alias *alias,
                         char text[2 * FG_LOOP_WORDS]) {
  char second[FG_LOOP_WORDS];
  fg_loop_candidate_words(report, &alias->candidate, text);
  if (!alias->sum) return;
  fg_loop_candidate_words(report, &alias->second, second);
  size_t used = strlen(text);
  fg_text_clip(text + used, 2 * FG_LOOP_WORDS - used, " together with %s", second);
}

void fg_loop_closeness_words(const fg_loop_alias *alias, char text[FG_LOOP_WORDS]) {
  double percent = 100 * fabs(alias->loss);
  *text = 0;
  if (!isfinite(alias->loss)) return;
  if (percent < 0.5)
    fg_text_clip(text, FG_LOOP_WORDS, "explains as much");
  else
    fg_text_clip(text, FG_LOOP_WORDS, "explains %.0f %% %s", percent,
                 alias->loss > 0 ? "less" : "more");
}

static void outlier_statement(const fg_loop_report *report, const fg_loop_candidate *candidate,
                              char text[FG_LOOP_WORDS]) {
  list_rows(report, candidate, text);
  if (candidate->effect->pair) {
    append_words(text, " has ");
    append_columns(report, candidate, text);
    append_words(text, " in each other's place");
    return;
  }
  append_words(text, candidate->effect->outlier == FG_LOOP_EXCHANGED_ROWS ? " changed places"
                     : candidate->rows > 1                                ? " are wrong"
                                                                          : " is wrong");
}

const char *fg_loop_row_words(const fg_loop_coordinate *at) {
  if (!at) return "rows";
  return !strcmp(at->name, "run") ? "runs" : at->roles & FG_LOOP_BUMP ? "bumps" : "rows";
}

/* By the slope of the residuals' log sizes over the coordinate, which single large rows hardly
 * influence. */
int fg_loop_spread_direction(const fg_loop_report *report, const fg_loop_claim *claim) {
  const fg_loop_problem *problem = &report->problem->problem;
  const fg_loop_coordinate *at = &problem->coordinate[claim->candidate.a];
  const double *residual = report->result->after_fit;
  double floor = 0.1 * report->result->after.rms;
  double rows = (double)problem->rows, mean = 0, sum = 0;
  if (fg_loop_spread_by_levels(problem, &claim->candidate)) return 0;
  for (size_t i = 0; i < problem->rows; i++)
    mean += at->value[i] / rows;
  for (size_t i = 0; i < problem->rows; i++)
    sum += (at->value[i] - mean) * log(fabs(residual[i]) + floor);
  return sum < 0 ? -1 : 1;
}

static void spread_statement(const fg_loop_report *report, const fg_loop_claim *claim,
                             char text[FG_LOOP_WORDS]) {
  const char *name = report->problem->problem.coordinate[claim->candidate.a].name;
  fg_loop_number times = fg_loop_number_text("%.2g", claim->noise_value);
  int direction = fg_loop_spread_direction(report, claim);
  if (direction)
    fg_text_clip(text, FG_LOOP_WORDS,
                 "the scatter %s with %s: %s times from the smallest to the largest",
                 direction > 0 ? "grows" : "falls", name, times.text);
  else
    fg_text_clip(text, FG_LOOP_WORDS,
                 "the scatter differs over %s: the largest is %s times the smallest", name,
                 times.text);
}

/* With where it is, or how often it returns: several may live on one coordinate. */
static void mean_statement(const fg_loop_report *report, const fg_loop_claim *claim,
                           char text[FG_LOOP_WORDS]) {
  const fg_loop_effect *effect = claim->candidate.effect;
  char place[FG_LOOP_NAME];
  fg_loop_candidate_words(report, &claim->candidate, text);
  if (effect->cycle) {
    char period[FG_LOOP_WORDS];
    fg_loop_period_words(report, claim, period, sizeof period);
    append_words(text, period);
  }
  if (effect->shapes != 1 || strcmp(effect->shape_name[0], "at") != 0) return;
  fg_text_clip(place, sizeof place, " at %.6g", claim->shape[0]);
  append_words(text, place);
}

/* Returns a column of words each of whose levels holds whole levels of `at`; NULL: none. */
static const fg_loop_coordinate *outer_of(const fg_loop_problem *problem,
                                          const fg_loop_coordinate *at) {
  for (size_t c = 0; c < problem->coordinates; c++) {
    const fg_loop_coordinate *outer = &problem->coordinate[c];
    bool holds = outer != at && outer->levels > 1 && outer->levels < at->levels;
    for (size_t i = 0; holds && i < problem->rows; i++)
      for (size_t k = 0; holds && k < i; k++)
        holds = at->value[i] != at->value[k] || outer->value[i] == outer->value[k];
    if (holds) return outer;
  }
  return NULL;
}

static void levels_statement(const fg_loop_report *report, const fg_loop_claim *claim,
                             char text[FG_LOOP_WORDS]) {
  const fg_loop_problem *problem = &report->problem->problem;
  const fg_loop_coordinate *at = &problem->coordinate[claim->candidate.a];
  const fg_loop_coordinate *outer = outer_of(problem, at);
  fg_text_clip(text, FG_LOOP_WORDS, "the %zu levels of %s scatter%s%s", at->levels, at->name,
               outer ? " within " : "", outer ? outer->name : "");
}

void fg_loop_claim_words(const fg_loop_report *report, const fg_loop_claim *claim,
                         char text[FG_LOOP_WORDS]) {
  const fg_loop_effect *effect = claim->candidate.effect;
  const fg_loop_coordinate *at = &report->problem->problem.coordinate[claim->candidate.a];
  *text = 0;
  if (!effect->accepts)
    outlier_statement(report, &claim->candidate, text);
  else if (effect->scatter == FG_LOOP_SERIAL)
    fg_text_clip(text, FG_LOOP_WORDS, "neighbouring %s are alike", fg_loop_row_words(at));
  else if (effect->scatter == FG_LOOP_SPREAD)
    spread_statement(report, claim, text);
  else if (effect->scatter == FG_LOOP_LEVELS)
    levels_statement(report, claim, text);
  else
    mean_statement(report, claim, text);
}

const char *fg_loop_rejected_word(const fg_loop_rejected *rejected) {
  return rejected->verdict == FG_LOOP_ABSORBED ? "in the model already"
                                               : fg_loop_verdict_word(rejected->verdict);
}

bool fg_loop_claims_scatter(const fg_loop_result *result, fg_loop_scatter scatter) {
  for (size_t i = 0; i < result->claims; i++)
    if (result->claim[i].candidate.effect->scatter == scatter) return true;
  return false;
}

bool fg_loop_has_after(const fg_loop_result *result) {
  return result->has_curve || fg_loop_claims_scatter(result, FG_LOOP_OF_THE_MEAN) ||
         fg_loop_claims_scatter(result, FG_LOOP_SERIAL);
}

/* Returns true when left-out rows test the findings. A left-out outlier row predicts nothing, nor
 * do neighbours when all of them are left out: then cross-validation cannot test the finding. */
static bool left_out_tells(const fg_loop_result *result) {
  bool tells = fg_loop_has_after(result) && !fg_loop_claims_scatter(result, FG_LOOP_SERIAL);
  for (size_t i = 0; i < result->claims; i++)
    tells = tells && result->claim[i].candidate.effect->outlier == FG_LOOP_NOT_OUTLIER;
  return tells;
}

size_t fg_loop_error_rows(const fg_loop_report *report,
                          fg_loop_error_row rows[FG_LOOP_ERROR_ROWS]) {
  const fg_loop_result *result = report->result;
  const fg_loop_problem *problem = &report->problem->problem;
  const fg_loop_error *before = &result->before, *after = &result->after;
  bool grouped = problem->groups < problem->rows;
  const fg_loop_error_row all[FG_LOOP_ERROR_ROWS] = {
      {"rms", before->rms, after->rms},
      {"robust sd", before->robust_sd, after->robust_sd},
      {"95th percentile", before->p95, after->p95},
      {"maximum", before->maximum, after->maximum},
      {fg_loop_has_after(result) ? "rows that took no part in the search, rms"
       : grouped                 ? "each group predicted from the others, rms"
                                 : "each row predicted from the others, rms",
       before->held_out_rms, after->held_out_rms},
      {grouped ? "each group predicted from the others, rms"
               : "each row predicted from the others, rms",
       left_out_tells(result) ? before->cross_validated_rms : NAN, after->cross_validated_rms}};
  size_t count = 0;
  for (size_t i = 0; i < FG_LOOP_ERROR_ROWS; i++)
    if (isfinite(all[i].before)) rows[count++] = all[i];
  return count;
}

const char *fg_loop_check_answer(const fg_loop_checked *check) {
  return check->failed ? "no" : check->p_value <= FG_LOOP_SUSPECTED_P ? "not sure" : "yes";
}

bool fg_loop_suspects_residual(const fg_loop_result *result, fg_loop_check *check) {
  double min = FG_LOOP_SUSPECTED_P, tests = 0;
  bool suspected = false;
  for (size_t k = 0; k < FG_LOOP_CHECKS; k++)
    tests += result->check[k].done;
  for (size_t k = 0; k < FG_LOOP_CHECKS && result->verdict == FG_LOOP_CLEAN; k++) {
    if (!result->check[k].done || !(tests * result->check[k].p_value <= min)) continue;
    min = tests * result->check[k].p_value;
    *check = (fg_loop_check)k;
    suspected = true;
  }
  return suspected;
}
