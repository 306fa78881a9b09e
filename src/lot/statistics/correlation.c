/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Angle against radius: does the arc length stay? */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "foilgauge/distribution.h"
#include "lot/statistics/analysis.h"
#include "stats/cluster_line.h"

typedef struct pairs {
  double *radius_pct, *angle_pct; /* errors */
  size_t *foil;                   /* index of each bump's foil */
  size_t count, foils;
} pairs;

static void free_pairs(pairs *p) {
  free(p->radius_pct);
  free(p->angle_pct);
  free(p->foil);
}

static fg_status allocate_pairs(fg_context *ctx, size_t count, pairs *p) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *p->radius_pct, &block));
  p->radius_pct = block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *p->angle_pct, &block));
  p->angle_pct = block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *p->foil, &block));
  p->foil = block;
  return FG_OK;
}

/* Key of a part: its name in the part's column, its bearing and its number in the scan. Scans of
 * one part show one foil; foils of two bearings may share a name (1, 2, 3 of each). */
typedef struct part {
  const char *name, *bearing;
  int number;
  size_t at; /* in the lot */
} part;

static int compare_parts(const void *a, const void *b) {
  const part *p = a, *q = b;
  int order = strcmp(p->name, q->name);
  if (order == 0) order = strcmp(p->bearing, q->bearing);
  if (order == 0) order = (p->number > q->number) - (p->number < q->number);
  return order ? order : (p->at > q->at) - (p->at < q->at);
}

fg_status fg_lot_find_owners(fg_context *ctx, const fg_lot_analysis *analysis, size_t *owner) {
  const fg_lot *lot = analysis->lot;
  size_t column = fg_manifest_column(&lot->manifest, lot->settings.part_column), count = 0;
  size_t of_bearing = fg_manifest_column(&lot->manifest, lot->settings.bearing_column);
  void *block;
  FG_TRY(fg_memory_allocate(ctx, analysis->foil_count, sizeof(part), &block));
  part *parts = block;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_lot_foil *foil = &analysis->foils[i];
    const char *name =
        column == FG_NO_COLUMN ? "" : fg_manifest_cell(&lot->manifest, foil->item, column);
    const char *bearing =
        of_bearing == FG_NO_COLUMN ? "" : fg_manifest_cell(&lot->manifest, foil->item, of_bearing);
    owner[i] = i;
    if (*name) parts[count++] = (part){name, bearing, foil->foil->number, i};
  }
  fg_sort_items(parts, count, sizeof *parts, compare_parts);
  for (size_t i = 1; i < count; i++)
    if (!strcmp(parts[i].name, parts[i - 1].name) && parts[i].number == parts[i - 1].number &&
        !strcmp(parts[i].bearing, parts[i - 1].bearing))
      owner[parts[i].at] = owner[parts[i - 1].at];
  free(parts);
  return FG_OK;
}

static void fill_pairs(const fg_lot_analysis *analysis, const size_t *owner, pairs *p) {
  for (size_t i = 0; i < analysis->foil_count; i++)
    for (size_t k = 0; k < analysis->foils[i].foil->bump_count; k++) {
      const fg_bump *bump = &analysis->foils[i].foil->bumps[k];
      if (!fg_lot_bump_counts(analysis->foils[i].foil, bump)) continue;
      if (!isfinite(bump->radius_error_pct) || !isfinite(bump->bump_angle_error_pct)) continue;
      p->radius_pct[p->count] = bump->radius_error_pct;
      p->angle_pct[p->count] = bump->bump_angle_error_pct;
      p->foil[p->count++] = owner[i];
    }
  p->foils = analysis->foil_count;
}

static fg_status collect_pairs(fg_context *ctx, const fg_lot_analysis *analysis, pairs *p) {
  size_t max = 0;
  void *block;
  for (size_t i = 0; i < analysis->foil_count; i++)
    max += analysis->foils[i].foil->bump_count;
  FG_TRY(allocate_pairs(ctx, max, p));
  FG_TRY(fg_memory_allocate(ctx, analysis->foil_count, sizeof(size_t), &block));
  fg_status status = fg_lot_find_owners(ctx, analysis, block);
  if (status == FG_OK) fill_pairs(analysis, block, p);
  free(block);
  return status;
}

