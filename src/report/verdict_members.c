/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/verdict_members.h"

#include <math.h>

const char *const fg_verdict_words[] = {
    [FG_VERDICT_PASS] = "pass",
    [FG_VERDICT_FAIL] = "fail",
    [FG_VERDICT_UNDECIDED] = "cannot_tell",
    [FG_VERDICT_NOT_MEASURED] = "not_measured",
    [FG_VERDICT_NONE] = "no_tolerance",
    NULL,
};

const char *fg_verdict_word(fg_verdict verdict) {
  return fg_verdict_words[verdict];
}

double fg_is_in_tolerance(fg_verdict verdict) {
  return verdict == FG_VERDICT_NONE ? NAN : verdict == FG_VERDICT_PASS;
}

int fg_verdict_rank(fg_verdict verdict) {
  static const int rank[] = {
      [FG_VERDICT_NONE] = 0,         [FG_VERDICT_PASS] = 1, [FG_VERDICT_UNDECIDED] = 2,
      [FG_VERDICT_NOT_MEASURED] = 3, [FG_VERDICT_FAIL] = 4,
  };
  return rank[verdict];
}

fg_verdict fg_verdict_worse(fg_verdict a, fg_verdict b) {
  return fg_verdict_rank(a) >= fg_verdict_rank(b) ? a : b;
}

static double find_in_tolerance(const fg_subject *subject) {
  return fg_is_in_tolerance(*(const fg_verdict *)subject->object);
}

static int find_verdict(const fg_subject *subject) {
  return (int)*(const fg_verdict *)subject->object;
}

static const fg_member verdict_rows[] = {
    {FG_FLAG_BY("in_tolerance", find_in_tolerance), .options = FG_MEMBER_NULLABLE,
     .words = FG_IN_TOLERANCE_WORDS},
    {FG_WORD_BY("verdict", find_verdict, fg_verdict_words), .options = FG_MEMBER_NEVER_NULL,
     .words = FG_VERDICT_WORDS},
};
const fg_members fg_verdict_members = FG_MEMBERS(verdict_rows);
