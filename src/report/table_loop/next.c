/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/table_loop/next.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "core/text.h"
#include "report/table_loop/checks.h"
#include "report/table_loop/suspect_members.h"

const char *fg_loop_outcome_meaning(const fg_loop_result *result) {
  fg_loop_check check;
  if (result->verdict == FG_LOOP_SUSPECTED || fg_loop_suspects_residual(result, &check))
    return "Something is suspected, nothing is proven.";
  if (result->verdict == FG_LOOP_CLEAN)
    return "The declared model is enough, as far as these data can tell.";
  if (result->verdict == FG_LOOP_UNATTRIBUTED)
    return "The declared model is not enough; what it lacks has no name here.";
  if (result->verdict == FG_LOOP_EXPLAINED)
    return "The declared model is not enough; what it lacks was found.";
  if (result->has_curve || result->fails)
    return "The declared model is not enough; what was found is not all that it lacks.";
  return fg_loop_has_after(result)
             ? "The declared model is not enough; what was found does not predict new rows better."
             : "The declared model may stand, but not one size of scatter for all rows.";
}

static void append_step_words(char text[FG_LOOP_STEP], const char *words) {
  size_t used = strlen(text);
  fg_text_clip(text + used, FG_LOOP_STEP - used, "%s", words);
}

/* Returns true for a name that a formula accepts without quotes. */
static bool is_plain_name(const char *name) {
  bool plain = isalpha((unsigned char)*name);
  for (; *name; name++)
    plain = plain && (isalnum((unsigned char)*name) || *name == '_' || *name == '.');
  return plain;
}

static void append_column(const fg_loop_effect *effect, const fg_loop_coordinate *at,
                          char text[FG_LOOP_STEP]) {
  bool factor = effect->own_levels && !at->levels;
  if (factor) append_step_words(text, "factor(");
  append_step_words(text, at->name);
  if (factor) append_step_words(text, ")");
}

/* Appends the main terms of a power or an interaction. */
static void append_main(const fg_loop_coordinate *at, bool alone, char text[FG_LOOP_STEP]) {
  if (alone || at->roles & FG_LOOP_DECLARED) return;
  append_step_words(text, at->name);
  append_step_words(text, " + ");
}

static void append_term(const fg_loop_report *report, const fg_loop_candidate *candidate,
                        char text[FG_LOOP_STEP]) {
  const fg_loop_coordinate *coordinate = report->problem->problem.coordinate;
  const fg_loop_coordinate *a = &coordinate[candidate->a], *b = &coordinate[candidate->b];
  const char *term = candidate->effect->term;
  bool alone = !strcmp(term, "{a}");
  append_step_words(text, " + ");
  append_main(a, alone, text);
  if (candidate->effect->pair) append_main(b, alone, text);
  for (; *term; term++) {
    if (*term == '{') {
      append_column(candidate->effect, term[1] == 'a' ? a : b, text);
      term += 2;
    } else {
      append_step_words(text, (char[]){*term, 0});
    }
  }
}

/* Returns true when a formula can express the effect, over columns with usable names; orders are no
 * causes. */
static bool has_term(const fg_loop_report *report, const fg_loop_candidate *candidate) {
  const fg_loop_coordinate *coordinate = report->problem->problem.coordinate;
  const fg_loop_coordinate *a = &coordinate[candidate->a], *b = &coordinate[candidate->b];
  bool order = a->roles & (FG_LOOP_ORDER | FG_LOOP_BUMP);
  return candidate->effect->term && !order && strcmp(report->spec->model, "arc_length") != 0 &&
         is_plain_name(a->name) && is_plain_name(b->name);
}

/* Returns true when all members of the alias class are of the same columns: only the basis is open.
 */
static bool only_basis_is_open(const fg_loop_claim *claim) {
  bool same = claim->aliases_unlisted == 0 && claim->candidate.effect->accepts;
  for (size_t k = 0; k < claim->aliases; k++) {
    const fg_loop_alias *alias = &claim->alias[k];
    same = same && !alias->sum && alias->candidate.effect->accepts &&
           alias->candidate.a == claim->candidate.a && alias->candidate.b == claim->candidate.b &&
           alias->candidate.effect->scatter == FG_LOOP_OF_THE_MEAN;
  }
  return same;
}

/* The declared formula with a finding in it, and with those before it that it can have. */
static bool formula_with(const fg_loop_report *report, size_t m, char text[FG_LOOP_STEP]) {
  const fg_loop_claim *claim = report->result->claim;
  if (!has_term(report, &claim[m].candidate)) return false;
  fg_text_clip(text, FG_LOOP_STEP, "%s", report->spec->model);
  for (size_t k = 0; k <= m; k++)
    if (has_term(report, &claim[k].candidate) && only_basis_is_open(&claim[k]))
      append_term(report, &claim[k].candidate, text);
  return true;
}

