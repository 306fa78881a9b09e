/* What the lot does to the bearings it will make: stiffness and clearance. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "lot/analysis.h"

/* Radii of design and measurement are those of the datum line; an arch bends about its midline. */
static fg_arch arch_of(const fg_design *design, double radius_mm, double angle_deg) {
  double shift = design->datum == FG_DATUM_INNER ? -0.5 : design->datum == FG_DATUM_OUTER ? 0.5 : 0;
  return (fg_arch){radius_mm + shift * design->thickness_mm, angle_deg, design->thickness_mm};
}

static double stiffness_ratio(const fg_lot_settings *settings, const fg_lot_stiffness *result,
                              double radius_mm, double angle_deg, double *foot) {
  fg_arch_stiffness stiffness;
  fg_context unused;
  fg_arch arch = arch_of(&settings->design, radius_mm, angle_deg);
  if (fg_arch_free(&unused, &arch, &settings->material, &stiffness) != FG_OK) return NAN;
  if (foot) *foot = stiffness.foot_n_mm2 / result->design_free.foot_n_mm2;
  return stiffness.stiffness_n_mm2 / result->design_free.stiffness_n_mm2;
}

static fg_status stiffness_of_design(fg_context *ctx, const fg_lot_settings *settings,
                                     fg_lot_stiffness *result) {
  const fg_design *design = &settings->design;
  fg_arch arch = arch_of(design, design->bump_radius_mm, design->bump_angle_deg);
  FG_TRY(fg_arch_free(ctx, &arch, &settings->material, &result->design_free));
  FG_TRY(fg_arch_welded(ctx, &arch, &settings->material, &result->design_welded));
  return fg_arch_sensitivities(ctx, &arch, &settings->material, &result->sensitivity);
}

/* Bumps of the lot with both radius and angle, as columns. */
typedef struct bump_columns {
  double *radius, *arc_length, *ratio, *foot;
  size_t count;
} bump_columns;

static fg_status allocate_columns(fg_context *ctx, size_t count, bump_columns *columns) {
  double **const all[] = {&columns->radius, &columns->arc_length, &columns->ratio, &columns->foot};
  void *block;
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
    FG_TRY(fg_memory_allocate(ctx, count, sizeof(double), &block));
    *all[i] = block;
  }
  return FG_OK;
}

static void free_columns(bump_columns *columns) {
  free(columns->radius);
  free(columns->arc_length);
  free(columns->ratio);
  free(columns->foot);
}

static void fill_columns(const fg_lot_analysis *analysis, fg_lot_stiffness *result,
                         bump_columns *columns) {
  const fg_lot_settings *settings = &analysis->lot->settings;
  size_t at = 0;
  for (size_t i = 0; i < analysis->foil_count; i++)
    for (size_t k = 0; k < analysis->foils[i].foil->bump_count; k++) {
      const fg_bump *bump = &analysis->foils[i].foil->bumps[k];
      double foot,
          ratio = stiffness_ratio(settings, result, bump->radius_mm, bump->bump_angle_deg, &foot);
      result->normalised[at++] = ratio;
      if (!isfinite(ratio)) continue;
      columns->radius[columns->count] = bump->radius_mm;
      columns->arc_length[columns->count] = bump->radius_mm * bump->bump_angle_deg;
      columns->foot[columns->count] = foot;
      columns->ratio[columns->count++] = ratio;
    }
}

/* Radius and arc length are drawn apart: the first carries the springback, the second what is left
 * of the angle when the first is taken out. */
static fg_status resample(fg_context *ctx, const fg_lot_settings *settings,
                          const bump_columns *columns, fg_lot_stiffness *result) {
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
    ratio[count] = stiffness_ratio(settings, result, r, length / r, NULL);
    count += isfinite(ratio[count]) != 0;
  }
  FG_TRY_EXIT(fg_lot_spread_of(ctx, ratio, count, settings->bandwidth, &result->resampled));
exit:
  free(block);
  fg_density_free(&radius);
  fg_density_free(&arc_length);
  return status;
}

static bool differ(const double *values, size_t count) {
  for (size_t i = 1; i < count; i++)
    if (values[i] != values[0]) return true;
  return false;
}

fg_status fg_lot_analyse_stiffness(fg_context *ctx, fg_lot_analysis *analysis) {
  const fg_lot_settings *settings = &analysis->lot->settings;
  fg_lot_stiffness *result = &analysis->stiffness;
  bump_columns columns = {0};
  void *block;
  size_t most = 0;
  fg_status status = FG_OK;
  for (size_t i = 0; i < analysis->foil_count; i++)
    most += analysis->foils[i].foil->bump_count;
  FG_TRY_EXIT(stiffness_of_design(ctx, settings, result));
  FG_TRY_EXIT(fg_memory_allocate(ctx, most, sizeof(double), &block));
  result->normalised = block;
  FG_TRY_EXIT(allocate_columns(ctx, most, &columns));
  fill_columns(analysis, result, &columns);
  analysis->has_stiffness = differ(columns.radius, columns.count) &&
                            differ(columns.arc_length, columns.count) && settings->resamples > 1;
  if (!analysis->has_stiffness) goto exit;
  FG_TRY_EXIT(
      fg_lot_spread_of(ctx, columns.ratio, columns.count, settings->bandwidth, &result->measured));
  FG_TRY_EXIT(
      fg_lot_spread_of(ctx, columns.foot, columns.count, settings->bandwidth, &result->foot));
  FG_TRY_EXIT(resample(ctx, settings, &columns, result));
exit:
  free_columns(&columns);
  return status;
}

