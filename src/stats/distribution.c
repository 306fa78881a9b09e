/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foilgauge/distribution.h"

#include <gsl/gsl_cdf.h>
#include <math.h>

#include "core/extended.h"
#include "core/numerics.h"

double fg_distribution_t_two_sided(double t, double dof) {
  if (!(dof > 0) || isnan(t)) return NAN;
  if (isinf(t)) return 0;
  /* t² / (dof + t²) is beta distributed; the upper tail keeps its digits where t is large. */
  return gsl_cdf_beta_P(dof / (dof + t * t), dof / 2, 0.5);
}

double fg_distribution_t_quantile(double probability, double dof) {
  if (!(dof > 0) || !(probability > 0 && probability < 1)) return NAN;
  return gsl_cdf_tdist_Pinv(probability, dof);
}

double fg_distribution_f_upper(double f, double dof_1, double dof_2) {
  if (!(dof_1 > 0 && dof_2 > 0) || isnan(f)) return NAN;
  if (isinf(f)) return 0;
  if (f <= 0) return 1;
  return gsl_cdf_beta_P(dof_2 / (dof_2 + dof_1 * f), dof_2 / 2, dof_1 / 2);
}

double fg_distribution_f_quantile(double probability, double dof_1, double dof_2) {
  if (!(dof_1 > 0 && dof_2 > 0) || !(probability > 0 && probability < 1)) return NAN;
  fg_numerics_start();
  return gsl_cdf_fdist_Pinv(probability, dof_1, dof_2);
}

double fg_distribution_chi2_quantile(double probability, double dof) {
  if (!(dof > 0) || !(probability > 0 && probability < 1)) return NAN;
  fg_numerics_start();
  double quantile = gsl_cdf_chisq_Pinv(probability, dof);
  if (isfinite(quantile)) return quantile;
  /* GSL's iteration may not converge for dof in the thousands; there the cube root is normal
   * (Wilson and Hilferty 1931). */
  double share = 2 / (9 * dof);
  return dof * pow(1 - share + sqrt(share) * gsl_cdf_ugaussian_Pinv(probability), 3);
}

double fg_distribution_normal_quantile(double probability) {
  if (!(probability > 0 && probability < 1)) return NAN;
  return gsl_cdf_ugaussian_Pinv(probability);
}

fg_status fg_summary_compute(fg_context *ctx, const fg_extended *numbers, size_t count,
                             fg_summary *summary) {
  if (!count) return fg_fail(ctx, FG_ERR_USAGE, "no numbers to summarise");
  fg_extended sum = {0, 0}, squares = {0, 0}, products = {0, 0}, before = {0, 0};
  *summary = (fg_summary){.count = count, .lowest = numbers[0].value, .highest = numbers[0].value};
  for (size_t i = 0; i < count; i++) {
    sum = fg_extended_add(sum, numbers[i]);
    summary->lowest = fmin(summary->lowest, numbers[i].value);
    summary->highest = fmax(summary->highest, numbers[i].value);
  }
  const fg_extended mean = fg_extended_divide(sum, fg_extended_of((double)count));
  for (size_t i = 0; i < count; i++) {
    fg_extended deviation = fg_extended_subtract(numbers[i], mean);
    squares = fg_extended_add(squares, fg_extended_square(deviation));
    products = fg_extended_add(products, fg_extended_multiply(deviation, before));
    before = deviation;
  }
  summary->mean = mean.value;
  summary->sd = count > 1 ? sqrt(squares.value / (double)(count - 1)) : NAN;
  summary->autocorrelation = squares.value > 0 ? fg_extended_divide(products, squares).value : NAN;
  return FG_OK;
}
