/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The columns of all effects beside the geometry, and least squares of any set of them. */
#ifndef FG_EFFECT_SEARCH_COLUMNS_H
#define FG_EFFECT_SEARCH_COLUMNS_H

#include "effect_search/effect_search.h"
#include "rows/scatter.h"

enum { FG_SEARCH_COLUMNS = 320, FG_SEARCH_TERMS = 64 };

/* How a column enters the basis of all effects at once. A curve is finer than noise along the edge
 * may be told from: with all its columns it would take that for its own. */
typedef enum fg_search_part {
  FG_SEARCH_ITSELF,
  FG_SEARCH_WITH_NEXT, /* its sum with the next one: a spline of twice the width */
  FG_SEARCH_LEFT_OUT,
} fg_search_part;

typedef struct fg_search_columns {
  const fg_edge_fit *edge_fit;
  size_t rows; /* that are not kept aside */
  size_t *row;
  double *basis;        /* orthonormal: the geometry, then all effects; FG_SEARCH_COLUMNS beyond the
                           geometry's parameters */
  size_t *first, *last; /* per vector of the basis: the rows where it is not 0; a bump's numbers act
                           on its own rows only */
  size_t geometry_rank;
  double *residual; /* beside the geometry, um */
  double *values;   /* FG_SEARCH_COLUMNS × rows: effects beside the geometry */
  double *strain;   /* the same columns in half the width */
  size_t count;
  fg_search_part part[FG_SEARCH_COLUMNS];
  double *gram;  /* FG_EXPLAIN_COLUMNS²: products of the columns */
  double *right; /* products with the residual */
  double square; /* of the residual */
  fg_whitening whitening;
  double min;        /* square of a vector that tells anything */
  double integral;   /* of the correlation that it takes out */
  double *work;      /* FG_EFFECT_COLUMNS_MAX × all rows */
  double *white;     /* all rows */
  double *left;      /* residual beside everything */
  double *width;     /* half the strip's width, um, without its mean over the part */
  bool has_width;    /* false for discs */
  double width_part; /* mean square of the widths' smooth part that no field of the scanner makes */
} fg_search_columns;

/* A term of a set: a weighted sum of columns. */
typedef struct fg_search_term {
  size_t count, column[FG_EFFECT_COLUMNS_MAX];
  double weight[FG_EFFECT_COLUMNS_MAX];
} fg_search_term;

fg_status fg_search_columns_open(fg_context *ctx, const fg_edge_fit *edge_fit,
                                 const double *residual_um, const double *jacobian,
                                 fg_search_columns *columns);
void fg_search_columns_close(fg_search_columns *columns);

double fg_search_dot(size_t n, const double *a, const double *b);

/* Weighted columns of an effect at the rows in use, as they are; returns how many. */
size_t fg_search_gather(const fg_search_columns *columns, const fg_effect *effect,
                        const double *shape, double *out);
/* Product with vector k of the basis. */
double fg_search_along(const fg_search_columns *columns, size_t k, const double *v);
/* Takes the first `rank` vectors of the basis out of v. */
void fg_search_take_out(const fg_search_columns *columns, size_t rank, double *v);

/* Adds an effect's columns; `first` is where they stand, `share` what the geometry leaves of
 * their square. Returns how many. */
size_t fg_search_columns_add(fg_search_columns *columns, const fg_effect *effect,
                             const double *shape, size_t *first, double *share);

/* All columns but [skip, end) at once: fills `left`, returns the rank of the basis. */
size_t fg_search_columns_span(fg_search_columns *columns, size_t skip, size_t end);

/* The same with columns [from, to) as they are behind a basis of `rank`, which stays valid. */
size_t fg_search_columns_span_more(fg_search_columns *columns, size_t rank, size_t from, size_t to);

/* Least squares of the residual by terms. Terms that lie in what stands before them get 0 and do
 * not count. `x` (or NULL) gets the coefficients, `last_u` (or NULL) the standard deviation of the
 * last one for noise of 1 um. Returns the residual sum; `rank` what was used. */
double fg_search_solve(const fg_search_columns *columns, const fg_search_term *terms, size_t count,
                       double *x, double *last_u, size_t *rank);

/* Share of a column's square that terms leave of it. */
double fg_search_share_left(const fg_search_columns *columns, const fg_search_term *terms,
                            size_t count, size_t column);

/* Residual sum of the widths when terms have these coefficients. */
double fg_search_width_sum(const fg_search_columns *columns, const fg_search_term *terms,
                           size_t count, const double *x);
/* Fills `width_part`; once all effects are there. */
fg_status fg_search_width_uncertainty(fg_context *ctx, fg_search_columns *columns);

#endif
