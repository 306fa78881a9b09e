/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Result of a search: its candidates, and the sets of them that explain the rows. */
#ifndef FG_EFFECT_SEARCH_EXPLANATIONS_H
#define FG_EFFECT_SEARCH_EXPLANATIONS_H

#include "effect/set.h"
#include "foilgauge/scan_loop.h"
#include "rows/edge_fit.h"

/* Differences between the searches on foils and on discs (policy.h). */
typedef struct fg_search_policy fg_search_policy;

enum { FG_CANDIDATES_MAX = 31, FG_EXPLANATIONS_MAX = 16, FG_SEARCH_BARRED_MAX = 24 };

/* Effect as it enters the search. Its shape is fixed, except the middle c of a polynomial, which
 * every set determines anew. */
typedef struct fg_candidate {
  const fg_effect *kind;
  fg_effect_polynomial polynomial;      /* polynomial that its terms make; else every column has a
                                           coefficient of its own */
  size_t columns, shapes;               /* of the effect in the joint fit */
  size_t terms;                         /* in the search */
  size_t column[FG_EFFECT_COLUMNS_MAX]; /* of the search, one per term (cubic: three) */
  double shape[FG_FIELD_SHAPES];
} fg_candidate;

/* Set of effects (bits of `effects`) and its residual. */
typedef struct fg_explanation {
  unsigned mask;
  double excess; /* residual sum beyond that of all effects, in units of the noise; chi² of `dof`
                    when the set is right */
  double dof;
  double width; /* as `excess`, of the strip's width: evidence of the width against the set */
  double middle_mm[FG_CANDIDATES_MAX]; /* c of the polynomials in the set */
} fg_explanation;

/* Effects that were found but that not all parts confirm; the next search leaves them out. */
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
  fg_explanation each[FG_EXPLANATIONS_MAX]; /* explanations, likeliest first; several are tied */
  size_t count, total;
  bool right; /* the first explanation leaves no more than noise and the edge model's error allow */
  double noise_um, integral;             /* noise of a row; integral of its correlation */
  double edge_error_um;                  /* error of the edge model that is allowed for */
  double width_rms_um, width_smooth_um;  /* rms of half the strip's width less the stretch of the
                                            first explanation; its smooth part, over place or
                                            direction, that no field of the scanner makes */
  double p_value;                        /* of no effect; 1 when explanations[0].mask is 0 */
  double share[FG_CANDIDATES_MAX];       /* |M f|² / |f|² beside the geometry */
  double smallest_um[FG_CANDIDATES_MAX]; /* smallest amplitude that would have shown beside the
                                            winner */
  double alone[FG_CANDIDATES_MAX]; /* share of the residual sum that the effect explains alone */
  fg_search_bars barred;           /* effects that the search left out */
} fg_explanations;

/* Makes a set, without numbers, of one explanation. */
void fg_explanations_get_set(const fg_explanations *explanations, size_t explanation,
                             fg_effect_set *set);

#endif
