/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Search over models by evidence: named effects and rivals added one at a time to the best models
 * so far, those of named effects alone beside those with rivals, so that neither starves. */
#ifndef FG_EVIDENCE_SEARCH_H
#define FG_EVIDENCE_SEARCH_H

#include "effect/set.h"
#include "evidence/model.h"

/* Opens a search beside the geometry of the edge fit. The displacements of the set
 * in force are put back in `residual_um`. */
fg_status fg_evidence_search_open(fg_context *ctx, const fg_edge_fit *edge_fit,
                                  const fg_evidence_request *request, const double *residual_um,
                                  const double *jacobian, fg_evidence_search *search);
/* Searches; again after a change of the noise. The models come sorted, best first. */
fg_status fg_evidence_search_run(fg_context *ctx, fg_evidence_search *search);

/* Returns the noise, um, that the best model's residual asks for: its mean square with its
 * correlation along the edge. Larger than the problem's, no model follows all of it. */
fg_status fg_evidence_find_misfit(fg_context *ctx, fg_evidence_search *search, double *misfit_um);
void fg_evidence_search_close(fg_evidence_search *search);

/* Returns true when a model holds an effect, in any basis. */
bool fg_evidence_holds(const fg_evidence_model *model, const fg_effect *effect);
static inline bool fg_evidence_is_named(const fg_evidence_model *model) {
  return model->named == model->parts;
}

#endif
