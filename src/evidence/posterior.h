/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Posterior of a model's amplitudes. */
#ifndef FG_EVIDENCE_POSTERIOR_H
#define FG_EVIDENCE_POSTERIOR_H

#include "evidence/search.h"

typedef struct fg_evidence_posterior {
  size_t count, column[FG_EVIDENCE_MODEL_COLUMNS]; /* the bumps' scatter first, then the parts */
  double *mean, *covariance;                       /* owned; count, count × count; um */
} fg_evidence_posterior;

fg_status fg_evidence_find_posterior(fg_context *ctx, fg_evidence_search *search,
                                     const fg_evidence_model *model,
                                     fg_evidence_posterior *posterior);
void fg_evidence_posterior_close(fg_evidence_posterior *posterior);

/* Returns the index in the posterior of the first column of part k. */
size_t fg_evidence_first_of(const fg_evidence_search *search, const fg_evidence_model *model,
                            size_t k);

#endif
