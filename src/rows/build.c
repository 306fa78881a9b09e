#include <string.h>

#include "rows/points.h"

fg_status fg_points_build(fg_context *ctx, const fg_points_view *views, size_t count,
                          fg_points *points) {
  memset(points, 0, sizeof *points);
  for (size_t i = 1; i < count; i++)
    if (!views[i].disc != !views[0].disc)
      return fg_fail(ctx, FG_ERR_DATA, "foils and discs in one loop: give scans of one kind");
  if (count && views[0].disc) return fg_points_build_discs(ctx, views, count, points);
  return fg_points_build_foils(ctx, views, count, points);
}
