/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Driver model of a round edge: sought only where one step without it does not explain the sectors'
 * mean profiles, see driver_choice.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "vision/disc_work.h"
#include "vision/driver_choice.h"

/* First estimate of a pixel's sd, counts. */
#define START_NOISE 1.5
#define SECTORS_MIN 6

static double driven_count(const fg_disc_work *work, double light) {
  double rate;
  return work->driver ? fg_driver_tone_at(work->driver_tone, light, &rate)
                      : fg_edge_count(work->gamma, light);
}

static double light_of(const fg_disc_work *work, double count) {
  return work->driver ? fg_driver_tone_inverse(work->driver_tone, count)
                      : fg_edge_light(work->gamma, count);
}

/* Factor from a slope in light to a driven profile's, which is over the contrast. */
static double contrast_ratio(const double *x, double counts) {
  double light = x[FG_STEP_OUTSIDE] - x[FG_STEP_INSIDE];
  return light != 0 && counts != 0 ? counts / light : 1;
}

void fg_disc_driven_values(const fg_disc_work *work, const double *x, double *values) {
  double inside = driven_count(work, x[FG_STEP_INSIDE]),
         outside = driven_count(work, x[FG_STEP_OUTSIDE]);
  double ratio = contrast_ratio(x, outside - inside);
  values[FG_DRIVEN_LEFT] = values[FG_DRIVEN_RIGHT] = x[FG_STEP_EDGE];
  values[FG_DRIVEN_PLATEAU] = inside;
  values[FG_DRIVEN_LEVEL_L] = values[FG_DRIVEN_LEVEL_R] = outside;
  values[FG_DRIVEN_SLOPE_L] = x[FG_STEP_SLOPE_IN] * ratio;
  values[FG_DRIVEN_SLOPE_R] = x[FG_STEP_SLOPE_OUT] * ratio;
  values[FG_DRIVEN_BLUR_L] = values[FG_DRIVEN_BLUR_R] = x[FG_STEP_BLUR];
}

/* Held values for one edge alone: the profile has no left edge. */
static unsigned held_of(unsigned held) {
  unsigned driven = 1u << FG_DRIVEN_LEFT | 1u << FG_DRIVEN_LEVEL_L | 1u << FG_DRIVEN_BLUR_L;
  if (held >> FG_STEP_SLOPE_IN & 1) driven |= 1u << FG_DRIVEN_SLOPE_L;
  if (held >> FG_STEP_SLOPE_OUT & 1) driven |= 1u << FG_DRIVEN_SLOPE_R;
  return driven;
}

static fg_driven_profile profile_of(const fg_disc_work *work, size_t sector, fg_profile_bin *bins) {
  const fg_profile_bin *from = work->bins + sector * work->bin_count;
  fg_driven_profile p = {.bins = bins, .single = true, .held = held_of(work->sectors[sector].held)};
  for (size_t i = 0; i < work->bin_count && p.count + 8 < FG_DRIVEN_MAX; i++)
    if (from[i].count > 0) bins[p.count++] = from[i];
  fg_disc_driven_values(work, work->sectors[sector].values, p.values);
  return p;
}

/* Converts a sector's fit with the driver held to light. */
static void convert_profile(const fg_disc_work *work, const fg_driven_profile *p,
                            fg_step_fit *fit) {
  static const int from[] = {FG_DRIVEN_RIGHT,   FG_DRIVEN_PLATEAU, FG_DRIVEN_LEVEL_R,
                             FG_DRIVEN_SLOPE_L, FG_DRIVEN_SLOPE_R, FG_DRIVEN_BLUR_R};
  double *x = fit->values, rate[2];
  x[FG_STEP_EDGE] = p->values[FG_DRIVEN_RIGHT];
  x[FG_STEP_INSIDE] = light_of(work, p->values[FG_DRIVEN_PLATEAU]);
  x[FG_STEP_OUTSIDE] = light_of(work, p->values[FG_DRIVEN_LEVEL_R]);
  double counts = p->values[FG_DRIVEN_LEVEL_R] - p->values[FG_DRIVEN_PLATEAU];
  double ratio = contrast_ratio(x, counts);
  x[FG_STEP_SLOPE_IN] = p->values[FG_DRIVEN_SLOPE_L] / ratio;
  x[FG_STEP_SLOPE_OUT] = p->values[FG_DRIVEN_SLOPE_R] / ratio;
  x[FG_STEP_BLUR] = p->values[FG_DRIVEN_BLUR_R];
  for (int i = FG_STEP_EDGE; i <= FG_STEP_BLUR; i++)
    fit->sd[i] = p->sd[from[i]];
  for (int side = 0; side < 2; side++) {
    fg_driver_tone_at(work->driver_tone, x[FG_STEP_INSIDE + side], &rate[side]);
    fit->sd[FG_STEP_INSIDE + side] /= fmax(rate[side], 1e-3);
    fit->sd[FG_STEP_SLOPE_IN + side] /= fabs(ratio);
  }
}

/* Fits all sectors again with the driver held. */
static fg_status fit_driven(fg_context *ctx, fg_disc_work *work) {
  fg_profile_bin bins[FG_DRIVEN_MAX];
  for (size_t s = 0; s < work->ring.sector_count; s++) {
    fg_step_fit *fit = &work->sectors[s];
    if (!fit->good) continue;
    fg_driver_fit driven = {
        .driver = *work->driver, .noise = START_NOISE, .tone = work->driver_tone};
    fg_driven_profile p = profile_of(work, s, bins);
    FG_TRY(fg_driver_fit_profiles(ctx, &p, 1, &driven));
    fit->good = driven.good && fabs(p.values[FG_DRIVEN_RIGHT]) < work->ring.reach_px;
    if (fit->good) convert_profile(work, &p, fit);
  }
  return FG_OK;
}

