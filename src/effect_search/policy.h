/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the search does differently on foils and on discs, one const struct each.
 *
 * A foil's strip has hundreds of bumps' flanks in one scan, so its rows are alike and noise follows
 * the edge; but its smooth effects are nearly the same thing, so that few may stand together. A
 * plate of discs tells the smooth effects apart, but each disc has a form and a noise of its own.
 */
#ifndef FG_EFFECT_SEARCH_POLICY_H
#define FG_EFFECT_SEARCH_POLICY_H

#include "effect_search/search.h"

/* How one start of the search goes about it. With `eager`, ripples and steps are looked for at
 * once: right for them, while a large smooth effect leaves traces in the first round that look like
 * them. Two curves can be made of nearly anything, so they come last. */
typedef struct fg_search_strategy {
  bool seeds_placed_first, two_curves;
} fg_search_strategy;

enum { FG_SEARCH_STRATEGIES_MAX = 3 };

struct fg_search_policy {
  /* ---- candidates ---- */
  bool middles_with_sets; /* a polynomial's middle is found with every set, from powers that all of
                             them share; else it stands where the last fit put it */
  bool smoother_curves;   /* of all effects at once a curve is a smoother part (fg_effect_coarse) */
  bool other_steps;       /* a bump between two places lets a step stand at either */
  fg_status (*find_placed)(fg_context *ctx, fg_search *search); /* new ripples and steps */

  /* ---- which sets are tried, and which are right ---- */
  size_t (*effects_max)(const fg_edge_fit *edge_fit); /* in a set */
  bool placed_beside;   /* ripples and steps are not among those: all that stand out may be there */
  bool keeps_collinear; /* one effect in two forms is a set */
  double edge_error_um; /* of the edge model: below it effects are not told apart */
  double effect_error;  /* an effect's form is known to this share of what it does to the rows; */
  double more_error;    /* what one more effect takes beside it may be so much of that */
  double bend_error;    /* the same of one that is led by the lowest polynomials */
  double one_more_chi2; /* a set is not right beside which a further effect gains more, */
  bool counts_columns;  /* with one column; as much by chance with several, and beside what the
                           edges' model leaves */
  double
      quadratic_chi2; /* of one view: what a quadratic gains over its slope; else it is a scale */
  double placed_chi2; /* gain of a ripple or step that makes it worth a place in the search: its
                         best of some hundred places stands for ln of their number more */
  bool has_rivals;    /* smooth curves that do as well are tied with listed sets */
  double worse_chi2;  /* a set so much worse than the best one is not tied with it */
  /* Whether a listed set stands before the best one so far where none is right. */
  bool (*is_better)(const fg_search *search, const fg_explanation *explanation,
                    const fg_explanation *best);

  /* ---- where no listed set is right ---- */
  size_t beside_curve; /* listed effects beside a curve, at most */
  bool
      curves_alone_last; /* curve by curve, alone only where that is better than beside an effect */
  double curve_share;    /* a curve is known to this share of itself: no effect stands beside it for
                            less */
  /* Whether the best listed set has a shape that is to be fitted with the geometry before any
   * curve is believed. */
  bool (*is_worth_fitting)(const fg_search *search, const fg_search_baseline *baseline,
                           const fg_explanation *best, const fg_explanation *curve);
  bool smallest_beside_own; /* the least amplitude of an effect is told beside its other columns */

  /* ---- search and fit in turns ---- */
  bool scatters; /* neighbours along an edge share their noise; else what is left says how much */
  fg_search_strategy
      strategies[FG_SEARCH_STRATEGIES_MAX]; /* the next one where the last is not right */
  size_t strategy_count;
  double converged_share;  /* a set that is not right has come to rest when a round takes no more of
                         what  is left */
  bool converges_in_force; /* it rests when it finds the set in force again, not the one it found
                          last: one that the fit gave up is tried again, without its outliers */
  bool falls_back; /* of a set that no fit holds the best effect is fitted alone; else the set is
                      not tried again */
  bool drops_nothings; /* what the fit has made nothing of leaves */
  bool drops_ends;     /* an arc's last rows may reach into its fillet */
  bool own_noise;      /* rows are outliers by their own noise, not by their size */
  double step_half_mm; /* half the height of the rows that a step in the picture blurs */

  /* ---- between parts ---- */
  bool confirms; /* what is found must be confirmed from part to part */
};

/* By what the parts are. */
const fg_search_policy *fg_search_policy_of(const fg_edge_fit *edge_fit);

#endif
