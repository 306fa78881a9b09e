/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Residuals of a model that many profiles share. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "vision/driver_choice.h"

#define CELL_PX     0.5
#define REACH_BLURS 4.0
#define REACH_PX    2.0
enum { CELLS = 64, HALVES_MAX = 2 * FG_DRIVER_PROFILES };

/* Mean residuals by distance outwards from the edge, of each half profile. */
typedef struct cells {
  double sum[CELLS], weight[CELLS];
} cells;

static void add_half(const fg_driven_profile *p, const double *counts, int side, cells *c) {
  double blur = p->values[FG_DRIVEN_BLUR_L + side], reach = REACH_BLURS * blur + REACH_PX;
  double edge = p->values[FG_DRIVEN_LEFT + side], other = p->values[FG_DRIVEN_LEFT + !side];
  double inner = p->single ? reach : fmin(reach, 0.5 * fabs(edge - other));
  memset(c, 0, sizeof *c);
  for (size_t i = 0; i < p->count; i++) {
    double d = (side ? 1 : -1) * (p->bins[i].across_px - edge);
    if (d < -inner || d > reach) continue;
    int cell = CELLS / 2 + (int)floor(d / CELL_PX);
    if (cell < 0 || cell >= CELLS) continue;
    c->sum[cell] += p->bins[i].count * (p->bins[i].value - counts[i]);
    c->weight[cell] += p->bins[i].count;
  }
}

/* Pools the mean and its standard error over the half profiles: medians, since some carry dust. */
static bool pool_cell(const cells *halves, size_t count, int cell, double *mean, double *error) {
  double values[HALVES_MAX];
  size_t n = 0;
  for (size_t i = 0; i < count; i++)
    if (halves[i].weight[cell] > 0) values[n++] = halves[i].sum[cell] / halves[i].weight[cell];
  if (2 * n < count || n < 4) return false;
  *mean = fg_select(values, n, n / 2);
  for (size_t i = 0; i < n; i++)
    values[i] = fabs(values[i] - *mean);
  *error = 1.4826 * fg_select(values, n, n / 2) * 1.2533 / sqrt((double)n);
  return true;
}

fg_status fg_driver_scratch_create(fg_context *ctx, fg_driver_scratch **scratch) {
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof **scratch, (void **)scratch));
  return fg_driven_places_create(ctx, FG_DRIVEN_MAX, true, &(*scratch)->places);
}

void fg_driver_scratch_free(fg_driver_scratch *scratch) {
  if (!scratch) return;
  fg_driven_places_free(&scratch->places);
  free(scratch);
}

void fg_driver_find_misfit(const fg_driven_profile *profiles, size_t count, const fg_driver *driver,
                           fg_driver_scratch *scratch, fg_driver_misfit *misfit) {
  cells halves[HALVES_MAX];
  double counts[FG_DRIVEN_MAX];
  size_t n = 0;
  *misfit = (fg_driver_misfit){0};
  bool masked = driver->values[FG_DRIVER_AMOUNT] != 0, lossy = driver->values[FG_DRIVER_HALO] > 0;
  fg_driver_tone_fill(driver, &scratch->tone);
  for (size_t i = 0; i < count && n + 2 <= HALVES_MAX; i++) {
    fg_driven_places_of_bins(&profiles[i], masked, driver->values[FG_DRIVER_RADIUS],
                             &scratch->places);
    fg_driven_places_keep(driver, &scratch->tone, profiles[i].values, lossy, &scratch->places,
                          counts);
    for (int side = profiles[i].single; side < 2; side++)
      add_half(&profiles[i], counts, side, &halves[n++]);
  }
  for (int cell = 0; cell < CELLS; cell++) {
    double mean, error;
    if (!pool_cell(halves, n, cell, &mean, &error)) continue;
    misfit->squares += mean * mean;
    misfit->expected += error * error;
    misfit->cells++;
  }
  misfit->rms =
      misfit->cells ? sqrt(fmax(misfit->squares - misfit->expected, 0) / misfit->cells) : NAN;
}
