/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cross-validation of the search: its error on rows that it did not use.
 *
 * Folds are made of bumps (of discs on plates) and lands, by their place; all rows of a bump, on
 * every scan of its foil, are in one fold. A free curve over a place is undetermined where no row
 * lies, and a step may show on one disc only. Where one of them was found, folds are made of short
 * stretches of every arc instead. The search is repeated without the rows of a fold (where
 * evidence chose the set, its numbers alone are fitted again), and its effects are removed from the
 * rows of that fold.
 *
 * The geometry (every bump's circle, the overall circles, the poses) is not under test: it is
 * fitted to all rows, without effects before and beside the effects after. So both errors compare
 * with the residual of all rows. */
#ifndef FG_EFFECT_SEARCH_CROSS_FIT_H
#define FG_EFFECT_SEARCH_CROSS_FIT_H

#include "effect_search/effect_search.h"

typedef enum fg_cross_fit_unit {
  FG_CROSS_FIT_BUMPS,
  FG_CROSS_FIT_DISCS,
  FG_CROSS_FIT_STRETCHES
} fg_cross_fit_unit;

typedef struct fg_cross_fit {
  fg_cross_fit_unit unit;
  size_t folds;               /* 0: too few bumps or rows; then no number is reported */
  double before_um, after_um; /* rms over all rows, each from the search without its fold */
  double gain, u_gain; /* fall of the mean square, um², and its standard error over the units left
                          out together: bumps, lands, discs, stretches */
} fg_cross_fit;

/* `edge_fit`: as the search left it, with no row held out; `set`: in force, not empty; `barred`:
 * effects that the search left out; NULL: evidence chose the set over all rows, and only its
 * numbers are fitted again. */
fg_status fg_search_cross_fit(fg_context *ctx, const fg_edge_fit *edge_fit,
                              const fg_effect_set *set, const fg_search_bars *barred,
                              unsigned threads, fg_cross_fit *result);

#endif
