/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effect_search/columns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "effect/columns.h"

/* Mean square below which a column counts as zero beside the geometry. */
#define VANISHED 1e-8
/* A column also counts as zero when an effect of this size, um, would be fewer standard errors than
 * this: remainders of nearly collinear columns follow the noise of their rows' places. */
#define LARGEST_UM  50.0
#define SEEN_ERRORS 3.0
/* Share of a term beside the terms before it, below which it is collinear with them. */
#define DEPENDENT 1e-6
/* Share of a vector beside the basis, below which it lies in its span: rounding. */
#define IN_BASIS 1e-12
/* Ratio to the chance level from which smooth parts of the width are significant. */
#define CHANCE_TIMES 3.0

double fg_search_along(const fg_search_columns *s, size_t k, const double *v) {
  size_t first = s->first[k];
  return fg_dot_in_lanes(s->basis + k * s->rows + first, v + first, s->last[k] - first);
}

size_t fg_search_along_next(const fg_search_columns *s, size_t rank, size_t k, const double *v,
                            double along[FG_DOTS_AT_ONCE]) {
  size_t first = s->first[k], last = s->last[k], count = 1;
  const double *vector[FG_DOTS_AT_ONCE] = {s->basis + k * s->rows + first};
  while (count < FG_DOTS_AT_ONCE && k + count < rank && s->first[k + count] == first &&
         s->last[k + count] == last) {
    vector[count] = vector[count - 1] + s->rows;
    count++;
  }
  if (count == FG_DOTS_AT_ONCE) {
    fg_dots_in_lanes(v + first, vector, last - first, along);
    return count;
  }
  along[0] = fg_search_along(s, k, v);
  return 1;
}

void fg_search_project_out(const fg_search_columns *s, size_t rank, double *v) {
  for (int twice = 0; twice < 2; twice++)
    for (size_t k = 0; k < rank; k++) {
      size_t first = s->first[k];
      double d = fg_search_along(s, k, v);
      if (d != 0)
        fg_subtract_share(v + first, d, s->basis + k * s->rows + first, s->last[k] - first);
    }
}

static void find_support(fg_search_columns *s, size_t rank) {
  const double *v = s->basis + rank * s->rows;
  size_t first = 0, last = s->rows;
  while (first < last && v[first] == 0)
    first++;
  while (last > first && v[last - 1] == 0)
    last--;
  s->first[rank] = first;
  s->last[rank] = last;
}

/* Adds v to the basis unless it lies in its span, or its new part is no longer than `min`. */
static bool extend(fg_search_columns *s, size_t rank, const double *v, double share, double min) {
  double *to = s->basis + rank * s->rows, whole = fg_dot_in_lanes(v, v, s->rows);
  if (!(whole > min)) return false;
  memcpy(to, v, s->rows * sizeof *to);
  fg_search_project_out(s, rank, to);
  double left = fg_dot_in_lanes(to, to, s->rows);
  if (!(left > fmax(share * whole, min))) return false;
  for (size_t i = 0; i < s->rows; i++)
    to[i] /= sqrt(left);
  find_support(s, rank);
  return true;
}

static double weight_of(const fg_search_columns *s, size_t i) {
  return fg_edge_fit_root_weight(&s->edge_fit->rows[s->row[i]]);
}

static size_t weigh_rows(const fg_search_columns *s, size_t count, double *out) {
  for (size_t c = 0; c < count; c++)
    for (size_t i = 0; i < s->rows; i++)
      out[c * s->rows + i] = weight_of(s, i) * s->work[c * s->edge_fit->row_count + s->row[i]];
  return count;
}

/* Weighted values of all rows, made independent: those in use. `values` may be the work's. */
static void whiten(const fg_search_columns *s, const double *values, double *out) {
  double *all = s->white;
  for (size_t i = 0; i < s->edge_fit->row_count; i++)
    all[i] = fg_edge_fit_root_weight(&s->edge_fit->rows[i]) * values[i];
  fg_whitening_apply(&s->whitening, all);
  for (size_t i = 0; i < s->rows; i++)
    out[i] = all[s->row[i]];
}

