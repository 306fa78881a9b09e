/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Columns of all effects, projected beside the geometry, and least squares of any set of them. */
#ifndef FG_EFFECT_SEARCH_COLUMNS_H
#define FG_EFFECT_SEARCH_COLUMNS_H

#include "core/numerics.h"
#include "effect_search/explanations.h"
#include "rows/scatter.h"

enum { FG_SEARCH_COLUMNS = 320, FG_SEARCH_TERMS = 64 };

/* Ways in which a column enters the basis of all effects at once. Free curves enter coarsened: a
 * curve with all its columns is finer than the noise along the edge and would absorb that noise. */
typedef enum fg_search_part {
  FG_SEARCH_ITSELF,
  FG_SEARCH_WITH_NEXT, /* its sum with the next one: a spline of twice the width */
  FG_SEARCH_LEFT_OUT,
} fg_search_part;

typedef struct fg_search_columns {
  const fg_edge_fit *edge_fit;
  size_t rows; /* rows that are not held out */
  size_t *row;
  double *basis;        /* orthonormal: the geometry, then all effects; FG_SEARCH_COLUMNS beyond the
                           geometry's parameters */
  size_t *first, *last; /* per vector of the basis: range of rows outside which it is 0; a bump's
                           numbers act on its own rows only */
  size_t geometry_rank;
  double *residual; /* beside the geometry, um */
  double *values;   /* FG_SEARCH_COLUMNS × rows: effects beside the geometry */
  double *strain;   /* the same columns in half the width */
  size_t count;
  fg_search_part part[FG_SEARCH_COLUMNS];
  double *gram;  /* FG_SEARCH_COLUMNS²: products of the columns */
  double *right; /* products with the residual */
  double square; /* sum of squares of the residual */
  fg_whitening whitening;
  double min;        /* smallest square at which a vector counts as independent */
  double integral;   /* integral of the correlation that the columns remove */
  double *work;      /* FG_EFFECT_COLUMNS_MAX × all rows */
  double *white;     /* all rows */
  double *left;      /* residual beside all columns */
  double *width;     /* half the strip's width less its mean over the part, um */
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

/* Gives a copy of the structure room for work of its own (`work`, `white`): then threads may gather
 * columns at once, each by its copy. */
fg_status fg_search_columns_open_work(fg_context *ctx, fg_search_columns *copy);
void fg_search_columns_close_work(fg_search_columns *copy);

/* Writes weighted columns of an effect at the rows in use, not projected; returns their number. */
size_t fg_search_gather(const fg_search_columns *columns, const fg_effect *effect,
                        const double *shape, double *out);
/* Product with vector k of the basis. */
double fg_search_along(const fg_search_columns *columns, size_t k, const double *v);
/* Products with vectors of the basis from k on, below `rank`: of as many as go in one pass, one at
 * least. Returns their number. */
size_t fg_search_along_next(const fg_search_columns *columns, size_t rank, size_t k,
                            const double *v, double along[FG_DOTS_AT_ONCE]);
/* Removes from v its part in the first `rank` vectors of the basis. */
void fg_search_project_out(const fg_search_columns *columns, size_t rank, double *v);

/* Adds an effect's columns. `first` gets the index of the first one, `share` the share of their
 * square that the geometry leaves. Returns their number. */
size_t fg_search_columns_add(fg_search_columns *columns, const fg_effect *effect,
                             const double *shape, size_t *first, double *share);

/* Projects on all columns but [skip, end) at once: fills `left`, returns the rank of the basis. */
size_t fg_search_columns_span(fg_search_columns *columns, size_t skip, size_t end);

/* Extends a basis of `rank` by the unchanged columns [from, to); the first `rank` vectors stay
 * valid. Returns the new rank. */
size_t fg_search_columns_span_more(fg_search_columns *columns, size_t rank, size_t from, size_t to);

/* Least squares of the residual by terms. A term in the span of those before it gets 0 and does not
 * count. `x` (or NULL) gets the coefficients, `last_u` (or NULL) the standard deviation of the last
 * one for noise of 1 um, `rank` the number of terms used. Returns the residual sum. */
double fg_search_solve(const fg_search_columns *columns, const fg_search_term *terms, size_t count,
                       double *x, double *last_u, size_t *rank);

/* Returns the share of a column's square that is left beside the terms. */
double fg_search_residual_share(const fg_search_columns *columns, const fg_search_term *terms,
                                size_t count, size_t column);

/* Returns the residual sum of the widths for terms with these coefficients. */
double fg_search_width_sum(const fg_search_columns *columns, const fg_search_term *terms,
                           size_t count, const double *x);
/* Fills `width_part`. Call it once all effects are added. */
fg_status fg_search_width_uncertainty(fg_context *ctx, fg_search_columns *columns);

#endif
