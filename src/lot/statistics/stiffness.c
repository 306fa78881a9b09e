/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stiffness of a lot's bumps. */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/spread.h"
#include "lot/statistics/budget.h"
#include "quantity/quantity_rows.h"

void fg_lot_analyse_thickness(fg_lot_analysis *analysis) {
  fg_lot_thickness *result = &analysis->thickness;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_foil *foil = analysis->foils[i].foil;
    if (!fg_foil_is_measured(foil) || !isfinite(foil->thickness.mm)) continue;
    result->foils++;
    result->mean.mm += foil->thickness.mm;
    result->mean.u_mm += foil->thickness.u_mm;
  }
  result->mean.mm /= (double)result->foils;
  result->mean.u_mm /= (double)result->foils;
  result->differs =
      result->foils && fg_thickness_differs(&analysis->lot->settings.design, &result->mean);
}

static double stiffness_ratio(const fg_lot_settings *settings, const fg_lot_stiffness *result,
                              double thickness_mm, double radius_mm, double angle_deg,
                              double *foot) {
  fg_arch_stiffness stiffness;
  fg_context unused;
  fg_arch arch = fg_design_arch(&settings->design, thickness_mm, radius_mm, angle_deg);
  if (fg_arch_free(&unused, &arch, &settings->material, &stiffness) != FG_OK) return NAN;
  if (foot) *foot = stiffness.foot_n_mm2 / result->design_free.foot_n_mm2;
  return stiffness.stiffness_n_mm2 / result->design_free.stiffness_n_mm2;
}

static fg_status stiffness_of_design(fg_context *ctx, const fg_lot_settings *settings,
                                     fg_lot_stiffness *result) {
  const fg_design *design = &settings->design;
  fg_arch arch = fg_design_arch(design, design->thickness_mm, design->bumps.radius_mm,
                                design->bumps.angle_deg);
  result->cases[FG_LOT_CASE_DESIGN] =
      fg_stiffness_case_of("as designed", design, &arch, &settings->material);
  FG_TRY(fg_arch_free(ctx, &arch, &settings->material, &result->design_free));
  FG_TRY(fg_arch_welded(ctx, &arch, &settings->material, &result->design_welded));
  return fg_arch_sensitivities(ctx, &arch, &settings->material, &result->sensitivity);
}

enum { COLUMNS = 9 + FG_STIFFNESS_MODELS };

static void list_bump_columns(fg_bump_columns *columns, double **all[COLUMNS]) {
  double **const named[] = {&columns->radius,      &columns->arc_length, &columns->arch_radius,
                            &columns->arch_length, &columns->thickness,  &columns->strip,
                            &columns->measurement, &columns->foot,       &columns->designed};
  size_t count = sizeof named / sizeof *named;
  for (size_t i = 0; i < count; i++)
    all[i] = named[i];
  for (size_t i = 0; i < FG_STIFFNESS_MODELS; i++)
    all[count + i] = &columns->ratio[i];
}

static fg_status allocate_columns(fg_context *ctx, size_t count, fg_bump_columns *columns) {
  double **all[COLUMNS];
  void *block;
  list_bump_columns(columns, all);
  for (size_t i = 0; i < COLUMNS; i++) {
    FG_TRY(fg_memory_allocate(ctx, count, sizeof(double), &block));
    *all[i] = block;
  }
  return FG_OK;
}

static void free_columns(fg_bump_columns *columns) {
  double **all[COLUMNS];
  list_bump_columns(columns, all);
  for (size_t i = 0; i < COLUMNS; i++)
    free(*all[i]);
}

