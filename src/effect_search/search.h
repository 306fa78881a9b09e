/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of the search share. */
#ifndef FG_EFFECT_SEARCH_SEARCH_H
#define FG_EFFECT_SEARCH_SEARCH_H

#include "effect_search/columns.h"

/* Columns of one shaped effect over its grid of starts: a search comes back to them several times,
 * beside other effects. */
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
  bool two_curves;               /* may stand in */
  const fg_effect_set *given_up; /* no fit of these holds */
  size_t given_up_count;
  bool hopeless;              /* sets whose shapes are not fitted yet had their chance */
  const fg_effect_set *tried; /* was fitted and is not right, or NULL */
  double full;                /* residual sum beside everything */
  size_t dof;                 /* columns that took it */
  size_t new_shapes;          /* ripples and steps that were found in this round */
  unsigned unfitted;          /* effects with a shape that was found in this round */
} fg_search;

/* What the search compares with: everything at once. */
typedef struct fg_search_baseline {
  double full, dof, unit, allowance;
  double none;    /* excess of no effect */
  unsigned bends; /* crown and skew */
  double reach;   /* of a polynomial's middle, in units of FG_FIELD_HALF_MM */
} fg_search_baseline;

/* ---- candidates.c ---- */

/* Whether an effect is looked for: these points can show it, and it is not barred. */
bool fg_search_seeks(const fg_search *s, const fg_effect *kind);
/* Adds an effect whose columns are its own. */
void fg_search_add(fg_search *s, const fg_candidate *effect);
/* The effect in a set; NULL: it is not there, or there is no set. */
const fg_effect_found *fg_search_find_known(const fg_effect_set *known, const fg_effect *kind);

size_t fg_search_bits(unsigned mask);
/* Of all effects, those that are free curves, or those that are listed. */
unsigned fg_search_mask_of(const fg_explanations *out, bool of_free);
/* Two forms of one effect, and two ripples of one period or two steps at one place. */
bool fg_search_has_collinear(const fg_explanations *out, unsigned mask);
/* Puts an explanation into the list, the likeliest first: the one that leaves least, a number more
 * counting two (Akaike 1974). */
void fg_search_keep(fg_explanations *out, const fg_explanation *explanation);
/* What they are sorted by. */
static inline double fg_search_akaike(const fg_explanation *m) {
  return m->excess - 2 * m->dof;
}

/* Shapes nearer to each other than this are one: over a foil's 40 mm a ripple of 2 mm turns by as
 * much as a wave then. */
#define FG_SEARCH_COLLINEAR_SHARE 0.05

/* What causes cost beside Schwarz's criterion: each is there in one part or scan of 20 (-2 ln). One
 * unlisted cause is likelier than several listed ones that happen to make its curve. */
#define FG_SEARCH_CAUSE 6.0
static inline double fg_search_causes(unsigned mask) {
  return FG_SEARCH_CAUSE * (double)fg_search_bits(mask);
}

/* ---- noise.c ---- */

/* Noise of a row and its correlation, from what is left beside geometry and all effects, or all
 * that are listed; returns the rank of the basis that took them out. */
size_t fg_search_noise(fg_search *s, bool listed_only);
/* The same beside all effects, with all columns of a curve that is there: it is no noise. */
void fg_search_refine_noise(fg_search *s);

/* FG_ERR_DATA when the last noise rests on too few rows. */
fg_status fg_search_check_rows(fg_context *ctx, const fg_search *s);

/* Probability of so large a chi² of so many numbers by chance, and the chi² of a probability, the
 * noise being known as well as it is: Fisher's F. */
double fg_search_chance(const fg_search *s, double chi2, double numbers);
double fg_search_chance_limit(const fg_search *s, double p, double numbers);

/* Integral of the correlation of what is left, along the edge. */
double fg_search_integral(const fg_search_columns *columns);

/* ---- score.c ---- */

/* What 1 in 1000 gains by chance in one column (chi² of 1). */
#define FG_SEARCH_GAIN_MIN 10.8

fg_search_baseline fg_search_find_baseline(fg_search *s);

