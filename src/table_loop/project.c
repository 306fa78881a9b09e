/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Projections and least squares of a training set (modified Gram-Schmidt, applied twice). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/numerics.h"
#include "table_loop/dots.h"
#include "table_loop/engine.h"

/* Share of a column's squared length below which it lies in the span. For the declared model it is
 * the rounding limit, because with an origin far away (a temperature of 10^6) its columns are
 * nearly parallel; for effects it also excludes nearly collinear columns. */
static const double same_span = 1e-9, declared_span = 1e-24;
/* Lower limit of the kept share by which a residual is divided, a sd of 0.05: the residual of a row
 * that the null's columns fit alone is rounding. */
static const double kept_min = 0.05 * 0.05;

static double dot(size_t n, const double *a, const double *b) {
  return fg_dot_in_lanes(a, b, n);
}

/* Vectors of a basis that are taken out together where rows are many. */
enum { TOGETHER = 64 };

/* As the function for few rows, with several vectors at a time, so that v is read and written only
 * a few times. Two passes suffice for this order of the sums as well (Giraud and others 2005).
 * `along` (or NULL) sums the removed parts. */
static double project_many(size_t n, const double *basis, size_t rank, double *v, double *along) {
  double here[TOGETHER];
  for (int pass = 0; pass < 2; pass++)
    for (size_t from = 0; from < rank; from += TOGETHER) {
      size_t count = rank - from < TOGETHER ? rank - from : TOGETHER;
      fg_engine_dots(n, basis + from * n, count, v, here);
      fg_engine_subtract(n, basis + from * n, count, here, v);
      for (size_t k = 0; along && k < count; k++)
        along[from + k] += here[k];
    }
  return dot(n, v, v);
}

double fg_engine_project_out(size_t n, const double *basis, size_t rank, double *v) {
  if (n > FG_ENGINE_SMALL_ROWS) return project_many(n, basis, rank, v, NULL);
  double whole = dot(n, v, v), left = whole;
  for (int pass = 0; pass < 2 && rank; pass++) {
    for (size_t k = 0; k < rank; k++) {
      double along = dot(n, basis + k * n, v);
      for (size_t i = 0; i < n; i++)
        v[i] -= along * basis[k * n + i];
    }
    left = dot(n, v, v);
    if (left > whole / 2) break; /* nothing was cancelled */
  }
  return left;
}

size_t fg_engine_orthonormal(size_t n, const double *basis, size_t rank, const double *columns,
                             size_t count, double *out, double *lengths) {
  size_t added = 0;
  for (size_t k = 0; k < count; k++) {
    double *v = out + added * n;
    memmove(v, columns + k * n, n * sizeof *v);
    double whole = dot(n, v, v);
    double left = fg_engine_project_out(n, basis, rank, v);
    if (lengths) lengths[k] = left;
    left = fg_engine_project_out(n, out, added, v);
    if (!(left > same_span * whole)) continue;
    for (size_t i = 0; i < n; i++)
      v[i] /= sqrt(left);
    added++;
  }
  return added;
}

static size_t null_basis(const fg_engine_training *training, fg_engine_noise noise, double *basis) {
  size_t n = training->n, rank = 0;
  memcpy(basis, training->x, n * training->columns * sizeof *basis);
  for (size_t k = 0; k < training->columns; k++) {
    double *v = basis + rank * n;
    memmove(v, basis + k * n, n * sizeof *v);
    fg_engine_whiten(training, noise, v);
    double whole = dot(n, v, v), left = fg_engine_project_out(n, basis, rank, v);
    if (!(left > (k < training->problem->parameters ? declared_span : same_span) * whole)) continue;
    for (size_t i = 0; i < n; i++)
      v[i] /= sqrt(left);
    rank++;
  }
  return rank;
}

fg_status fg_engine_span_open(fg_context *ctx, const fg_engine_training *training,
                              fg_engine_noise noise, size_t more, fg_engine_span *span) {
  size_t n = training->n, room = training->columns + more + 1;
  fg_status status = FG_OK;
  *span = (fg_engine_span){.n = n};
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, room * sizeof *span->basis, (void **)&span->basis));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, sizeof *span->kept, (void **)&span->kept));
  span->rank = null_basis(training, noise, span->basis);
  memset(span->basis + span->rank * n, 0, n * (training->columns - span->rank) * sizeof(double));
  for (size_t i = 0; i < n; i++)
    span->kept[i] = 1;
  for (size_t k = 0; k < span->rank; k++)
    for (size_t i = 0; i < n; i++)
      span->kept[i] -= span->basis[k * n + i] * span->basis[k * n + i];
exit:
  if (status != FG_OK) fg_engine_span_close(span);
  return status;
}

void fg_engine_span_close(fg_engine_span *span) {
  free(span->basis);
  free(span->kept);
  *span = (fg_engine_span){0};
}

double fg_engine_along(size_t n, const double *unit, size_t count, const double *y) {
  double sum = 0;
  for (size_t k = 0; k < count; k++) {
    double one = 0;
    for (size_t i = 0; i < n; i++)
      one += unit[k * n + i] * y[i];
    sum += one * one;
  }
  return sum;
}

double fg_engine_kept_sd(double share) {
  return sqrt(fmax(share, kept_min));
}

double fg_engine_span_kept_sd(const fg_engine_span *span, size_t i) {
  return fg_engine_kept_sd(span->kept[i]);
}

