/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limits and load-displacement tests. */
#include <math.h>
#include <string.h>

#include "core/text.h"
#include "foilgauge/load_report.h"

fg_verdict fg_load_judge_value(const fg_load_test *test, fg_load_quantity quantity,
                               const fg_load_value *value) {
  fg_verdict worst = FG_VERDICT_NONE;
  for (size_t i = 0; i < test->options.limit_count; i++)
    if (!strcmp(test->options.limits[i].quantity, fg_load_quantity_name(quantity)))
      worst =
          fg_verdict_worse(worst, fg_judge_value(&test->options.limits[i], value->value, value->u));
  return worst;
}

static void count_verdict(fg_verdict verdict, fg_report_outcome *sum) {
  fg_outcome_add(sum, &(fg_report_outcome){.verdict = verdict,
                                           .exceeded = verdict == FG_VERDICT_FAIL,
                                           .undecided = verdict == FG_VERDICT_UNDECIDED,
                                           .not_measured = verdict == FG_VERDICT_NOT_MEASURED});
}

/* True for a record with a clearance that is withheld: it passes and fails no limit. */
static bool is_withheld(const fg_load_direction *d) {
  return !isfinite(d->clearance.value) && (d->flags & (FG_LOAD_UNSAMPLED | FG_LOAD_CONTRADICTION));
}

static fg_report_outcome judge_direction(const fg_load_test *test, const fg_load_direction *d) {
  fg_report_outcome sum = {.verdict = FG_VERDICT_NONE};
  fg_verdict clearance = fg_load_judge_value(test, FG_LOAD_CLEARANCE, &d->clearance);
  if (clearance == FG_VERDICT_NOT_MEASURED && is_withheld(d)) {
    clearance = FG_VERDICT_UNDECIDED;
  } else if (!isfinite(d->clearance.value)) {
    count_verdict(FG_VERDICT_NOT_MEASURED, &sum);
    if (!is_withheld(d)) return sum;
  }
  count_verdict(clearance, &sum);
  count_verdict(fg_load_judge_value(test, FG_LOAD_STIFFNESS, &d->stiffness), &sum);
  count_verdict(fg_load_judge_value(test, FG_LOAD_LOSS, &d->loss), &sum);
  return sum;
}

fg_verdict fg_load_judge_direction(const fg_load_test *test, const fg_load_direction *direction) {
  return judge_direction(test, direction).verdict;
}

/* Friction without a weight that a gap contradicts may be the rig's: no limit passes or fails for
 * it. */
static fg_verdict judge_preload(const fg_load_test *test, const fg_load_bearing *b) {
  fg_verdict verdict = fg_load_judge_value(test, FG_LOAD_PRELOAD, &b->preload_kpa);
  bool judged = verdict == FG_VERDICT_PASS || verdict == FG_VERDICT_FAIL;
  return judged && (b->break_away.flags & FG_BREAK_GAP) ? FG_VERDICT_UNDECIDED : verdict;
}

static fg_report_outcome judge_bearing(const fg_load_test *test, size_t bearing) {
  fg_report_outcome sum = {.verdict = FG_VERDICT_NONE};
  for (size_t i = 0; i < test->direction_count; i++) {
    if (test->directions[i].bearing != bearing) continue;
    fg_report_outcome part = judge_direction(test, &test->directions[i]);
    fg_outcome_add(&sum, &part);
  }
  const fg_load_bearing *b = &test->bearings[bearing];
  if (b->break_away.pulls && !isfinite(b->preload_kpa.value))
    count_verdict(FG_VERDICT_NOT_MEASURED, &sum);
  count_verdict(judge_preload(test, b), &sum);
  count_verdict(fg_load_judge_value(test, FG_LOAD_HYSTERESIS, &b->hysteresis_n), &sum);
  count_verdict(fg_load_judge_value(test, FG_LOAD_FRICTION, &b->break_away.friction), &sum);
  return sum;
}

fg_verdict fg_load_judge_bearing(const fg_load_test *test, size_t bearing) {
  return judge_bearing(test, bearing).verdict;
}

static void join_words(const fg_load_flag *flag, unsigned flags, bool plain, char *words,
                       size_t size) {
  words[0] = '\0';
  for (; flag->name; flag++) {
    size_t length = strlen(words);
    if (flags & flag->flag)
      fg_text_clip(words + length, size - length, "%s%s", length ? (plain ? "; " : " ") : "",
                   plain ? flag->plain : flag->name);
  }
}

