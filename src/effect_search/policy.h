/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Differences between the searches on foils and on discs: one const struct each.
 *
 * A foil's strip has hundreds of bumps' flanks in one scan, so its rows are alike and noise
 * follows the edge. But its smooth effects are nearly collinear, so a set may hold only a few. A
 * plate of discs tells the smooth effects apart, but each disc has a form error and a noise of its
 * own. */
#ifndef FG_EFFECT_SEARCH_POLICY_H
#define FG_EFFECT_SEARCH_POLICY_H

#include "effect_search/state.h"

/* Strategy of one start of the search. With `seeds_placed`, ripples and steps are sought from the
 * first round on. That is correct for ripples and steps, but a large smooth effect leaves residuals
 * in the first round that resemble them. Two curves fit nearly anything, so strategies with two
 * come last. */
typedef struct fg_search_strategy {
  bool seeds_placed_first, two_curves;
} fg_search_strategy;

enum { FG_SEARCH_STRATEGIES_MAX = 3 };

struct fg_search_policy {
  /* ---- candidates ---- */
  bool middles_with_sets; /* a polynomial's middle is determined with every set, from powers common
                             to all polynomials; else it is held where the last fit put it */
  bool smoother_curves;   /* in the set of all effects, a curve enters as its smoother part
                             (fg_effect_coarse) */
  bool other_steps; /* steps at either end of a bump are both candidates: the bump between them
                       makes them equivalent */
  fg_status (*find_placed)(fg_context *ctx, fg_search *search); /* finds new ripples and steps */

  /* ---- which sets are tried, and which are right ---- */
  size_t (*effects_max)(const fg_edge_fit *edge_fit); /* maximum size of a set */
  bool placed_beside;    /* ripples and steps do not count in the size: all that stand out may be in
                            the set */
  bool keeps_collinear;  /* two bases of one effect may be in a set */
  double edge_error_um;  /* error of the edge model: smaller effects are not told apart */
  double effect_error;   /* relative error of an effect's basis, as a share of its displacements; */
  double more_error;     /* residual that one more effect may explain beside it, as such a share */
  double bend_error;     /* as more_error, for an effect that the lowest polynomials dominate */
  double one_more_chi2;  /* a set is not right if one further effect of one column gains more than
                            this; */
  bool counts_columns;   /* for several columns: the gain of equal probability by chance, plus the
                            residual of the edge model */
  double quadratic_chi2; /* gain of a quadratic over its slope that one scan must show; else the
                            effect is a scale */
  double placed_chi2;    /* gain at which a ripple or step becomes a candidate: the best of some
                            hundred places gains more by chance, by ln of their number */
  bool has_rivals;       /* smooth curves that fit as well are tied with listed sets */
  double worse_chi2;     /* a set worse than the best one by more than this is not tied with it */
  /* Returns true when a listed set is better than the best one so far, where none is right. */
  bool (*is_better)(const fg_search *search, const fg_explanation *explanation,
                    const fg_explanation *best);

  /* ---- where no listed set is right ---- */
  size_t beside_curve;    /* maximum number of listed effects beside a curve */
  bool curves_alone_last; /* a curve is tried alone last, and accepted only if better than beside an
                             effect */
  double curve_share; /* relative error of a curve: an effect that explains less stands not beside
                         it */
  /* Returns true when the best listed set has a shape that must be fitted with the geometry before
   * any curve is accepted. */
  bool (*is_worth_fitting)(const fg_search *search, const fg_search_baseline *baseline,
                           const fg_explanation *best, const fg_explanation *curve);
  bool smallest_beside_own; /* the smallest detectable amplitude is determined beside the effect's
                               other columns */

  /* ---- search and fit in turns ---- */
  bool scatters; /* rows are weighted by noise that neighbours along an edge share; else the
                    residual estimates the correlation */
  fg_search_strategy strategies[FG_SEARCH_STRATEGIES_MAX]; /* tried in order until one is right */
  size_t strategy_count;
  double converged_share;  /* a set that is not right has converged when a round lowers the residual
                              by no more than this share */
  bool converges_in_force; /* converged when the search finds the set in force again, not the set
                              found last; so a set that the fit gave up is tried again without its
                              outliers */
  bool falls_back; /* when a set cannot be fitted, its best effect is fitted alone; else the set is
                      not tried again */
  bool drops_nothings; /* effects that the fit reduced to nothing are dropped from the set */
  bool drops_ends;     /* drops the last rows of an arc that reach into its fillet */
  bool own_noise; /* outliers are judged in units of each row's noise, not of the common noise */
  double step_half_mm; /* half the height of the band of rows that a step in the picture blurs */

  /* ---- between parts ---- */
  bool confirms; /* findings must be confirmed from part to part */
};

/* Returns the policy for the kind of parts in the edge fit. */
const fg_search_policy *fg_search_policy_of(const fg_edge_fit *edge_fit);

#endif
