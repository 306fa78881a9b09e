/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/jump.h"

bool fg_jump_solve(const fg_jump_sums *sums, int axis, double min_share, double *jump_mm,
                   double change[FG_JUMP_CIRCLE_TERMS]) {
  double moved[FG_JUMP_CIRCLE_TERMS], own = sums->with_itself;
  for (int p = 0; p < FG_JUMP_CIRCLE_TERMS; p++) {
    moved[p] = 0;
    for (int q = 0; q < FG_JUMP_CIRCLE_TERMS; q++)
      moved[p] += sums->inverse[p][q] * sums->with_row[q];
    own -= moved[p] * sums->with_row[p];
  }
  if (!(own > min_share * sums->with_itself)) return false;
  *jump_mm = sums->with_residual / own;
  for (int k = 0; k < FG_JUMP_CIRCLE_TERMS; k++)
    change[k] = sums->moves[k] - moved[k] * *jump_mm + (k == axis ? *jump_mm / 2 : 0);
  return true;
}