/* Fits a set; an excess of INFINITY says that it is no set of its own. */
fg_explanation fg_search_try(const fg_search *s, const fg_search_baseline *y, unsigned mask);
/* Excess that edges and the forms of its effects may leave, in chi². */
double fg_search_known_to(const fg_search *s, const fg_search_baseline *y, const fg_explanation *m);
/* Whether it leaves no more than it should. */
bool fg_search_is_right(const fg_search *s, const fg_search_baseline *y, const fg_explanation *m);
/* Whether it is also without what the forms of effects may leave. */
bool fg_search_is_exact(const fg_search *s, const fg_search_baseline *y, const fg_explanation *m);
/* Schwarz's criterion: the smaller one is the better one. */
double fg_search_schwarz(const fg_search *s, const fg_explanation *m);

/* What further terms gain beside a set, in chi², with so many numbers. */
double fg_search_gain_of_more(const fg_search *s, const fg_search_baseline *y, unsigned mask,
                              const fg_search_term *more, size_t count, size_t *numbers);

/* Residual sum of one effect alone; the standard deviation of its leading amplitude beside other
 * effects for noise of 1 um, INFINITY when it lies in them. */
double fg_search_outlier_sum(const fg_search *s, const fg_search_baseline *y, size_t e);
double fg_search_amplitude_u(const fg_search *s, unsigned others, size_t e);

/* ---- sets.c ---- */

/* Tries sets as the policy says, and fills the explanations. */
void fg_search_try_sets(fg_search *s, const fg_search_baseline *y);
/* A shape that was found just now has not been fitted with the geometry yet: a set that holds one
 * and takes most of what there is to take gets its chance before any curve that is not far better.
 */
bool fg_search_hopes_for_shape(const fg_search *s, const fg_search_baseline *y,
                               const fg_explanation *best, const fg_explanation *curve);

/* ---- rivals.c ---- */

/* Adds free curves that do as well as the best listed explanation, smooth ones of few numbers. */
void fg_search_add_rivals(fg_search *s, const fg_search_baseline *y);
/* Adds smooth curves over other coordinates that could take the place of the one curve in the list,
 * whose score by Schwarz's criterion is given. */
void fg_search_add_curves(fg_search *s, const fg_search_baseline *y, double score);
/* Whether a smooth free curve beside a set gains more than chance, and more than `known_to`. */
bool fg_search_curve_helps(const fg_search *s, const fg_search_baseline *y, unsigned mask,
                           double known_to);
/* The smooth free curve, or the one bump, that Schwarz's criterion prefers, whether it is right or
 * not, and that criterion. */
fg_explanation fg_search_best_smooth(const fg_search *s, const fg_search_baseline *y,
                                     double *score);

/* ---- describe.c ---- */

/* Fills what the report says of every effect, and of the width, beside the best explanation. */
void fg_search_describe(fg_search *s, const fg_search_baseline *y);

/* ---- places.c, placed.c ---- */

/* A size that makes one worth a place in the search, um (tuned on reports/loop_scans.md). */
#define FG_SEARCH_SHAPED_MIN_UM 0.15

/* Where one takes most beside the first `rank` vectors of the basis, with `left` beside them: its
 * gain in chi², its size in um. `work` has room for two columns. */
typedef struct fg_search_hit {
  double gain, amplitude, at;
} fg_search_hit;
fg_search_hit fg_search_find_place(fg_search *s, size_t rank, const fg_effect *kind, double *work);
void fg_search_free_grids(fg_search *s);
/* What a step at this place leaves beside the basis, its mean square being 1 per um; INFINITY where
 * too few rows lie on one side. */
double fg_search_rest_of_step(const fg_search_columns *c, size_t rank, const fg_effect *kind,
                              double at_mm, double *work);

/* Adds a smooth effect with a shape: with the one it has in the known set (NULL: none), and with
 * the one that takes most beside the geometry alone, which a fit beside wrong effects may have
 * missed.
 */
fg_status fg_search_add_shaped(fg_context *ctx, fg_search *s, const fg_effect *kind,
                               const fg_effect_set *known);

/* Looks for ripples and steps beside everything else, and adds those that stand out. */
fg_status fg_search_find_on_foils(fg_context *ctx, fg_search *s);
fg_status fg_search_find_on_discs(fg_context *ctx, fg_search *s);
/* Ripples and steps that beside the geometry alone take as much as the best smooth effect: they may
 * be what it only follows. */
fg_status fg_search_find_in_place(fg_context *ctx, fg_search *s);

/* Steps at other places that the geometry turns into those that are known: a whole bump between the
 * two places takes the difference. They are added as effects of their own. */
fg_status fg_search_add_other_steps(fg_context *ctx, fg_search *s, const fg_effect_set *known);

#endif