size_t fg_search_gather(const fg_search_columns *s, const fg_effect *effect, const double *shape,
                        double *out) {
  size_t count = fg_effect_columns(s->edge_fit, effect, shape, s->work);
  for (size_t c = 0; c < count; c++)
    whiten(s, s->work + c * s->edge_fit->row_count, out + c * s->rows);
  return count;
}

static void fill_products(fg_search_columns *s, size_t from) {
  for (size_t a = from; a < s->count; a++) {
    const double *p = s->values + a * s->rows;
    s->right[a] = fg_dot_in_lanes(p, s->residual, s->rows);
    double *products = s->gram + a * FG_SEARCH_COLUMNS;
    size_t b = 0;
    for (; b + FG_DOTS_AT_ONCE <= a + 1; b += FG_DOTS_AT_ONCE) {
      const double *other = s->values + b * s->rows;
      const double *next[FG_DOTS_AT_ONCE] = {other, other + s->rows, other + 2 * s->rows,
                                             other + 3 * s->rows};
      fg_dots_in_lanes(p, next, s->rows, products + b);
    }
    for (; b <= a; b++)
      products[b] = fg_dot_in_lanes(p, s->values + b * s->rows, s->rows);
    for (b = 0; b < a; b++)
      s->gram[b * FG_SEARCH_COLUMNS + a] = products[b];
  }
}

size_t fg_search_columns_add(fg_search_columns *s, const fg_effect *effect, const double *shape,
                             size_t *first, double *share) {
  double *to = s->values + s->count * s->rows, *strain = s->strain + s->count * s->rows;
  double whole = 0, left = 0;
  *first = s->count;
  size_t count = fg_search_gather(s, effect, shape, to);
  for (size_t c = 0; c < count; c++, to += s->rows) {
    double square = fg_dot_in_lanes(to, to, s->rows);
    if (square == 0) continue; /* a knot that is not used */
    whole += square;
    fg_search_project_out(s, s->geometry_rank, to);
    left += fg_dot_in_lanes(to, to, s->rows);
  }
  *share = whole > 0 ? left / whole : 0;
  memset(strain, 0, count * s->rows * sizeof *strain);
  weigh_rows(s, fg_effect_width_columns(s->edge_fit, effect, shape, s->work), strain);
  s->count += count;
  fill_products(s, *first);
  return count;
}

size_t fg_search_columns_span(fg_search_columns *s, size_t skip, size_t end) {
  size_t rank = s->geometry_rank;
  for (size_t c = 0; c < s->count; c++) {
    const double *v = s->values + c * s->rows;
    if ((c >= skip && c < end) || s->part[c] == FG_SEARCH_LEFT_OUT) continue;
    if (s->part[c] == FG_SEARCH_WITH_NEXT) {
      for (size_t i = 0; i < s->rows; i++)
        s->left[i] = v[i] + v[i + s->rows];
      v = s->left;
    }
    if (extend(s, rank, v, DEPENDENT, s->min)) rank++;
  }
  memcpy(s->left, s->residual, s->rows * sizeof *s->left);
  fg_search_project_out(s, rank, s->left);
  return rank;
}

size_t fg_search_columns_span_more(fg_search_columns *s, size_t rank, size_t from, size_t to) {
  for (size_t c = from; c < to; c++)
    if (extend(s, rank, s->values + c * s->rows, DEPENDENT, s->min)) rank++;
  memcpy(s->left, s->residual, s->rows * sizeof *s->left);
  fg_search_project_out(s, rank, s->left);
  return rank;
}

/* ---- least squares of a set ---- */

static double term_product(const fg_search_columns *s, const fg_search_term *a,
                           const fg_search_term *b) {
  double sum = 0;
  for (size_t i = 0; i < a->count; i++)
    for (size_t k = 0; k < b->count; k++)
      sum += a->weight[i] * b->weight[k] * s->gram[a->column[i] * FG_SEARCH_COLUMNS + b->column[k]];
  return sum;
}

/* Target of a fit: products of all columns with it, its square, and the minimum share that a term
 * must keep to count. */
typedef struct target {
  const double *right;
  double square, min;
} target;

static double term_right(const target *to, const fg_search_term *a) {
  double sum = 0;
  for (size_t i = 0; i < a->count; i++)
    sum += a->weight[i] * to->right[a->column[i]];
  return sum;
}

