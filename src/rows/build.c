/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <string.h>

#include "rows/edge_fit.h"

fg_status fg_edge_fit_build(fg_context *ctx, const fg_edge_fit_view *views, size_t count,
                            fg_edge_fit *edge_fit) {
  memset(edge_fit, 0, sizeof *edge_fit);
  for (size_t i = 1; i < count; i++)
    if (!views[i].disc != !views[0].disc)
      return fg_fail(ctx, FG_ERR_DATA, "foils and discs in one loop: give scans of one kind");
  if (count && views[0].disc) return fg_edge_fit_build_discs(ctx, views, count, edge_fit);
  return fg_edge_fit_build_foils(ctx, views, count, edge_fit);
}
