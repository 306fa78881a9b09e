/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pixels of a round edge's stations under a driver's model: profiles as tables, of a few
 * stations each, see edges_driven.c. */
#include <math.h>

#include "vision/disc_work.h"

enum { BLOCK_STATIONS = 8, REACH_BLURS = 4 };

static void mean_values(const fg_disc_work *work, const fg_disc_station *stations, size_t count,
                        double *values) {
  double x[FG_STEP_VALUES] = {0};
  for (size_t i = 0; i < count; i++)
    for (int k = FG_STEP_INSIDE; k <= FG_STEP_BLUR; k++)
      x[k] += (double)stations[i].shape[k] / (double)count;
  fg_disc_driven_values(work, x, values);
}

fg_status fg_disc_fill_tables(fg_context *ctx, const fg_disc_work *work, const fg_disc_edge *edge,
                              fg_driven_tables *tables) {
  double values[FG_DRIVEN_VALUES];
  size_t blocks = (edge->count + BLOCK_STATIONS - 1) / BLOCK_STATIONS;
  FG_TRY(fg_driven_tables_create(ctx, blocks, work->ring.reach_px + 3, tables));
  for (size_t b = 0; b < blocks; b++) {
    size_t first = b * BLOCK_STATIONS, count = edge->count - first;
    if (count > BLOCK_STATIONS) count = BLOCK_STATIONS;
    mean_values(work, edge->stations + first, count, values);
    fg_driven_tables_fill(work->driver, work->driver_tone, values, true, tables, b);
  }
  return FG_OK;
}

bool fg_disc_driven_at(const fg_disc_work *work, const fg_driven_tables *tables, size_t station,
                       const fg_disc_station *s, float d, float *model, float *by_edge) {
  float reach = s->shape[FG_STEP_BLUR];
  if (work->driver->values[FG_DRIVER_AMOUNT] != 0)
    reach = hypotf(reach, (float)work->driver->values[FG_DRIVER_RADIUS]);
  if (fabsf(d) > REACH_BLURS * reach) return false;
  float rate;
  if (!fg_driven_table_at(&tables->list[station / BLOCK_STATIONS], d, model, &rate)) return false;
  *by_edge = -rate;
  return true;
}