/* Cholesky, row by row; a term that adds nothing is left out. */
static double fit_terms(const fg_search_columns *s, const target *to, const fg_search_term *terms,
                        size_t count, double *x, double *last_u, size_t *rank) {
  double lower[FG_SEARCH_TERMS][FG_SEARCH_TERMS], forward[FG_SEARCH_TERMS], sum = to->square;
  size_t used[FG_SEARCH_TERMS], n = 0;
  for (size_t a = 0; a < count; a++) {
    double whole = term_product(s, &terms[a], &terms[a]), pivot = whole;
    double right = term_right(to, &terms[a]);
    for (size_t k = 0; k < n; k++) {
      double value = term_product(s, &terms[a], &terms[used[k]]);
      for (size_t j = 0; j < k; j++)
        value -= lower[n][j] * lower[k][j];
      lower[n][k] = value / lower[k][k];
      pivot -= lower[n][k] * lower[n][k];
      right -= lower[n][k] * forward[k];
    }
    if (x) x[a] = 0;
    if (!(pivot > fmax(DEPENDENT * whole, to->min))) continue;
    lower[n][n] = sqrt(pivot);
    forward[n] = right / lower[n][n];
    sum -= forward[n] * forward[n];
    if (last_u) *last_u = 1 / lower[n][n];
    used[n++] = a;
  }
  for (size_t k = n; x && k-- > 0;) {
    double value = forward[k];
    for (size_t j = k + 1; j < n; j++)
      value -= lower[j][k] * x[used[j]];
    x[used[k]] = value / lower[k][k];
  }
  *rank = n;
  return fmax(sum, 0);
}

double fg_search_solve(const fg_search_columns *s, const fg_search_term *terms, size_t count,
                       double *x, double *last_u, size_t *rank) {
  const target residual = {s->right, s->square, s->min};
  return fit_terms(s, &residual, terms, count, x, last_u, rank);
}

double fg_search_residual_share(const fg_search_columns *s, const fg_search_term *terms,
                                size_t count, size_t column) {
  const double *products = s->gram + column * FG_SEARCH_COLUMNS;
  const target to = {products, products[column], 0};
  size_t rank;
  return to.square > 0 ? fit_terms(s, &to, terms, count, NULL, NULL, &rank) / to.square : 0;
}

/* ---- widths ---- */

/* Rows that stay beside the processor while all terms pass. */
enum { WIDTHS_BLOCK = 256 };

/* Computes the next widths from row `from` on less the terms' displacement; returns their number.
 */
static size_t widths_left(const fg_search_columns *s, const fg_search_term *terms, size_t count,
                          const double *x, size_t from, double out[WIDTHS_BLOCK]) {
  size_t rows = s->rows - from < WIDTHS_BLOCK ? s->rows - from : WIDTHS_BLOCK;
  memcpy(out, s->width + from, rows * sizeof *out);
  for (size_t t = 0; t < count; t++)
    for (size_t k = 0; k < terms[t].count; k++) {
      const double *strain = s->strain + terms[t].column[k] * s->rows + from;
      double size = x[t] * terms[t].weight[k];
      for (size_t i = 0; i < rows; i++)
        out[i] -= size * strain[i];
    }
  return rows;
}

double fg_search_width_sum(const fg_search_columns *s, const fg_search_term *terms, size_t count,
                           const double *x) {
  double left[WIDTHS_BLOCK], squares = 0, along = 0, weight = 0;
  for (size_t from = 0; from < s->rows; from += WIDTHS_BLOCK) {
    size_t rows = widths_left(s, terms, count, x, from, left);
    for (size_t i = 0; i < rows; i++) {
      double w = weight_of(s, from + i);
      squares += left[i] * left[i];
      along += w * left[i];
      weight += w * w;
    }
  }
  return squares - along * along / weight; /* about the mean */
}

/* Directions and places that an error of the edge model may follow: threshold, flare, shading and
 * one-sided blur move the edges apart. */
