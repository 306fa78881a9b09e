#include "lot/characteristics.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"

/* Ratios and percentages follow from these; quality systems know lengths and angles. */
static const struct {
  const char *name, *kind;
} exported[] = {
    {"radius_mm", "Radius"},    {"bump_angle_deg", "Angle"},     {"height_mm", "Height"},
    {"clearance_mm", "Length"}, {"overall.radius_mm", "Radius"}, {"thickness_mm", "Thickness"},
};

enum { EXPORTED = sizeof exported / sizeof exported[0] };

static double nominal_of(const fg_lot *lot, size_t row) {
  const fg_design *design = &lot->settings.design;
  const double nominals[EXPORTED] = {design->bump_radius_mm,    design->bump_angle_deg,
                                     lot->nominal.height_mm,    lot->nominal.clearance_mm,
                                     design->overall_radius_mm, design->thickness_mm};
  return nominals[row];
}

fg_status fg_characteristics_list(fg_context *ctx, const fg_lot_analysis *analysis,
                                  fg_characteristic **list, size_t *count) {
  size_t most = 0;
  void *block;
  for (size_t i = 0; i < analysis->quantity_count; i++)
    most += analysis->quantities[i].places + 1;
  FG_TRY(fg_memory_allocate(ctx, most, sizeof **list, &block));
  *list = block;
  *count = 0;
  for (size_t i = 0; i < EXPORTED; i++) {
    const fg_lot_quantity *quantity = fg_lot_find_quantity(analysis, exported[i].name);
    if (!quantity || !quantity->count) continue;
    bool of_bumps = quantity->owner == FG_REPORT_BUMP;
    for (size_t bump = of_bumps; bump <= (of_bumps ? quantity->places : 0); bump++)
      (*list)[(*count)++] =
          (fg_characteristic){quantity, (int)bump, nominal_of(analysis->lot, i), exported[i].kind};
  }
  return FG_OK;
}

double fg_characteristic_value(const fg_characteristic *characteristic, const fg_foil *foil,
                               double *u) {
  const fg_report_field *field = characteristic->quantity->field;
  const void *object = characteristic->bump ? NULL : foil;
  for (size_t i = 0; characteristic->bump && i < foil->bump_count; i++)
    if (foil->bumps[i].number == characteristic->bump) object = &foil->bumps[i];
  *u = NAN;
  if (!object || !fg_foil_is_measured(foil)) return NAN;
  *u = fg_report_uncertainty(field, object);
  return fg_report_value(field, object);
}
