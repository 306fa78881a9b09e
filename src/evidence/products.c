/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "evidence/products.h"

#include <math.h>
#include <stdlib.h>

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

void fg_evidence_products(fg_evidence_problem *p, size_t column, size_t first, size_t count,
                          double *into) {
  const double *own = p->values + column * p->rows;
  for (size_t c = first; c < first + count; c++) {
    double *known = near_product(p, column, c);
    if (!known) known = far_product(p, column, c);
    double value = known ? *known : NAN;
    if (isnan(value) && p->gram[c]) value = p->gram[c][column];
    if (isnan(value))
      value = fg_evidence_dot(own, p->span[column], p->values + c * p->rows, p->span[c]);
    if (known && isnan(*known)) *known = value;
    into[c - first] = value;
  }
}

/* ---- found ahead, by threads that write to places of their own ---- */

typedef struct own_task {
  fg_evidence_problem *problem;
  const size_t *first;
} own_task;

static fg_status find_own(fg_context *ctx, void *shared, size_t item) {
  const own_task *task = shared;
  fg_evidence_problem *p = task->problem;
  size_t end = (item + 1) * AT_ONCE < p->count ? (item + 1) * AT_ONCE : p->count;
  double product[FG_EVIDENCE_NEAR];
  (void)ctx;
  for (size_t c = item * AT_ONCE; c < end; c++)
    if (c - task->first[c] < FG_EVIDENCE_NEAR)
      fg_evidence_products(p, c, task->first[c], c - task->first[c] + 1, product);
  return FG_OK;
}

fg_status fg_evidence_find_own_products(fg_context *ctx, fg_evidence_problem *p,
                                        const size_t *first, unsigned threads) {
  own_task task = {p, first};
  return fg_parallel_run(ctx, threads, (p->count + AT_ONCE - 1) / AT_ONCE, find_own, &task);
}

typedef struct products_task {
  fg_evidence_problem *problem;
  const size_t *column;
  size_t count;
  const bool *wanted;
} products_task;

static fg_status find_some(fg_context *ctx, void *shared, size_t item) {
  const products_task *task = shared;
  fg_evidence_problem *p = task->problem;
  size_t end = (item + 1) * AT_ONCE < p->count ? (item + 1) * AT_ONCE : p->count;
  double product;
  (void)ctx;
  for (size_t c = item * AT_ONCE; c < end; c++)
    for (size_t k = 0; task->wanted[c] && k < task->count; k++)
      fg_evidence_products(p, task->column[k], c, 1, &product);
  return FG_OK;
}

fg_status fg_evidence_find_products(fg_context *ctx, fg_evidence_problem *p, const size_t *column,
                                    size_t count, const bool *wanted, unsigned threads) {
  products_task task = {p, column, count, wanted};
  double product;
  /* Memory and the products among the columns themselves, of which two threads would write. */
  for (size_t a = 0; a < count; a++) {
    if (!gram_row(p, column[a])) return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: products");
    for (size_t b = 0; b <= a; b++)
      fg_evidence_products(p, column[a], column[b], 1, &product);
  }
  return fg_parallel_run(ctx, threads, (p->count + AT_ONCE - 1) / AT_ONCE, find_some, &task);
}
