/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Verdict of evidence: which explanations remain. */
#ifndef FG_EVIDENCE_VERDICT_H
#define FG_EVIDENCE_VERDICT_H

#include "evidence/posterior.h"

/* A cause leads by this factor, ln (Kass and Raftery 1995: "very strong" from ln 150 on). */
#define FG_EVIDENCE_LEAD 5.0

enum { FG_EVIDENCE_TIES = 16 };

typedef enum fg_evidence_outcome {
  FG_EVIDENCE_CLEAN,        /* no effect is as likely as one in a hundred */
  FG_EVIDENCE_FOUND,        /* one set of named effects leads all others */
  FG_EVIDENCE_TIED,         /* several explanations, at least one of them of named effects alone */
  FG_EVIDENCE_UNATTRIBUTED, /* a rival leads all sets of named effects */
} fg_evidence_outcome;

typedef struct fg_evidence_verdict {
  fg_evidence_outcome outcome;
  fg_evidence_model tie[FG_EVIDENCE_TIES]; /* the likeliest first, or one of as few named effects */
  double middle_mm[FG_EVIDENCE_TIES][FG_EVIDENCE_PARTS]; /* of polynomials: their middle */
  size_t ties;
  /* Of UNATTRIBUTED: named effects of tie[0] that no explanation can do without. */
  bool certain[FG_EVIDENCE_PARTS];
  double score_without; /* of the likeliest model without the others of its named effects */
  double p_null;        /* posterior probability of no effect */
  double margin;        /* ln; what gains less may be an error of the columns */
} fg_evidence_verdict;

/* Returns true when a model holds all causes of another. */
bool fg_evidence_includes(const fg_evidence_model *model, const fg_evidence_model *other);

/* `has`: false where an effect that extends another one has 0, within its uncertainty, in the
 * column that defines it: then it is no effect of that name, as a keystone without a slope is a
 * scale. */
fg_status fg_evidence_has_defining_columns(fg_context *ctx, fg_evidence_search *search,
                                           const fg_evidence_model *model, bool *has);

/* `far`: the columns were taken so far from where the edges lie that they err; named effects are
 * preferred, about which they can be taken anew. */
fg_status fg_evidence_decide(fg_context *ctx, fg_evidence_search *search, bool far,
                             fg_evidence_verdict *verdict);

/* Takes the likeliest explanation without a name in place of one that cannot be fitted; returns
 * false where there is none. */
bool fg_evidence_choose_unnamed(const fg_evidence_search *search, fg_evidence_verdict *verdict);

#endif