/* Adds the ratios of the models beside the arch; NaN where one gives none. */
static void add_model_ratios(const fg_lot_settings *settings, const fg_lot_stiffness *result,
                             const fg_arch *arch, fg_bump_columns *columns) {
  for (int i = 1; i < FG_STIFFNESS_MODELS; i++) {
    double stiffness = NAN;
    fg_context unused;
    if (fg_stiffness_models()[i].stiffness(&unused, arch, &settings->material, &stiffness) != FG_OK)
      stiffness = NAN;
    columns->ratio[i][columns->count] =
        stiffness / result->cases[FG_LOT_CASE_DESIGN].by_model[i].stiffness_n_mm2;
  }
}

/* Adds a bump to the columns; returns its stiffness over the design's. */
static double add_stiffness_row(const fg_lot_analysis *analysis, const fg_foil *foil,
                                const fg_bump *bump, fg_bump_columns *columns) {
  const fg_lot_settings *settings = &analysis->lot->settings;
  double thickness_mm = fg_foil_thickness(&settings->design, foil).mm;
  double radius = bump->radius_mm, angle = bump->bump_angle_deg, foot;
  const fg_lot_stiffness *result = &analysis->stiffness;
  double ratio = stiffness_ratio(settings, result, thickness_mm, radius, angle, &foot);
  size_t at = columns->count;
  if (!isfinite(ratio) || !fg_lot_bump_counts(foil, bump)) return ratio;
  columns->radius[at] = radius;
  columns->arc_length[at] = radius * angle;
  columns->thickness[at] = thickness_mm;
  columns->foot[at] = foot;
  columns->ratio[0][at] = ratio;
  const fg_arch arch = fg_design_arch(&settings->design, thickness_mm, radius, angle);
  columns->arch_radius[at] = arch.radius_mm;
  columns->arch_length[at] = arch.radius_mm * angle;
  columns->strip[at] = foil->thickness.mm;
  fg_bump scattered = *bump; /* errors that all bumps share cause no spread */
  fg_quantity_narrow_calibrated(FG_QUANTITY_OF_BUMP, &scattered, &bump->calibrated);
  columns->measurement[at] =
      fg_bump_stiffness_variance(&foil->overall, &scattered, &result->sensitivity);
  add_model_ratios(settings, result, &arch, columns);
  columns->designed[at] =
      stiffness_ratio(settings, result, settings->design.thickness_mm, radius, angle, NULL);
  columns->count++;
  return ratio;
}

static void fill_bump_columns(fg_lot_analysis *analysis, fg_bump_columns *columns) {
  size_t at = 0;
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_foil *foil = analysis->foils[i].foil;
    for (size_t k = 0; k < foil->bump_count; k++)
      analysis->stiffness.normalised[at++] =
          add_stiffness_row(analysis, foil, &foil->bumps[k], columns);
  }
}

/* Draws radius and arc length independently: the radius carries the springback, the arc length the
 * rest of the angle's variation. Thicknesses of the bumps come in turns. */
static fg_status resample_stiffness(fg_context *ctx, const fg_lot_settings *settings,
                                    const fg_bump_columns *columns, fg_lot_stiffness *result) {
  fg_density radius = {0}, arc_length = {0};
  void *block = NULL;
  fg_status status = FG_OK;
  uint64_t seed = settings->seed;
  size_t count = 0;
  FG_TRY_EXIT(fg_density_fit(ctx, columns->radius, columns->count, settings->bandwidth, &radius));
  FG_TRY_EXIT(
      fg_density_fit(ctx, columns->arc_length, columns->count, settings->bandwidth, &arc_length));
  FG_TRY_EXIT(fg_memory_allocate(ctx, settings->resamples, sizeof(double), &block));
  double *ratio = block;
  for (size_t i = 0; i < settings->resamples; i++) {
    double r = fg_density_draw(&radius, &seed), length = fg_density_draw(&arc_length, &seed);
    double thickness_mm = columns->thickness[i % columns->count];
    ratio[count] = stiffness_ratio(settings, result, thickness_mm, r, length / r, NULL);
    count += isfinite(ratio[count]) != 0;
  }
  FG_TRY_EXIT(fg_lot_find_spread(ctx, ratio, count, settings->bandwidth, &result->resampled));
exit:
  free(block);
  fg_density_free(&radius);
  fg_density_free(&arc_length);
  return status;
}

