/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Scans, views and rows of the result, and its end. */
#include "scan_loop/result.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "scan_loop/state.h"

/* Neighbours on one arc are no further apart. */
#define GAP_MM 0.5
/* Weight, relative to the largest, up to which rows hardly contribute. */
#define LIGHT_SHARE 0.1

static fg_status put_scans(fg_context *ctx, const fg_scan_loop *loop, fg_scan_result *result) {
  FG_TRY(fg_memory_allocate(ctx, loop->scan_count, sizeof *result->scan, (void **)&result->scan));
  for (size_t i = 0; i < loop->scan_count; i++)
    result->scan[i] = (fg_scan_result_scan){&loop->before[i], loop->after ? &loop->after[i] : NULL,
                                            loop->hold_out[i]};
  result->scans = loop->scan_count;
  return FG_OK;
}

static fg_status put_views(fg_context *ctx, const fg_edge_fit *edge_fit, fg_scan_result *result) {
  FG_TRY(
      fg_memory_allocate(ctx, edge_fit->view_count, sizeof *result->view, (void **)&result->view));
  for (size_t v = 0; v < edge_fit->view_count; v++) {
    const fg_edge_fit_view *view = &edge_fit->views[v];
    result->view[v] =
        (fg_scan_result_view){view->scan, view->foil, edge_fit->parts[view->part].bump_count};
  }
  result->views = edge_fit->view_count;
  return FG_OK;
}

static bool same_arc(const fg_edge_fit_row *a, const fg_edge_fit_row *b) {
  return a->view == b->view && a->group == b->group &&
         hypot(a->at.x - b->at.x, a->at.y - b->at.y) < GAP_MM;
}

static fg_scan_result_row row_of(const fg_scan_loop *loop, size_t i, size_t arc) {
  const fg_edge_fit_row *row = &loop->edge_fit.rows[i];
  return (fg_scan_result_row){
      .scan = loop->edge_fit.views[row->view].scan,
      .arc = arc,
      .bump = row->bump,
      .at_mm = row->at,
      .ideal_mm = row->ideal,
      .normal = row->normal,
      .place = {[FG_SCAN_X] = row->at.x,
                [FG_SCAN_Y] = row->at.y,
                [FG_SCAN_FOIL] = row->s_mm,
                [FG_SCAN_PHI] = row->bump ? row->phi : NAN,
                [FG_SCAN_INDEX] = fg_edge_fit_along_bumps(row),
                [FG_SCAN_NORMAL] = row->normal_rad * 180 / M_PI},
      .weight = row->weight,
      .residual_um = {loop->residual_before[i], loop->residual_after[i]},
  };
}

fg_status fg_scan_result_put_rows(fg_context *ctx, const fg_scan_loop *loop,
                                  fg_scan_result *result) {
  const fg_edge_fit *edge_fit = &loop->edge_fit;
  double max = 0;
  size_t arc = 0;
  FG_TRY(put_scans(ctx, loop, result));
  FG_TRY(put_views(ctx, edge_fit, result));
  FG_TRY(fg_memory_allocate(ctx, edge_fit->row_count, sizeof *result->row, (void **)&result->row));
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    arc += i && !same_arc(&edge_fit->rows[i - 1], &edge_fit->rows[i]);
    result->row[i] = row_of(loop, i, arc);
    max = fmax(max, edge_fit->rows[i].weight);
  }
  result->rows = edge_fit->row_count;
  result->row_stations = FG_EDGE_FIT_BLOCK;
  result->light_weight = LIGHT_SHARE * max;
  return FG_OK;
}

static void free_response(fg_scan_result_response *response) {
  free(response->unclaimed);
  free(response->bump);
  free(response->curve);
  free(response->nearest);
}

void fg_scan_result_free(fg_scan_result *result) {
  for (size_t i = 0; i < result->claims; i++)
    free(result->claim[i].shape);
  for (size_t r = 0; r < FG_SCAN_RESULT_RESPONSES; r++)
    free_response(&result->bumps.response[r]);
  free(result->scan);
  free(result->view);
  free(result->row);
  free(result->line);
  free(result->grid.line);
  free(result->noise.disc_um);
  fg_scanner_model_free((fg_scanner_model *)result->model);
  *result = (fg_scan_result){0};
}
