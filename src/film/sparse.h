/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sparse matrix of fixed pattern, real and complex, factorised by KLU (SuiteSparse).
 *
 * The pattern is that of the first assembly: every assembly adds the same entries in the same
 * order, so that an addition finds its place by a counter. */
#ifndef FG_FILM_SPARSE_H
#define FG_FILM_SPARSE_H

#include <complex.h>
#include <klu.h>
#include <stdbool.h>
#include <stddef.h>

#include "foilgauge/status.h"

typedef struct fg_sparse {
  int size;
  int *column, *row;  /* compressed columns */
  int *slot;          /* of the n-th addition: its place among the values */
  int *added[2];      /* row and column of every addition, until the pattern is made */
  size_t additions;   /* of an assembly, all in all */
  size_t next;        /* addition that comes next */
  size_t capacity[2]; /* of `added` */
  size_t entries;     /* of the pattern */
  fg_status status;   /* of the additions */
  klu_common common;  /* settings and outcome of KLU */
  klu_symbolic *symbolic;
  klu_numeric *real, *whirl; /* factors; of the complex matrix */
} fg_sparse;

/* The pattern: additions between both calls. */
void fg_sparse_begin(fg_sparse *sparse, int size);
fg_status fg_sparse_finish(fg_context *ctx, fg_sparse *sparse);
void fg_sparse_free(fg_sparse *sparse);

void fg_sparse_record(fg_context *ctx, fg_sparse *sparse, int row, int column);

/* Returns the place of the next addition among the values; 0 while the pattern is made. */
static inline size_t fg_sparse_place(fg_context *ctx, fg_sparse *sparse, int row, int column) {
  if (sparse->symbolic) return (size_t)sparse->slot[sparse->next++];
  fg_sparse_record(ctx, sparse, row, column);
  return 0;
}

/* Factorise, then solve `count` right-hand sides in place, column after column. FG_ERR_NUMERIC for
 * a singular matrix. */
fg_status fg_sparse_factor(fg_context *ctx, fg_sparse *sparse, double *values);
fg_status fg_sparse_solve(fg_context *ctx, fg_sparse *sparse, double *right, int count);
fg_status fg_sparse_factor_complex(fg_context *ctx, fg_sparse *sparse, double complex *values);
fg_status fg_sparse_solve_complex(fg_context *ctx, fg_sparse *sparse, double complex *right,
                                  int count);

#endif
