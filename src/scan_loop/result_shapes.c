/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shape of one claim as points. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "scan_loop/result.h"
#include "scan_loop/state.h"

enum { SHAPE_POINTS = 81 };

static void fill_shape_point(fg_scan_result_claim *claim, double at, double um) {
  claim->shape[claim->shape_points][0] = at;
  claim->shape[claim->shape_points++][1] = um;
}

static void put_field(const fg_scan_loop *loop, const fg_effect_found *effect,
                      fg_scan_result_claim *claim) {
  const fg_field_frame *f = &loop->edge_fit.frame;
  int along = effect->kind->coordinate == FG_EFFECT_X ? 0 : 1;
  bool moves_x = effect->kind->moves && !strcmp(effect->kind->moves, "x");
  fg_field_list list = {.frame = *f, .fields = {fg_effect_found_field(effect)}, .count = 1};
  for (int i = 0; i < SHAPE_POINTS; i++) {
    double t = i / (SHAPE_POINTS - 1.0);
    double at = f->first_mm[along] + t * (f->last_mm[along] - f->first_mm[along]);
    fg_point d = fg_field_at(&list, (fg_point){at, at});
    fill_shape_point(claim, at, 1000 * (moves_x ? d.x : d.y));
  }
}

static void fill_foil_shape(const fg_scan_loop *loop, const fg_effect_found *effect,
                            fg_scan_result_claim *claim) {
  const double *psi = loop->edge_fit.psi_rad;
  for (int i = 0; i < SHAPE_POINTS; i++) {
    double values[FG_FIELD_COLUMNS], t = i / (SHAPE_POINTS - 1.0), sum = 0;
    fg_field_splines(psi[0], psi[1], FG_FIELD_COLUMNS, psi[0] + t * (psi[1] - psi[0]), values);
    for (size_t c = 0; c < effect->columns; c++)
      sum += effect->coefficient_um[c] * values[c];
    fill_shape_point(claim, 2 * t - 1, sum);
  }
}

/* Returns half the arc of a row's bump between its fillets. The fillet's circle (radius r) touches
 * the overall circle from inside and the bump's from outside, so the triangle of the three centres
 * has the sides R0 - r, R + r and X. */
static double fillet_to_fillet_rad(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row) {
  const fg_edge_fit_part *part = &edge_fit->parts[row->part];
  const fg_edge_fit_bump *bump = &part->bumps[row->bump_index];
  double r = edge_fit->views[row->view].measurement->design.bumps.fillet_radius_mm;
  double x = bump->distance_mm, from_o = part->overall_radius_mm - r, from_c = bump->radius_mm + r;
  double angle = acos((x * x + from_c * from_c - from_o * from_o) / (2 * x * from_c));
  return isfinite(angle) ? angle : part->half_arc_rad;
}

/* Returns the row's place on the coordinate; NaN: none. */
static double shape_coordinate_of(const fg_edge_fit *edge_fit, const fg_edge_fit_row *row,
                                  fg_effect_coordinate coordinate) {
  if (coordinate == FG_EFFECT_INDEX) return fg_edge_fit_along_bumps(row);
  if (coordinate == FG_EFFECT_PHI)
    return row->bump ? row->phi * edge_fit->parts[row->part].half_arc_rad /
                           fillet_to_fillet_rad(edge_fit, row)
                     : NAN;
  double deg = row->normal_rad * 180 / M_PI;
  return deg < 0 ? deg + 360 : deg;
}

/* Means of a deviation at the rows, which are where it is known. */
static fg_status fill_part_shape(fg_context *ctx, const fg_scan_loop *loop,
                                 const fg_effect_found *effect, fg_scan_result_claim *claim) {
  const fg_edge_fit *edge_fit = &loop->edge_fit;
  fg_effect_coordinate over = effect->kind->coordinate;
  double low = INFINITY, high = -INFINITY, sum[SHAPE_POINTS] = {0}, at[SHAPE_POINTS] = {0};
  double count[SHAPE_POINTS] = {0}, *shift = NULL;
  fg_effect_set alone = {.effects = {*effect}, .count = 1};
  FG_TRY(fg_effect_set_shift(ctx, edge_fit, &alone, &shift));
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    low = fmin(low, shape_coordinate_of(edge_fit, &edge_fit->rows[i], over));
    high = fmax(high, shape_coordinate_of(edge_fit, &edge_fit->rows[i], over));
  }
  for (size_t i = 0; i < edge_fit->row_count; i++) {
    double place = shape_coordinate_of(edge_fit, &edge_fit->rows[i], over);
    if (!isfinite(place)) continue;
    size_t bin = (size_t)fmin(SHAPE_POINTS - 1, (place - low) / (high - low) * SHAPE_POINTS);
    sum[bin] += 1000 * shift[i];
    at[bin] += place;
    count[bin]++;
  }
  free(shift);
  for (int k = 0; k < SHAPE_POINTS; k++)
    if (count[k] > 0) fill_shape_point(claim, at[k] / count[k], sum[k] / count[k]);
  return FG_OK;
}

fg_status fg_scan_result_put_shape(fg_context *ctx, const fg_scan_loop *loop,
                                   const fg_effect_found *effect, fg_scan_result_claim *claim) {
  FG_TRY(fg_memory_allocate(ctx, SHAPE_POINTS, sizeof *claim->shape, (void **)&claim->shape));
  if (effect->kind->glass)
    put_field(loop, effect, claim);
  else if (effect->kind->coordinate == FG_EFFECT_FOIL)
    fill_foil_shape(loop, effect, claim);
  else
    return fill_part_shape(ctx, loop, effect, claim);
  return FG_OK;
}
