/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "in_tolerance" and "verdict" as members of every report that judges. */
#ifndef FG_REPORT_VERDICT_MEMBERS_H
#define FG_REPORT_VERDICT_MEMBERS_H

#include "core/member.h"
#include "foilgauge/report.h"

/* Words of fg_verdict, in its order. */
extern const char *const fg_verdict_words[];

/* Value of "in_tolerance": true for a pass alone, null where nothing is judged. */
double fg_is_in_tolerance(fg_verdict verdict);

/* Higher is worse. */
int fg_verdict_rank(fg_verdict verdict);

#define FG_IN_TOLERANCE_WORDS "true only where every value passes; null: nothing is judged"
#define FG_VERDICT_WORDS      "of all values against their tolerances, with U"

/* Rows "in_tolerance" and "verdict" of an object with a field of type fg_verdict:
 * {FG_VERDICT(fg_lot_foil, verdict)}. Their subject is the verdict. */
extern const fg_members fg_verdict_members;
#define FG_VERDICT(object_, field)                                                                 \
  .kind = FG_MEMBER_SAME, .members = &fg_verdict_members,                                          \
  .offset = offsetof(object_, field) + 0 * sizeof(_Generic(((object_ *)0)->field, fg_verdict       \
                                                           : (char)0))

#endif
