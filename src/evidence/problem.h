/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rows of an edge fit as one linear Gaussian problem: residual = geometry + effects + noise.
 *
 * All values are whitened, divided by the noise, and beside the geometry's flat directions: those
 * that no prior bounds. Products of columns are in evidence/products.h. */
#ifndef FG_EVIDENCE_PROBLEM_H
#define FG_EVIDENCE_PROBLEM_H

#include "effect/effect.h"
#include "rows/scatter.h"

/* Columns of one cause lie beside each other: near ones. */
enum { FG_EVIDENCE_COLUMNS = 7200, FG_EVIDENCE_NEAR = 128 };

/* Rows [first, last) outside of which a column is 0: it may move one bump or one disc. */
typedef struct fg_evidence_span {
  size_t first, last;
} fg_evidence_span;

typedef struct fg_evidence_problem {
  const fg_edge_fit *edge_fit;
  size_t rows, *row; /* rows in use */
  fg_whitening whitening;
  double noise_um; /* standard deviation of a whitened smooth value */
  double error_um; /* known to be left on the edge by its model and linear columns, smooth */
  bool large;      /* the residual is so large that linear columns err */
  double *basis;   /* owned; rank × rows: flat directions of the geometry, orthonormal */
  fg_evidence_span *basis_span, *span; /* owned; of the basis, of the columns */
  double *directions; /* owned; rank × parameters: those directions in the geometry's numbers */
  size_t rank;
  double *residual;
  double *values; /* owned; FG_EVIDENCE_COLUMNS × rows */
  double *along;  /* owned; FG_EVIDENCE_COLUMNS × rank: a column's part along the basis */
  double *residual_along;
  double *right; /* products with the residual */
  size_t count;
  double *near;  /* owned; FG_EVIDENCE_COLUMNS × FG_EVIDENCE_NEAR: products of a column with itself
                    and those just before it, NaN: not yet asked for */
  double **gram; /* owned; the same of some columns with all others */
  double *white; /* all rows */
} fg_evidence_problem;

/* Returns true for rows of some foils, or of some discs, not of many: a problem's
 * time grows with the cube of the number of bumps, its memory with the number of rows. */
bool fg_evidence_fits(const fg_edge_fit *edge_fit);

/* Opens a problem at the edge fit's geometry. `residual_um` has the effects put back; `jacobian` is
 * parameters × rows (fg_edge_fit_residual). */
fg_status fg_evidence_open(fg_context *ctx, const fg_edge_fit *edge_fit, const double *residual_um,
                           const double *jacobian, fg_evidence_problem *problem);
void fg_evidence_close(fg_evidence_problem *problem);
/* Changes the noise of all rows. */
void fg_evidence_rescale(fg_evidence_problem *problem, double noise_um);

/* A column beside the flat directions: `values` (rows) and `along` (rank) are the caller's. */
typedef struct fg_evidence_column {
  double *values, *along, right;
  fg_evidence_span span;
} fg_evidence_column;

/* Makes a column of values as fg_evidence_add has them; `white`: all rows, for work. */
void fg_evidence_make(const fg_evidence_problem *problem, const double *values, double *white,
                      fg_evidence_column *column);
/* Copies a column to a place of the problem's. */
void fg_evidence_put(fg_evidence_problem *problem, size_t at, const fg_evidence_column *column);
/* Rows in both; empty where there are none. */
fg_evidence_span fg_evidence_overlap(fg_evidence_span a, fg_evidence_span b);
/* Product of two vectors on the rows in both. */
double fg_evidence_dot(const double *a, fg_evidence_span of_a, const double *b,
                       fg_evidence_span of_b);

/* Appends a column, um along the normal per unit, one value per row of the edge fit; returns its
 * index. The caller has seen that there is room (fg_evidence_has_room). */
size_t fg_evidence_add(fg_evidence_problem *problem, const double *values);
static inline bool fg_evidence_has_room(const fg_evidence_problem *problem, size_t columns) {
  return problem->count + columns <= FG_EVIDENCE_COLUMNS;
}
/* Measures a column's amplitude from another zero: it was `amplitude` above it. */
void fg_evidence_put_back(fg_evidence_problem *problem, size_t column, double amplitude);
#endif
