/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Driver model of a strip's edges: sought only where the plain model of edge_model.h misses the
 * mean profiles, and then held for the whole strip. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "vision/driver_choice.h"
#include "vision/edge_work.h"
#include "vision/picture.h"

/* Max |ln gamma| that single profiles determine well; beyond it all profiles are fitted together.
 */
#define LN_GAMMA_MAX   0.8
#define NOISE_FACTOR   1.3
#define MERGED_BLUR_PX 1.6
/* First estimate of a pixel's sd, counts. */
#define START_NOISE 1.5
/* Min number of profiles of a driver's fit. */
#define SAMPLE_MIN 4

/* Profiles of the driver's fit, and their bins, none of them empty. */
typedef struct sample {
  fg_driven_profile profiles[FG_DRIVER_PROFILES];
  fg_profile_bin *bins;
  size_t count;
  double ends[2];
} sample;

double fg_edges_count(const fg_edge_work *work, double light, double *rate) {
  *rate = 1;
  if (work->driver) return fg_driver_tone_at(work->driver_tone, light, rate);
  if (work->gamma == 1) return light;
  double value = fg_edge_count(work->gamma, light);
  *rate = value / (work->gamma * light);
  return value;
}

double fg_edges_light(const fg_edge_work *work, double count) {
  return work->driver ? fg_driver_tone_inverse(work->driver_tone, count)
                      : fg_edge_light(work->gamma, count);
}

/* Converts a fit to counts. Slopes are over the contrast. */
static fg_driven_profile driven_profile(const fg_edge_work *work, const fg_profile_fit *fit) {
  const fg_edge_shape *shape = &fit->shape;
  double rate, plateau = fg_edges_count(work, fmax(shape->plateau, 1e-3), &rate);
  fg_driven_profile p = {.values = {fit->edge_px[0], fit->edge_px[1], plateau}};
  for (int side = 0; side < 2; side++) {
    double count = fg_edges_count(work, fmax(shape->level[side], 1e-3), &rate);
    double step = shape->level[side] - shape->plateau;
    p.values[FG_DRIVEN_LEVEL_L + side] = count;
    p.values[FG_DRIVEN_SLOPE_L + side] = shape->slope[side] * (step != 0 ? (count - plateau) / step : 1);
    p.values[FG_DRIVEN_BLUR_L + side] = shape->blur_px[side];
  }
  return p;
}

/* Converts a driven profile back to a fit, with the standard deviations. */
static void accept_profile(const fg_edge_work *work, const fg_driven_profile *p,
                           fg_profile_fit *fit) {
  fg_edge_shape *shape = &fit->shape;
  double rate;
  shape->plateau = fg_edges_light(work, p->values[FG_DRIVEN_PLATEAU]);
  fg_edges_count(work, shape->plateau, &rate);
  fit->sd[0] = p->sd[FG_DRIVEN_PLATEAU] / fmax(rate, 1e-3);
  for (int side = 0; side < 2; side++) {
    double counts = p->values[FG_DRIVEN_LEVEL_L + side] - p->values[FG_DRIVEN_PLATEAU];
    shape->level[side] = fg_edges_light(work, p->values[FG_DRIVEN_LEVEL_L + side]);
    fg_edges_count(work, shape->level[side], &rate);
    double per_count = (shape->level[side] - shape->plateau) / (counts != 0 ? counts : 1);
    shape->slope[side] = p->values[FG_DRIVEN_SLOPE_L + side] * per_count;
    shape->blur_px[side] = p->values[FG_DRIVEN_BLUR_L + side];
    fit->edge_px[side] = p->values[FG_DRIVEN_LEFT + side];
    fit->sd[1 + side] = p->sd[FG_DRIVEN_LEVEL_L + side] / fmax(rate, 1e-3);
    fit->sd[3 + side] = p->sd[FG_DRIVEN_SLOPE_L + side] * fabs(per_count);
    fit->sd[5 + side] = p->sd[FG_DRIVEN_BLUR_L + side];
  }
}