static bool has_different_values(const double *values, size_t count) {
  for (size_t i = 1; i < count; i++)
    if (values[i] != values[0]) return true;
  return false;
}

/* Finds the stiffness of a bump with the lot's mean radius, arc length and thickness. */
static void find_mean_bump(const fg_lot_settings *settings, const fg_bump_columns *columns,
                           fg_lot_stiffness *result) {
  double radius = fg_mean(columns->arch_radius, columns->count);
  const fg_arch arch = {radius, fg_mean(columns->arch_length, columns->count) / radius,
                        fg_mean(columns->thickness, columns->count)};
  result->cases[FG_LOT_CASE_MEAN] =
      fg_stiffness_case_of("the lot's mean", &settings->design, &arch, &settings->material);
}

/* A model without a stiffness for one of the bumps has no spread over them. */
static fg_status spread_by_models(fg_context *ctx, const fg_lot_settings *settings,
                                  const fg_bump_columns *columns, fg_lot_stiffness *result) {
  for (int i = 0; i < FG_STIFFNESS_MODELS; i++) {
    if (!isfinite(fg_mean(columns->ratio[i], columns->count))) continue;
    FG_TRY(fg_lot_find_spread(ctx, columns->ratio[i], columns->count, settings->bandwidth,
                              &result->by_model[i]));
  }
  return FG_OK;
}

fg_status fg_lot_analyse_stiffness(fg_context *ctx, fg_lot_analysis *analysis) {
  const fg_lot_settings *settings = &analysis->lot->settings;
  fg_lot_stiffness *result = &analysis->stiffness;
  fg_bump_columns columns = {0};
  void *block;
  size_t max = 0;
  fg_status status = FG_OK;
  if (!fg_foil_kind_has_bumps(settings->design.kind)) return FG_OK;
  for (size_t i = 0; i < analysis->foil_count; i++)
    max += analysis->foils[i].foil->bump_count;
  FG_TRY_EXIT(stiffness_of_design(ctx, settings, result));
  FG_TRY_EXIT(fg_memory_allocate(ctx, max, sizeof(double), &block));
  result->normalised = block;
  FG_TRY_EXIT(allocate_columns(ctx, max, &columns));
  fill_bump_columns(analysis, &columns);
  analysis->has_stiffness = has_different_values(columns.radius, columns.count) &&
                            has_different_values(columns.arc_length, columns.count) &&
                            settings->resamples > 1;
  if (!analysis->has_stiffness) goto exit;
  FG_TRY_EXIT(fg_lot_find_spread(ctx, columns.ratio[0], columns.count, settings->bandwidth,
                                 &result->measured));
  FG_TRY_EXIT(spread_by_models(ctx, settings, &columns, result));
  find_mean_bump(settings, &columns, result);
  fg_lot_analyse_budget(analysis, &columns);
  FG_TRY_EXIT(
      fg_lot_find_spread(ctx, columns.foot, columns.count, settings->bandwidth, &result->foot));
  FG_TRY_EXIT(fg_lot_find_spread(ctx, columns.designed, columns.count, settings->bandwidth,
                                 &result->at_design_thickness));
  if (analysis->thickness.foils)
    result->u_by_thickness = fabs(result->sensitivity.thickness) * result->measured.mean *
                             analysis->thickness.mean.u_mm / analysis->thickness.mean.mm;
  result->u_by_calibration = result->measured.mean * fg_lot_stiffness_calibration(analysis);
  FG_TRY_EXIT(resample_stiffness(ctx, settings, &columns, result));
exit:
  free_columns(&columns);
  return status;
}

const char *fg_lot_stiffness_note(const fg_lot_analysis *analysis) {
  return fg_stiffness_kind_note(analysis->lot->settings.design.kind);
}
