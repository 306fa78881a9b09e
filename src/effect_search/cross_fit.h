/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was found, held against rows that took no part in finding it.
 *
 * Bumps (discs: the discs) and lands go round some folds by their place; all rows of a bump, on
 * every scan of its foil, are in one. A free curve over a place tells nothing of a place where no
 * row lies, and of a step one disc may be all that shows it, so where one was found short stretches
 * of every arc go round instead. Without the rows
 * of a fold the search is repeated, and what it finds then is taken out of all rows with the
 * numbers that it has then. The geometry (every bump's circle, the overall circles, the poses) is
 * not what is tested: it is fitted to all rows, beside nothing before and beside what was found
 * after, so that both errors are of the kind that the residual of all rows is. */
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
  size_t folds;               /* 0: too few bumps or rows, and no number is told */
  double before_um, after_um; /* rms over all rows, each from the search without its fold */
  double gain, u_gain; /* fall of the mean square, um², and its standard error over what was left
                          out together: bumps, lands, discs, stretches */
} fg_cross_fit;

/* `points`: as the search left them, none of them aside; `set`: in force, not empty; `barred`: what
 * that search left out. */
fg_status fg_search_cross_fit(fg_context *ctx, const fg_edge_fit *edge_fit,
                              const fg_effect_set *set, const fg_search_bars *barred,
                              unsigned threads, fg_cross_fit *result);

#endif
