/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regression line of points in clusters (bumps of a foil).
 *
 * The line is least squares. Points of one cluster have a common error (the foil's springback, its
 * place in the oven) and are not independent: the variance of the slope is the sum over clusters of
 * the squared scores (Liang and Zeger 1986), each with the residuals of its cluster enlarged by (I
 * - H_gg)^(-1/2), the bias-reduced form CR2 (Bell and McCaffrey 2002). With few clusters that
 * variance is itself uncertain: its degrees of freedom are Satterthwaite's, from the same paper, 2
 * E² / Var of it where points are independent.
 *
 * With n points, x about its mean and s = sum of squares of x, the rows z = (1/sqrt n, x/sqrt s)
 * are orthonormal, H = Z Z', and a cluster enters only by its 2 × 2 matrix S = Z_g' Z_g. With S
 * = V diag(l) V': Z_g' (I - H_gg)^(-1/2) = V diag((1 - l)^(-1/2)) V' Z_g'. */
#ifndef FG_STATS_CLUSTER_LINE_H
#define FG_STATS_CLUSTER_LINE_H

#include <stddef.h>

#include "foilgauge/status.h"

typedef struct fg_cluster_line {
  double slope, intercept, r;
  double u_slope, dof; /* NaN for fewer than two clusters */
} fg_cluster_line;

/* `cluster[i]`, below `clusters`, is the cluster of point i. */
fg_status fg_cluster_line_fit(fg_context *ctx, const double *x, const double *y,
                              const size_t *cluster, size_t count, size_t clusters,
                              fg_cluster_line *line);

#endif
