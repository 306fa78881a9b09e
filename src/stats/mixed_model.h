/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear model with one random effect: y = X b + Z u + e, u of the groups, e of the runs.
 *
 * V = s² (I + r Z Z'), r the ratio of the groups' variance to that of the runs. Restricted
 * likelihood (Patterson and Thompson 1971), profiled over b and s², so that only r is searched for.
 * Variances and degrees of freedom of the estimates: Kenward and Roger (1997).
 *
 * The groups' variance may come out negative: group means that scatter less than the scatter of
 * their runs implies. It stays negative for its effect on b. Held at 0 it would make the intervals
 * of differences between groups too wide (99 % where 95 % is stated), and with groups of one size
 * the answer would not be that of the analysis of variance, which uses the means' scatter without a
 * lower limit.
 *
 * Everything is computed in the orthonormal basis Q of X that least squares found, from the groups'
 * sums s_g = Q_g' 1 and of the residuals: V of a group has the eigenvalue s² (1 + n_g r) along 1
 * and s² across it. */
#ifndef FG_STATS_MIXED_MODEL_H
#define FG_STATS_MIXED_MODEL_H

#include <gsl/gsl_matrix.h>

#include "foilgauge/regression.h"
#include "foilgauge/table.h"

enum { FG_MIXED_RUNS, FG_MIXED_GROUPS, FG_MIXED_VARIANCES };

typedef struct fg_mixed_model {
  size_t columns, rank;
  double variance[FG_MIXED_VARIANCES];
  bool fixed_groups;
  bool at_border;   /* the groups' variance is estimated as 0 or less */
  double *estimate; /* columns; 0 where aliased */
  /* Of b, columns × columns, 0 where aliased: the covariance, the same with Kenward and Roger's
   * adjustment, and its derivatives by the two variances. */
  double *covariance, *adjusted, *slope[FG_MIXED_VARIANCES];
  double variances_covariance[FG_MIXED_VARIANCES][FG_MIXED_VARIANCES];
} fg_mixed_model;

/* `least_squares` is of the same model and response. FG_ERR_NUMERIC where the two variances cannot
 * be separated: no dof for the groups or for the runs within them. `fixed_groups`, for groups
 * without dof: the groups are arbitrary, so only differences within them have a meaningful
 * covariance, and the groups' variance is NaN. */
fg_status fg_mixed_fit(fg_context *ctx, const fg_model *model, const fg_levels *groups,
                       const fg_regression *least_squares, bool fixed_groups,
                       fg_mixed_model *mixed);
void fg_mixed_free(fg_mixed_model *mixed);

/* Returns the variance of row · b and its dof; with `run`, that of one new run of a new group
 * there. */
double fg_mixed_variance(const fg_mixed_model *mixed, const double *row, bool run, double *dof);

/* Tests whether `count` linear combinations of the coefficients are all 0: scaled F and the dof of
 * its denominator. `rows` is count × columns. NaN when `count` is 0. */
fg_status fg_mixed_test(fg_context *ctx, const fg_mixed_model *mixed, const double *rows,
                        size_t count, double *f, double *dof);

/* Sets *orthogonal where least squares is the estimate at every ratio: groups of one size, and Z Z'
 * X within the space of X. Then the analysis of variance by strata is exact, and `of_groups`,
 * columns × columns, becomes the projector Q' Z Z' Q / n onto the errors that the groups make. */
fg_status fg_mixed_is_orthogonal(fg_context *ctx, const fg_model *model, const fg_levels *groups,
                                 const fg_regression *least_squares, bool *orthogonal,
                                 double *of_groups);

/* Trace of a b. */
double fg_mixed_trace_product(const gsl_matrix *a, const gsl_matrix *b);

#endif
