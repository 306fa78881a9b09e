/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Profiles under a driver's model as tables, for the inner loops over pixels. */
#ifndef FG_VISION_DRIVER_TABLE_H
#define FG_VISION_DRIVER_TABLE_H

#include <stdint.h>

#include "vision/driver_places.h"

/* One profile about 0, and its rise there without slopes, which are the least certain part of an
 * edge's shape. */
typedef struct fg_driven_table {
  float *counts, *rates;
  double from_px;
  size_t size;
} fg_driven_table;

typedef struct fg_driven_tables {
  fg_driven_table *list;
  float *memory;
  double *scratch;
  fg_driven_places places;
  size_t size; /* of one table */
} fg_driven_tables;

/* Allocates tables from -reach_px to reach_px; fg_driven_tables_free them. */
fg_status fg_driven_tables_create(fg_context *ctx, size_t count, double reach_px,
                                  fg_driven_tables *tables);
void fg_driven_tables_free(fg_driven_tables *tables);

/* `values` and `single` as of fg_driven_profile. */
void fg_driven_tables_fill(const fg_driver *driver, const fg_driver_tone *tone,
                           const double *values, bool single, fg_driven_tables *tables,
                           size_t index);

/* Steps from the start of a table to a place; the table holds those that have counts around them.
 */
static inline float fg_driven_table_steps(const fg_driven_table *table, float across_px) {
  return (across_px - (float)table->from_px) / (float)FG_DRIVEN_STEP_PX;
}

static inline bool fg_driven_table_holds(const fg_driven_table *table, float steps) {
  return steps >= 1 && steps < (float)(table->size - 3);
}

/* Cubic through four neighbouring counts, `f` of a step behind the second. */
static inline float fg_driven_cubic(float a, float b, float c, float d, float f) {
  return a * (-f * (f - 1) * (f - 2) / 6) + b * ((f + 1) * (f - 1) * (f - 2) / 2) +
         c * (-(f + 1) * f * (f - 2) / 2) + d * ((f + 1) * f * (f - 1) / 6);
}

/* Index of a table's counts in the memory of all. */
static inline int32_t fg_driven_tables_start(const fg_driven_tables *tables, size_t index) {
  return (int32_t)(tables->list[index].counts - tables->memory);
}

/* Counts and rates at many places within tables: each by the start of its table and its steps. */
void fg_driven_tables_at(const fg_driven_tables *tables, size_t count, const int32_t *start,
                         const float *steps, float *counts, float *rates);

/* Counts at a place and their change per px; false beyond the table. */
static inline bool fg_driven_table_at(const fg_driven_table *table, float across_px, float *count,
                                      float *rate) {
  float at = fg_driven_table_steps(table, across_px);
  if (!fg_driven_table_holds(table, at)) return false;
  size_t i = (size_t)at;
  float f = at - (float)i;
  const float *grid = table->counts + i;
  *count = fg_driven_cubic(grid[-1], grid[0], grid[1], grid[2], f);
  *rate = table->rates[i] + f * (table->rates[i + 1] - table->rates[i]);
  return true;
}

#endif
