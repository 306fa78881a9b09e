/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/driver_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

fg_status fg_driven_tables_create(fg_context *ctx, size_t count, double reach_px,
                                  fg_driven_tables *tables) {
  fg_status status = FG_OK;
  memset(tables, 0, sizeof *tables);
  tables->size = (size_t)fmin(2 * reach_px / FG_DRIVEN_STEP_PX + 1, FG_DRIVEN_MAX);
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *tables->list, (void **)&tables->list));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, tables->size, sizeof *tables->scratch, (void **)&tables->scratch));
  FG_TRY_EXIT(fg_driven_places_create(ctx, 0, true, &tables->places));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count * 2 * tables->size, sizeof *tables->memory,
                                 (void **)&tables->memory));
  for (size_t i = 0; i < count; i++) {
    float *counts = tables->memory + 2 * i * tables->size;
    tables->list[i] = (fg_driven_table){.counts = counts,
                                        .rates = counts + tables->size,
                                        .from_px = -reach_px,
                                        .size = tables->size};
  }
exit:
  if (status != FG_OK) fg_driven_tables_free(tables);
  return status;
}

void fg_driven_tables_free(fg_driven_tables *tables) {
  free(tables->list);
  free(tables->memory);
  free(tables->scratch);
  fg_driven_places_free(&tables->places);
  memset(tables, 0, sizeof *tables);
}

void fg_driven_tables_fill(const fg_driver *driver, const fg_driver_tone *tone,
                           const double *values, bool single, fg_driven_tables *tables,
                           size_t index) {
  fg_driven_table *table = &tables->list[index];
  double *grid = tables->scratch, flat[FG_DRIVEN_VALUES];
  size_t size = table->size;
  double radius = driver->values[FG_DRIVER_AMOUNT] != 0 ? driver->values[FG_DRIVER_RADIUS] : 0;
  fg_driven_places *places = &tables->places;
  fg_driven_places_of_grid(table->from_px, size, single, radius, places);
  fg_driven_places_keep(driver, tone, values, driver->values[FG_DRIVER_HALO] > 0, places, grid);
  for (size_t i = 0; i < size; i++)
    table->counts[i] = (float)grid[i];
  memcpy(flat, values, sizeof flat);
  flat[FG_DRIVEN_SLOPE_L] = flat[FG_DRIVEN_SLOPE_R] = 0;
  fg_driven_places_vary(driver, tone, flat, places, grid);
  for (size_t i = 0; i < size; i++) {
    size_t before = i > 0 ? i - 1 : i, after = i + 1 < size ? i + 1 : i;
    table->rates[i] =
        (float)((grid[after] - grid[before]) / ((double)(after - before) * FG_DRIVEN_STEP_PX));
  }
}

__attribute__((target_clones("avx2", "default"))) static void
interpolate(const float *restrict memory, int32_t size, size_t count, const int32_t *restrict start,
            const float *restrict steps, float *restrict counts, float *restrict rates) {
  for (size_t k = 0; k < count; k++) {
    int32_t whole = (int32_t)steps[k], i = start[k] + whole;
    float f = steps[k] - (float)whole;
    counts[k] = fg_driven_cubic(memory[i - 1], memory[i], memory[i + 1], memory[i + 2], f);
    rates[k] = memory[i + size] + f * (memory[i + size + 1] - memory[i + size]);
  }
}

void fg_driven_tables_at(const fg_driven_tables *tables, size_t count, const int32_t *start,
                         const float *steps, float *counts, float *rates) {
  interpolate(tables->memory, (int32_t)tables->size, count, start, steps, counts, rates);
}
