/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Permutation tests for a difference in spread between two small samples.
 *
 * F and Levene's statistic (about the median) refer to many values, F to normal ones: with seven
 * values on each side Levene's p falls below 0.05 in 2 % of cases, and that of F in 0 to 44 %, as
 * the values have short or long tails. Here the values, aligned in their means, are reassigned to
 * the two samples in every possible way, or at random, and the statistic is compared with those of
 * the relabelled samples. */
#ifndef FG_STATS_RELABELLED_SPREAD_H
#define FG_STATS_RELABELLED_SPREAD_H

#include "foilgauge/comparison.h"

typedef struct fg_relabelled_spread {
  double p_variances; /* |ln F|, two-sided */
  double p_levene;
  bool complete; /* all relabellings were used, not a sample of them */
} fg_relabelled_spread;

/* Uses at least `draws` relabellings where more are possible; a clearly large p-value stops earlier
 * (Besag and Clifford 1991). Of samples of thousands fewer are drawn, 500 of 100,000 values,
 * and the tail that they do not reach is that of a normal distribution with their scatter. The same
 * values give the same result. NaN for fewer than three values on a side, or without any spread. */
fg_status fg_relabel_spreads(fg_context *ctx, fg_sample a, fg_sample b, size_t draws,
                             fg_relabelled_spread *result);

#endif