/* Merges two neighbouring bins. */
static fg_profile_bin merge_bins(const fg_profile_bin *a, const fg_profile_bin *b) {
  double count = a->count + b->count;
  return (fg_profile_bin){.across_px = (a->count * a->across_px + b->count * b->across_px) / count,
                          .value = (a->count * a->value + b->count * b->value) / count,
                          .count = count};
}

/* Copies the bins that are not empty; blurred edges need only bins of twice the width, in half the
 * time. */
static size_t copy_bins(const fg_edge_work *work, const fg_segment_profile *segment,
                        fg_profile_bin *bins) {
  const double *blur = segment->fit.shape.blur_px;
  size_t n = 0, step = fmin(blur[0], blur[1]) > MERGED_BLUR_PX ? 2 : 1, first, count;
  fg_edges_reach(work, segment, &first, &count);
  for (size_t i = first; i + step <= first + count && n + 8 < FG_DRIVEN_MAX; i += step) {
    fg_profile_bin bin = segment->bins[i];
    if (step == 2) bin = merge_bins(&segment->bins[i], &segment->bins[i + 1]);
    if (bin.count > 0) bins[n++] = bin;
  }
  return n;
}

/* Finds the noise limit of sound segments: one with a fillet, an end or dust misses any model. */
static fg_status find_noise_limit(fg_context *ctx, const fg_edge_work *work, double *limit) {
  double *noise;
  size_t n = 0;
  FG_TRY(fg_memory_allocate(ctx, work->segment_count, sizeof *noise, (void **)&noise));
  for (size_t i = 0; i < work->segment_count; i++)
    if (work->segments[i].fit.good) noise[n++] = work->segments[i].fit.noise;
  *limit = n ? NOISE_FACTOR * fg_select(noise, n, n / 4) : 0;
  free(noise);
  return FG_OK;
}

static bool is_sound(const fg_segment_profile *segment, double limit) {
  return segment->fit.good && segment->fit.noise <= limit;
}

static void add_ends(const fg_driven_profile *p, sample *s) {
  for (int k = FG_DRIVEN_PLATEAU; k <= FG_DRIVEN_LEVEL_R; k++) {
    s->ends[0] = fmin(s->ends[0], p->values[k]);
    s->ends[1] = fmax(s->ends[1], p->values[k]);
  }
}

static void add_to_sample(const fg_edge_work *work, const fg_segment_profile *segment, sample *s) {
  fg_driven_profile *p = &s->profiles[s->count];
  fg_profile_bin *bins = s->bins + s->count++ * work->bin_count;
  *p = driven_profile(work, &segment->fit);
  p->bins = bins;
  p->count = copy_bins(work, segment, bins);
  add_ends(p, s);
}

/* One edge of a segment as a profile of its own, outwards. */
static fg_driven_profile side_of(const fg_driven_profile *both, int side) {
  static const unsigned held =
      1u << FG_DRIVEN_LEFT | 1u << FG_DRIVEN_LEVEL_L | 1u << FG_DRIVEN_BLUR_L;
  fg_driven_profile p = {.single = true, .held = held};
  p.values[FG_DRIVEN_PLATEAU] = both->values[FG_DRIVEN_PLATEAU];
  p.values[FG_DRIVEN_SLOPE_R] = both->values[FG_DRIVEN_SLOPE_L + side];
  for (int k = 0; k < 2; k++) {
    p.values[FG_DRIVEN_LEFT + k] = (side ? 1 : -1) * both->values[FG_DRIVEN_LEFT + side];
    p.values[FG_DRIVEN_LEVEL_L + k] = both->values[FG_DRIVEN_LEVEL_L + side];
    p.values[FG_DRIVEN_BLUR_L + k] = both->values[FG_DRIVEN_BLUR_L + side];
  }
  return p;
}

