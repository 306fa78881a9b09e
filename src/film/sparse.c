/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "film/sparse.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "core/select.h"
#include "foilgauge/memory.h"

void fg_sparse_begin(fg_sparse *sparse, int size) {
  *sparse = (fg_sparse){.size = size};
  klu_defaults(&sparse->common);
}

void fg_sparse_record(fg_context *ctx, fg_sparse *sparse, int row, int column) {
  const int pair[2] = {row, column};
  for (size_t i = 0; i < 2 && sparse->status == FG_OK; i++) {
    void *block = sparse->added[i];
    sparse->status =
        fg_memory_reserve(ctx, sparse->additions + 1, sizeof(int), &sparse->capacity[i], &block);
    sparse->added[i] = block;
    if (sparse->status == FG_OK) sparse->added[i][sparse->additions] = pair[i];
  }
  if (sparse->status == FG_OK) sparse->additions++;
}

/* An addition's place in column order; its rank among all. */
typedef struct placed_addition {
  int64_t place;
  int rank;
} placed_addition;

static int compare_additions(const void *left, const void *right) {
  const placed_addition *a = left, *b = right;
  return (a->place > b->place) - (a->place < b->place);
}

static void fill_pattern(fg_sparse *sparse, const placed_addition *sorted) {
  size_t entries = 0;
  int column = 0;
  for (size_t i = 0; i < sparse->additions; i++) {
    if (!i || sorted[i].place != sorted[i - 1].place) {
      int at = (int)(sorted[i].place / sparse->size);
      while (column <= at)
        sparse->column[column++] = (int)entries;
      sparse->row[entries++] = (int)(sorted[i].place % sparse->size);
    }
    sparse->slot[sorted[i].rank] = (int)entries - 1;
  }
  while (column <= sparse->size)
    sparse->column[column++] = (int)entries;
  sparse->entries = entries;
}

static fg_status allocate_pattern(fg_context *ctx, fg_sparse *sparse, placed_addition **sorted) {
  int **const parts[] = {&sparse->column, &sparse->row, &sparse->slot};
  const size_t counts[] = {(size_t)sparse->size + 1, sparse->additions, sparse->additions};
  void *block;
  for (size_t i = 0; i < 3; i++) {
    FG_TRY(fg_memory_allocate(ctx, counts[i], sizeof(int), &block));
    *parts[i] = block;
  }
  FG_TRY(fg_memory_allocate(ctx, sparse->additions, sizeof **sorted, &block));
  *sorted = block;
  return FG_OK;
}

fg_status fg_sparse_finish(fg_context *ctx, fg_sparse *sparse) {
  placed_addition *sorted = NULL;
  FG_TRY(sparse->status);
  FG_TRY(allocate_pattern(ctx, sparse, &sorted));
  for (size_t i = 0; i < sparse->additions; i++)
    sorted[i] = (placed_addition){(int64_t)sparse->added[1][i] * sparse->size + sparse->added[0][i],
                                  (int)i};
  fg_sort_items(sorted, sparse->additions, sizeof *sorted, compare_additions);
  fill_pattern(sparse, sorted);
  free(sorted);
  for (int i = 0; i < 2; i++) {
    free(sparse->added[i]);
    sparse->added[i] = NULL;
  }
  sparse->symbolic = klu_analyze(sparse->size, sparse->column, sparse->row, &sparse->common);
  return sparse->symbolic ? FG_OK
                          : fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the film's equations");
}

void fg_sparse_free(fg_sparse *sparse) {
  if (sparse->symbolic) {
    klu_free_numeric(&sparse->real, &sparse->common);
    klu_z_free_numeric(&sparse->whirl, &sparse->common);
    klu_free_symbolic(&sparse->symbolic, &sparse->common);
  }
  free(sparse->column);
  free(sparse->row);
  free(sparse->slot);
  free(sparse->added[0]);
  free(sparse->added[1]);
  *sparse = (fg_sparse){0};
}

static fg_status fail_by_klu(fg_context *ctx, const fg_sparse *sparse) {
  if (sparse->common.status == KLU_OUT_OF_MEMORY)
    return fg_fail(ctx, FG_ERR_MEMORY, "out of memory: the film's equations");
  return fg_fail(ctx, FG_ERR_NUMERIC,
                 "the film's equations are singular: is a clearance or the bore wrong?");
}

/* Growth of the pivots below which old pivots are not good enough. */
static const double growth_min = 1e-8;

fg_status fg_sparse_factor(fg_context *ctx, fg_sparse *s, double *values) {
  if (s->real && klu_refactor(s->column, s->row, values, s->symbolic, s->real, &s->common) &&
      klu_rgrowth(s->column, s->row, values, s->symbolic, s->real, &s->common) &&
      s->common.rgrowth > growth_min)
    return FG_OK;
  klu_free_numeric(&s->real, &s->common);
  s->real = klu_factor(s->column, s->row, values, s->symbolic, &s->common);
  return s->real ? FG_OK : fail_by_klu(ctx, s);
}

fg_status fg_sparse_solve(fg_context *ctx, fg_sparse *s, double *right, int count) {
  if (klu_solve(s->symbolic, s->real, s->size, count, right, &s->common)) return FG_OK;
  return fail_by_klu(ctx, s);
}

fg_status fg_sparse_factor_complex(fg_context *ctx, fg_sparse *s, double complex *values) {
  double *pairs = (double *)values;
  if (s->whirl && klu_z_refactor(s->column, s->row, pairs, s->symbolic, s->whirl, &s->common) &&
      klu_z_rgrowth(s->column, s->row, pairs, s->symbolic, s->whirl, &s->common) &&
      s->common.rgrowth > growth_min)
    return FG_OK;
  klu_z_free_numeric(&s->whirl, &s->common);
  s->whirl = klu_z_factor(s->column, s->row, pairs, s->symbolic, &s->common);
  return s->whirl ? FG_OK : fail_by_klu(ctx, s);
}

fg_status fg_sparse_solve_complex(fg_context *ctx, fg_sparse *s, double complex *right, int count) {
  if (klu_z_solve(s->symbolic, s->whirl, s->size, count, (double *)right, &s->common)) return FG_OK;
  return fail_by_klu(ctx, s);
}