/* Sectors of the driver's fit, and their bins. */
typedef struct sample {
  fg_driven_profile profiles[FG_DRIVER_PROFILES];
  fg_profile_bin *bins;
  size_t count;
  double ends[2];
} sample;

static fg_status draw_sample(fg_context *ctx, const fg_disc_work *work, sample *s) {
  size_t good = 0, seen = 0;
  FG_TRY(fg_memory_allocate(ctx, FG_DRIVER_PROFILES * work->bin_count, sizeof *s->bins,
                            (void **)&s->bins));
  s->ends[0] = INFINITY;
  s->ends[1] = -INFINITY;
  for (size_t i = 0; i < work->ring.sector_count; i++)
    good += work->sectors[i].good;
  for (size_t i = 0; i < work->ring.sector_count && s->count < FG_DRIVER_PROFILES; i++) {
    if (!work->sectors[i].good || seen++ * FG_DRIVER_PROFILES < s->count * good) continue;
    fg_driven_profile *p = &s->profiles[s->count];
    *p = profile_of(work, i, s->bins + s->count++ * work->bin_count);
    for (int side = 0; side < 2; side++) {
      double level = p->values[side ? FG_DRIVEN_LEVEL_R : FG_DRIVEN_PLATEAU];
      s->ends[0] = fmin(s->ends[0], level);
      s->ends[1] = fmax(s->ends[1], level);
    }
  }
  return FG_OK;
}

static fg_status adopt_driver(fg_context *ctx, fg_disc_work *work, const fg_found_driver *found) {
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *work->driver_tone, (void **)&work->driver_tone));
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *work->driver, (void **)&work->driver));
  *work->driver = found->driver;
  work->gamma = exp(found->driver.values[FG_DRIVER_LN_GAMMA]);
  work->u_driver_px = found->u_edge_px;
  work->unexplained = found->unexplained;
  fg_driver_tone_fill(work->driver, work->driver_tone);
  return FG_OK;
}

/* Converts the sectors' fits to light of the new tone curve, as a start. */
static void convert_sectors(fg_disc_work *work, double gamma) {
  for (size_t s = 0; s < work->ring.sector_count; s++) {
    double *x = work->sectors[s].values, counts[2];
    double before = x[FG_STEP_OUTSIDE] - x[FG_STEP_INSIDE];
    for (int side = 0; side < 2; side++) {
      counts[side] = fg_edge_count(gamma, x[FG_STEP_INSIDE + side]);
      x[FG_STEP_INSIDE + side] = light_of(work, counts[side]);
    }
    double ratio = before != 0 ? (x[FG_STEP_OUTSIDE] - x[FG_STEP_INSIDE]) / before : 1;
    x[FG_STEP_SLOPE_IN] *= ratio;
    x[FG_STEP_SLOPE_OUT] *= ratio;
  }
}

fg_found_driver fg_disc_found_driver(const fg_disc_work *work) {
  if (!work->driver) return (fg_found_driver){.found = false};
  return (fg_found_driver){true, *work->driver, work->u_driver_px, work->unexplained};
}

fg_status fg_disc_use_driver(fg_context *ctx, fg_disc_work *work, const fg_found_driver *found) {
  double gamma = work->gamma;
  if (!found->found || work->white[0] || work->white[1]) return FG_OK;
  FG_TRY(adopt_driver(ctx, work, found));
  convert_sectors(work, gamma);
  return fit_driven(ctx, work);
}

fg_status fg_disc_find_driver(fg_context *ctx, fg_disc_work *work) {
  sample s = {.count = 0};
  fg_driver_scratch *scratch = NULL;
  fg_driver_misfit misfit;
  fg_driver_choice choice = {.threads = 1, .linear = work->linear};
  double gamma = work->gamma;
  fg_status status = FG_OK;
  if (work->white[0] || work->white[1]) return FG_OK;
  FG_TRY_EXIT(fg_driver_scratch_create(ctx, &scratch));
  FG_TRY_EXIT(draw_sample(ctx, work, &s));
  if (s.count < SECTORS_MIN || !(s.ends[1] > s.ends[0])) goto exit;
  fg_driver plain = fg_driver_none(s.ends);
  plain.values[FG_DRIVER_LN_GAMMA] = log(gamma);
  fg_driver_find_misfit(s.profiles, s.count, &plain, scratch, &misfit);
  if (!fg_driver_is_missed(&misfit, s.ends[1] - s.ends[0])) goto exit;
  FG_TRY_EXIT(fg_driver_choose(ctx, s.profiles, s.count, s.ends, gamma, START_NOISE, &choice));
  if (!choice.fit.good) goto exit;
  const fg_found_driver found = {true, choice.fit.driver, choice.u_edge_px, choice.missed};
  FG_TRY_EXIT(fg_disc_use_driver(ctx, work, &found));
exit:
  fg_driver_scratch_free(scratch);
  free(s.bins);
  return status;
}

void fg_disc_describe_driver(const fg_disc_work *work, const fg_disc_edge *edge,
                             fg_picture_state *state) {
  if (!work->driver) return;
  fg_driver_describe(work->driver, state);
  state->level = 0;
  state->u_level = work->u_driver_px / (edge->blur_px * sqrt(2 * M_PI));
  if (work->unexplained) state->findings |= FG_PICTURE_UNKNOWN_PROFILE;
}