static size_t nuisance(const fg_search_columns *s, double *out) {
  enum { COUNT = 9 };
  const fg_field_frame *f = &s->edge_fit->frame;
  for (size_t i = 0; i < s->rows; i++) {
    const fg_edge_fit_row *row = &s->edge_fit->rows[s->row[i]];
    double x = (row->at.x - f->centre_mm[0]) / FG_FIELD_HALF_MM;
    double y = (row->at.y - f->centre_mm[1]) / FG_FIELD_HALF_MM, w = weight_of(s, i);
    double all[COUNT] = {x, y, x * x, x * y, y * y};
    for (int k = 0; k < 2; k++) {
      all[5 + 2 * k] = cos((2 + 2 * k) * row->normal_rad);
      all[6 + 2 * k] = sin((2 + 2 * k) * row->normal_rad);
    }
    for (int c = 0; c < COUNT; c++)
      out[(size_t)c * s->rows + i] = w * all[c];
  }
  return COUNT;
}

/* Orthonormalises further vectors behind the basis; returns the new rank. The basis is borrowed:
 * the caller spans it again. */
static size_t span_more(fg_search_columns *s, size_t rank, const double *v, size_t count) {
  for (size_t c = 0; c < count; c++)
    if (extend(s, rank, v + c * s->rows, IN_BASIS, 0)) rank++;
  return rank;
}

/* Error of the edge model: the part of the widths that is smooth over place and direction and that
 * no stretch by the scanner's fields explains. The edges' common error is assumed to be no larger.
 */
fg_status fg_search_width_uncertainty(fg_context *ctx, fg_search_columns *s) {
  double *v = NULL, *left = NULL, *kept = NULL;
  fg_status status = FG_OK;
  s->width_part = 0;
  if (!s->has_width) return FG_OK;
  size_t kept_size = s->geometry_rank * s->rows * sizeof *kept;
  FG_TRY_EXIT(fg_memory_allocate(ctx, FG_EFFECT_COLUMNS_MAX, s->rows * sizeof *v, (void **)&v));
  FG_TRY_EXIT(fg_memory_allocate(ctx, s->rows, sizeof *left, (void **)&left));
  FG_TRY_EXIT(fg_memory_allocate(ctx, 1, kept_size, (void **)&kept));
  memcpy(kept, s->basis, kept_size);
  for (size_t i = 0; i < s->rows; i++)
    v[i] = weight_of(s, i);
  size_t rank = span_more(s, 0, v, 1);
  rank = span_more(s, rank, s->strain, s->count);
  memcpy(left, s->width, s->rows * sizeof *left);
  fg_search_project_out(s, rank, left);
  double before = fg_dot_in_lanes(left, left, s->rows);
  size_t more = span_more(s, rank, v, nuisance(s, v));
  fg_search_project_out(s, more, left);
  double after = fg_dot_in_lanes(left, left, s->rows), n = (double)s->rows;
  double chance = (double)(more - rank) * after / fmax(n - (double)more, 1);
  if (before - after > CHANCE_TIMES * chance) s->width_part = (before - after - chance) / n;
  memcpy(s->basis, kept, kept_size);
  for (size_t k = 0; k < s->geometry_rank; k++)
    find_support(s, k);
exit:
  free(v);
  free(left);
  free(kept);
  return status;
}

/* ---- setting up ---- */

static fg_status list_rows(fg_context *ctx, fg_search_columns *s) {
  const fg_edge_fit *edge_fit = s->edge_fit;
  FG_TRY(fg_memory_allocate(ctx, edge_fit->row_count, sizeof *s->row, (void **)&s->row));
  for (size_t i = 0; i < edge_fit->row_count; i++)
    if (!edge_fit->views[edge_fit->rows[i].view].held_out) s->row[s->rows++] = i;
  return FG_OK;
}

fg_status fg_search_columns_open_work(fg_context *ctx, fg_search_columns *s) {
  size_t all = s->edge_fit->row_count;
  s->white = s->work = NULL;
  FG_TRY(fg_memory_allocate(ctx, all, sizeof *s->white, (void **)&s->white));
  fg_status status =
      fg_memory_allocate(ctx, all, FG_EFFECT_COLUMNS_MAX * sizeof *s->work, (void **)&s->work);
  if (status != FG_OK) fg_search_columns_close_work(s);
  return status;
}

void fg_search_columns_close_work(fg_search_columns *s) {
  free(s->white);
  free(s->work);
  s->white = s->work = NULL;
}

