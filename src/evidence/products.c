/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/products.h"

#include <math.h>
#include <stdlib.h>

#include "core/numerics.h"
#include "core/parallel.h"

/* Columns that a thread takes at once. */
enum { AT_ONCE = 64 };

/* Returns where products of two columns that lie near each other are kept; NULL: they do not. */
static double *near_product(const fg_evidence_problem *p, size_t a, size_t b) {
  size_t later = a > b ? a : b, before = a > b ? a - b : b - a;
  return before < FG_EVIDENCE_NEAR ? p->near + later * FG_EVIDENCE_NEAR + before : NULL;
}

/* Returns where a column's products with all others are kept; NULL: no memory. */
static double *gram_row(fg_evidence_problem *p, size_t column) {
  double **row = &p->gram[column];
  if (!*row && (*row = malloc(FG_EVIDENCE_COLUMNS * sizeof **row)))
    for (size_t k = 0; k < FG_EVIDENCE_COLUMNS; k++)
      (*row)[k] = NAN;
  return *row;
}

static double *far_product(fg_evidence_problem *p, size_t column, size_t c) {
  if (!p->gram[column] && p->gram[c] && !isnan(p->gram[c][column])) return &p->gram[c][column];
  double *row = gram_row(p, column);
  return row ? &row[c] : NULL;
}

/* Returns a product that is known, or NAN; `kept` gets where it is kept (NULL: no memory). */
static double known_product(fg_evidence_problem *p, size_t column, size_t c, double **kept) {
  *kept = near_product(p, column, c);
  if (!*kept) *kept = far_product(p, column, c);
  double value = *kept ? **kept : NAN;
  if (isnan(value) && p->gram[c]) value = p->gram[c][column];
  if (*kept && isnan(**kept)) **kept = value;
  return value;
}

void fg_evidence_products(fg_evidence_problem *p, size_t column, size_t first, size_t count,
                          double *into) {
  const double *own = p->values + column * p->rows;
  for (size_t c = first; c < first + count; c++) {
    double *kept, value = known_product(p, column, c, &kept);
    if (isnan(value)) {
      value = fg_evidence_dot(own, p->span[column], p->values + c * p->rows, p->span[c]);
      if (kept) *kept = value;
    }
    into[c - first] = value;
  }
}

/* ---- found ahead, by threads that write to places of their own ---- */

/* A search of all columns by chunks: each with those of its set, from `first` on, or, where it is
 * `wanted`, with those that are given. */
typedef struct column_task column_task;
struct column_task {
  fg_evidence_problem *problem;
  void (*find)(const column_task *task, size_t c);
  const size_t *first;
  const size_t *column;
  size_t count;
  const bool *wanted;
};

static void find_own(const column_task *task, size_t c) {
  double product[FG_EVIDENCE_NEAR];
  size_t first = task->first[c], count = c - first + 1;
  if (count <= FG_EVIDENCE_NEAR) fg_evidence_products(task->problem, c, first, count, product);
}

/* Columns whose products with one column are found in one pass: on the same rows. */
typedef struct batch {
  fg_evidence_span span;
  size_t count;
  const double *values[FG_DOTS_AT_ONCE];
  double *kept[FG_DOTS_AT_ONCE];
} batch;

static void find_batch(const double *own, batch *b) {
  double product[FG_DOTS_AT_ONCE];
  size_t rows = b->span.last - b->span.first;
  if (b->count == FG_DOTS_AT_ONCE)
    fg_dots_in_lanes(own + b->span.first, b->values, rows, product);
  else
    for (size_t i = 0; i < b->count; i++)
      product[i] = fg_dot_in_lanes(own + b->span.first, b->values[i], rows);
  for (size_t i = 0; i < b->count; i++)
    *b->kept[i] = product[i];
  b->count = 0;
}

static void find_wanted(const column_task *task, size_t c) {
  fg_evidence_problem *p = task->problem;
  const double *own = p->values + c * p->rows;
  batch next = {.count = 0};
  for (size_t k = 0; task->wanted[c] && k < task->count; k++) {
    size_t column = task->column[k];
    double *kept, value = known_product(p, column, c, &kept);
    if (!isnan(value) || !kept) continue;
    fg_evidence_span span = fg_evidence_overlap(p->span[column], p->span[c]);
    bool same = span.first == next.span.first && span.last == next.span.last;
    if (next.count == FG_DOTS_AT_ONCE || !same) find_batch(own, &next);
    next.span = span;
    next.kept[next.count] = kept;
    next.values[next.count++] = p->values + column * p->rows + span.first;
  }
  find_batch(own, &next);
}

static fg_status find_chunk(fg_context *ctx, void *shared, size_t item) {
  const column_task *task = shared;
  size_t all = task->problem->count, end = (item + 1) * AT_ONCE < all ? (item + 1) * AT_ONCE : all;
  (void)ctx;
  for (size_t c = item * AT_ONCE; c < end; c++)
    task->find(task, c);
  return FG_OK;
}

static fg_status find_of_all(fg_context *ctx, column_task *task, unsigned threads) {
  size_t chunks = (task->problem->count + AT_ONCE - 1) / AT_ONCE;
  return fg_parallel_run(ctx, threads, chunks, find_chunk, task);
}

fg_status fg_evidence_find_own_products(fg_context *ctx, fg_evidence_problem *p,
                                        const size_t *first, unsigned threads) {
  column_task task = {.problem = p, .find = find_own, .first = first};
  return find_of_all(ctx, &task, threads);
}

fg_status fg_evidence_find_products(fg_context *ctx, fg_evidence_problem *p, const size_t *column,
                                    size_t count, const bool *wanted, unsigned threads) {
  column_task task = {
      .problem = p, .find = find_wanted, .column = column, .count = count, .wanted = wanted};
  double product;
  /* Memory and the products among the columns themselves, of which two threads would write. */
  for (size_t a = 0; a < count; a++) {
    if (!gram_row(p, column[a])) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: products");
    for (size_t b = 0; b <= a; b++)
      fg_evidence_products(p, column[a], column[b], 1, &product);
  }
  return find_of_all(ctx, &task, threads);
}
