/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/discs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/select.h"
#include "geometry/disc_fit.h"
#include "geometry/level_uncertainty.h"
#include "measure/loss.h"
#include "vision/disc_edge.h"
#include "vision/disc_find.h"

/* Min radius of a round feature that is no dust, unless the design states smaller ones; and of an
 * edge, in pixels. */
#define RADIUS_MIN_MM 0.2
#define RADIUS_MIN_PX 14.0
#define DESIGN_SHARE  0.7
/* Max rms deviation of a round feature's edge from its circle, as a share of the radius. */
#define ROUND_SHARE 0.04
/* Max difference of a disc's surroundings from background, as a share of the contrast. */
#define BACKGROUND_SHARE 0.3

typedef struct disc_work {
  const fg_tiles *tiles;
  const fg_design *design;
  int jpeg_quality; /* as in fg_measurement */
  fg_pixel_shape shape;
  const fg_disc_candidates *found;
  double background; /* counts */
  fg_tone *tones;    /* one per candidate */
  fg_tone tone;
  fg_disc *discs; /* one per candidate; no points: no round feature */
} disc_work;

static double min_radius_px(const fg_design *design, const fg_pixel_shape *shape) {
  double min = RADIUS_MIN_MM;
  for (size_t i = 0; i < design->discs.count; i++) {
    double stated = DESIGN_SHARE * 0.5 * design->discs.diameters_mm[i];
    min = i == 0 ? stated : fmin(min, stated);
  }
  return fmax(min * 1000 / shape->um, RADIUS_MIN_PX);
}

/* Level of the scan's border: the median of the outermost blocks. */
static fg_status find_background(fg_context *ctx, const fg_tiles *tiles, double *level) {
  int32_t w = tiles->block_columns, h = tiles->block_rows;
  size_t n = 0;
  double *values;
  FG_TRY(fg_memory_allocate(ctx, 2 * ((size_t)w + (size_t)h), sizeof *values, (void **)&values));
  for (int32_t x = 0; x < w; x++) {
    values[n++] = (double)fg_tiles_block(tiles, x, 0);
    values[n++] = (double)fg_tiles_block(tiles, x, h - 1);
  }
  for (int32_t y = 0; y < h; y++) {
    values[n++] = (double)fg_tiles_block(tiles, 0, y);
    values[n++] = (double)fg_tiles_block(tiles, w - 1, y);
  }
  *level = fg_select(values, n, n / 2);
  free(values);
  return FG_OK;
}

/* Converts stations of the edge to points in mm, and fits their circle. The picture's state and the
 * blur are set already. */
static fg_status fit_edge(fg_context *ctx, const disc_work *work, const fg_disc_edge *edge,
                          fg_disc *disc) {
  fg_disc_point *points;
  double mm = work->shape.um / 1000;
  double loss_px = fg_loss_edge_px(work->jpeg_quality, edge->inside - edge->outside, edge->blur_px);
  FG_TRY(fg_memory_allocate(ctx, edge->count, sizeof *points, (void **)&points));
  for (size_t i = 0; i < edge->count; i++) {
    const fg_disc_station *s = &edge->stations[i];
    double angle = ((double)i + 0.5) * 2 * M_PI / (double)edge->count;
    double radius = edge->circle.radius + (double)s->edge_px;
    points[i] = (fg_disc_point){.at = {(edge->circle.x + radius * cos(angle)) * mm,
                                       (edge->circle.y + radius * sin(angle)) * mm},
                                .u = (double)s->u_px * mm,
                                .split = (double)s->split_px * mm,
                                .u_split = (double)s->u_split_px * mm,
                                .used = s->weight > 0};
    if (!points[i].used) points[i].at = (fg_point){edge->circle.x * mm, edge->circle.y * mm};
  }
  disc->stations = points;
  disc->station_count = edge->count;
  disc->loss_variance = fg_loss_turn_variance(work->jpeg_quality);
  disc->edge_u_mm = hypot(edge->level_u_px, loss_px) * mm;
  fg_disc_find_level_uncertainty(work->design, disc);
  return fg_disc_measure_again(ctx, disc);
}

