/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/tails.h"

#include <math.h>

#include "core/numerics.h"

/* Range of a wrong value, in sd of the others, to either side. */
#define WILD 20
/* Log odds of a further wrong value beside a first one, of FURTHER_OF values: several values far
 * out are typical of a heavy tail. Of more values they are more typical still: with some taken out,
 * the others look normal. */
#define FURTHER    1.2
#define FURTHER_OF 24
/* Log odds against a heavy tail of the others beside a wrong value, two departures at once: in
 * simulation anything from 3.5 to 8 gives the same errors of the test. */
#define BESIDE_TAIL 3.5
/* The scale of a Student's t, by expectation and maximisation. */
enum { SCALE_STEPS = 25 };
#define SCALE_CONVERGED 1e-6

static const double tail_dof[] = {2.5, 3, 4, 6, 10};

static double sum_of_squares(size_t count, const double *value) {
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += value[i] * value[i];
  return sum;
}

static double normal_likelihood(double count, double squares) {
  return -0.5 * count * (log(2 * M_PI * squares / count) + 1);
}

static double weighted_squares(size_t count, const double *value, double dof, double scale) {
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += (dof + 1) * value[i] * value[i] / (dof + value[i] * value[i] / scale);
  return sum;
}

static double log_terms(size_t count, const double *value, double dof, double scale) {
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += log1p(value[i] * value[i] / (dof * scale));
  return sum;
}

/* `scale` is squared. */
static double t_likelihood(size_t rest, const double *value, size_t wrong,
                           const double *wrong_value, double dof, double scale) {
  double count = (double)(rest + wrong);
  for (int step = 0; step < SCALE_STEPS; step++) {
    double before = scale;
    scale = (weighted_squares(rest, value, dof, before) +
             weighted_squares(wrong, wrong_value, dof, before)) /
            count;
    if (fabs(scale - before) < SCALE_CONVERGED * before) break;
  }
  double one = fg_log_gamma((dof + 1) / 2) - fg_log_gamma(dof / 2) - 0.5 * log(dof * M_PI * scale);
  return count * one -
         (dof + 1) / 2 *
             (log_terms(rest, value, dof, scale) + log_terms(wrong, wrong_value, dof, scale));
}

/* The largest log likelihood of a Student's t at its best scale, of any tail. */
static double best_tail(size_t count, const double *value) {
  double best = -INFINITY, scale = sum_of_squares(count, value) / (double)count;
  for (size_t k = 0; k < sizeof tail_dof / sizeof *tail_dof; k++)
    best = fmax(best, t_likelihood(count, value, 0, NULL, tail_dof[k], scale));
  return best;
}

double fg_engine_exchanged_over_tail(size_t count, const double *measured, const double *put_back) {
  double before = sum_of_squares(count, measured), after = sum_of_squares(count, put_back);
  if (!(after > 0)) return INFINITY;
  double apart =
      fmax(normal_likelihood((double)count, after), best_tail(count, put_back) - BESIDE_TAIL);
  return apart - fmax(normal_likelihood((double)count, before), best_tail(count, measured));
}

double fg_engine_wrong_over_tail(size_t rest, const double *value, size_t wrong,
                                 const double *wrong_value) {
  double squares = sum_of_squares(rest, value), all = squares + sum_of_squares(wrong, wrong_value);
  double sd = sqrt(squares / (double)rest), further = wrong > 1 ? (double)(wrong - 1) : 0;
  if (!(sd > 0)) return INFINITY;
  double apart = normal_likelihood((double)rest, squares);
  double odds = FURTHER + fmax(log((double)(rest + wrong) / FURTHER_OF), 0);
  for (size_t k = 0; k < sizeof tail_dof / sizeof *tail_dof; k++)
    apart = fmax(apart, t_likelihood(rest, value, 0, NULL, tail_dof[k], sd * sd) - BESIDE_TAIL);
  apart -= (double)wrong * log(2 * WILD * sd) + odds * further;
  double alike = normal_likelihood((double)(rest + wrong), all);
  for (size_t k = 0; k < sizeof tail_dof / sizeof *tail_dof; k++)
    alike = fmax(alike, t_likelihood(rest, value, wrong, wrong_value, tail_dof[k], sd * sd));
  return apart - alike;
}
