/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/verdict_members.h"

#include <math.h>

#include "foilgauge/quantity.h"

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

const char *fg_verdict_phrase(fg_verdict verdict) {
  static const char *const phrases[] = {
      [FG_VERDICT_PASS] = "pass",
      [FG_VERDICT_FAIL] = "fail",
      [FG_VERDICT_UNDECIDED] = "cannot tell",
      [FG_VERDICT_NOT_MEASURED] = "not measured",
      [FG_VERDICT_NONE] = "no tolerances stated",
  };
  return phrases[verdict];
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

static double is_in_tolerance(const fg_subject *subject) {
  return fg_is_in_tolerance(*(const fg_verdict *)subject->object);
}

static int find_verdict(const fg_subject *subject) {
  return (int)*(const fg_verdict *)subject->object;
}

static const fg_member verdict_rows[] = {
    {FG_FLAG_BY("in_tolerance", is_in_tolerance), .options = FG_MEMBER_NULLABLE,
     .words = FG_IN_TOLERANCE_WORDS},
    {FG_WORD_BY("verdict", find_verdict, fg_verdict_words), .options = FG_MEMBER_NEVER_NULL,
     .words = FG_VERDICT_WORDS},
};
const fg_members fg_verdict_members = FG_MEMBERS(verdict_rows);

/* Judgements: a number, where the value is that of a part. */
static bool is_of_part(const fg_subject *subject, fg_quantity_owner owner) {
  const fg_judgement *judgement = subject->object;
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  return judgement->number && judgement->row >= rows && judgement->row < rows + count;
}

#define IS_OF(function, owner)                                                                     \
  static bool function(const fg_subject *subject) {                                                \
    return is_of_part(subject, owner);                                                             \
  }
IS_OF(is_of_bump, FG_QUANTITY_OF_BUMP)
IS_OF(is_of_beam, FG_QUANTITY_OF_BEAM)
IS_OF(is_of_disc, FG_QUANTITY_OF_DISC)

static const char *find_quantity_name(const fg_subject *subject, char *buffer) {
  (void)buffer;
  return ((const fg_judgement *)subject->object)->tolerance->quantity;
}

static double find_lower(const fg_subject *subject) {
  return ((const fg_judgement *)subject->object)->tolerance->lower;
}

static double find_upper(const fg_subject *subject) {
  return ((const fg_judgement *)subject->object)->tolerance->upper;
}

static const fg_member judgement_rows[] = {
    {FG_TEXT_BY("quantity", find_quantity_name), .options = FG_MEMBER_NEVER_NULL,
     .words = "toleranced quantity"},
    {FG_INTEGER("bump", fg_judgement, number), .present = is_of_bump, .lowest = 1,
     .words = "number of the bump; without a number of a part: of the whole"},
    {FG_INTEGER("beam", fg_judgement, number), .present = is_of_beam, .lowest = 1,
     .words = "number of the beam"},
    {FG_INTEGER("disc", fg_judgement, number), .present = is_of_disc, .lowest = 1,
     .words = "number of the disc"},
    {FG_NUMBER("value", fg_judgement, value)},
    {FG_NUMBER("u", fg_judgement, u), .words = "its standard uncertainty"},
    {FG_NUMBER_BY("min", find_lower), .words = "lower limit"},
    {FG_NUMBER_BY("max", find_upper), .words = "upper limit"},
    {FG_FLAG("exceeded", fg_judgement, exceeded),
     .words = "beyond a limit by more than U = 2 u: the verdict is fail"},
    {FG_FLAG("missing", fg_judgement, missing),
     .options = FG_MEMBER_LEFT_OUT | FG_MEMBER_EMPTY_IS_NULL,
     .words = "the part is not there: the verdict is fail without a value"},
    {FG_WORD("verdict", fg_judgement, verdict, fg_verdict_words), .words = FG_VERDICT_WORDS},
    {FG_STRING("cure", fg_judgement, cure), .options = FG_MEMBER_LEFT_OUT,
     .words = "of cannot_tell: the cheapest thing that would decide it"},
};
const fg_members fg_judgement_members = FG_MEMBERS_OF_FILE(judgement_rows, "judgement", "measure");
