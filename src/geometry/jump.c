/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/jump.h"

#include <math.h>
#include <string.h>

fg_distance fg_distance_at(double cosine, double sine, double mm) {
  return (fg_distance){.row = {cosine, sine, 1, cosine * cosine - sine * sine, 2 * cosine * sine},
                       .mm = mm};
}

/* The squares are summed from the residuals: those of sound lands are a small difference of large
 * sums. */
double fg_distances_fit(const fg_distance *distances, size_t count, size_t terms,
                        double x[FG_SMALL_MAX], double inverse[FG_SMALL_MAX][FG_SMALL_MAX]) {
  fg_normal_equations system;
  double left = 0;
  fg_normal_clear(&system, terms);
  for (size_t i = 0; i < count; i++)
    fg_normal_add(&system, distances[i].row, distances[i].mm, 1);
  if (!fg_normal_solve(&system, 0, x, inverse)) return INFINITY;
  for (size_t i = 0; i < count; i++) {
    double residual = distances[i].mm;
    for (size_t k = 0; k < terms; k++)
      residual -= distances[i].row[k] * x[k];
    left += residual * residual;
  }
  return left;
}

double fg_jump_residual(const fg_jump_sums *sums, const fg_distance *distance) {
  double residual = distance->mm;
  for (int k = 0; k < FG_CIRCLE_TERMS; k++)
    residual -= sums->moves[k] * distance->row[k];
  return residual;
}

void fg_jump_clear(fg_jump_sums *sums) {
  sums->with_residual = sums->with_itself = 0;
  memset(sums->with_row, 0, sizeof sums->with_row);
}

bool fg_jump_solve(const fg_jump_sums *sums, int axis, double min_share, double *jump_mm,
                   double change[FG_CIRCLE_TERMS]) {
  double moved[FG_CIRCLE_TERMS], own = sums->with_itself;
  for (int p = 0; p < FG_CIRCLE_TERMS; p++) {
    moved[p] = 0;
    for (int q = 0; q < FG_CIRCLE_TERMS; q++)
      moved[p] += sums->inverse[p][q] * sums->with_row[q];
    own -= moved[p] * sums->with_row[p];
  }
  if (!(own > min_share * sums->with_itself)) return false;
  *jump_mm = sums->with_residual / own;
  for (int k = 0; k < FG_CIRCLE_TERMS; k++)
    change[k] = sums->moves[k] - moved[k] * *jump_mm + (k == axis ? *jump_mm / 2 : 0);
  return true;
}
