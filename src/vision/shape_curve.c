/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/shape_curve.h"

#include <math.h>
#include <string.h>

#include "core/spread.h"

/* Stations further than this many robust deviations from the smooth curve are left out of it; the
 * floor is for values that are all equal. */
#define OUTLIER_DEVIATIONS 4.0
#define LIMIT_MIN          1e-9
/* Ridge on every coefficient but the constant, as a share of the constant's weight: a curve over
 * equal directions stays solvable. */
#define RIDGE 1e-3
/* Min degrees of freedom for an estimate of the scatter. */
#define DOF_MIN 4

bool fg_shape_curve_solve(fg_normal_equations *system, const fg_shape_curve_sums *sums, bool judged,
                          double *coefficients, double *real) {
  double x[FG_SMALL_MAX];
  for (size_t b = 1; b < system->unknowns; b++)
    system->matrix[b][b] += RIDGE * system->matrix[0][0];
  if (!fg_normal_solve(system, 0, x, NULL)) return false;
  memcpy(coefficients, x, system->unknowns * sizeof *x);
  double dof = sums->count - (double)system->unknowns;
  if (judged && dof > DOF_MIN && sums->squares > 0)
    *real = fmax(0, 1 - 2 * sums->expected * dof / (sums->squares * sums->count));
  return true;
}

double fg_shape_curve_limit(double *sizes, size_t count) {
  return fg_spread_limit(sizes, count, OUTLIER_DEVIATIONS) + LIMIT_MIN;
}
