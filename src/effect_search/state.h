/* SPDX-License-Identifier: GPL-3.0-or-later */
/* State of one search, and the functions of its parts. */
#ifndef FG_EFFECT_SEARCH_STATE_H
#define FG_EFFECT_SEARCH_STATE_H

#include "effect_search/columns.h"

/* Columns of one shaped effect over its grid of starting shapes. They are stored because a search
 * evaluates them several times, beside other effects. */
typedef struct fg_search_grid {
  const fg_effect *kind;
  size_t starts, columns;
  double *values; /* owned; starts × FG_SMALL_MAX or fewer columns × rows */
} fg_search_grid;
enum { FG_SEARCH_GRIDS = 8 };

typedef struct fg_search {
  const fg_search_policy *policy;
  fg_search_columns columns;
  fg_search_grid grid[FG_SEARCH_GRIDS];
  size_t grids;
  fg_explanations *out;
  size_t free_column, free_end;  /* columns of the free curves */
  bool two_curves;               /* two curves at once are allowed */
  const fg_effect_set *given_up; /* sets that cannot be fitted */
  size_t given_up_count;
  bool hopeless;              /* sets with unfitted shapes had their chance */
  const fg_effect_set *tried; /* fitted and not right, or NULL */
  double full;                /* residual sum beside all effects */
  size_t dof;                 /* number of columns behind `full` */
  size_t new_shapes;          /* ripples and steps that were found in this round */
  unsigned unfitted;          /* effects with a shape that was found in this round */
} fg_search;

/* Reference for every set: all effects at once. */
typedef struct fg_search_baseline {
  double full, dof, unit, allowance;
  double none;    /* excess of the empty set */
  unsigned bends; /* mask of crown and skew */
  double reach;   /* of a polynomial's middle, in units of FG_FIELD_HALF_MM */
} fg_search_baseline;

/* ---- candidates.c ---- */

/* Returns true when an effect is sought: these rows can show it, and it is not barred. */
bool fg_search_seeks(const fg_search *s, const fg_effect *kind);
/* Adds a candidate together with its columns. */
void fg_search_add(fg_search *s, const fg_candidate *effect);
/* Returns the effect as it is in a set, or NULL when it or the set is missing. */
const fg_effect_found *fg_search_find_known(const fg_effect_set *known, const fg_effect *kind);

size_t fg_search_bits(unsigned mask);
/* Returns the mask of the free curves, or of the listed effects. */
unsigned fg_search_mask_of(const fg_explanations *out, bool of_free);
/* Returns true when a set holds two bases of one effect, two ripples of one period or two steps at
 * one place. */
bool fg_search_has_collinear(const fg_explanations *out, unsigned mask);
/* Inserts an explanation into the list, which is sorted by residual sum plus 2 per number (Akaike
 * 1974). */
void fg_search_keep(fg_explanations *out, const fg_explanation *explanation);
/* Returns the criterion that explanations are sorted by. */
static inline double fg_search_akaike(const fg_explanation *m) {
  return m->excess - 2 * m->dof;
}

/* Relative difference below which two shapes are one: over a foil's 40 mm, a ripple of 2 mm then
 * shifts by up to one wave. */
#define FG_SEARCH_COLLINEAR_SHARE 0.05

/* Penalty per cause beside Schwarz's criterion, -2 ln(prior): a listed cause is present in one part
 * or scan of 20. One unlisted cause is likelier than several listed ones that happen to sum to its
 * curve. */
#define FG_SEARCH_CAUSE 6.0
static inline double fg_search_causes(unsigned mask) {
  return FG_SEARCH_CAUSE * (double)fg_search_bits(mask);
}

/* ---- noise.c ---- */

/* Estimates the noise of a row and its correlation from the residual beside geometry and all
 * effects, or all listed effects; returns the rank of the basis. */
size_t fg_search_noise(fg_search *s, bool listed_only);
/* Estimates them again beside all effects, with all columns of a curve that is in the set: the
 * curve is no noise. */
void fg_search_refine_noise(fg_search *s);

/* FG_ERR_DATA when the last noise rests on too few rows. */
fg_status fg_search_check_rows(fg_context *ctx, const fg_search *s);

/* Returns the probability of so large a chi² of `numbers` by chance. The noise is an estimate, so
 * the distribution is Fisher's F. */
double fg_search_chance(const fg_search *s, double chi2, double numbers);
double fg_search_chance_limit(const fg_search *s, double p, double numbers);

/* Returns the integral of the residual's correlation along the edge. */
double fg_search_integral(const fg_search_columns *columns);

/* ---- score.c ---- */

/* Gain in chi² of one column that 1 in 1000 reaches by chance. */
#define FG_SEARCH_GAIN_MIN 10.8

fg_search_baseline fg_search_find_baseline(fg_search *s);

