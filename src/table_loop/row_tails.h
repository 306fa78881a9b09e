/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tails that the errors of measured rows may have: Student's t of a few dof, and normal, with prior
 * probabilities. A row is judged by what the fit without it predicts. Of the variance of that
 * difference the share 1 - leverage (`own`) is the row's own error, with these tails; the rest is
 * the prediction's, a sum over the other rows and near normal. So the same difference is less
 * likely to be a tail in a row of high leverage. */
#ifndef FG_TABLE_LOOP_ROW_TAILS_H
#define FG_TABLE_LOOP_ROW_TAILS_H

#include <stddef.h>
#include <stdint.h>

enum { FG_ENGINE_TAILS = 5 };

/* Rows by which tails are weighed. */
typedef struct fg_engine_tail_rows {
  size_t n;
  const double *size; /* n: difference over its own sd; NaN: left out */
  const double *own;  /* n */
  double largest;     /* `beyond` rows are left out, known to lie beyond that size */
  size_t beyond;
} fg_engine_tail_rows;

/* Computes the posterior weight of each tail. */
void fg_engine_tails_weigh(const fg_engine_tail_rows *rows, double weight[FG_ENGINE_TAILS]);
/* Returns the probability of a difference beyond `size` sd on either side, over all tails;
 * `normal_dof` are those of the sd. */
double fg_engine_tails_beyond(const double weight[FG_ENGINE_TAILS], double size, double own,
                              double normal_dof);
/* Returns the size at which a row without leverage would be as rare a tail. */
double fg_engine_tails_equivalent(double size, double own);
/* Fills n independent errors of unit variance, of one tail chosen by weight. */
void fg_engine_tails_draw(const double weight[FG_ENGINE_TAILS], size_t n, uint64_t *seed,
                          double *error);

#endif
