/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "report/lot/characteristics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "quantity/quantity_rows.h"

static bool has_named_bearings(const fg_lot_analysis *analysis) {
  return analysis->bearing_count && analysis->bearings[0].name;
}

static const fg_tolerance *find_part_tolerance(const fg_design *design, const fg_quantity *row) {
  for (size_t i = 0; i < design->tolerance_count; i++)
    if (fg_quantity_of_bearing_for(design->tolerances[i].quantity) == row)
      return &design->tolerances[i];
  return NULL;
}

static void list_foil_characteristics(const fg_lot_analysis *analysis, fg_characteristic *list,
                                      size_t *count) {
  for (size_t i = 0; i < analysis->quantity_count; i++) {
    const fg_lot_quantity *quantity = &analysis->quantities[i];
    const fg_quantity *row = quantity->row;
    if (!row->characteristic || !quantity->count) continue;
    double nominal = row->nominal(&analysis->lot->settings.design, &analysis->lot->nominal);
    bool of_parts = fg_owner_is_part(quantity->owner);
    for (size_t number = of_parts; number <= (of_parts ? quantity->places : 0); number++)
      list[(*count)++] =
          (fg_characteristic){row, quantity->owner, quantity->tolerance, (int)number, nominal};
  }
}

static void list_bearing_characteristics(const fg_lot_analysis *analysis, fg_characteristic *list,
                                         size_t *count) {
  const fg_design *design = &analysis->lot->settings.design;
  size_t rows;
  const fg_quantity *row = fg_quantities(FG_QUANTITY_OF_BEARING, &rows);
  for (size_t i = 0; i < rows; i++)
    if (row[i].characteristic)
      list[(*count)++] =
          (fg_characteristic){&row[i], FG_QUANTITY_OF_BEARING, find_part_tolerance(design, &row[i]),
                              0, row[i].nominal(design, &analysis->lot->nominal)};
}

fg_status fg_characteristics_list(fg_context *ctx, const fg_lot_analysis *analysis,
                                  fg_characteristic **list, size_t *count) {
  size_t max;
  void *block;
  fg_quantities(FG_QUANTITY_OF_BEARING, &max);
  for (size_t i = 0; i < analysis->quantity_count; i++)
    max += analysis->quantities[i].places + 1;
  FG_TRY(fg_memory_allocate(ctx, max, sizeof **list, &block));
  *list = block;
  *count = 0;
  list_foil_characteristics(analysis, *list, count);
  if (*count && has_named_bearings(analysis)) list_bearing_characteristics(analysis, *list, count);
  return FG_OK;
}

static void list_built(const fg_lot_analysis *analysis, fg_measured_part *parts, size_t *count,
                       bool *built) {
  for (size_t i = 0; i < analysis->bearing_count; i++) {
    const fg_lot_bearing *bearing = &analysis->bearings[i];
    parts[(*count)++] = (fg_measured_part){.bearing = bearing};
    for (size_t pad = 0; pad < analysis->layout.pads; pad++) {
      if (!bearing->pad[pad]) continue;
      parts[(*count)++] = (fg_measured_part){bearing->pad[pad], bearing, pad};
      built[bearing->pad[pad] - analysis->foils] = true;
    }
  }
}

fg_status fg_measured_parts_list(fg_context *ctx, const fg_lot_analysis *analysis,
                                 fg_measured_part **parts, size_t *count) {
  void *block;
  FG_TRY(fg_memory_allocate(ctx, analysis->foil_count + analysis->bearing_count, sizeof **parts,
                            &block));
  *parts = block;
  *count = 0;
  fg_status status = fg_memory_allocate(ctx, analysis->foil_count, sizeof(bool), &block);
  if (status != FG_OK) {
    free(*parts);
    *parts = NULL;
    return status;
  }
  bool *built = block;
  if (has_named_bearings(analysis)) list_built(analysis, *parts, count, built);
  for (size_t i = 0; i < analysis->foil_count; i++)
    if (!built[i]) (*parts)[(*count)++] = (fg_measured_part){.foil = &analysis->foils[i]};
  free(built);
  return FG_OK;
}

/* Returns the object of the part that the characteristic describes; NULL: none, or none that was
 * measured. */
static const void *find_measured_object(const fg_characteristic *one,
                                        const fg_measured_part *part) {
  if (one->owner == FG_QUANTITY_OF_BEARING)
    return !part->foil && part->bearing->known ? &part->bearing->clearance : NULL;
  if (!part->foil || !fg_foil_is_measured(part->foil->foil)) return NULL;
  const fg_foil *foil = part->foil->foil;
  if (!one->number) return foil;
  for (size_t i = 0; i < fg_part_count(foil, one->owner); i++) {
    const fg_foil_part found = fg_part_at(foil, one->owner, i);
    if (found.number == one->number) return found.object;
  }
  return NULL;
}

double fg_characteristic_value(const fg_characteristic *characteristic,
                               const fg_measured_part *part, double *u) {
  const void *object = find_measured_object(characteristic, part);
  *u = object ? fg_quantity_uncertainty(characteristic->row, object) : NAN;
  return object ? fg_quantity_value(characteristic->row, object) : NAN;
}
