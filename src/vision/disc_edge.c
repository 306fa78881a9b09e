/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/disc_edge.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/spread.h"
#include "vision/edge_spread.h"
#include "vision/picture.h"

enum { CENTRE_ROUNDS = 3, TRIM_ROUNDS = 4, SECTORS_MIN = 12, SECTORS_MAX = 64 };
#define SECTOR_PX  48.0
#define STATION_PX 1.5
/* Reach of the ring on both sides of the edge, enough for levels and slopes. */
#define REACH_PX    8.0
#define REACH_BLURS 6.0
#define START_PX    12.0
#define SOUND_SHARE 0.01
/* Min step of a sector with an edge, as a share of the typical one. */
#define STEP_SHARE 0.3
/* Min contrast of an edge, counts. */
#define CONTRAST_MIN    6.0
#define TRIM_DEVIATIONS 2.5
#define TRIM_MIN_PX     0.3
/* Uncertainty of clipped light, as a share of the contrast: it may lie beyond the end of the scale.
 */
#define WHITE_U 0.1

static double step_of(const fg_step_fit *fit) {
  return fit->values[FG_STEP_OUTSIDE] - fit->values[FG_STEP_INSIDE];
}

/* Drops sectors with a much smaller step than usual, or one the other way: they have no edge of
 * this kind. */
static fg_status drop_weak(fg_context *ctx, fg_disc_work *work) {
  size_t count = work->ring.sector_count, n = 0;
  double *steps;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *steps, (void **)&steps));
  for (size_t s = 0; s < count; s++)
    if (work->sectors[s].good) steps[n++] = step_of(&work->sectors[s]);
  double typical = n ? fg_select(steps, n, n / 2) : 0;
  free(steps);
  n = 0;
  for (size_t s = 0; s < count; s++) {
    fg_step_fit *fit = &work->sectors[s];
    fit->good = fit->good && step_of(fit) * typical > STEP_SHARE * typical * typical;
    n += fit->good;
  }
  if (n < SECTORS_MIN / 2 || 2 * n < count || fabs(typical) < CONTRAST_MIN)
    return fg_fail(ctx, FG_ERR_NUMERIC, "no edge around the circle");
  return FG_OK;
}

static fg_status fit_sectors(fg_context *ctx, fg_disc_work *work, unsigned held) {
  fg_disc_fit_sectors(work, held);
  return drop_weak(ctx, work);
}

/* Collects the ring about its circle and stacks it. */
static fg_status fill_ring(fg_context *ctx, fg_disc_work *work, double reach_px) {
  fg_ring *ring = &work->ring;
  double circumference = 2 * M_PI * ring->circle.radius;
  ring->reach_px = fmin(reach_px, 0.6 * ring->circle.radius);
  ring->sector_count = (size_t)fmin(fmax(circumference / SECTOR_PX, SECTORS_MIN), SECTORS_MAX);
  size_t per_sector = (size_t)(circumference / STATION_PX / (double)ring->sector_count) + 1;
  ring->station_count = per_sector * ring->sector_count;
  FG_TRY(fg_ring_collect(ctx, work->tiles, work->shape, ring));
  return fg_disc_stack_sectors(ctx, work);
}

/* Weighs the sectors' points by their distance from the circle, as one step of a trimmed fit.
 * Returns their rms. */
static double trim_points(const fg_point *points, size_t n, const fg_circle *circle,
                          double *weights, double *scratch) {
  double sum = 0, used = 0;
  for (size_t i = 0; i < n; i++)
    scratch[i] = fabs(hypot(points[i].x - circle->x, points[i].y - circle->y) - circle->radius);
  double limit = fmax(fg_spread_limit(scratch, n, TRIM_DEVIATIONS), TRIM_MIN_PX);
  for (size_t i = 0; i < n; i++) {
    double off = hypot(points[i].x - circle->x, points[i].y - circle->y) - circle->radius;
    weights[i] = fabs(off) <= limit;
    sum += weights[i] * off * off;
    used += weights[i];
  }
  return sqrt(sum / used);
}

static fg_status fit_trimmed(fg_context *ctx, fg_point *points, size_t n, double *block,
                             fg_circle *circle, double *rms) {
  for (size_t i = 0; i < n; i++)
    block[i] = 1;
  for (int round = 0; round < TRIM_ROUNDS; round++) {
    FG_TRY(fg_circle_estimate(ctx, points, block, n, circle));
    *rms = trim_points(points, n, circle, block, block + n);
  }
  return FG_OK;
}

