/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which effects, of all that could, explain the points: sets of them are tried.
 *
 * The smooth effects of scanner and part are nearly the same thing in one scan (they correlate at
 * 0.83 to 0.99), so a search that adds the best one first can take a wrong one and never come back.
 * There are few of them: all sets of up to two (three where a part was scanned more than once) are
 * fitted beside the geometry, with any ripples and steps, which stand alone. Those of the smallest
 * size that leave no more than all effects and free curves together would, within what noise and
 * the edge model's own error allow, are explanations, tied when there are several. When there are
 * none, a free curve, alone or beside up to two listed effects, stands in.
 *
 * The width of the strip orders them: a scanner's field stretches it as it stretches the foil,
 * a part's effect does not. It does not decide: an edge model that errs with the direction of the
 * edge would look the same.
 */
#ifndef FG_EFFECT_SEARCH_EFFECT_SEARCH_H
#define FG_EFFECT_SEARCH_EFFECT_SEARCH_H

#include "effect/set.h"
#include "foilgauge/scan_loop.h"
#include "rows/edge_fit.h"

enum { FG_CANDIDATES_MAX = 28, FG_EXPLANATIONS_MAX = 16, FG_SEARCH_BARRED_MAX = 24 };

/* An effect as it enters the search: its shape is known by now, but for the middle c of a
 * polynomial, which is found with every set anew. */
typedef struct fg_candidate {
  const fg_effect *kind;
  fg_effect_polynomial polynomial; /* that its terms make; else every column has its coefficient */
  size_t columns, shapes;          /* of the effect as it is fitted in the end */
  size_t terms;                    /* in the search */
  size_t column[FG_EFFECT_COLUMNS_MAX]; /* of the search, one per term (cubic: three) */
  double shape[FG_FIELD_SHAPES];
} fg_candidate;

/* One set of effects (bits of `effects`) and what it leaves. */
typedef struct fg_explanation {
  unsigned mask;
  double excess; /* residual sum beyond that of all effects, in units of the noise; chi² of
                    `freedom` when the set is right */
  double dof;
  double width; /* of the same kind: what the strip's width says against it */
  double middle_mm[FG_CANDIDATES_MAX]; /* of the polynomials in it */
} fg_explanation;

/* Effects that were found and that not all parts confirm: a search leaves them out. */
typedef struct fg_search_barred {
  const fg_effect *effect;
  double would_explain, share, smallest_um; /* as in fg_explanations */
} fg_search_barred;

typedef struct fg_search_bars {
  fg_search_barred each[FG_SEARCH_BARRED_MAX];
  size_t count;
} fg_search_bars;

typedef struct fg_explanations {
  fg_candidate candidates[FG_CANDIDATES_MAX];
  size_t candidate_count;
  fg_explanation each[FG_EXPLANATIONS_MAX]; /* they are tied; the likeliest first */
  size_t count, total;
  bool right;                           /* the explanations leave no more than they should */
  double noise_um, integral;            /* of a row; of its correlation */
  double edge_error_um;                 /* of the edge model, allowed for */
  double width_rms_um, width_smooth_um; /* of half the strip's width, with the first explanation's
                                           stretch out; of its part that follows place or
                                           direction as no field of the scanner does */
  double p_value;                  /* that no effect is needed; 1 when explanations[0].mask is 0 */
  double share[FG_CANDIDATES_MAX]; /* |M f|² / |f|² beside the geometry */
  double smallest_um[FG_CANDIDATES_MAX]; /* amplitude that would have shown beside the winner */
  double alone[FG_CANDIDATES_MAX];       /* share of the residual sum that it alone takes */
  fg_search_bars barred;                 /* what the search left out */
} fg_explanations;

/* What is searched. */
typedef struct fg_search_policy fg_search_policy;
typedef struct fg_search_request {
  const fg_search_policy *policy;
  const double *residual_um, *jacobian; /* geometry fitted; as from fg_edge_fit_residual */
  const fg_effect_set
      *known; /* NULL: none; its shaped effects are in the search with their shapes */
  const fg_effect_set *tried;    /* NULL: none; this set was fitted and is not right */
  const fg_effect_set *given_up; /* fitted and run away, or worse than nothing: none of these */
  size_t given_up_count;
  const fg_search_bars *barred; /* NULL: none */
  bool look;                    /* for further shaped effects */
  bool two_curves;              /* where one is not enough and there are several views */
  bool hopeless; /* sets whose shapes are not fitted yet had their chance: a right curve stands */
} fg_search_request;

fg_status fg_search_find(fg_context *ctx, const fg_edge_fit *edge_fit,
                         const fg_search_request *request, fg_explanations *explanations);

/* The whole of it: search and joint fit in turns (settle.h); what discs do not confirm from one to
 * the next is barred. `set` gets the winner, fitted; `residual_um` (rows) what it leaves. */
fg_status fg_search_run(fg_context *ctx, fg_edge_fit *edge_fit, fg_effect_set *set,
                        fg_explanations *explanations, double *residual_um);

/* One explanation as a set without numbers. */
void fg_search_take(const fg_explanations *explanations, size_t explanation, fg_effect_set *set);

#endif
