/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Search and fit in turns. */
#ifndef FG_EFFECT_SEARCH_ITERATE_H
#define FG_EFFECT_SEARCH_ITERATE_H

#include "effect_search/effect_search.h"

typedef struct fg_iterate_request {
  fg_edge_fit *edge_fit; /* gets the geometry that was fitted beside the winner */
  const fg_search_policy *policy;
  const fg_search_bars *barred; /* NULL: none */
} fg_iterate_request;

/* Fits the geometry and the effects together between searches, until the set stays: what is linear
 * at the wrong geometry leaves traces that look like further effects. `set` gets the winner,
 * fitted; `residual_um` (rows) what it leaves. */
fg_status fg_search_iterate(fg_context *ctx, const fg_iterate_request *request, fg_effect_set *set,
                            fg_explanations *explanations, double *residual_um);

/* The same in one turn from a set in force, whose shapes are the start, with the noise found
 * anew: for some of the rows on which it was found. Where explanations are tied, the set in force
 * is the one that is taken if it is among them. */
fg_status fg_search_iterate_again(fg_context *ctx, const fg_iterate_request *request,
                                  fg_effect_set *set, double *residual_um);

#endif