/* Fits a set. An excess of INFINITY marks a mask that is no set of its own. */
fg_explanation fg_search_try(const fg_search *s, const fg_search_baseline *y, unsigned mask);
/* Returns the excess, in chi², that errors of the edge model and of the effects' bases may leave.
 */
double fg_search_known_to(const fg_search *s, const fg_search_baseline *y, const fg_explanation *m);
/* Returns true when a set leaves no more than noise and model errors allow. */
bool fg_search_is_right(const fg_search *s, const fg_search_baseline *y, const fg_explanation *m);
/* Returns true when a set leaves no more than noise and the edge model's error allow, without the
 * errors of the effects' bases. */
bool fg_search_is_exact(const fg_search *s, const fg_search_baseline *y, const fg_explanation *m);
/* Returns Schwarz's criterion; smaller is better. */
double fg_search_schwarz(const fg_search *s, const fg_explanation *m);

/* Returns the gain in chi² of further terms beside a set, and their number. */
double fg_search_gain_of_more(const fg_search *s, const fg_search_baseline *y, unsigned mask,
                              const fg_search_term *more, size_t count, size_t *numbers);

/* Residual sum of one effect alone; the standard deviation of its leading amplitude beside other
 * effects for noise of 1 um, INFINITY when it lies in their span. */
double fg_search_sum_of_one(const fg_search *s, const fg_search_baseline *y, size_t e);
double fg_search_amplitude_u(const fg_search *s, unsigned others, size_t e);

/* ---- sets.c ---- */

/* Tries sets by the policy and fills the explanations. */
void fg_search_try_sets(fg_search *s, const fg_search_baseline *y);
/* Returns true when the best set should be fitted before a curve is accepted: it holds a shape that
 * was found in this round, explains most of the residual, and no curve is far better. */
bool fg_search_hopes_for_shape(const fg_search *s, const fg_search_baseline *y,
                               const fg_explanation *best, const fg_explanation *curve);

/* ---- rivals.c ---- */

/* Adds free curves, smooth ones of few numbers, that fit as well as the best listed explanation. */
void fg_search_add_rivals(fg_search *s, const fg_search_baseline *y);
/* Adds smooth curves over other coordinates that fit as well as the one curve in the list, whose
 * score by Schwarz's criterion is given. */
void fg_search_add_curves(fg_search *s, const fg_search_baseline *y, double score);
/* Returns true when a smooth free curve beside a set gains more than chance and more than
 * `known_to`. */
bool fg_search_curve_helps(const fg_search *s, const fg_search_baseline *y, unsigned mask,
                           double known_to);
/* Returns the smooth free curve, or the single bump, that Schwarz's criterion prefers, right or
 * not, and its criterion. */
fg_explanation fg_search_best_smooth(const fg_search *s, const fg_search_baseline *y,
                                     double *score);

/* ---- describe.c ---- */

/* Fills the report's facts of every effect, and of the width, beside the best explanation. */
void fg_search_describe(fg_search *s, const fg_search_baseline *y);

/* ---- places.c, placed.c ---- */

/* Smallest size at which a ripple or step becomes a candidate, um (tuned on reports/loop_scans.md).
 */
#define FG_SEARCH_SHAPED_MIN_UM 0.15

/* Best place of a shaped effect beside the first `rank` vectors of the basis, with `left` their
 * residual: its gain in chi² and size in um. */
typedef struct fg_search_hit {
  double gain, amplitude, at;
} fg_search_hit;
fg_status fg_search_find_place(fg_context *ctx, fg_search *s, size_t rank, const fg_effect *kind,
                               fg_search_hit *best);
void fg_search_free_grids(fg_search *s);
/* Returns the part of a step at this place that the basis leaves, as a mean square per um²;
 * INFINITY when too few rows lie on one side. */
double fg_search_rest_of_step(const fg_search_columns *c, size_t rank, const fg_effect *kind,
                              double at_mm, double *work);

/* Adds a smooth effect with a shape twice: with its shape in the known set (NULL: none), and with
 * the shape that explains most beside the geometry alone, which a fit beside wrong effects may have
 * missed. */
fg_status fg_search_add_shaped(fg_context *ctx, fg_search *s, const fg_effect *kind,
                               const fg_effect_set *known);

/* Searches ripples and steps beside all other effects, and adds those that stand out. */
fg_status fg_search_find_on_foils(fg_context *ctx, fg_search *s);
fg_status fg_search_find_on_discs(fg_context *ctx, fg_search *s);
/* Adds ripples and steps that beside the geometry alone explain as much as the best smooth effect:
 * that effect may be an artefact of theirs. */
fg_status fg_search_find_in_place(fg_context *ctx, fg_search *s);

/* Adds steps at other places that the geometry makes equivalent to known ones: a whole bump between
 * the two places absorbs the difference. They are effects of their own. */
fg_status fg_search_add_other_steps(fg_context *ctx, fg_search *s, const fg_effect_set *known);

#endif