/* The circle through the sectors' edges. */
static fg_status centre_ring(fg_context *ctx, fg_disc_work *work, double *rms) {
  size_t count = work->ring.sector_count, n = 0;
  fg_circle circle = work->ring.circle;
  fg_point *points = NULL;
  double *block = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *points, (void **)&points));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, 2 * sizeof *block, (void **)&block));
  for (size_t s = 0; s < count; s++) {
    const fg_step_fit *fit = &work->sectors[s];
    if (!fit->good) continue;
    double angle = ((double)s + 0.5) * 2 * M_PI / (double)count;
    double radius = circle.radius + fit->values[FG_STEP_EDGE];
    points[n++] = (fg_point){circle.x + radius * cos(angle), circle.y + radius * sin(angle)};
  }
  FG_TRY_EXIT(fit_trimmed(ctx, points, n, block, &circle, rms));
  if (hypot(circle.x - work->ring.circle.x, circle.y - work->ring.circle.y) > work->ring.reach_px)
    status = fg_fail(ctx, FG_ERR_NUMERIC, "the edge around the circle is not round");
  work->ring.circle = circle;
exit:
  free(points);
  free(block);
  return status;
}

static double typical_blur(const fg_disc_work *work) {
  double values[SECTORS_MAX];
  size_t n = 0;
  for (size_t s = 0; s < work->ring.sector_count; s++)
    if (work->sectors[s].good) values[n++] = work->sectors[s].values[FG_STEP_BLUR];
  return n ? fg_select(values, n, n / 2) : 1;
}

/* Centres the ring on the edge, with levels that have no slopes. */
static fg_status find_ring(fg_context *ctx, fg_disc_work *work, const fg_disc_candidate *candidate,
                           double *rms) {
  double reach = candidate->u_px + START_PX;
  work->ring.circle = candidate->circle;
  for (int round = 0; round < CENTRE_ROUNDS; round++) {
    FG_TRY(fill_ring(ctx, work, reach));
    FG_TRY(fit_sectors(ctx, work,
                       1u << FG_STEP_GAMMA | 1u << FG_STEP_SLOPE_IN | 1u << FG_STEP_SLOPE_OUT));
    FG_TRY(centre_ring(ctx, work, rms));
    /* An edge that is damaged or not round keeps the first reach: a wider one would include its
     * surroundings. */
    if (*rms < SOUND_SHARE * work->ring.circle.radius)
      reach = REACH_PX + REACH_BLURS * typical_blur(work) + 3 * *rms;
  }
  return fill_ring(ctx, work, reach);
}

/* Makes the sectors' final fits, with slopes only where they are significant. */
static fg_status find_shape(fg_context *ctx, fg_disc_work *work) {
  unsigned held = 1u << FG_STEP_GAMMA;
  FG_TRY(fit_sectors(ctx, work, held));
  for (int side = 0; side < 2; side++)
    if (!fg_disc_has_slope(work, FG_STEP_SLOPE_IN + side)) held |= 1u << (FG_STEP_SLOPE_IN + side);
  return fit_sectors(ctx, work, held);
}

void fg_disc_work_free(fg_disc_work *work) {
  fg_ring_free(&work->ring);
  free(work->bins);
  free(work->sectors);
  free(work->driver);
  free(work->driver_tone);
}

fg_status fg_disc_edge_tone(fg_context *ctx, const fg_tiles *tiles, const fg_pixel_shape *shape,
                            const fg_disc_candidate *candidate, fg_tone *tone) {
  fg_disc_work work = {.tiles = tiles, .shape = shape, .gamma = 1};
  double rms;
  fg_status status = FG_OK;
  FG_TRY_EXIT(find_ring(ctx, &work, candidate, &rms));
  FG_TRY_EXIT(fit_sectors(ctx, &work, 1u << FG_STEP_GAMMA));
  FG_TRY_EXIT(fg_disc_find_tone(ctx, &work, tone));
exit:
  fg_disc_work_free(&work);
  return status;
}

/* Uncertainty of an edge's place by its level. An error of the levels or the tone curve moves the
 * count that marks the edge; over the profile's slope there, contrast / (s sqrt(2 pi)), that is a
 * shift. */
