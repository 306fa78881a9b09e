/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions common to the rows of foils and of discs. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/correlation.h"
#include "core/memory.h"
#include "rows/edge_fit.h"

/* Edges lie so far beside the middle of the strip, and are moved by effects. */
#define EDGE_ROOM_MM 0.2
/* Maximum number of knots of free curves that the few places of discs determine. */
enum { DISC_KNOTS = 12, COARSE_KNOTS = 6 };

fg_status fg_edge_fit_build(fg_context *ctx, const fg_edge_fit_view *views, size_t count,
                            fg_edge_fit *edge_fit) {
  memset(edge_fit, 0, sizeof *edge_fit);
  for (size_t i = 1; i < count; i++)
    if (!views[i].disc != !views[0].disc)
      return fg_fail(ctx, FG_ERR_DATA, "foils and discs in one loop: give scans of one kind");
  if (count && views[0].disc) return fg_edge_fit_build_discs(ctx, views, count, edge_fit);
  return fg_edge_fit_build_foils(ctx, views, count, edge_fit);
}

void fg_edge_fit_free(fg_edge_fit *edge_fit) {
  if (!edge_fit) return;
  for (size_t i = 0; edge_fit->parts && i < edge_fit->part_count; i++)
    free(edge_fit->parts[i].bumps);
  free(edge_fit->views);
  free(edge_fit->poses);
  free(edge_fit->parts);
  free(edge_fit->rows);
  memset(edge_fit, 0, sizeof *edge_fit);
}

fg_status fg_edge_fit_add_row(fg_context *ctx, fg_edge_fit *edge_fit, const fg_edge_fit_row *row) {
  FG_TRY(fg_memory_reserve(ctx, edge_fit->row_count + 1, sizeof *edge_fit->rows,
                           &edge_fit->row_capacity, (void **)&edge_fit->rows));
  edge_fit->rows[edge_fit->row_count++] = *row;
  return FG_OK;
}

void fg_edge_fit_find_frame(fg_edge_fit *edge_fit) {
  fg_field_frame *f = &edge_fit->frame;
  f->knots = edge_fit->coarse ? COARSE_KNOTS : edge_fit->discs ? DISC_KNOTS : FG_FIELD_COLUMNS;
  for (int axis = 0; axis < 2; axis++)
    f->low_mm[axis] = 0;
  for (size_t v = 0; v < edge_fit->view_count; v++) {
    double size_mm[2];
    fg_measurement_size_mm(edge_fit->views[v].measurement, size_mm);
    for (int axis = 0; axis < 2; axis++)
      f->high_mm[axis] = fmax(f->high_mm[axis], size_mm[axis]);
  }
  for (int axis = 0; axis < 2; axis++) {
    f->centre_mm[axis] = 0.5 * (f->low_mm[axis] + f->high_mm[axis]);
    f->first_mm[axis] = f->high_mm[axis];
    f->last_mm[axis] = f->low_mm[axis];
    for (size_t i = 0; i < edge_fit->row_count; i++) {
      double at = fg_point_along(edge_fit->rows[i].at, axis);
      f->first_mm[axis] = fmin(f->first_mm[axis], at - EDGE_ROOM_MM);
      f->last_mm[axis] = fmax(f->last_mm[axis], at + EDGE_ROOM_MM);
    }
  }
}

double fg_edge_fit_integral(const fg_edge_fit *edge_fit, const size_t *row, size_t count,
                            const double *value) {
  enum { LAGS = 16 };
  double products[LAGS] = {0}, pairs[LAGS] = {0};
  for (size_t i = 0; i < count; i++)
    for (size_t lag = 0; lag < LAGS && i + lag < count; lag++) {
      const fg_edge_fit_row *a = &edge_fit->rows[row ? row[i] : i];
      const fg_edge_fit_row *b = &edge_fit->rows[row ? row[i + lag] : i + lag];
      if (a->view != b->view || a->group != b->group) break;
      products[lag] += value[i] * value[i + lag];
      pairs[lag]++;
    }
  return fg_correlation_integral(products, pairs, LAGS);
}