/* Adds one edge of a segment, from the middle of the strip on. */
static void add_side_to_sample(const fg_edge_work *work, const fg_segment_profile *segment,
                               int side, sample *s) {
  fg_driven_profile both = driven_profile(work, &segment->fit), *p = &s->profiles[s->count];
  fg_profile_bin *bins = s->bins + s->count++ * work->bin_count;
  double way = side ? 1 : -1;
  double middle = 0.5 * way * (both.values[FG_DRIVEN_LEFT] + both.values[FG_DRIVEN_RIGHT]);
  *p = side_of(&both, side);
  p->bins = bins;
  for (size_t i = 0; i < work->bin_count && p->count + 8 < FG_DRIVEN_MAX; i++) {
    fg_profile_bin bin = segment->bins[side ? i : work->bin_count - 1 - i];
    bin.across_px *= way;
    if (bin.count > 0 && bin.across_px > middle) bins[p->count++] = bin;
  }
  add_ends(p, s);
}

/* Chooses edges without a wall of sound segments, spread along the strip. */
static void draw_sides(const fg_edge_work *work, double limit, sample *s) {
  size_t sound = 0, seen = 0;
  for (size_t i = 0; i < 2 * work->segment_count; i++)
    sound += is_sound(&work->segments[i / 2], limit) && !work->segments[i / 2].wall[i % 2];
  for (size_t i = 0; i < 2 * work->segment_count && s->count < FG_DRIVER_PROFILES; i++) {
    const fg_segment_profile *segment = &work->segments[i / 2];
    if (!is_sound(segment, limit) || segment->wall[i % 2]) continue;
    if (seen++ * FG_DRIVER_PROFILES >= s->count * sound)
      add_side_to_sample(work, segment, (int)(i % 2), s);
  }
}

/* Chooses sound segments, spread along the strip. */
static fg_status draw_sample(fg_context *ctx, const fg_edge_work *work, sample *s) {
  size_t sound = 0, seen = 0;
  double limit;
  FG_TRY(fg_memory_allocate(ctx, FG_DRIVER_PROFILES * work->bin_count, sizeof *s->bins,
                            (void **)&s->bins));
  FG_TRY(find_noise_limit(ctx, work, &limit));
  s->ends[0] = INFINITY;
  s->ends[1] = -INFINITY;
  if (work->outer_px > 0) {
    draw_sides(work, limit, s);
    return FG_OK;
  }
  for (size_t i = 0; i < work->segment_count; i++)
    sound += is_sound(&work->segments[i], limit);
  for (size_t i = 0; i < work->segment_count && s->count < FG_DRIVER_PROFILES; i++)
    if (is_sound(&work->segments[i], limit) && seen++ * FG_DRIVER_PROFILES >= s->count * sound)
      add_to_sample(work, &work->segments[i], s);
  return FG_OK;
}

/* Returns true when the plain model leaves more than chance. */
static bool is_missed(const fg_edge_work *work, const sample *s, fg_driver_scratch *scratch) {
  fg_driver plain = fg_driver_none(s->ends);
  fg_driver_misfit misfit;
  plain.values[FG_DRIVER_LN_GAMMA] = log(work->gamma);
  fg_driver_find_misfit(s->profiles, s->count, &plain, scratch, &misfit);
  return fg_driver_is_missed(&misfit, s->ends[1] - s->ends[0]);
}

/* Adopts the chosen driver for all later steps. */
static fg_status adopt_choice(fg_context *ctx, fg_edge_work *work, const fg_driver_choice *choice) {
  const fg_driver *driver = &choice->fit.driver;
  work->gamma = exp(driver->values[FG_DRIVER_LN_GAMMA]);
  work->u_gamma = choice->fit.sd[FG_DRIVER_LN_GAMMA] * work->gamma;
  work->u_driver_px = choice->u_edge_px;
  work->unexplained = choice->missed;
  fg_edge_tables_init(work->tables, 1);
  if (!choice->fit.free) return FG_OK;
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *work->driver, (void **)&work->driver));
  FG_TRY(fg_memory_allocate(ctx, 1, sizeof *work->driver_tone, (void **)&work->driver_tone));
  *work->driver = *driver;
  fg_driver_tone_fill(driver, work->driver_tone);
  work->tables->linear = work->driver_tone->linear;
  for (int i = 0; i < FG_TONE_STEPS + 2; i++)
    work->tables->tone[i] = (float)fg_driver_count(driver, 255.0 * i / FG_TONE_STEPS);
  return FG_OK;
}