/* X = Q R column by column; coefficients and (X'X)^-1 from R. */
typedef struct triangle {
  size_t columns, declared, rank;
  size_t *kept;  /* columns of X */
  double *basis; /* rank × n */
  double *r;     /* columns × columns, r[i * columns + j]: row i of kept column j */
} triangle;

/* Projects v beside the columns kept so far; along[k] is its part along each. */
static double project_kept(size_t n, const triangle *t, double *v, double *along) {
  memset(along, 0, t->rank * sizeof *along);
  if (n > FG_ENGINE_SMALL_ROWS) return project_many(n, t->basis, t->rank, v, along);
  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0; i < t->rank; i++) {
      double part = dot(n, t->basis + i * n, v);
      along[i] += part;
      for (size_t m = 0; m < n; m++)
        v[m] -= part * t->basis[i * n + m];
    }
  return dot(n, v, v);
}

/* `along` has room for the columns. */
static void decompose(size_t n, const double *x, double *along, triangle *t) {
  for (size_t k = 0; k < t->columns; k++) {
    double *v = t->basis + t->rank * n;
    memcpy(v, x + k * n, n * sizeof *v);
    double whole = dot(n, v, v), left = project_kept(n, t, v, along);
    if (!(left > (k < t->declared ? declared_span : same_span) * whole)) continue;
    for (size_t i = 0; i < t->rank; i++)
      t->r[i * t->columns + t->rank] = along[i];
    t->r[t->rank * t->columns + t->rank] = sqrt(left);
    for (size_t m = 0; m < n; m++)
      v[m] /= sqrt(left);
    t->kept[t->rank++] = k;
  }
}

/* column j of R^-1, written to u (rank numbers). */
static void invert_column(const triangle *t, size_t j, double *u) {
  memset(u, 0, t->rank * sizeof *u);
  for (size_t i = j + 1; i-- > 0;) {
    double sum = i == j;
    for (size_t k = i + 1; k <= j; k++)
      sum -= t->r[i * t->columns + k] * u[k];
    u[i] = sum / t->r[i * t->columns + i];
  }
}

static void solve_triangle(const triangle *t, const double *along, double *u, fg_engine_fit *fit) {
  for (size_t j = 0; j < t->rank; j++) {
    invert_column(t, j, u);
    fit->log_det += 2 * log(t->r[j * t->columns + j]);
    for (size_t i = 0; i <= j; i++) {
      fit->beta[t->kept[i]] += u[i] * along[j];
      for (size_t k = 0; k <= j; k++)
        fit->inverse[t->kept[i] * t->columns + t->kept[k]] += u[i] * u[k];
    }
  }
}

static fg_status fit_allocate(fg_context *ctx, size_t columns, fg_engine_fit *fit) {
  *fit = (fg_engine_fit){.columns = columns};
  FG_TRY(fg_memory_allocate(ctx, columns, sizeof *fit->beta, (void **)&fit->beta));
  return fg_memory_allocate(ctx, columns, columns * sizeof *fit->beta, (void **)&fit->inverse);
}

fg_status fg_engine_least_squares(fg_context *ctx, const fg_engine_training *training,
                                  fg_engine_noise noise, fg_engine_fit *fit) {
  fg_status status = FG_OK;
  size_t n = training->n, columns = training->columns;
  triangle t = {.columns = columns, .declared = training->problem->parameters};
  double *x = NULL, *y = NULL, *small = NULL;
  FG_TRY_EXIT(fit_allocate(ctx, columns, fit));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, columns * sizeof *x + 1, (void **)&x));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, (columns + 1) * sizeof *x, (void **)&t.basis));
  FG_TRY_EXIT(fg_memory_allocate(ctx, columns, columns * sizeof *x, (void **)&t.r));
  FG_TRY_EXIT(fg_memory_allocate(ctx, columns, sizeof *t.kept, (void **)&t.kept));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, sizeof *y, (void **)&y));
  FG_TRY_EXIT(fg_memory_allocate(ctx, columns, 2 * sizeof *y, (void **)&small));
  memcpy(x, training->x, n * columns * sizeof *x);
  memcpy(y, training->y, n * sizeof *y);
  for (size_t k = 0; k < columns; k++)
    fg_engine_whiten(training, noise, x + k * n);
  fg_engine_whiten(training, noise, y);
  decompose(n, x, small, &t);
  for (size_t k = 0; k < t.rank; k++)
    small[k] = dot(n, t.basis + k * n, y);
  solve_triangle(&t, small, small + columns, fit);
  fit->rank = t.rank;
  fit->rss = fg_engine_project_out(n, t.basis, t.rank, y);
exit:
  free(x);
  free(t.basis);
  free(t.r);
  free(t.kept);
  free(y);
  free(small);
  if (status != FG_OK) fg_engine_fit_free(fit);
  return status;
}

void fg_engine_fit_residual(const fg_engine_training *training, const fg_engine_fit *fit,
                            double *residual) {
  memcpy(residual, training->y, training->n * sizeof *residual);
  for (size_t k = 0; k < training->columns; k++)
    for (size_t i = 0; i < training->n; i++)
      residual[i] -= fit->beta[k] * training->x[k * training->n + i];
}

void fg_engine_fit_free(fg_engine_fit *fit) {
  free(fit->beta);
  free(fit->inverse);
  *fit = (fg_engine_fit){0};
}
