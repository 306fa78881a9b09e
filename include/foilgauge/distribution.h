/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Probabilities and quantiles (GSL's), and the summary of one column of numbers.
 *
 * Degrees of freedom that are not positive, and statistics that are not numbers, give NaN: what
 * cannot be said is passed on as such.
 */
#ifndef FOILGAUGE_DISTRIBUTION_H
#define FOILGAUGE_DISTRIBUTION_H

#include <stddef.h>

#include "foilgauge/status.h"
#include "foilgauge/table.h"

#ifdef __cplusplus
extern "C" {
#endif

double fg_distribution_t_two_sided(double t, double dof);          /* P(|T| > |t|) */
double fg_distribution_t_quantile(double probability, double dof); /* P(T < q) = probability */
double fg_distribution_f_upper(double f, double dof_1, double dof_2);
double fg_distribution_f_quantile(double probability, double dof_1, double dof_2);
double fg_distribution_chi2_quantile(double probability, double dof);
double fg_distribution_normal_quantile(double probability);

typedef struct fg_summary {
  size_t count;
  double mean;
  double sd;              /* n - 1 in the denominator; NaN for one number */
  double autocorrelation; /* lag 1; NaN where all numbers are equal */
  double lowest, highest;
} fg_summary;

/* Sums in extended precision. FG_ERR_USAGE for no numbers. */
fg_status fg_summary_compute(fg_context *ctx, const fg_extended *numbers, size_t count,
                             fg_summary *summary);

#ifdef __cplusplus
}
#endif
#endif
