/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Products of a basis's columns with the null's span, and the statistics that follow from them.
 * They equal those of the columns beside the null, without storing any column. For tables of many
 * rows. */
#ifndef FG_TABLE_LOOP_GRAM_H
#define FG_TABLE_LOOP_GRAM_H

#include "table_loop/engine.h"

/* Products of whitened columns F with themselves, with the null's orthonormal columns Q and with
 * its residual r. */
typedef struct fg_engine_gram {
  size_t count, rank;
  double own[FG_LOOP_COLUMNS * FG_LOOP_COLUMNS]; /* F'F, the lower triangle */
  double *cross; /* count × (rank + 1): F'Q, then F'r; the caller provides room for FG_LOOP_COLUMNS
                    rows */
} fg_engine_gram;

/* `vectors`: rank + 1 of length n; the last is r. `weight` of every row: F'diag(w)F (the vectors
 * include theirs already); NULL: 1. */
void fg_engine_gram_take(size_t n, const double *columns, size_t count, const double *weight,
                         const double *vectors, size_t rank, fg_engine_gram *gram);

typedef struct fg_engine_beside_null {
  size_t rank;
  double gain;          /* reduction of |r|² */
  double length, share; /* as fg_engine_version's */
} fg_engine_beside_null;

/* Factors the gram in place. */
fg_engine_beside_null fg_engine_gram_solve(fg_engine_gram *gram);

#endif