static fg_status add_bearing(fg_context *ctx, fg_lot_analysis *analysis, const char *name,
                             fg_lot_bearing **bearing) {
  FG_TRY(fg_memory_reserve(ctx, analysis->bearing_count + 1, sizeof *analysis->bearings,
                           &analysis->bearing_capacity, (void **)&analysis->bearings));
  *bearing = &analysis->bearings[analysis->bearing_count++];
  **bearing = (fg_lot_bearing){.name = name, .number = analysis->bearing_count};
  return FG_OK;
}

static bool is_measured(const fg_lot_foil *foil) {
  return !(foil->foil->flags & FG_FOIL_NOT_MEASURED);
}

/* Foils in a row, as many as a bearing has pads; what is left over makes none. */
static fg_status assume_bearings(fg_context *ctx, fg_lot_analysis *analysis) {
  size_t pads = analysis->lot->settings.layout.pads, pad = 0;
  const fg_lot_foil *set[FG_BEARING_BUMPS_MAX];
  for (size_t i = 0; i < analysis->foil_count; i++) {
    if (!is_measured(&analysis->foils[i])) continue;
    set[pad++] = &analysis->foils[i];
    if (pad < pads) continue;
    fg_lot_bearing *bearing;
    FG_TRY(add_bearing(ctx, analysis, NULL, &bearing));
    memcpy(bearing->pad, set, pads * sizeof *set);
    pad = 0;
  }
  return FG_OK;
}

static fg_lot_bearing *find_bearing(fg_lot_analysis *analysis, const char *name) {
  for (size_t i = analysis->bearing_count; i-- > 0;)
    if (!strcmp(analysis->bearings[i].name, name)) return &analysis->bearings[i];
  return NULL;
}

/* The pad that the manifest says, else the next free one. */
static size_t pad_of(const fg_lot_bearing *bearing, const char *text, size_t pads) {
  char *end;
  unsigned long pad = strtoul(text, &end, 10);
  if (*text && !*end && pad >= 1 && pad <= pads) return pad - 1;
  size_t next = 0;
  while (next < pads && bearing->pad[next])
    next++;
  return next;
}

static fg_status place_foils(fg_context *ctx, fg_lot_analysis *analysis, size_t column) {
  const fg_manifest *manifest = &analysis->lot->manifest;
  const fg_lot_settings *settings = &analysis->lot->settings;
  size_t pad_column = fg_manifest_column(manifest, settings->pad_column);
  for (size_t i = 0; i < analysis->foil_count; i++) {
    const fg_lot_foil *foil = &analysis->foils[i];
    const char *name = fg_manifest_cell(manifest, foil->item, column);
    if (!*name || !is_measured(foil)) continue;
    fg_lot_bearing *bearing = find_bearing(analysis, name);
    if (!bearing) FG_TRY(add_bearing(ctx, analysis, name, &bearing));
    size_t pad =
        pad_of(bearing, fg_manifest_cell(manifest, foil->item, pad_column), settings->layout.pads);
    if (pad < settings->layout.pads) bearing->pad[pad] = foil;
  }
  return FG_OK;
}

static double clearance_of(const fg_lot_foil *foil, int number) {
  for (size_t i = 0; foil && i < foil->foil->bump_count; i++)
    if (foil->foil->bumps[i].number == number) return foil->foil->bumps[i].clearance_mm;
  return NAN;
}

static void assess(const fg_bearing_layout *layout, fg_lot_bearing *bearing) {
  fg_context unused;
  for (size_t pad = 0; pad < layout->pads; pad++)
    for (size_t bump = 0; bump < layout->bumps_per_pad; bump++) {
      bearing->angle_deg[bearing->places] = fg_bearing_angle_deg(layout, pad, bump);
      bearing->clearance_mm[bearing->places++] =
          clearance_of(bearing->pad[pad], (int)(layout->first_bump + bump));
    }
  bearing->known = fg_bearing_assess(&unused, bearing->angle_deg, bearing->clearance_mm,
                                     bearing->places, &bearing->clearance) == FG_OK;
}

/* Clearances as the thesis's figure 5.13 has them: 100 (C_local - C_D) / C_D. */
static fg_status relative_clearance(fg_context *ctx, fg_lot_analysis *analysis) {
  const fg_lot_quantity *quantity = fg_lot_find_quantity(analysis, "clearance_mm");
  double nominal = analysis->lot->nominal.clearance_mm;
  void *block;
  if (!quantity || !(fabs(nominal) > 0)) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, quantity->count, sizeof(double), &block));
  double *relative = block;
  for (size_t i = 0; i < quantity->count; i++)
    relative[i] = 100 * (quantity->value[i] - nominal) / nominal;
  fg_status status = fg_lot_spread_of(ctx, relative, quantity->count,
                                      analysis->lot->settings.bandwidth, &analysis->clearance_pct);
  free(relative);
  return status;
}

fg_status fg_lot_analyse_bearings(fg_context *ctx, fg_lot_analysis *analysis) {
  const fg_lot_settings *settings = &analysis->lot->settings;
  size_t column = fg_manifest_column(&analysis->lot->manifest, settings->bearing_column);
  if (column == FG_NO_COLUMN)
    FG_TRY(assume_bearings(ctx, analysis));
  else
    FG_TRY(place_foils(ctx, analysis, column));
  for (size_t i = 0; i < analysis->bearing_count; i++)
    assess(&settings->layout, &analysis->bearings[i]);
  return relative_clearance(ctx, analysis);
}
