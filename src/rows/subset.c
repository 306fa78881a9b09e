/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Some of the rows, to fit and search by themselves. */
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "rows/edge_fit.h"

static fg_status copy(fg_context *ctx, const void *from, size_t count, size_t size, void *to) {
  void **out = to;
  FG_TRY(fg_memory_allocate(ctx, count, size, out));
  if (count) memcpy(*out, from, count * size);
  return FG_OK;
}

static fg_status copy_parts(fg_context *ctx, const fg_edge_fit *edge_fit, fg_edge_fit *subset) {
  FG_TRY(copy(ctx, edge_fit->parts, edge_fit->part_count, sizeof *edge_fit->parts, &subset->parts));
  for (size_t p = 0; p < edge_fit->part_count; p++)
    subset->parts[p].bumps = NULL;
  for (size_t p = 0; p < edge_fit->part_count; p++)
    FG_TRY(copy(ctx, edge_fit->parts[p].bumps, edge_fit->parts[p].bump_count,
                sizeof *edge_fit->parts[p].bumps, &subset->parts[p].bumps));
  return FG_OK;
}

fg_status fg_edge_fit_subset(fg_context *ctx, const fg_edge_fit *edge_fit, const bool *keep,
                             fg_edge_fit *subset) {
  fg_status status = FG_OK;
  *subset = *edge_fit;
  subset->views = NULL;
  subset->poses = NULL;
  subset->parts = NULL;
  subset->rows = NULL;
  subset->row_count = subset->row_capacity = 0;
  FG_TRY_EXIT(
      copy(ctx, edge_fit->views, edge_fit->view_count, sizeof *edge_fit->views, &subset->views));
  FG_TRY_EXIT(
      copy(ctx, edge_fit->poses, edge_fit->view_count, sizeof *edge_fit->poses, &subset->poses));
  FG_TRY_EXIT(copy_parts(ctx, edge_fit, subset));
  for (size_t i = 0; i < edge_fit->row_count; i++)
    if (!keep || keep[i]) FG_TRY_EXIT(fg_edge_fit_add_row(ctx, subset, &edge_fit->rows[i]));
exit:
  if (status != FG_OK) fg_edge_fit_free(subset);
  return status;
}
