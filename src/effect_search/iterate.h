/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Search and joint fit in turns. */
#ifndef FG_EFFECT_SEARCH_ITERATE_H
#define FG_EFFECT_SEARCH_ITERATE_H

#include "effect_search/explanations.h"

typedef struct fg_iterate_request {
  fg_edge_fit *edge_fit; /* gets the geometry fitted beside the winner */
  const fg_search_policy *policy;
  const fg_search_bars *barred; /* NULL: none */
} fg_iterate_request;

/* Alternates search and joint fit of geometry and effects until the set stays. The turns are needed
 * because the columns are linearised: at a wrong geometry their errors resemble further effects.
 * `set` gets the winner, fitted; `residual_um` (rows) its residual. */
fg_status fg_search_iterate(fg_context *ctx, const fg_iterate_request *request, fg_effect_set *set,
                            fg_explanations *explanations, double *residual_um);

/* Runs one turn from a set in force, starting at its shapes, with the noise found anew: for a
 * subset of the rows that the set was found on. Of tied explanations the set in force is preferred
 * if it is among them. */
fg_status fg_search_iterate_again(fg_context *ctx, const fg_iterate_request *request,
                                  fg_effect_set *set, double *residual_um);

/* Computes residual (um) and Jacobian (parameters × rows) at the set's geometry, with the set's
 * effects added back, linearly. */
fg_status fg_search_put_back(fg_context *ctx, fg_edge_fit *edge_fit, const fg_effect_set *set,
                             double *residual_um, double *jacobian);

#endif