static fg_status allocate_columns(fg_context *ctx, fg_search_columns *s) {
  size_t vector = s->rows * sizeof(double), all = FG_SEARCH_COLUMNS;
  FG_TRY(fg_memory_allocate(ctx, s->edge_fit->parameters + all, vector, (void **)&s->basis));
  size_t max = s->edge_fit->parameters + all;
  FG_TRY(fg_memory_allocate(ctx, max, sizeof *s->first, (void **)&s->first));
  FG_TRY(fg_memory_allocate(ctx, max, sizeof *s->last, (void **)&s->last));
  FG_TRY(fg_whitening_open(ctx, s->edge_fit, &s->whitening));
  FG_TRY(fg_memory_allocate(ctx, all, vector, (void **)&s->values));
  FG_TRY(fg_memory_allocate(ctx, all, vector, (void **)&s->strain));
  FG_TRY(fg_memory_allocate(ctx, 1, vector, (void **)&s->residual));
  FG_TRY(fg_memory_allocate(ctx, 1, vector, (void **)&s->left));
  FG_TRY(fg_memory_allocate(ctx, 1, vector, (void **)&s->width));
  FG_TRY(fg_memory_allocate(ctx, all * all, sizeof *s->gram, (void **)&s->gram));
  FG_TRY(fg_memory_allocate(ctx, all, sizeof *s->right, (void **)&s->right));
  return fg_search_columns_open_work(ctx, s);
}

/* Mean width of every part out: its thickness is a parameter of the geometry. */
static void fill_width(fg_search_columns *s) {
  for (size_t p = 0; p < s->edge_fit->part_count; p++) {
    double sum = 0, weight = 0;
    for (size_t i = 0; i < s->rows; i++) {
      const fg_edge_fit_row *row = &s->edge_fit->rows[s->row[i]];
      if (row->part != p) continue;
      sum += row->weight * row->half_width_mm;
      weight += row->weight;
    }
    for (size_t i = 0; i < s->rows; i++) {
      const fg_edge_fit_row *row = &s->edge_fit->rows[s->row[i]];
      if (row->part != p || !(weight > 0)) continue;
      s->width[i] = 1000 * weight_of(s, i) * (row->half_width_mm - sum / weight);
      s->has_width = s->has_width || row->half_width_mm > 0;
    }
  }
}

static void span_geometry(fg_search_columns *s, const double *residual_um, const double *jacobian) {
  double *column = s->left; /* borrowed */
  for (size_t a = 0; a < s->edge_fit->parameters; a++) {
    whiten(s, jacobian + a * s->edge_fit->row_count, column);
    if (fg_dot_in_lanes(column, column, s->rows) > 0 &&
        extend(s, s->geometry_rank, column, IN_BASIS, 0))
      s->geometry_rank++;
  }
  whiten(s, residual_um, s->residual);
  fg_search_project_out(s, s->geometry_rank, s->residual);
  s->square = fg_dot_in_lanes(s->residual, s->residual, s->rows);
}

fg_status fg_search_columns_open(fg_context *ctx, const fg_edge_fit *edge_fit,
                                 const double *residual_um, const double *jacobian,
                                 fg_search_columns *s) {
  memset(s, 0, sizeof *s);
  s->edge_fit = edge_fit;
  const fg_scatter *scatter = &edge_fit->scatter;
  s->integral = scatter->share > 0 ? scatter->integral : 1;
  fg_status status = list_rows(ctx, s);
  if (status == FG_OK) status = allocate_columns(ctx, s);
  if (status != FG_OK) {
    fg_search_columns_close(s);
    return status;
  }
  double noise = SEEN_ERRORS * scatter->row_um / LARGEST_UM;
  s->min = fmax(VANISHED * (double)s->rows, noise * noise * s->integral);
  span_geometry(s, residual_um, jacobian);
  fill_width(s);
  return FG_OK;
}

void fg_search_columns_close(fg_search_columns *s) {
  free(s->row);
  free(s->basis);
  free(s->first);
  free(s->last);
  free(s->values);
  free(s->strain);
  free(s->residual);
  free(s->left);
  free(s->width);
  free(s->gram);
  free(s->right);
  fg_search_columns_close_work(s);
  fg_whitening_close(&s->whitening);
  memset(s, 0, sizeof *s);
}