static double count_at_gamma(double gamma, double light) {
  return 255 * pow(fmax(light, 0) / 255, 1 / gamma);
}

static double mean_radius_px(const fg_disc_edge *edge) {
  double sum = 0, n = 0;
  for (size_t i = 0; i < edge->count; i++) {
    if (!(edge->stations[i].weight > 0)) continue;
    sum += (double)edge->stations[i].edge_px;
    n++;
  }
  return edge->circle.radius + sum / n;
}

/* Measures diameter and blur with counts used as light. */
static fg_status find_plain(fg_context *ctx, const disc_work *work,
                            const fg_disc_candidate *candidate, const fg_disc_edge *edge,
                            fg_disc *disc) {
  static const fg_tone linear = {.gamma = 1, .plain = true};
  fg_disc_edge plain = {0};
  double um = work->shape.um;
  disc->plain_mm = disc->diameter_mm;
  disc->plain_blur_um = disc->blur_um;
  if (work->tone.gamma == 1 && !edge->driven) return FG_OK;
  FG_TRY(fg_disc_edge_measure(ctx, work->tiles, &work->shape, candidate, &linear, &plain));
  disc->plain_mm += 2 * um / 1000 * (mean_radius_px(&plain) - mean_radius_px(edge));
  disc->plain_blur_um = plain.blur_px * um;
  disc->contrast = fabs(plain.inside - plain.outside);
  fg_disc_edge_free(&plain);
  return FG_OK;
}

static void describe_disc(const disc_work *work, const fg_disc_edge *edge, fg_disc *disc) {
  disc->picture = edge->picture;
  double contrast = fabs(edge->inside - edge->outside);
  disc->bright = edge->inside > edge->outside;
  disc->hole = fabs(edge->outside - work->background) > BACKGROUND_SHARE * contrast;
  disc->blur_um = edge->blur_px * work->shape.um;
  disc->spread_px = edge->spread_px;
  disc->asymmetry = edge->asymmetry;
  disc->contrast =
      fabs(count_at_gamma(edge->gamma, edge->inside) - count_at_gamma(edge->gamma, edge->outside));
}

static fg_status find_tone(fg_context *ctx, void *shared, size_t i) {
  disc_work *work = shared;
  fg_status status =
      fg_disc_edge_tone(ctx, work->tiles, &work->shape, &work->found->list[i], &work->tones[i]);
  if (status == FG_ERR_NUMERIC) work->tones[i] = (fg_tone){.gamma = 1, .uncertainty = INFINITY};
  return status == FG_ERR_NUMERIC ? FG_OK : status;
}

/* Measures one candidate; one that is no round feature stays without points. */
static fg_status measure_candidate(fg_context *ctx, void *shared, size_t i) {
  disc_work *work = shared;
  fg_disc *disc = &work->discs[i];
  fg_disc_edge edge = {0};
  fg_status status = fg_disc_edge_measure(ctx, work->tiles, &work->shape, &work->found->list[i],
                                          &work->tone, &edge);
  if (status == FG_OK) describe_disc(work, &edge, disc);
  if (status == FG_OK) status = fit_edge(ctx, work, &edge, disc);
  if (status == FG_OK) status = find_plain(ctx, work, &work->found->list[i], &edge, disc);
  if (status == FG_OK && disc->rms_um > ROUND_SHARE * 1000 * disc->radius_mm) fg_disc_free(disc);
  if (status != FG_OK) fg_disc_free(disc);
  fg_disc_edge_free(&edge);
  return status == FG_ERR_NUMERIC ? FG_OK : status;
}

fg_status fg_measure_disc_near(fg_context *ctx, const fg_tiles *tiles, const fg_pixel_shape *shape,
                               const fg_measurement *m, const fg_disc_candidate *candidate,
                               fg_disc *disc) {
  fg_disc_candidate one = *candidate;
  const fg_disc_candidates found = {.list = &one, .count = 1};
  fg_tone tone;
  disc_work work = {.tiles = tiles,
                    .design = &m->design,
                    .jpeg_quality = m->file.jpeg_quality,
                    .shape = *shape,
                    .found = &found,
                    .tones = &tone,
                    .discs = disc};
  memset(disc, 0, sizeof *disc);
  FG_TRY(find_tone(ctx, &work, 0));
  work.tone = fg_tone_pool(&tone, 1);
  return measure_candidate(ctx, &work, 0);
}

