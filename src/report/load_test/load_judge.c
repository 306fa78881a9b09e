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

static void add(fg_verdict verdict, fg_report_outcome *sum) {
  fg_outcome_add(sum, &(fg_report_outcome){.verdict = verdict,
                                           .exceeded = verdict == FG_VERDICT_FAIL,
                                           .undecided = verdict == FG_VERDICT_UNDECIDED,
                                           .not_measured = verdict == FG_VERDICT_NOT_MEASURED});
}

static fg_report_outcome judge_direction(const fg_load_test *test, const fg_load_direction *d) {
  fg_report_outcome sum = {.verdict = FG_VERDICT_NONE};
  if (!isfinite(d->clearance.value)) {
    add(FG_VERDICT_NOT_MEASURED, &sum);
    return sum;
  }
  add(fg_load_judge_value(test, FG_LOAD_CLEARANCE, &d->clearance), &sum);
  add(fg_load_judge_value(test, FG_LOAD_STIFFNESS, &d->stiffness), &sum);
  add(fg_load_judge_value(test, FG_LOAD_LOSS, &d->loss), &sum);
  return sum;
}

fg_verdict fg_load_judge_direction(const fg_load_test *test, const fg_load_direction *direction) {
  return judge_direction(test, direction).verdict;
}

static fg_report_outcome judge_bearing(const fg_load_test *test, size_t bearing) {
  fg_report_outcome sum = {.verdict = FG_VERDICT_NONE};
  for (size_t i = 0; i < test->direction_count; i++) {
    if (test->directions[i].bearing != bearing) continue;
    fg_report_outcome part = judge_direction(test, &test->directions[i]);
    fg_outcome_add(&sum, &part);
  }
  add(fg_load_judge_value(test, FG_LOAD_PRELOAD, &test->bearings[bearing].preload_kpa), &sum);
  return sum;
}

fg_verdict fg_load_judge_bearing(const fg_load_test *test, size_t bearing) {
  return judge_bearing(test, bearing).verdict;
}

void fg_load_flag_words(unsigned flags, bool plain, char *words, size_t size) {
  words[0] = '\0';
  for (const fg_load_flag *flag = fg_load_flags(); flag->name; flag++) {
    size_t length = strlen(words);
    if (flags & flag->flag)
      fg_text_clip(words + length, size - length, "%s%s", length ? (plain ? "; " : " ") : "",
                   plain ? flag->plain : flag->name);
  }
}

static void say_range(const fg_load_test *test, char *words, size_t size) {
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
  if (!measured)
    fg_text_clip(words, size, "%s: none has a clearance", counts);
  else if (measured < test->direction_count)
    fg_text_clip(words, size, "%s: clearances of %.4f to %.4f mm at %g N, none of %zu azimuth%s",
                 counts, low, high, test->options.threshold_n, test->direction_count - measured,
                 test->direction_count - measured == 1 ? "" : "s");
  else
    fg_text_clip(words, size, "%s: clearances of %.4f to %.4f mm at %g N", counts, low, high,
                 test->options.threshold_n);
}

void fg_load_judge(const fg_load_test *test, fg_report_outcome *outcome, char *words, size_t size) {
  *outcome = (fg_report_outcome){.verdict = FG_VERDICT_NONE};
  for (size_t i = 0; i < test->bearing_count; i++) {
    fg_report_outcome part = judge_bearing(test, i);
    fg_outcome_add(outcome, &part);
  }
  if (!words) return;
  say_range(test, words, size);
  size_t length = strlen(words);
  if (outcome->exceeded)
    fg_text_clip(words + length, size - length, "; %zu value%s beyond a limit by more than U",
                 outcome->exceeded, outcome->exceeded == 1 ? " is" : "s are");
  else if (outcome->undecided)
    fg_text_clip(words + length, size - length, "; %zu value%s with a limit within U",
                 outcome->undecided, outcome->undecided == 1 ? "" : "s");
  else if (test->options.limit_count)
    fg_text_clip(words + length, size - length, "; what was measured is within the limits");
}
