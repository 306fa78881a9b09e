/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The truth of a render as a document, and the parts of it. */
#ifndef FG_RENDER_TRUTH_H
#define FG_RENDER_TRUTH_H

#include "core/member.h"

extern const fg_document fg_render_truth_document;

/* Effects of the spec, then its jumps; the lines of a colour sensor, members of the spec. */
extern const fg_members fg_truth_effect_members, fg_truth_colour_members;
fg_member_element fg_truth_effect_at;

/* Two numbers on a line as an element of a list. */
#define FG_TRUTH_PAIR(function)                                                                    \
  {                                                                                                \
    { FG_NUMBERS_BY(NULL, function), .options = FG_MEMBER_NEVER_NULL, .lowest = 2, .highest = 2 }  \
  }
const double *fg_truth_pair(double *pair, size_t *count, double first, double second);

/* A value of an object that is no field of it, and a case in which a member is there. */
#define FG_TRUE_VALUE(function, type, expression)                                                  \
  static double function(const fg_subject *s) {                                                    \
    const type *o = s->object;                                                                     \
    return (expression);                                                                           \
  }
#define FG_TRUE_CASE(function, type, expression)                                                   \
  static bool function(const fg_subject *s) {                                                      \
    const type *o = s->object;                                                                     \
    return (expression);                                                                           \
  }

#endif
