/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Uncertainty of every value by a scanner's model. */
#include <math.h>
#include <stddef.h>

#include "quantity/quantity_rows.h"

enum { CIRCLE = 3 }; /* rows of a circle's covariance: x, y, radius */

size_t fg_quantity_moves(fg_quantity_owner owner) {
  size_t count, moves = 0;
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t i = 0; i < count; i++)
    if (fg_quantity_has_u(&rows[i])) moves += fg_quantity_values(&rows[i]);
  return moves;
}

void fg_quantity_keep_farthest(fg_quantity_owner owner, const void *object, const void *other,
                               double *farthest) {
  size_t count;
  const fg_quantity *rows = fg_quantities(owner, &count);
  for (size_t i = 0; i < count; i++) {
    double here[FG_QUANTITY_NUMBERS_MAX], there[FG_QUANTITY_NUMBERS_MAX];
    if (!fg_quantity_has_u(&rows[i])) continue;
    fg_quantity_numbers(&rows[i], object, here);
    fg_quantity_numbers(&rows[i], other, there);
    for (size_t k = 0; k < fg_quantity_values(&rows[i]); k++, farthest++)
      if (fabs(there[k] - here[k]) > fabs(*farthest)) *farthest = there[k] - here[k];
  }
}

/* Widens a circle's covariance: a move of the whole circle moves centre and radius together. */
static void widen_covariance(void *object, size_t offset, const double move[CIRCLE]) {
  double *covariance = (double *)(void *)((char *)object + offset);
  for (int i = 0; i < CIRCLE; i++)
    for (int k = 0; k < CIRCLE; k++)
      covariance[CIRCLE * i + k] += move[i] * move[k];
}

void fg_quantity_widen(fg_quantity_owner owner, void *object, const double *moves, double share) {
  size_t count, covariance = 0;
  const fg_quantity *rows = fg_quantities(owner, &count);
  double circle[CIRCLE] = {0};
  for (size_t i = 0; i < count; i++) {
    double numbers[FG_QUANTITY_NUMBERS_MAX];
    size_t values = fg_quantity_values(&rows[i]);
    if (!fg_quantity_has_u(&rows[i])) continue;
    fg_quantity_numbers(&rows[i], object, numbers);
    for (size_t k = 0; k < values; k++, moves++) {
      numbers[values + k] = hypot(numbers[values + k], share * *moves);
      if (rows[i].covariance) circle[rows[i].covariance_row + k] = share * *moves;
    }
    fg_quantity_restore(&rows[i], object, numbers);
    if (rows[i].covariance) covariance = rows[i].covariance;
  }
  if (covariance) widen_covariance(object, covariance, circle);
}