void fg_edges_free_driver(fg_edge_work *work) {
  free(work->driver);
  free(work->driver_tone);
}

fg_status fg_edges_fit_driven(fg_context *ctx, const fg_edge_work *work,
                              fg_segment_profile *segment) {
  fg_driven_profile p = driven_profile(work, &segment->fit);
  fg_driver_fit fit = {.driver = *work->driver, .noise = START_NOISE, .tone = work->driver_tone};
  fg_profile_bin bins[FG_DRIVEN_MAX];
  p.bins = bins;
  p.count = copy_bins(work, segment, bins);
  FG_TRY(fg_driver_fit_profiles(ctx, &p, 1, &fit));
  segment->fit.good = fit.good;
  segment->fit.noise = fit.noise;
  if (fit.good) accept_profile(work, &p, &segment->fit);
  return FG_OK;
}

void fg_edges_describe_driver(const fg_edge_work *work, fg_picture_state *state) {
  double per_level = 0.5 * (work->blur_px[0] + work->blur_px[1]) * sqrt(2 * M_PI);
  double u_edge_px = work->u_driver_px;
  if (isnan(u_edge_px)) u_edge_px = 0.5 * work->tone_px * work->u_gamma / work->gamma;
  if (work->level_step > FG_LEVEL_STEP_MAX) {
    /* Either level, and with it the half between them, lies anywhere within a step. */
    double share = work->level_step / sqrt(12) / work->contrast;
    u_edge_px = hypot(u_edge_px, share * per_level);
    u_edge_px *= fmax(1, FG_HIDDEN_BLUR_PX * sqrt(2 * M_PI) / per_level);
  }
  state->gamma = work->gamma;
  state->u_gamma = work->u_gamma;
  state->level = 0;
  state->u_level = u_edge_px / per_level;
  state->tone_s = state->sharpen_amount = 0;
  if (work->unexplained) state->findings |= FG_PICTURE_UNKNOWN_PROFILE;
  if (work->driver) fg_driver_describe(work->driver, state);
}

fg_status fg_edges_find_driver(fg_context *ctx, fg_edge_work *work, bool *found) {
  sample s = {.count = 0};
  fg_driver_scratch *scratch = NULL;
  fg_driver_choice choice = {.threads = work->threads, .linear = work->linear};
  fg_status status = FG_OK;
  *found = false;
  FG_TRY_EXIT(fg_driver_scratch_create(ctx, &scratch));
  FG_TRY_EXIT(draw_sample(ctx, work, &s));
  bool missed = is_missed(work, &s, scratch), few = work->level_step > FG_LEVEL_STEP_MAX;
  work->unexplained = missed && few;
  bool asked = missed || fabs(log(work->gamma)) > LN_GAMMA_MAX || work->outer_px > 0;
  *found = !work->clipped && !few && s.count >= SAMPLE_MIN && asked;
  if (!*found) goto exit;
  FG_TRY_EXIT(
      fg_driver_choose(ctx, s.profiles, s.count, s.ends, work->gamma, START_NOISE, &choice));
  /* A model that misses edges without a wall says nothing of those beside it. */
  if (choice.fit.good && !(choice.missed && work->outer_px > 0))
    FG_TRY_EXIT(adopt_choice(ctx, work, &choice));
  else
    work->unexplained = true;
exit:
  fg_driver_scratch_free(scratch);
  free(s.bins);
  return status;
}
