/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tone curve, from the asymmetry of round edges. */
#include "vision/disc_edge.h"

#include <stdlib.h>

#include "core/memory.h"
#include "core/select.h"

/* Limits of an accepted gamma: so many of its own deviations from 1, and a scanner's range. Values
 * beyond come from a wall or a halo beside the edge. */
#define GAMMA_DEVIATIONS 4.0
#define GAMMA_MIN_CHANGE 0.003
static const double range_of_gamma[2] = {0.4, 2.8};
/* Uncertainty of gamma = 1 beside a halo or a wall, which hide the tone curve. */
#define GAMMA_U 0.4
/* Max scatter of sectors that show a tone curve, in their own deviations. */
#define SECTOR_SCATTER 3.0
enum { SECTORS_MIN = 6 };

/* Returns the median of the sectors' gammas; reorders both arrays. */
static fg_tone pool_gammas(double *values, double *sd, size_t n) {
  fg_tone none = {.gamma = 1, .uncertainty = INFINITY};
  if (n < SECTORS_MIN) return none;
  double upper = fg_select(values, n, n * 3 / 4), lower = fg_select(values, n, n / 4);
  double scatter = 0.7413 * (upper - lower), own = fg_select(sd, n, n / 2);
  if (scatter > SECTOR_SCATTER * own + 0.01) return none;
  return (fg_tone){.gamma = fg_select(values, n, n / 2),
                   .uncertainty = 1.2533 * fmax(scatter, own) / sqrt((double)n)};
}

/* Fits all sectors with gamma free, their slopes free or held at 0. */
static void fit_sectors(fg_disc_work *work, bool slopes) {
  for (size_t s = 0; s < work->ring.sector_count; s++) {
    fg_step_fit *fit = &work->sectors[s];
    if (!fit->good) continue;
    fit->held &= ~(1u << FG_STEP_GAMMA);
    for (int i = FG_STEP_SLOPE_IN; i <= FG_STEP_SLOPE_OUT; i++) {
      fit->held = slopes ? fit->held & ~(1u << i) : fit->held | 1u << i;
      if (!slopes) fit->values[i] = 0;
    }
    fg_step_fit_model(work->bins + s * work->bin_count, work->bin_count, fit);
  }
}

fg_status fg_disc_find_tone(fg_context *ctx, fg_disc_work *work, fg_tone *tone) {
  size_t count = work->ring.sector_count, n = 0;
  double *values;
  *tone = (fg_tone){.gamma = 1, .uncertainty = INFINITY};
  if (work->white[0] || work->white[1]) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, count, 2 * sizeof *values, (void **)&values));
  /* A tone curve that is not in the model looks like slopes, so both are fitted at once. */
  fit_sectors(work, true);
  bool slopes =
      fg_disc_has_slope(work, FG_STEP_SLOPE_IN) || fg_disc_has_slope(work, FG_STEP_SLOPE_OUT);
  if (!slopes) fit_sectors(work, false);
  for (size_t s = 0; s < count; s++) {
    const fg_step_fit *fit = &work->sectors[s];
    if (!fit->good) continue;
    values[n] = fit->values[FG_STEP_GAMMA];
    values[count + n++] = fit->sd[FG_STEP_GAMMA];
  }
  *tone = pool_gammas(values, values + count, n);
  tone->slopes = slopes;
  free(values);
  return FG_OK;
}

fg_tone fg_tone_linear(void) {
  return (fg_tone){.gamma = 1, .linear = true};
}

fg_tone fg_tone_pool(const fg_tone *tones, size_t count) {
  return fg_tone_pool_within(tones, count, range_of_gamma);
}

fg_tone fg_tone_pool_within(const fg_tone *tones, size_t count, const double range[2]) {
  double sum = 0, weights = 0, squares = 0, slopes = 0, n = 0;
  for (size_t i = 0; i < count; i++) {
    if (!(tones[i].uncertainty > 0) || !isfinite(tones[i].uncertainty)) continue;
    double weight = 1 / (tones[i].uncertainty * tones[i].uncertainty);
    sum += weight * tones[i].gamma;
    squares += weight * tones[i].gamma * tones[i].gamma;
    weights += weight;
    slopes += tones[i].slopes;
    n++;
  }
  if (n < 1) return (fg_tone){.gamma = 1};
  double gamma = sum / weights, spread = fmax(0, squares - sum * gamma);
  double uncertainty = sqrt((n > 1 ? fmax(1, spread / (n - 1)) : 1) / weights);
  if (2 * slopes > n || gamma < range[0] || gamma > range[1])
    return (fg_tone){.gamma = 1, .uncertainty = GAMMA_U};
  if (fabs(gamma - 1) < fmax(GAMMA_DEVIATIONS * uncertainty, GAMMA_MIN_CHANGE))
    return (fg_tone){.gamma = 1, .found = gamma, .u_found = uncertainty};
  return (fg_tone){
      .gamma = gamma, .uncertainty = uncertainty, .found = gamma, .u_found = uncertainty};
}
