/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The design's limits and a die. */
#include <math.h>
#include <string.h>

#include "core/text.h"
#include "foilgauge/die_report.h"

#define OVERALL "overall.radius_mm"

static bool is_of_a_die(const char *name) {
  for (int q = 0; q < FG_DIE_QUANTITIES; q++)
    if (!strcmp(name, fg_die_row_of((fg_die_quantity)q)->name)) return true;
  return !strcmp(name, OVERALL);
}

size_t fg_die_tolerances(const fg_die *die) {
  size_t count = 0;
  for (size_t i = 0; i < die->design.tolerance_count; i++)
    count += is_of_a_die(die->design.tolerances[i].quantity);
  return count;
}

fg_verdict fg_die_judge_value(const fg_die *die, const char *name, const fg_die_value *value) {
  fg_verdict worst = FG_VERDICT_NONE;
  for (size_t i = 0; i < die->design.tolerance_count; i++)
    if (!strcmp(die->design.tolerances[i].quantity, name))
      worst = fg_verdict_worse(worst,
                               fg_judge_value(&die->design.tolerances[i], value->value, value->u));
  return worst;
}

fg_verdict fg_die_judge_bump(const fg_die *die, const fg_die_bump *bump) {
  fg_verdict worst = FG_VERDICT_NONE;
  for (int q = 0; q < FG_DIE_QUANTITIES; q++)
    worst = fg_verdict_worse(
        worst, fg_die_judge_value(die, fg_die_row_of((fg_die_quantity)q)->name, &bump->value[q]));
  return worst;
}

static bool is_seen(const fg_die_side *side, int number) {
  for (size_t i = 0; i < side->bump_count; i++)
    if (side->bumps[i].number == number) return true;
  return false;
}

bool fg_die_is_lost(const fg_die_trace *trace, int number) {
  for (size_t i = 0; i < trace->lost_count; i++)
    if (trace->lost[i] == number) return true;
  return false;
}

/* True when a trace of the half lost the bump, and none measured it. */
static bool is_lost(const fg_die *die, fg_die_half half, int number) {
  for (size_t i = 0; i < die->trace_count; i++)
    if (die->traces[i].half == half && fg_die_is_lost(&die->traces[i], number)) return true;
  return false;
}

static size_t count_unseen(const fg_die *die, fg_die_half half, fg_die_unseen_kind kind,
                           char *words, size_t size) {
  size_t count = 0, length = 0;
  if (words) words[0] = '\0';
  for (int number = 1; number <= (int)die->design.bumps.count; number++) {
    if (is_seen(&die->half[half], number)) continue;
    bool lost = is_lost(die, half, number);
    if (kind != FG_DIE_UNSEEN && lost != (kind == FG_DIE_LOST)) continue;
    if (words && length < size)
      fg_text_clip(words + length, size - length, "%s%d", count ? ", " : "", number);
    length = words ? strlen(words) : 0;
    count++;
  }
  return count;
}

size_t fg_die_unseen(const fg_die *die, fg_die_half half, fg_die_unseen_kind kind, char *words,
                     size_t size) {
  words[0] = '\0';
  return die->half[half].traces ? count_unseen(die, half, kind, words, size) : 0;
}

static void add_verdict(fg_verdict verdict, fg_report_outcome *sum) {
  fg_outcome_add(sum, &(fg_report_outcome){.verdict = verdict,
                                           .exceeded = verdict == FG_VERDICT_FAIL,
                                           .undecided = verdict == FG_VERDICT_UNDECIDED,
                                           .not_measured = verdict == FG_VERDICT_NOT_MEASURED});
}

static void judge_side(const fg_die *die, fg_die_half half, fg_report_outcome *sum) {
  const fg_die_side *side = &die->half[half];
  for (size_t i = 0; i < side->bump_count; i++)
    for (int q = 0; q < FG_DIE_QUANTITIES; q++)
      add_verdict(fg_die_judge_value(die, fg_die_row_of((fg_die_quantity)q)->name,
                                     &side->bumps[i].value[q]),
                  sum);
  add_verdict(fg_die_judge_value(die, OVERALL, &side->overall_radius_mm), sum);
  for (size_t unseen = count_unseen(die, half, FG_DIE_UNSEEN, NULL, 0); unseen > 0; unseen--)
    add_verdict(FG_VERDICT_NOT_MEASURED, sum);
}

/* Adds the traced bumps without a value: "; lost to dust: concave 5, convex 2, 3". */
static void add_lost(const fg_die *die, char *words, size_t size) {
  char numbers[200];
  size_t sum = 0;
  for (int half = 0; half < FG_DIE_HALVES; half++) {
    size_t count = fg_die_unseen(die, (fg_die_half)half, FG_DIE_LOST, numbers, sizeof numbers);
    size_t length = strlen(words);
    if (count && length < size)
      fg_text_clip(words + length, size - length, "%s%s bump%s %s",
                   sum ? ", " : "; lost to dust or a lost contact: ",
                   fg_die_half_word((fg_die_half)half), fg_plural(count), numbers);
    sum += count;
  }
}

static void write_die_outcome(const fg_report_outcome *o, size_t lost, char *words, size_t size) {
  size_t untraced = o->not_measured - lost;
  if (o->verdict == FG_VERDICT_NONE)
    fg_text_clip(words, size, "the design states no limit for a die");
  else if (o->exceeded)
    fg_text_clip(words, size, "%zu value%s beyond a limit by more than U%s", o->exceeded,
                 o->exceeded == 1 ? " is" : "s are",
                 untraced ? "; bumps that no trace shows were not judged" : "");
  else if (untraced)
    fg_text_clip(words, size, "%zu bump%s no trace shows whole; what was seen %s", untraced,
                 untraced == 1 ? " that" : "s that",
                 o->undecided ? "exceeds no limit by more than U" : "is within the limits");
  else if (lost)
    fg_text_clip(words, size, "%zu bump%s without a value; what was measured %s", lost,
                 fg_plural(lost),
                 o->undecided ? "exceeds no limit by more than U" : "is within the limits");
  else if (o->undecided)
    fg_text_clip(words, size, "%zu value%s with a limit within U, none beyond", o->undecided,
                 o->undecided == 1 ? "" : "s");
  else
    fg_text_clip(words, size, "every value is within its limits, U considered");
}

static size_t count_lost(const fg_die *die) {
  size_t sum = 0;
  for (int half = 0; half < FG_DIE_HALVES; half++)
    if (die->half[half].traces) sum += count_unseen(die, (fg_die_half)half, FG_DIE_LOST, NULL, 0);
  return sum;
}

void fg_die_judge(const fg_die *die, fg_report_outcome *outcome, char *words, size_t size) {
  *outcome = (fg_report_outcome){.verdict = FG_VERDICT_NONE};
  if (fg_die_tolerances(die))
    for (int half = 0; half < FG_DIE_HALVES; half++)
      if (die->half[half].traces) judge_side(die, (fg_die_half)half, outcome);
  if (!words) return;
  write_die_outcome(outcome, fg_die_tolerances(die) ? count_lost(die) : 0, words, size);
  add_lost(die, words, size);
}
