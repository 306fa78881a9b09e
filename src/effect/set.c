/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "effect/set.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "effect/columns.h"

fg_field fg_effect_found_field(const fg_effect_found *effect) {
  fg_field field = fg_effect_field(effect->kind);
  for (size_t c = 0; c < field.columns; c++) {
    field.amplitude_mm[c] = effect->coefficient_um[c] / 1000;
    field.u_amplitude_mm[c] = effect->u_coefficient_um[c] / 1000;
  }
  for (size_t s = 0; s < field.shapes; s++) {
    field.shape[s] = effect->shape[s];
    field.u_shape[s] = effect->u_shape[s];
  }
  return field;
}

void fg_effect_set_fields(const fg_edge_fit *edge_fit, const fg_effect_set *set,
                          fg_field_list *fields) {
  memset(fields, 0, sizeof *fields);
  fields->frame = edge_fit->frame;
  for (size_t e = 0; e < set->count && fields->count < FG_FIELDS_MAX; e++)
    if (set->effects[e].kind->glass)
      fields->fields[fields->count++] = fg_effect_found_field(&set->effects[e]);
}

bool fg_effect_set_scales(const fg_effect_set *set) {
  for (size_t e = 0; e < set->count; e++)
    if (set->effects[e].kind->scales) return true;
  return false;
}

fg_status fg_effect_set_shift(fg_context *ctx, const fg_edge_fit *edge_fit,
                              const fg_effect_set *set, double **shift_mm) {
  size_t rows = edge_fit->row_count;
  double *columns = NULL;
  *shift_mm = NULL;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof **shift_mm, (void **)shift_mm));
  fg_status status =
      fg_memory_allocate(ctx, rows, FG_EFFECT_COLUMNS_MAX * sizeof *columns, (void **)&columns);
  for (size_t e = 0; e < set->count && status == FG_OK; e++) {
    const fg_effect_found *effect = &set->effects[e];
    if (effect->kind->glass) continue;
    size_t count = fg_effect_columns(edge_fit, effect->kind, effect->shape, columns);
    for (size_t c = 0; c < count; c++)
      for (size_t i = 0; i < rows; i++)
        (*shift_mm)[i] += effect->coefficient_um[c] / 1000 * columns[c * rows + i];
  }
  free(columns);
  if (status != FG_OK) {
    free(*shift_mm);
    *shift_mm = NULL;
  }
  return status;
}
