/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/bins.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "table_loop/grid.h"

/* Rows that are sorted into steps while their places stay in the nearest cache. */
enum { BLOCK = 1024 };

static void add_rows(const fg_engine_training *training, const double *vectors,
                     fg_engine_bins *bins) {
  const fg_loop_coordinate *at = &training->problem->coordinate[bins->coordinate];
  size_t n = training->n, place[BLOCK];
  double weight[BLOCK], steps = (double)bins->count, width = at->high - at->low;
  for (size_t from = 0; from < n; from += BLOCK) {
    size_t rows = n - from < BLOCK ? n - from : BLOCK;
    for (size_t i = 0; i < rows; i++) {
      double x = (at->value[training->row[from + i]] - at->low) / width * steps;
      place[i] = (size_t)fmin(fmax(x, 0), steps - 1);
      weight[i] = training->scale ? 1 / training->scale[from + i] : 1;
      bins->weight[place[i]] += weight[i] * weight[i];
    }
    for (size_t k = 0; k <= bins->rank; k++) {
      const double *v = vectors + k * n + from;
      double *sum = bins->vectors + k * bins->count;
      for (size_t i = 0; i < rows; i++)
        sum[place[i]] += weight[i] * v[i];
    }
  }
}

fg_status fg_engine_bins_open(fg_context *ctx, const fg_engine_training *training,
                              size_t coordinate, size_t count, const double *vectors, size_t rank,
                              fg_engine_bins *bins) {
  const fg_loop_coordinate *at = &training->problem->coordinate[coordinate];
  fg_status status = FG_OK;
  double *value = NULL;
  *bins = (fg_engine_bins){.count = count, .rank = rank, .coordinate = coordinate};
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *bins->weight, (void **)&bins->weight));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, count, (rank + 1) * sizeof *bins->vectors, (void **)&bins->vectors));
  FG_TRY_EXIT(fg_engine_grid_open(ctx, training->problem, count, &bins->grid));
  FG_TRY_EXIT(fg_engine_grid_axis(ctx, &bins->grid, coordinate, &value));
  for (size_t i = 0; i < count; i++)
    value[i] = at->low + (at->high - at->low) * ((double)i + 0.5) / (double)count;
  add_rows(training, vectors, bins);
exit:
  if (status != FG_OK) fg_engine_bins_close(bins);
  return status;
}

void fg_engine_bins_close(fg_engine_bins *bins) {
  free(bins->weight);
  free(bins->vectors);
  fg_engine_grid_close(&bins->grid);
  *bins = (fg_engine_bins){0};
}

void fg_engine_bins_gram(const fg_engine_bins *bins, const fg_loop_candidate *candidate,
                         const double *shape, double *columns, fg_engine_gram *gram) {
  size_t count = fg_engine_candidate_columns(&bins->grid, candidate);
  candidate->effect->basis(&bins->grid, candidate, shape, columns);
  for (size_t i = 0; i < count * bins->count; i++)
    if (!isfinite(columns[i])) columns[i] = 0;
  fg_engine_gram_take(bins->count, columns, count, bins->weight, bins->vectors, bins->rank, gram);
}