/* Finds the two values beyond which `share` of all lie on each side. */
static fg_status find_tails(fg_context *ctx, const double *values, size_t count, double share,
                            double limits[2]) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *values, &block));
  double *sorted = block;
  memcpy(sorted, values, count * sizeof *values);
  fg_sort(sorted, count);
  limits[0] = fg_sample_quantile(sorted, count, share);
  limits[1] = fg_sample_quantile(sorted, count, 1 - share);
  free(sorted);
  return FG_OK;
}

/* Trims by the radius alone, as the thesis does. Trimming by the angle, the response, would bias
 * the slope towards 0. */
static fg_status trim_by_radius(fg_context *ctx, double trim_pct, pairs *p) {
  double limits[2];
  size_t kept = 0;
  FG_TRY(find_tails(ctx, p->radius_pct, p->count, trim_pct / 100, limits));
  for (size_t i = 0; i < p->count; i++) {
    if (!(p->radius_pct[i] >= limits[0] && p->radius_pct[i] <= limits[1])) continue;
    p->radius_pct[kept] = p->radius_pct[i];
    p->angle_pct[kept] = p->angle_pct[i];
    p->foil[kept++] = p->foil[i];
  }
  p->count = kept;
  return FG_OK;
}

/* Describes 100 (R alpha / R_D alpha_D - 1) of every bump, trimmed ones included: without them its
 * scatter would be too small. */
static void describe_arc_length(const pairs *p, fg_lot_correlation *result) {
  double mean = 0, squares = 0;
  for (size_t i = 0; i < p->count; i++) {
    double radius = 1 + p->radius_pct[i] / 100, angle = 1 + p->angle_pct[i] / 100;
    double value = 100 * (radius * angle - 1), step = value - mean;
    mean += step / (double)(i + 1);
    squares += step * (value - mean);
  }
  result->arc_length_mean_pct = mean;
  result->arc_length_sd_pct = sqrt(squares / (double)(p->count - 1));
}

static size_t count_paired_foils(const pairs *p, size_t *seen) {
  size_t count = 0;
  for (size_t i = 0; i < p->count; i++)
    count += seen[p->foil[i]]++ == 0;
  return count;
}

static fg_status fit_errors(fg_context *ctx, const fg_lot_settings *settings, pairs *p,
                            fg_lot_correlation *result) {
  fg_cluster_line errors, logs;
  void *seen;
  FG_TRY(fg_memory_allocate(ctx, p->foils, sizeof(size_t), &seen));
  result->foils = count_paired_foils(p, seen);
  free(seen);
  FG_TRY(
      fg_cluster_line_fit(ctx, p->radius_pct, p->angle_pct, p->foil, p->count, p->foils, &errors));
  result->r = errors.r;
  result->slope = errors.slope;
  result->intercept = errors.intercept;
  for (size_t i = 0; i < p->count; i++) {
    p->radius_pct[i] = log1p(p->radius_pct[i] / 100);
    p->angle_pct[i] = log1p(p->angle_pct[i] / 100);
  }
  FG_TRY(fg_cluster_line_fit(ctx, p->radius_pct, p->angle_pct, p->foil, p->count, p->foils, &logs));
  double reach =
      logs.dof > 0
          ? logs.u_slope * fg_distribution_t_quantile((1 + settings->confidence) / 2, logs.dof)
          : NAN;
  result->log_slope = logs.slope;
  result->log_low = logs.slope - reach;
  result->log_high = logs.slope + reach;
  result->log_dof = logs.dof;
  return FG_OK;
}

fg_status fg_lot_analyse_correlation(fg_context *ctx, fg_lot_analysis *analysis) {
  const fg_lot_settings *settings = &analysis->lot->settings;
  fg_lot_correlation *result = &analysis->correlation;
  pairs p = {0};
  fg_status status = FG_OK;
  FG_TRY_EXIT(collect_pairs(ctx, analysis, &p));
  result->count = p.count;
  if (p.count < 5) goto exit;
  describe_arc_length(&p, result);
  FG_TRY_EXIT(trim_by_radius(ctx, settings->trim_pct, &p));
  result->trimmed = result->count - p.count;
  analysis->has_correlation = p.count >= 5;
  if (analysis->has_correlation) FG_TRY_EXIT(fit_errors(ctx, settings, &p, result));
exit:
  free_pairs(&p);
  return status;
}
