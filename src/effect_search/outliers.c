/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effect_search/outliers.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/spread.h"

/* Rows beyond so many sigmas are dropped, if they are fewer than this share: of normal noise 1
 * in 1.7 million is. */
#define OUTLIER_SIGMAS 5.0
#define OUTLIER_SHARE  0.02
/* Of a third difference at a run's end (tuned on reports/loop_scans.md). */
#define END_SIGMAS 8.0
/* Rows at either end that may leave, and rows that a run must have between them. */
enum { END_ROWS = 3, BETWEEN = 4 };
/* Residual, or in units of its row's noise, but for one factor. */
static double size_of(const fg_edge_fit_row *row, bool own_noise, double residual) {
  return own_noise ? fabs(residual) * sqrt(row->weight / FG_EDGE_FIT_BLOCK) : fabs(residual);
}

fg_status fg_search_drop_outliers(fg_context *ctx, fg_edge_fit *edge_fit, bool own_noise,
                                  const double *residual_um) {
  double *absolute = NULL;
  size_t n = 0, out = 0, rows = edge_fit->row_count;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *absolute, (void **)&absolute));
  for (size_t i = 0; i < rows; i++)
    if (edge_fit->rows[i].weight > 0)
      absolute[n++] = size_of(&edge_fit->rows[i], own_noise, residual_um[i]);
  double limit = fg_spread_limit(absolute, n, OUTLIER_SIGMAS);
  free(absolute);
  for (size_t i = 0; i < rows; i++)
    out += size_of(&edge_fit->rows[i], own_noise, residual_um[i]) > limit;
  if ((double)out > OUTLIER_SHARE * (double)rows) return FG_OK;
  for (size_t i = 0; i < rows; i++)
    if (size_of(&edge_fit->rows[i], own_noise, residual_um[i]) > limit)
      edge_fit->rows[i].weight = 0;
  return FG_OK;
}

static double third_difference(const double *r, size_t at, int step) {
  size_t k[4];
  for (int i = 0; i < 4; i++)
    k[i] = (size_t)((ptrdiff_t)at + i * step);
  return r[k[0]] - 3 * r[k[1]] + 3 * r[k[2]] - r[k[3]];
}

static bool same_run(const fg_edge_fit *edge_fit, size_t a, size_t b) {
  const fg_edge_fit_row *p = &edge_fit->rows[a], *q = &edge_fit->rows[b];
  return b < edge_fit->row_count && p->view == q->view && p->group == q->group;
}

static void drop_range(fg_edge_fit *edge_fit, size_t from, size_t to) {
  for (size_t i = from; i < to; i++)
    edge_fit->rows[i].weight = 0;
}

/* Third differences remove smooth deviations. */
fg_status fg_search_drop_ends(fg_context *ctx, fg_edge_fit *edge_fit, const double *residual_um) {
  size_t rows = edge_fit->row_count, n = 0;
  double *size = NULL;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *size, (void **)&size));
  for (size_t i = 0; i + 3 < rows; i++)
    if (same_run(edge_fit, i, i + 3)) size[n++] = fabs(third_difference(residual_um, i, 1));
  double limit = fg_spread_limit(size, n, END_SIGMAS);
  free(size);
  for (size_t from = 0, to; from < rows; from = to) {
    for (to = from + 1; to < rows && same_run(edge_fit, from, to);)
      to++;
    for (size_t k = 0; k < END_ROWS && from + 2 * END_ROWS + BETWEEN < to; k++) {
      size_t low = from + END_ROWS - 1 - k, high = to - END_ROWS + k;
      if (fabs(third_difference(residual_um, low, 1)) > limit) drop_range(edge_fit, from, low + 1);
      if (fabs(third_difference(residual_um, high, -1)) > limit) drop_range(edge_fit, high, to);
    }
  }
  return FG_OK;
}

void fg_search_drop_across_steps(fg_edge_fit *edge_fit, const fg_effect_set *set, double half_mm) {
  for (size_t e = 0; e < set->count; e++)
    for (size_t i = 0; i < edge_fit->row_count; i++)
      if (set->effects[e].kind->jumps &&
          fg_effect_from_jump_mm(set->effects[e].kind, set->effects[e].shape,
                                 fg_point_along(edge_fit->rows[i].at, set->effects[e].kind->axis)) <
              half_mm)
        edge_fit->rows[i].weight = 0;
}
