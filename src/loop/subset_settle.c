/* The search for effects and the fit of the geometry in turns. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "loop/scan_loop.h"

/* Rows this far off are left out, if they are fewer than this share. */
#define OUTLIER_SIGMAS 5.0
#define OUTLIER_SHARE  0.02
/* Largest change of an overall radius, and largest coefficient, that an effect may have. */
#define SANE_SHARE 0.03
#define SANE_UM    2000.0

void fg_subset_take(const fg_subset *subset, size_t member, fg_scan_set *set) {
  memset(set, 0, sizeof *set);
  for (size_t e = 0; e < subset->effect_count; e++) {
    if (!(subset->members[member].mask >> e & 1) || set->count == FG_SCAN_EFFECTS) continue;
    const fg_subset_effect *from = &subset->effects[e];
    fg_scan_effect *to = &set->effects[set->count++];
    *to = (fg_scan_effect){.id = from->id, .columns = from->columns, .shapes = from->shapes};
    memcpy(to->shape, from->shape, sizeof to->shape);
    if (from->form != FG_SUBSET_PLAIN) to->shape[0] = subset->members[member].middle_mm[e];
  }
}

/* Its shape is the middle, which every search finds anew; the fit's is the better one. */
static bool is_polynomial(const fg_scan_effect *effect) {
  return effect->columns == 1 && effect->shapes == 1 && strcmp(effect->id, "scan.row_step") != 0;
}

/* Numbers of the effects that both sets hold. */
static void keep_numbers(const fg_scan_set *from, fg_scan_set *to) {
  for (size_t e = 0; e < to->count; e++)
    for (size_t k = 0; k < from->count; k++)
      if (!strcmp(to->effects[e].id, from->effects[k].id) &&
          (to->effects[e].shape[0] == from->effects[k].shape[0] || is_polynomial(&to->effects[e])))
        to->effects[e] = from->effects[k];
}

static bool same_effects(const fg_scan_set *a, const fg_scan_set *b) {
  if (a->count != b->count) return false;
  for (size_t e = 0; e < a->count; e++)
    if (strcmp(a->effects[e].id, b->effects[e].id)) return false;
  return true;
}

/* Residual and Jacobian at the set's geometry, with what the set does put back, linearly. */
static fg_status put_back(fg_context *ctx, fg_points *points, const fg_scan_set *set,
                          double *residual_um, double *jacobian) {
  size_t rows = points->row_count;
  fg_field_list fields;
  double *shift = NULL, *columns = NULL;
  fg_status status = FG_OK;
  fg_scan_fields(points, set, &fields);
  FG_TRY_EXIT(fg_scan_shift(ctx, points, set, &shift));
  FG_TRY_EXIT(fg_memory_allocate(ctx, rows, FG_LOOP_COLUMNS * sizeof *columns, (void **)&columns));
  fg_points_correction correction = {&fields, shift};
  fg_points_residual(points, &correction, residual_um, jacobian);
  for (size_t i = 0; i < rows; i++)
    residual_um[i] *= 1000;
  for (size_t e = 0; e < set->count; e++) {
    const fg_scan_effect *effect = &set->effects[e];
    size_t count = fg_points_effect_columns(points, effect->id, effect->shape, columns);
    for (size_t c = 0; c < count; c++)
      for (size_t i = 0; i < rows; i++)
        residual_um[i] += effect->coefficient_um[c] * columns[c * rows + i];
  }
exit:
  free(shift);
  free(columns);
  return status;
}

/* Rows far outside what the set leaves elsewhere are no effect of the scanner or the part: an arc
 * that reached into its fillet, a burr. They lose their weight; should there be many, they are no
 * outliers. */
static fg_status drop_outliers(fg_context *ctx, fg_points *points, const double *residual_um) {
  double *absolute = NULL;
  size_t n = 0, out = 0, rows = points->row_count;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *absolute, (void **)&absolute));
  for (size_t i = 0; i < rows; i++)
    if (points->rows[i].weight > 0) absolute[n++] = fabs(residual_um[i]);
  double limit = n ? OUTLIER_SIGMAS * 1.4826 * fg_select(absolute, n, n / 2) : INFINITY;
  free(absolute);
  for (size_t i = 0; i < rows; i++)
    out += fabs(residual_um[i]) > limit;
  if ((double)out > OUTLIER_SHARE * (double)rows) return FG_OK;
  for (size_t i = 0; i < rows; i++)
    if (fabs(residual_um[i]) > limit) points->rows[i].weight = 0;
  return FG_OK;
}

/* An effect that bends the geometry so far is none. */
static bool is_sane(const fg_points *points, const double *geometry, const fg_scan_set *set) {
  size_t at = 0;
  for (size_t p = 0; p < points->part_count; p++) {
    double was = geometry[at];
    if (!(fabs(points->parts[p].overall_radius_mm / was - 1) < SANE_SHARE)) return false;
    at += 1 + 3 * points->parts[p].bump_count;
  }
  for (size_t e = 0; e < set->count; e++)
    for (size_t c = 0; c < set->effects[e].columns; c++)
      if (!(fabs(set->effects[e].coefficient_um[c]) < SANE_UM)) return false;
  return true;
}

/* Fits a set from the geometry that stands; one that runs away is given up for none. */
static fg_status fit_set(fg_context *ctx, fg_points *points, fg_scan_set *set, double *geometry,
                         double *residual_um) {
  fg_points_geometry_save(points, geometry);
  fg_status status = fg_scan_refit(ctx, points, set, residual_um);
  if (status != FG_OK && status != FG_ERR_NUMERIC) return status;
  if (status == FG_OK && is_sane(points, geometry, set)) return FG_OK;
  fg_points_geometry_load(points, geometry);
  memset(set, 0, sizeof *set);
  ctx->message[0] = 0;
  return fg_scan_refit(ctx, points, set, residual_um);
}

fg_status fg_subset_settle(fg_context *ctx, fg_points *points, fg_scan_set *set, fg_subset *subset,
                           double *residual_um) {
  enum { ROUNDS = 6 };
  double *jacobian = NULL, *geometry = NULL;
  fg_status status = FG_OK;
  memset(set, 0, sizeof *set);
  FG_TRY(fg_scan_refit(ctx, points, set, NULL));
  FG_TRY(fg_memory_allocate(ctx, points->row_count, points->parameters * sizeof *jacobian,
                            (void **)&jacobian));
  FG_TRY_EXIT(fg_memory_allocate(ctx, fg_points_geometry_size(points), sizeof *geometry,
                                 (void **)&geometry));
  for (int round = 0; round < ROUNDS; round++) {
    fg_scan_set next;
    FG_TRY_EXIT(put_back(ctx, points, set, residual_um, jacobian));
    FG_TRY_EXIT(fg_subset_find(ctx, points, residual_um, jacobian, set, round > 0, subset));
    fg_subset_take(subset, 0, &next);
    bool settled = same_effects(set, &next);
    keep_numbers(set, &next);
    *set = next;
    FG_TRY_EXIT(fit_set(ctx, points, set, geometry, residual_um));
    FG_TRY_EXIT(drop_outliers(ctx, points, residual_um));
    if (settled && round > 0) break;
  }
exit:
  free(jacobian);
  free(geometry);
  return status;
}
