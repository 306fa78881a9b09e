#include "lot/characteristics.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"

fg_status fg_characteristics_list(fg_context *ctx, const fg_lot_analysis *analysis,
                                  fg_characteristic **list, size_t *count) {
  size_t most = 0;
  void *block;
  for (size_t i = 0; i < analysis->quantity_count; i++)
    most += analysis->quantities[i].places + 1;
  FG_TRY(fg_memory_allocate(ctx, most, sizeof **list, &block));
  *list = block;
  *count = 0;
  for (size_t i = 0; i < analysis->quantity_count; i++) {
    const fg_lot_quantity *quantity = &analysis->quantities[i];
    const fg_quantity *row = quantity->row;
    if (!row->characteristic || !quantity->count) continue;
    double nominal = row->nominal(&analysis->lot->settings.design, &analysis->lot->nominal);
    bool of_parts = fg_owner_is_part(quantity->owner);
    for (size_t number = of_parts; number <= (of_parts ? quantity->places : 0); number++)
      (*list)[(*count)++] =
          (fg_characteristic){quantity, (int)number, nominal, row->characteristic};
  }
  return FG_OK;
}

double fg_characteristic_value(const fg_characteristic *characteristic, const fg_foil *foil,
                               double *u) {
  const fg_quantity *row = characteristic->quantity->row;
  const fg_quantity_owner owner = characteristic->quantity->owner;
  const void *object = characteristic->number ? NULL : foil;
  for (size_t i = 0; characteristic->number && i < fg_part_count(foil, owner); i++) {
    const fg_foil_part part = fg_part_at(foil, owner, i);
    if (part.number == characteristic->number) object = part.object;
  }
  *u = NAN;
  if (!object || !fg_foil_is_measured(foil)) return NAN;
  *u = fg_quantity_uncertainty(row, object);
  return fg_quantity_value(row, object);
}
