/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Capability of a process against a tolerance (ISO 22514-2; Bissell 1990).
 *
 *   Pp  = (U - L) / 6 s        Ppk = min(U - mean, mean - L) / 3 s       s: of all values
 *   Cp  = (U - L) / 6 sigma    Cpk = min(U - mean, mean - L) / 3 sigma   sigma: within subgroups
 * Cp and Cpk predict the process, so they are stated only when a control chart shows it stable;
 * Pp and Ppk describe the values at hand. Where values are not normal (Anderson
 * and Darling 1954, case of unknown mean and sd; p-value after D'Agostino and Stephens 1986), the
 * quantile method: 6 s becomes X99.865 - X0.135, the mean becomes X50, all of the kernel density.
 *
 * Intervals: Pp sqrt(chi2(a/2, f) / f); Ppk ± z sqrt(1/(9 n) + Ppk² / (2 f)).
 *
 * Values of one group (bumps of a foil) share the group's level and are not independent. Then the
 * variance of a value is B / n0 + (1 - 1 / n0) W, B and W the mean squares between and within the
 * groups, n0 the mean number of values of a group; its interval is that of Graybill and Wang 1980,
 * and Ppk joins it with the mean's (Zou and Donner 2008); of one group alone there is none.
 * Normality is tested of the groups' means
 * and of the deviations from them, as two tests.
 */
#ifndef FOILGAUGE_CAPABILITY_H
#define FOILGAUGE_CAPABILITY_H

#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/density.h"
#include "foilgauge/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct fg_normality {
  double a2;      /* Anderson-Darling, adjusted for n */
  double p_value; /* NaN for fewer than 8 values */
} fg_normality;

/* Values in groups, group by group; an empty group may be among them. */
typedef struct fg_value_groups {
  const size_t *size; /* number of values of each group; NULL: the values are independent */
  size_t count;
} fg_value_groups;

fg_status fg_normality_test(fg_context *ctx, const double *values, size_t count,
                            fg_normality *normality);

/* Returns the test of the two that rejects more, its p doubled for their number. */
fg_status fg_normality_test_groups(fg_context *ctx, const double *values, size_t count,
                                   fg_value_groups groups, fg_normality *normality);

typedef struct fg_ratio {
  double value, low, high; /* with its confidence interval; NaN where it cannot be said */
} fg_ratio;

typedef struct fg_capability {
  size_t count;
  double mean, sd;
  fg_ratio p, pk;                 /* one-sided tolerances have no p */
  fg_ratio c, ck;                 /* NaN unless stable */
  double quantile_p, quantile_pk; /* by the quantile method */
  double quantile[3];             /* X0.135, X50, X99.865 % */
  fg_normality normality;
  bool stable;
  bool normal; /* p_value >= 0.05, or too few values to say */
} fg_capability;

typedef struct fg_capability_input {
  const double *values;
  size_t count;
  fg_value_groups groups;
  double lower, upper; /* -inf, +inf: none */
  double sigma;        /* within subgroups; NaN: not known */
  double sigma_dof;    /* its degrees of freedom */
  bool stable;
  double confidence;         /* 0: 0.95 */
  const fg_density *density; /* of the values; NULL: no quantile method */
} fg_capability_input;

/* FG_ERR_DATA for fewer than two values or no spread, FG_ERR_USAGE without any limit. */
fg_status fg_capability_compute(fg_context *ctx, const fg_capability_input *input,
                                fg_capability *capability);

#ifdef __cplusplus
}
#endif
#endif
