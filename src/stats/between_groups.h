/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Variance between groups beyond the scatter within them.
 *
 * The means y_i have the variance v_i from within; the groups scatter about a common
 * centre with the standard deviation tau. tau² solves sum w_i (y_i - centre)² = k - 1 with
 * w_i = 1 / (tau² + v_i) (Paule and Mandel 1982), its interval the same sum at the quantiles of
 * chi² (Viechtbauer 2007). */
#ifndef FG_STATS_BETWEEN_GROUPS_H
#define FG_STATS_BETWEEN_GROUPS_H

#include <stddef.h>

#include "foilgauge/status.h"

typedef struct fg_group_mean {
  double mean, variance; /* `variance`: of the mean, from the scatter within the group */
} fg_group_mean;

typedef struct fg_between {
  double centre, u_centre;
  double sd, sd_low, sd_high; /* tau */
} fg_between;

/* NaN for fewer than two groups. */
fg_between fg_between_groups(const fg_group_mean *groups, size_t count, double confidence);

/* Returns the half width, about the centre, of the prediction interval for another group's mean, by
 * Student's t with count - 1 dof. NaN for fewer than two groups. */
double fg_between_reach(const fg_between *between, size_t count, double variance,
                        double confidence);

/* Adjusts the p-values of a family so that the probability of any false rejection is the level
 * (Holm 1979). NaN stays NaN and is no member. */
fg_status fg_holm_adjust(fg_context *ctx, const double *p, size_t count, double *adjusted);

#endif
