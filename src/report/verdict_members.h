/* SPDX-License-Identifier: GPL-3.0-or-later */
/* "in_tolerance", "verdict" and "judgements" as members of every report that judges. */
#ifndef FG_REPORT_VERDICT_MEMBERS_H
#define FG_REPORT_VERDICT_MEMBERS_H

#include "core/member.h"
#include "foilgauge/report.h"

/* Words of fg_verdict, in its order. */
extern const char *const fg_verdict_words[];

/* A verdict as a terminal says it; static. */
const char *fg_verdict_phrase(fg_verdict verdict);

/* Value of "in_tolerance": true for a pass alone, null where nothing is judged. */
double fg_is_in_tolerance(fg_verdict verdict);

/* Higher is worse. */
int fg_verdict_rank(fg_verdict verdict);

#define FG_IN_TOLERANCE_WORDS                                                                      \
  "true only when all was measured and the verdict is pass; false for fail, cannot_tell and "      \
  "not_measured; null when no tolerance is stated and nothing rejects it"
#define FG_VERDICT_WORDS                                                                            \
  "value ± 2 u inside both limits (pass), outside one, or a part is missing (fail), a limit runs " \
  "through it (cannot_tell); of several the worst: fail, not_measured, cannot_tell, pass"

/* Rows "in_tolerance" and "verdict" of an object with a field of type fg_verdict:
 * {FG_VERDICT(fg_lot_foil, verdict)}. Their subject is the verdict. */
extern const fg_members fg_verdict_members;
#define FG_VERDICT(object_, field)                                                                 \
  .kind = FG_MEMBER_SAME, .members = &fg_verdict_members,                                          \
  .offset = offsetof(object_, field) + 0 * sizeof(_Generic(((object_ *)0)->field, fg_verdict       \
                                                           : (char)0))

/* Judgements of an fg_decision inside an object. Each names its part: "bump", "beam", "disc". */
extern const fg_members fg_judgement_members;
#define FG_JUDGEMENTS(object_, decision_)                                                          \
  FG_LIST("judgements", object_, decision_.judgements, decision_.count, &fg_judgement_members),    \
      .options = FG_MEMBER_ON_LINE
#define FG_JUDGEMENTS_WORDS "tolerances of the design, applied to values"

#endif