static void look_up_rows(const fg_loop_report *report, const fg_loop_claim *claim,
                         char text[FG_LOOP_STEP]) {
  bool exchanged = claim->candidate.effect->outlier == FG_LOOP_EXCHANGED_ROWS;
  bool one = !exchanged && claim->candidate.rows == 1;
  char rows[FG_LOOP_WORDS];
  fg_loop_rows_words(report, &claim->candidate, rows);
  if (exchanged)
    fg_text_clip(text, FG_LOOP_STEP,
                 "Compare the labels of %s with the records; where they were exchanged, put them "
                 "right in the table.",
                 rows);
  else
    fg_text_clip(text, FG_LOOP_STEP,
                 "Look up %s in the records: a slip in writing, a wrong part, a disturbed "
                 "measurement? Where that is so, correct %s or strike %s; where not, %s.",
                 rows, one ? "it" : "them", one ? "it" : "them",
                 one ? "it stands, and the process can do this"
                     : "they stand, and the process can do this");
}

/* n (1 - rho) / (1 + rho): effective number of independent values in the mean of a correlated
 * series. */
static void count_independent(const fg_loop_report *report, const fg_loop_claim *claim,
                              char text[FG_LOOP_STEP]) {
  const fg_loop_problem *problem = &report->problem->problem;
  const char *rows = fg_loop_row_words(&problem->coordinate[claim->candidate.a]);
  double rho = claim->noise_value, n = (double)problem->rows;
  if (rho > 0)
    fg_text_clip(text, FG_LOOP_STEP,
                 "Do not count these %s as independent: for a mean, %zu of them are worth about "
                 "%.0f. Measure at longer intervals, or record what lasts from one to the next (a "
                 "temperature, a batch) and give it as a column.",
                 rows, problem->rows, fmax(n * (1 - rho) / (1 + rho), 1));
  else
    fg_text_clip(text, FG_LOOP_STEP,
                 "After a high one of these %s comes a low one: look for what corrects too much "
                 "(an operator, a controller) or alternates (two tools, two places).",
                 rows);
}

static void follow_spread(const fg_loop_report *report, const fg_loop_claim *claim,
                          char text[FG_LOOP_STEP]) {
  const fg_loop_coordinate *at = &report->problem->problem.coordinate[claim->candidate.a];
  if (at->roles & FG_LOOP_LEVEL)
    fg_text_clip(text, FG_LOOP_STEP,
                 "Analyse the logarithm (or the root) of %s, or use limits and uncertainties that "
                 "follow its level: one for all is wrong at both ends.",
                 report->spec->response);
  else
    fg_text_clip(text, FG_LOOP_STEP,
                 "Use limits and uncertainties that follow %s: one for all is too wide at one end "
                 "and too narrow at the other; and look for what makes it scatter there.",
                 at->name);
}

static void follow_levels(const fg_loop_report *report, const fg_loop_claim *claim,
                          char text[FG_LOOP_STEP]) {
  const fg_loop_coordinate *at = &report->problem->problem.coordinate[claim->candidate.a];
  fg_text_clip(
      text, FG_LOOP_STEP,
      "Judge what is the same in all rows of one %s by the %zu levels, not by the rows, as "
      "the uncertainties here do; more levels of %s narrow them, more rows of one do not. "
      "Look for what differs from level to level, and give it as a column.",
      at->name, at->levels, at->name);
}

static void follow_mean(const fg_loop_report *report, size_t m, char text[FG_LOOP_STEP]) {
  const fg_loop_claim *claim = &report->result->claim[m];
  const fg_loop_effect *effect = claim->candidate.effect;
  const fg_loop_coordinate *at = &report->problem->problem.coordinate[claim->candidate.a];
  char formula[FG_LOOP_STEP], words[FG_LOOP_WORDS];
  bool order = at->roles & (FG_LOOP_ORDER | FG_LOOP_BUMP);
  fg_loop_claim_words(report, claim, words);
  if (formula_with(report, m, formula))
    fg_text_clip(text, FG_LOOP_STEP, "Declare %s: --model '%s'.", words, formula);
  else if (effect->stepwise)
    fg_text_clip(text, FG_LOOP_STEP, "Find out what changed at %s %.6g, and give it as a column.",
                 at->name, claim->shape[0]);
  else if (effect->cycle && order)
    fg_text_clip(text, FG_LOOP_STEP,
                 "Find out what returns every %.3g of %s (a shift, a tool, a season), and give it "
                 "as a column.",
                 claim->shape[0], at->name);
  else if (effect->cycle)
    fg_text_clip(text, FG_LOOP_STEP,
                 "Find out what turns or repeats so often over %s (a shaft, a screw's lead, teeth, "
                 "a scale's division): --model-out FILE keeps the cycle as it was found, and `doe "
                 "--model FILE` takes it out.",
                 at->name);
  else if (order)
    fg_text_clip(text, FG_LOOP_STEP,
                 "Find out what causes %s (wear, temperature, a new batch), give it as a column, "
                 "and make the next runs in random order.",
                 words);
  else
    fg_text_clip(text, FG_LOOP_STEP,
                 "Let the model have %s: --model-out FILE keeps it as it was found, and `doe "
                 "--model FILE` takes it out.",
                 words);
}