/* Returns true when two candidates led to one edge: the one seen over more of the turn stays. */
static bool is_same(const fg_disc *a, const fg_disc *b) {
  double distance = hypot(a->centre_mm.x - b->centre_mm.x, a->centre_mm.y - b->centre_mm.y);
  double limit = 0.05 * fmin(a->radius_mm, b->radius_mm);
  return distance < limit && fabs(a->radius_mm - b->radius_mm) < limit;
}

static void drop_doubles(const disc_work *work) {
  for (size_t i = 0; i < work->found->count; i++)
    for (size_t k = 0; k < work->found->count && work->discs[i].points; k++) {
      fg_disc *other = &work->discs[k];
      if (k == i || !other->points || !is_same(&work->discs[i], other)) continue;
      fg_disc_free(other->coverage_deg <= work->discs[i].coverage_deg ? other : &work->discs[i]);
    }
}

/* Hands over the discs in reading order. The polarity is that of parts on the background, or of the
 * surroundings of holes. */
static void hand_out_discs(disc_work *work, fg_measurement *m) {
  int votes = 0;
  size_t count = work->found->count;
  drop_doubles(work);
  for (size_t i = 0; i < count; i++) {
    fg_disc *disc = &work->discs[i];
    if (!disc->points) continue;
    votes += disc->hole == disc->bright ? -1 : 1;
    m->discs[m->disc_count] = *disc;
    m->discs[m->disc_count].number = (int)m->disc_count + 1;
    m->disc_count++;
    memset(disc, 0, sizeof *disc);
  }
  m->light_on_dark = votes >= 0;
  m->specks = work->found->other_shapes + count - m->disc_count;
}

static fg_status measure_candidates(fg_context *ctx, disc_work *work, unsigned threads,
                                    fg_measurement *m) {
  size_t count = work->found->count;
  fg_status status = FG_OK;
  FG_TRY_EXIT(find_background(ctx, work->tiles, &work->background));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *work->discs, (void **)&work->discs));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *m->discs, (void **)&m->discs));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *work->tones, (void **)&work->tones));
  bool linear = m->design.tone == FG_TONE_LINEAR;
  if (!linear) FG_TRY_EXIT(fg_parallel_run(ctx, threads, count, find_tone, work));
  work->tone = linear ? fg_tone_linear() : fg_tone_pool(work->tones, count);
  FG_TRY_EXIT(fg_parallel_run(ctx, threads, count, measure_candidate, work));
  hand_out_discs(work, m);
exit:
  for (size_t i = 0; work->discs && i < count; i++)
    fg_disc_free(&work->discs[i]);
  free(work->discs);
  free(work->tones);
  return status;
}

fg_status fg_measure_discs(fg_context *ctx, const fg_tiles *tiles, unsigned threads,
                           fg_measurement *m) {
  fg_disc_candidates found = {0};
  disc_work work = {.tiles = tiles,
                    .design = &m->design,
                    .jpeg_quality = m->file.jpeg_quality,
                    .shape = fg_pixel_shape_of(m->dpi),
                    .found = &found};
  double min = min_radius_px(&m->design, &work.shape);
  FG_TRY(fg_discs_find(ctx, tiles, &work.shape, min, threads, &found));
  fg_status status = measure_candidates(ctx, &work, threads, m);
  fg_disc_candidates_free(&found);
  if (status == FG_OK && m->disc_count == 0)
    status = fg_fail(ctx, FG_ERR_DATA,
                     "%s: no round hole or disc in the picture (%zu other shapes); the smallest "
                     "that counts has a radius of %.3g mm",
                     m->scan, m->specks, min * work.shape.um / 1000);
  return status;
}
