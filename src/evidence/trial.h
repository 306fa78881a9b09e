/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shapes of one effect that are tried beside a model. Their columns stay apart from the problem's,
 * so that several threads can try. */
#ifndef FG_EVIDENCE_TRIAL_H
#define FG_EVIDENCE_TRIAL_H

#include "evidence/problem.h"

typedef struct fg_evidence_trial {
  const fg_effect *effect;
  size_t each, count;         /* columns of a shape, of all */
  fg_evidence_column *column; /* owned */
  double *values, *raw;       /* owned: of all columns; of one shape before it is whitened */
} fg_evidence_trial;

/* Opens a trial of so many shapes, of `each` columns. */
fg_status fg_evidence_trial_open(fg_context *ctx, const fg_evidence_problem *problem,
                                 const fg_effect *effect, size_t each, size_t shapes,
                                 fg_evidence_trial *trial);
void fg_evidence_trial_close(fg_evidence_trial *trial);
void fg_evidence_trial_add(const fg_evidence_problem *problem, const double *shape,
                           fg_evidence_trial *trial);

#endif