static void step_of_claim(const fg_loop_report *report, size_t m, char text[FG_LOOP_STEP]) {
  const fg_loop_claim *claim = &report->result->claim[m];
  const fg_loop_effect *effect = claim->candidate.effect;
  char formula[FG_LOOP_STEP], words[FG_LOOP_WORDS];
  size_t advice = 0;
  for (size_t k = 0; k < m; k++)
    advice += report->result->claim[k].aliases > 0;
  bool tied = claim->aliases && advice < report->result->advices;
  const char *apart = tied ? report->result->advice[advice].text : "";
  if (tied && (!only_basis_is_open(claim) || !formula_with(report, m, formula))) {
    fg_text_clip(text, FG_LOOP_STEP, "Name no cause yet. %s", apart);
    return;
  }
  if (tied) {
    fg_loop_claim_words(report, claim, words);
    fg_text_clip(text, FG_LOOP_STEP,
                 "Declare %s: --model '%s'. Only its form is open; if that matters: %s", words,
                 formula, apart);
    return;
  }
  if (effect->outlier != FG_LOOP_NOT_OUTLIER)
    look_up_rows(report, claim, text);
  else if (effect->scatter == FG_LOOP_SERIAL)
    count_independent(report, claim, text);
  else if (effect->scatter == FG_LOOP_SPREAD)
    follow_spread(report, claim, text);
  else if (effect->scatter == FG_LOOP_LEVELS)
    follow_levels(report, claim, text);
  else
    follow_mean(report, m, text);
}

static void step_of_curve(const fg_loop_report *report, char text[FG_LOOP_STEP]) {
  const fg_loop_curve *curve = &report->result->curve;
  fg_text_clip(text, FG_LOOP_STEP, "Find out what else changed over %s", curve->name);
  for (size_t k = 0; k < curve->nearest_count && k < 3; k++) {
    size_t row = report->problem->row[curve->nearest[k]];
    char number[FG_LOOP_NAME];
    if (report->row_name)
      fg_text_clip(number, sizeof number, "%s%s", k ? ", " : ", most at ", report->row_name[row]);
    else
      fg_text_clip(number, sizeof number, "%s%zu", k ? ", " : ", most at rows ", row + 1);
    append_step_words(text, number);
  }
  append_step_words(text, ", give it as a column, and run again.");
}

static void step_of_suspect(const fg_loop_report *report, char text[FG_LOOP_STEP]) {
  const fg_loop_suspect *suspect = &report->result->suspect[0];
  char decides[FG_LOOP_WORDS];
  fg_loop_suspect_decides(report, suspect, decides);
  if (!suspect->more_rows)
    fg_text_clip(text, FG_LOOP_STEP,
                 "Change nothing yet. Look up how these rows were measured: %s would decide.",
                 decides);
  else
    fg_text_clip(
        text, FG_LOOP_STEP,
        "Change nothing yet. Measure %s, and run the loop on all rows: if the effect is as "
        "large as it looks, it is then proven nine times in ten.",
        decides);
}

size_t fg_loop_next_count(const fg_loop_report *report) {
  const fg_loop_result *result = report->result;
  size_t count = result->claims + result->has_curve + result->fails;
  return count ? count : 1;
}

void fg_loop_next_step(const fg_loop_report *report, size_t step, char text[FG_LOOP_STEP]) {
  const fg_loop_result *result = report->result;
  char words[FG_LOOP_WORDS];
  fg_loop_check check;
  if (step < result->claims) {
    step_of_claim(report, step, text);
  } else if (result->has_curve && step == result->claims) {
    step_of_curve(report, text);
  } else if (result->fails) {
    fg_loop_failed_advice(report, words);
    fg_text_clip(text, FG_LOOP_STEP, "%s", words);
  } else if (result->suspects) {
    step_of_suspect(report, text);
  } else if (fg_loop_suspects_residual(result, &check)) {
    fg_text_clip(text, FG_LOOP_STEP,
                 "Add rows, or measure again, and run the loop on all of them: these rows neither "
                 "prove what is suspected nor clear the model of it.");
  } else if (result->far_row.rows) {
    fg_loop_rows_words(report, &result->far_row, words);
    fg_text_clip(text, FG_LOOP_STEP,
                 "Look up %s in the records: it lies farther out than normal noise reaches, which "
                 "the other rows neither call a slip nor clear of one.",
                 words);
  } else {
    fg_text_clip(text, FG_LOOP_STEP,
                 "Nothing. What is called inconclusive below could still be there, smaller than "
                 "what would have shown.");
  }
}
