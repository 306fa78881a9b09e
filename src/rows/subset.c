/* Some of the rows, to fit and search by themselves. */
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "rows/points.h"

static fg_status copy(fg_context *ctx, const void *from, size_t count, size_t size, void *to) {
  void **out = to;
  FG_TRY(fg_memory_allocate(ctx, count, size, out));
  if (count) memcpy(*out, from, count * size);
  return FG_OK;
}

static fg_status copy_parts(fg_context *ctx, const fg_points *points, fg_points *subset) {
  FG_TRY(copy(ctx, points->parts, points->part_count, sizeof *points->parts, &subset->parts));
  for (size_t p = 0; p < points->part_count; p++)
    subset->parts[p].bumps = NULL;
  for (size_t p = 0; p < points->part_count; p++)
    FG_TRY(copy(ctx, points->parts[p].bumps, points->parts[p].bump_count,
                sizeof *points->parts[p].bumps, &subset->parts[p].bumps));
  return FG_OK;
}

fg_status fg_points_subset(fg_context *ctx, const fg_points *points, const bool *keep,
                           fg_points *subset) {
  fg_status status = FG_OK;
  *subset = *points;
  subset->views = NULL;
  subset->poses = NULL;
  subset->parts = NULL;
  subset->rows = NULL;
  subset->row_count = subset->row_capacity = 0;
  FG_TRY_EXIT(copy(ctx, points->views, points->view_count, sizeof *points->views, &subset->views));
  FG_TRY_EXIT(copy(ctx, points->poses, points->view_count, sizeof *points->poses, &subset->poses));
  FG_TRY_EXIT(copy_parts(ctx, points, subset));
  for (size_t i = 0; i < points->row_count; i++)
    if (!keep || keep[i]) FG_TRY_EXIT(fg_points_add_row(ctx, subset, &points->rows[i]));
exit:
  if (status != FG_OK) fg_points_free(subset);
  return status;
}