double fg_disc_level_uncertainty(const fg_disc_work *work, const fg_tone *tone,
                                 const fg_disc_edge *edge) {
  double per_contrast = edge->blur_px * sqrt(2 * M_PI), white = 0, change = 0;
  if (work->driver) return work->u_driver_px;
  const double lights[2] = {edge->inside, edge->outside};
  double counts[2];
  for (int i = 0; i < 2; i++)
    counts[i] = 255 * pow(fmax(lights[i], 1) / 255, 1 / tone->gamma);
  if (work->white[0] || work->white[1]) white = WHITE_U * 0.5 * per_contrast;
  if (tone->uncertainty > 0)
    change = (fg_edge_count_between(tone->gamma + tone->uncertainty, counts) -
              fg_edge_count_between(tone->gamma - tone->uncertainty, counts)) /
             2 / fabs(counts[1] - counts[0]) * per_contrast;
  return hypot(white, change);
}

/* Adds the sectors' mean profiles to the edge's spread. */
static void add_disc_spread(const fg_disc_work *work, fg_disc_edge *edge) {
  fg_edge_spread spread = {.sum = {0}};
  for (size_t s = 0; s < work->ring.sector_count; s++) {
    const fg_step_fit *fit = &work->sectors[s];
    if (!fit->good) continue;
    double sides[2];
    for (int i = 0; i < 2; i++)
      sides[i] =
          255 * pow(fmax(fit->values[FG_STEP_INSIDE + i], 0) / 255, 1 / fit->values[FG_STEP_GAMMA]);
    for (size_t i = 0; i < work->bin_count; i++) {
      const fg_profile_bin *bin = &work->bins[s * work->bin_count + i];
      double outwards = bin->across_px - fit->values[FG_STEP_EDGE];
      double share = (bin->value - fmin(sides[0], sides[1])) / fabs(sides[0] - sides[1]);
      if (bin->count > 0)
        fg_edge_spread_add(&spread, sides[1] > sides[0] ? outwards : -outwards, share, bin->count);
    }
  }
  fg_edge_spread_measure(&spread, &edge->spread_px, &edge->asymmetry);
}

static fg_status measure_disc_edge(fg_context *ctx, fg_disc_work *work,
                                   const fg_disc_candidate *candidate, const fg_tone *tone,
                                   fg_disc_edge *edge) {
  FG_TRY(find_ring(ctx, work, candidate, &edge->sector_rms_px));
  FG_TRY(find_shape(ctx, work));
  add_disc_spread(work, edge);
  if (!tone->plain) FG_TRY(fg_disc_find_driver(ctx, work));
  edge->gamma = work->gamma;
  edge->driven = work->driver != NULL;
  edge->circle = work->ring.circle;
  edge->count = work->ring.station_count;
  FG_TRY(fg_memory_allocate(ctx, edge->count, sizeof *edge->stations, (void **)&edge->stations));
  FG_TRY(fg_disc_smooth_shape(ctx, work, edge));
  edge->level_u_px = fg_disc_level_uncertainty(work, tone, edge);
  return fg_disc_solve(ctx, work, edge);
}

fg_status fg_disc_edge_measure(fg_context *ctx, const fg_tiles *tiles, const fg_pixel_shape *shape,
                               const fg_disc_candidate *candidate, const fg_tone *tone,
                               fg_disc_edge *edge) {
  fg_disc_work work = {
      .tiles = tiles, .shape = shape, .gamma = tone->gamma, .linear = tone->linear};
  memset(edge, 0, sizeof *edge);
  edge->picture = fg_picture_unknown();
  edge->gamma = tone->gamma;
  fg_status status = measure_disc_edge(ctx, &work, candidate, tone, edge);
  if (status == FG_OK) status = fg_picture_of_ring(ctx, &work, edge, &edge->picture);
  if (status == FG_OK && isnan(edge->picture.gamma) && tone->found > 0) {
    edge->picture.gamma = tone->found;
    edge->picture.u_gamma = tone->u_found;
  }
  if (status == FG_OK) fg_disc_describe_driver(&work, edge, &edge->picture);
  fg_disc_work_free(&work);
  if (status != FG_OK) fg_disc_edge_free(edge);
  return status;
}

void fg_disc_edge_free(fg_disc_edge *edge) {
  if (!edge) return;
  free(edge->stations);
  memset(edge, 0, sizeof *edge);
}
