/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "table_loop/between.h"

#include <stdlib.h>

#include "core/memory.h"

/* Number of groups above which Student's t of their dof is close to normal, and the basis large. */
enum { GROUPS_MAX = 100 };

bool fg_engine_constant_in_levels(const fg_engine_training *training, const double *columns,
                                  size_t count) {
  for (size_t k = 0; k < count; k++)
    for (size_t b = 0; b < training->levels; b++)
      for (size_t i = training->level_start[b] + 1; i < training->level_start[b + 1]; i++)
        if (columns[k * training->n + fg_engine_level_row(training, i)] !=
            columns[k * training->n + fg_engine_level_row(training, i - 1)])
          return false;
  return training->levels > 0;
}

bool fg_engine_constant_in_outer_levels(const fg_engine_training *training, const double *columns,
                                        size_t count) {
  if (!training->outers || !fg_engine_constant_in_levels(training, columns, count)) return false;
  for (size_t k = 0; k < count; k++)
    for (size_t o = 0; o < training->outers; o++)
      for (size_t b = training->outer_start[o] + 1; b < training->outer_start[o + 1]; b++) {
        size_t one = training->level_start[training->outer_block[b]];
        size_t other = training->level_start[training->outer_block[b - 1]];
        if (columns[k * training->n + fg_engine_level_row(training, one)] !=
            columns[k * training->n + fg_engine_level_row(training, other)])
          return false;
      }
  return true;
}

fg_status fg_engine_between_basis(fg_context *ctx, const fg_engine_training *training,
                                  fg_engine_noise noise, const fg_engine_span *null,
                                  double **between, size_t *between_rank) {
  size_t n = training->n, levels = training->levels;
  double *columns = NULL;
  *between = NULL;
  *between_rank = 0;
  if (levels == 0 || levels > GROUPS_MAX) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, n, levels * sizeof *columns, (void **)&columns));
  for (size_t b = 0; b < levels; b++) {
    for (size_t i = training->level_start[b]; i < training->level_start[b + 1]; i++)
      columns[b * n + fg_engine_level_row(training, i)] = 1;
    fg_engine_whiten(training, noise, columns + b * n);
  }
  fg_status status = fg_memory_allocate(ctx, n, levels * sizeof **between, (void **)between);
  if (status == FG_OK)
    *between_rank =
        fg_engine_orthonormal(n, null->basis, null->rank, columns, levels, *between, NULL);
  free(columns);
  return status;
}