void fg_load_flag_words(unsigned flags, bool plain, char *words, size_t size) {
  join_words(fg_load_flags(), flags, plain, words, size);
}

void fg_break_away_flag_words(unsigned flags, bool plain, char *words, size_t size) {
  join_words(fg_break_away_flags(), flags, plain, words, size);
}

static void write_range_words(const fg_load_test *test, char *words, size_t size) {
  double low = INFINITY, high = -INFINITY;
  size_t measured = 0;
  for (size_t i = 0; i < test->direction_count; i++)
    if (isfinite(test->directions[i].clearance.value)) {
      low = fmin(low, test->directions[i].clearance.value);
      high = fmax(high, test->directions[i].clearance.value);
      measured++;
    }
  char counts[100];
  fg_text_clip(counts, sizeof counts, "%zu bearing%s, %zu azimuth%s", test->bearing_count,
               test->bearing_count == 1 ? "" : "s", test->direction_count,
               test->direction_count == 1 ? "" : "s");
  if (!test->direction_count)
    fg_text_clip(words, size, "%zu bearing%s", test->bearing_count,
                 test->bearing_count == 1 ? "" : "s");
  else if (!measured)
    fg_text_clip(words, size, "%s: none has a clearance", counts);
  else if (measured < test->direction_count)
    fg_text_clip(words, size, "%s: clearances of %.4f to %.4f mm at %g N, none of %zu azimuth%s",
                 counts, low, high, test->options.threshold_n, test->direction_count - measured,
                 test->direction_count - measured == 1 ? "" : "s");
  else
    fg_text_clip(words, size, "%s: clearances of %.4f to %.4f mm at %g N", counts, low, high,
                 test->options.threshold_n);
}

/* Preloads of the break-away tests. */
static void write_preload_words(const fg_load_test *test, char *words, size_t size) {
  double low = INFINITY, high = -INFINITY;
  size_t tests = 0, known = 0, length = strlen(words);
  for (size_t i = 0; i < test->bearing_count; i++) {
    const fg_load_bearing *b = &test->bearings[i];
    tests += b->break_away.pulls > 0;
    if (!isfinite(b->preload_kpa.value)) continue;
    low = fmin(low, b->preload_kpa.value), high = fmax(high, b->preload_kpa.value);
    known++;
  }
  const char *join = test->direction_count ? "; " : ": ";
  if (known == 1)
    fg_text_clip(words + length, size - length, "%spreload %.2f kPa", join, low);
  else if (known)
    fg_text_clip(words + length, size - length, "%spreloads of %.2f to %.2f kPa", join, low, high);
  length = strlen(words);
  if (tests > known)
    fg_text_clip(words + length, size - length, "%s%zu break-away test%s without a preload",
                 known ? ", " : join, tests - known, tests - known == 1 ? "" : "s");
}

static bool any_withheld(const fg_load_test *test) {
  bool any = false;
  for (size_t i = 0; i < test->direction_count; i++)
    any = any || is_withheld(&test->directions[i]);
  return any;
}

void fg_load_judge(const fg_load_test *test, fg_report_outcome *outcome, char *words, size_t size) {
  *outcome = (fg_report_outcome){.verdict = FG_VERDICT_NONE};
  for (size_t i = 0; i < test->bearing_count; i++) {
    fg_report_outcome part = judge_bearing(test, i);
    fg_outcome_add(outcome, &part);
  }
  if (!words) return;
  write_range_words(test, words, size);
  write_preload_words(test, words, size);
  size_t length = strlen(words);
  if (outcome->exceeded)
    fg_text_clip(words + length, size - length, "; %zu value%s beyond a limit by more than U",
                 outcome->exceeded, outcome->exceeded == 1 ? " is" : "s are");
  else if (outcome->undecided)
    fg_text_clip(words + length, size - length, "; %zu value%s with a limit within U%s",
                 outcome->undecided, outcome->undecided == 1 ? "" : "s",
                 any_withheld(test) ? " or withheld" : "");
  else if (test->options.limit_count)
    fg_text_clip(words + length, size - length, "; what was measured is within the limits");
}
