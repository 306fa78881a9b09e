/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effect/bases.h"

#include <math.h>

static const double gas_constant_kj = 8.314462618e-3; /* per mol and K */

/* Scales a monotone function to -1 and +1 at the ends of the coordinate. */
static double scaled_basis(double value, double at_low, double at_high) {
  return at_high != at_low ? (2 * value - at_low - at_high) / (at_high - at_low) : 0;
}

bool fg_basis_accepts_temperature(const fg_loop_problem *problem, size_t a, size_t b) {
  const fg_loop_coordinate *at = &problem->coordinate[a];
  (void)b;
  return fg_basis_is_number(at) && at->roles & FG_LOOP_TEMPERATURE &&
         at->low + at->kelvin_offset > 0;
}

bool fg_basis_accepts_duration(const fg_loop_problem *problem, size_t a, size_t b) {
  const fg_loop_coordinate *at = &problem->coordinate[a];
  (void)b;
  return fg_basis_is_number(at) && at->roles & FG_LOOP_DURATION && at->low > 0;
}

bool fg_basis_accepts_both(const fg_loop_problem *problem, size_t a, size_t b) {
  return a != b && fg_basis_accepts_temperature(problem, a, a) &&
         fg_basis_accepts_duration(problem, b, b);
}

/* A rate with activation energy `shape` kJ/mol. */
static double rate(const fg_loop_coordinate *at, double value, double energy) {
  double kelvin = value + at->kelvin_offset, top = at->high + at->kelvin_offset;
  return exp(-energy / gas_constant_kj * (1 / kelvin - 1 / top));
}

void fg_basis_arrhenius(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                        const double *shape, double *columns) {
  const fg_loop_coordinate *at = fg_basis_first(problem, candidate);
  double low = rate(at, at->low, shape[0]), high = rate(at, at->high, shape[0]);
  for (size_t i = 0; i < problem->rows; i++)
    columns[i] = scaled_basis(rate(at, at->value[i], shape[0]), low, high);
}

size_t fg_basis_arrhenius_starts(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                                 double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  static const double energy[] = {20, 60, 120, 240};
  (void)problem, (void)candidate;
  for (size_t i = 0; i < 4; i++)
    starts[i][0] = energy[i];
  return 4;
}

/* T (20 + log10 t), kelvin and hours (Larson and Miller 1952). */
static double larson_miller(const fg_loop_coordinate *at, double temperature, double duration) {
  return (temperature + at->kelvin_offset) * (20 + log10(duration));
}

void fg_basis_larson_miller(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                            const double *shape, double *columns) {
  const fg_loop_coordinate *t = fg_basis_first(problem, candidate);
  const fg_loop_coordinate *d = &problem->coordinate[candidate->b];
  double low = larson_miller(t, t->low, d->low), high = larson_miller(t, t->high, d->high);
  (void)shape;
  for (size_t i = 0; i < problem->rows; i++)
    columns[i] = scaled_basis(larson_miller(t, t->value[i], d->value[i]), low, high);
}

void fg_basis_log_time(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                       const double *shape, double *columns) {
  const fg_loop_coordinate *at = fg_basis_first(problem, candidate);
  (void)shape;
  for (size_t i = 0; i < problem->rows; i++)
    columns[i] = scaled_basis(log(at->value[i]), log(at->low), log(at->high));
}

/* Share transformed after a time: 1 - exp(-(t / tau)^n) (Johnson, Mehl, Avrami, Kolmogorov). */
static double transformed(double time, const double *shape) {
  return -expm1(-pow(time / shape[0], shape[1]));
}

void fg_basis_jmak(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                   const double *shape, double *columns) {
  const fg_loop_coordinate *at = fg_basis_first(problem, candidate);
  double low = transformed(at->low, shape), high = transformed(at->high, shape);
  for (size_t i = 0; i < problem->rows; i++)
    columns[i] = scaled_basis(transformed(at->value[i], shape), low, high);
}

size_t fg_basis_jmak_starts(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                            double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  const fg_loop_coordinate *at = fg_basis_first(problem, candidate);
  size_t count = 0;
  for (double share = 0.2; share < 1; share *= 2)
    for (double n = 1; n <= 3; n++) {
      starts[count][0] = at->low + share * (at->high - at->low);
      starts[count++][1] = n;
    }
  return count;
}
