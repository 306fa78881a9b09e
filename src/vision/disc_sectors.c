/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sectors of an edge: mean profiles and a step fitted to each. */
#include "vision/disc_work.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

static double *value_of(fg_step_fit *fit, int i) {
  return &fit->values[i];
}

/* Mean of the profile on one side's outer half, in counts. */
static double side_level(const fg_disc_work *work, const fg_profile_bin *bins, int side) {
  double sum = 0, n = 0, half = 0.5 * work->ring.reach_px;
  for (size_t i = 0; i < work->bin_count; i++) {
    if (bins[i].count <= 0 || (side ? bins[i].across_px < half : bins[i].across_px > -half))
      continue;
    sum += bins[i].value * bins[i].count;
    n += bins[i].count;
  }
  return n > 0 ? sum / n : NAN;
}

/* Finds the crossing of the middle of the profile's two levels nearest to the circle. */
static double find_crossing(const fg_disc_work *work, const fg_profile_bin *bins, double inside,
                            double outside) {
  double middle = 0.5 * (inside + outside), sign = outside > inside ? 1 : -1, best = NAN;
  const fg_profile_bin *last = NULL;
  for (size_t i = 0; i < work->bin_count; i++) {
    if (bins[i].count <= 0) continue;
    if (last && sign * (last->value - middle) < 0 && sign * (bins[i].value - middle) >= 0) {
      double at = 0.5 * (last->across_px + bins[i].across_px);
      if (!(fabs(best) <= fabs(at))) best = at;
    }
    last = &bins[i];
  }
  return best;
}

static void start_sector(const fg_disc_work *work, size_t s, unsigned held, fg_step_fit *fit) {
  const fg_profile_bin *bins = work->bins + s * work->bin_count;
  double level[2] = {side_level(work, bins, 0), side_level(work, bins, 1)};
  memset(fit, 0, sizeof *fit);
  fit->held = held;
  fit->values[FG_STEP_EDGE] = find_crossing(work, bins, level[0], level[1]);
  for (int side = 0; side < 2; side++) {
    *value_of(fit, FG_STEP_INSIDE + side) = fg_edge_light(work->gamma, level[side]);
    if (!work->white[side]) continue;
    *value_of(fit, FG_STEP_INSIDE + side) = 255;
    fit->held |= 1u << (FG_STEP_INSIDE + side) | 1u << (FG_STEP_SLOPE_IN + side);
  }
  fit->values[FG_STEP_BLUR] = work->blur_px > 0 ? work->blur_px : 1.2;
  if (work->blur_px > 0) fit->held |= 1u << FG_STEP_BLUR;
  fit->values[FG_STEP_GAMMA] = work->gamma;
}

/* Sets white[]: a side is white when it is so in half of the sectors. */
static void find_white(fg_disc_work *work) {
  size_t count = work->ring.sector_count;
  for (int side = 0; side < 2; side++) {
    size_t white = 0;
    for (size_t s = 0; s < count; s++)
      white += side_level(work, work->bins + s * work->bin_count, side) >= FG_COUNT_WHITE;
    work->white[side] = 2 * white > count;
  }
}

void fg_disc_fit_sectors(const fg_disc_work *work, unsigned held) {
  for (size_t s = 0; s < work->ring.sector_count; s++) {
    fg_step_fit *fit = &work->sectors[s];
    start_sector(work, s, held, fit);
    if (isnan(fit->values[FG_STEP_EDGE])) continue;
    fg_step_fit_model(work->bins + s * work->bin_count, work->bin_count, fit);
    fit->good = fit->good && fabs(fit->values[FG_STEP_EDGE]) < work->ring.reach_px;
  }
}

fg_status fg_disc_stack_sectors(fg_context *ctx, fg_disc_work *work) {
  const fg_ring *ring = &work->ring;
  free(work->bins);
  free(work->sectors);
  work->bins = NULL;
  work->sectors = NULL;
  work->bin_count = fg_ring_bin_count(ring->reach_px);
  FG_TRY(fg_memory_allocate(ctx, ring->sector_count * work->bin_count, sizeof *work->bins,
                            (void **)&work->bins));
  FG_TRY(
      fg_memory_allocate(ctx, ring->sector_count, sizeof *work->sectors, (void **)&work->sectors));
  fg_ring_stack(ring, work->bins, work->bin_count);
  find_white(work);
  return FG_OK;
}
