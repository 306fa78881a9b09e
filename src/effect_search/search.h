/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One search beside a geometry that is fitted. */
#ifndef FG_EFFECT_SEARCH_SEARCH_H
#define FG_EFFECT_SEARCH_SEARCH_H

#include "effect_search/explanations.h"

/* Input of one search. */
typedef struct fg_search_request {
  const fg_search_policy *policy;
  const double *residual_um, *jacobian; /* with the geometry fitted; as from fg_edge_fit_residual */
  const fg_effect_set
      *known; /* effects with known shapes, which the search starts with; NULL: none */
  const fg_effect_set *tried; /* set that was fitted and is not right; NULL: none */
  const fg_effect_set
      *given_up; /* sets whose fit ran away or was worse than none; the search avoids them */
  size_t given_up_count;
  const fg_search_bars *barred; /* NULL: none */
  bool look;                    /* search for further shaped effects */
  bool two_curves; /* two curves at once, where one is not enough and a part has several scans */
  bool hopeless;   /* sets with unfitted shapes had their chance: a right curve is accepted */
} fg_search_request;

fg_status fg_search_find(fg_context *ctx, const fg_edge_fit *edge_fit,
                         const fg_search_request *request, fg_explanations *explanations);

#endif
