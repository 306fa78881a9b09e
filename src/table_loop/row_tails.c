/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/row_tails.h"

#include <math.h>

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>

#include "core/splitmix.h"

/* Tails of measured tables (dof) with their prior probabilities, a choice (power and false claims
 * with heavy tails: reports/loop_power.md). The last is normal. */
static const double tail_dof[FG_ENGINE_TAILS] = {3, 4, 6, 10, INFINITY};
static const double tail_before[FG_ENGINE_TAILS] = {0.01, 0.03, 0.08, 0.18, 0.7};

/* Share of a row's own error from which on the prediction's part is left out of account. */
#define OWN_ALONE 0.8
/* Smallest share: a row that the model fits alone. */
#define OWN_MIN 1e-3
/* Integral over the prediction's error, in its sd. */
#define REACH 8.0
#define STEP  0.25
/* Tail at which sizes are compared. */
enum { COMPARED = 1, BISECTIONS = 50 };
#define SIZE_MAX_SD 1e4

static double unit_of(double dof) {
  return sqrt((dof - 2) / dof);
}

/* One side, of unit variance. */
static double beyond_own(double x, double dof) {
  return gsl_cdf_tdist_Q(x / unit_of(dof), dof);
}

static double density_own(double x, double dof) {
  return gsl_ran_tdist_pdf(x / unit_of(dof), dof) / unit_of(dof);
}

/* Of sqrt(own) t + sqrt(1 - own) z at x: the probability beyond, or the density. */
static double with_prediction(double x, double dof, double own, double (*of)(double, double)) {
  double sum = 0, share = fmax(own, OWN_MIN), root = sqrt(share), other = sqrt(1 - share);
  for (double z = -REACH; z <= REACH; z += STEP)
    sum += STEP * gsl_ran_ugaussian_pdf(z) * of((x - other * z) / root, dof);
  return of == density_own ? sum / root : sum;
}

static double beyond_tail(double size, double dof, double own) {
  return 2 *
         (own >= OWN_ALONE ? beyond_own(size, dof) : with_prediction(size, dof, own, beyond_own));
}

static double log_density(double size, double dof, double own) {
  if (isinf(dof)) return log(gsl_ran_ugaussian_pdf(size));
  return log(own >= OWN_ALONE ? density_own(size, dof)
                              : with_prediction(size, dof, own, density_own));
}

static double weigh_tail(const fg_engine_tail_rows *rows, size_t k) {
  double dof = tail_dof[k], sum = log(tail_before[k]);
  double beyond =
      isinf(dof) ? 2 * gsl_cdf_ugaussian_Q(rows->largest) : beyond_tail(rows->largest, dof, 1);
  if (rows->beyond) sum += (double)rows->beyond * log(fmax(beyond, 1e-300));
  for (size_t i = 0; i < rows->n; i++)
    if (!isnan(rows->size[i])) sum += log_density(rows->size[i], dof, rows->own[i]);
  return sum;
}

void fg_engine_tails_weigh(const fg_engine_tail_rows *rows, double weight[FG_ENGINE_TAILS]) {
  double max = -INFINITY, sum = 0;
  for (size_t k = 0; k < FG_ENGINE_TAILS; k++)
    max = fmax(max, weight[k] = weigh_tail(rows, k));
  for (size_t k = 0; k < FG_ENGINE_TAILS; k++)
    sum += weight[k] = exp(weight[k] - max);
  for (size_t k = 0; k < FG_ENGINE_TAILS; k++)
    weight[k] /= sum;
}

double fg_engine_tails_beyond(const double weight[FG_ENGINE_TAILS], double size, double own,
                              double normal_dof) {
  double p = 0;
  for (size_t k = 0; k < FG_ENGINE_TAILS; k++)
    p += weight[k] * (isinf(tail_dof[k]) ? 2 * gsl_cdf_tdist_Q(size, normal_dof)
                                         : beyond_tail(size, tail_dof[k], own));
  return p;
}

double fg_engine_tails_equivalent(double size, double own) {
  double dof = tail_dof[COMPARED], x = fabs(size), low = x, high = SIZE_MAX_SD;
  if (own >= OWN_ALONE || !(x < high)) return size;
  double p = beyond_tail(x, dof, own);
  for (int i = 0; i < BISECTIONS; i++) {
    double middle = sqrt(fmax(low, 1e-6) * high);
    if (beyond_tail(middle, dof, 1) > p)
      low = middle;
    else
      high = middle;
  }
  return copysign(fmax(high, x), size);
}

/* Student's t from normal numbers: sums of squares need a whole number of dof. */
static double draw_error(double dof, uint64_t *seed) {
  double normal = fg_splitmix_normal(seed), squares = 0;
  if (isinf(dof)) return normal;
  for (double k = 0; k < dof; k++) {
    double other = fg_splitmix_normal(seed);
    squares += other * other;
  }
  return normal / sqrt(squares / dof) * unit_of(dof);
}

void fg_engine_tails_draw(const double weight[FG_ENGINE_TAILS], size_t n, uint64_t *seed,
                          double *error) {
  double at = fg_splitmix_uniform(seed);
  size_t k = 0;
  while (k + 1 < FG_ENGINE_TAILS && at >= weight[k])
    at -= weight[k++];
  for (size_t i = 0; i < n; i++)
    error[i] = draw_error(tail_dof[k], seed);
}
