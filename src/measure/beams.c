/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/beams.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "geometry/level_uncertainty.h"
#include "measure/loss.h"
#include "vision/beam_find.h"
#include "vision/line_end.h"
#include "vision/rims.h"

/* Min size of an object that is no dust, as a share of a beam's length. */
#define MIN_SHARE 0.3
/* Min difference between the edge's core and flanks, in its own deviations (geometry/disc_fit.c).
 */
#define SPLIT_DEVIATIONS 3.0
/* Error of a Gaussian's shift along a curved edge, s²/2R, as a share of (s/R)². */
#define CURVED_U 0.5
/* Min uncertainty of an edge by its tone curve, px, whatever the curve's own uncertainty
 * (reports/accuracy_discs.md: gamma 1.8). */
#define TONE_U_PX 0.015
/* Distance from the border within which an edge's end is cut by it: a corner's margin, and some. */
#define BORDER_PX 12.0
/* Max shift by the next edge's blur, px; beyond it the cut is too narrow. */
#define NARROW_PX 0.01

/* Min difference of an exponent from 1 that is a finding: edges of a linear scan show as much. */
#define BENT_MIN 0.05
/* Range of accepted exponents. Straight edges have no wall or ring around them that looks like a
 * tone curve, so the range is wider than that of discs. */
static const double range_of_gamma[2] = {0.25, 3.5};

/* An island in work. */
typedef struct flat_work {
  fg_line_view view;
  const int64_t *origin_px;
  const fg_measurement *m;
  fg_rims rims;
  fg_polygon *polygons; /* one per rim */
  fg_beam_places places;
  size_t *place_rim; /* rim of each place */
  fg_tone *tones;    /* two per place */
  fg_tone tone;
  double bent_gamma; /* exponent shown by the edges where the tone is stated as linear; 1: they
                        agree */
  fg_beam *beams;    /* one per place */
  fg_found_driver *drivers;      /* of the long edges, two per place */
  const fg_found_driver *common; /* of all edges; NULL: each long edge shows its own */
} flat_work;

static double min_px(const fg_measurement *m, const fg_pixel_shape *shape) {
  return MIN_SHARE * m->design.beams.length_mm * 1000 / shape->um;
}

static fg_status find_polygon(fg_context *ctx, void *shared, size_t i) {
  flat_work *w = shared;
  fg_rim *rim = &w->rims.list[i];
  const fg_beam_limits limits = fg_beam_limits_of(&w->m->design, &w->view.shape);
  for (size_t k = 0; k < rim->count; k++) {
    rim->points[k].x *= w->view.shape.scale[0];
    rim->points[k].y *= w->view.shape.scale[1];
  }
  return fg_polygon_make(ctx, rim->points, rim->count, limits.tolerance_px, &w->polygons[i]);
}

static fg_status find_places(fg_context *ctx, flat_work *w, unsigned threads) {
  const fg_beam_limits limits = fg_beam_limits_of(&w->m->design, &w->view.shape);
  size_t capacity = 0;
  FG_TRY(fg_memory_allocate(ctx, w->rims.count, sizeof *w->polygons, (void **)&w->polygons));
  FG_TRY(fg_parallel_run(ctx, threads, w->rims.count, find_polygon, w));
  for (size_t i = 0; i < w->rims.count; i++) {
    size_t before = w->places.count;
    FG_TRY(fg_beams_find(ctx, &w->polygons[i], &limits, &w->places));
    FG_TRY(fg_memory_reserve(ctx, w->places.count + 1, sizeof *w->place_rim, &capacity,
                             (void **)&w->place_rim));
    for (size_t k = before; k < w->places.count; k++)
      w->place_rim[k] = i;
  }
  return FG_OK;
}

static fg_status find_tone(fg_context *ctx, void *shared, size_t i) {
  flat_work *w = shared;
  const fg_stretch *side = &w->places.list[i / 2].sides[FG_BEAM_LEFT + i % 2];
  fg_status status = fg_line_edge_tone(ctx, &w->view, side, &w->tones[i]);
  if (status == FG_ERR_NUMERIC) w->tones[i] = (fg_tone){.gamma = 1, .uncertainty = INFINITY};
  return status == FG_ERR_NUMERIC ? FG_OK : status;
}

/* Difference of the whole edge's flanks and core, beyond chance. The sum's own variance is that of
 * its stations, raised by the ratio of their scatter. */
static double find_split(const fg_disc_edge *edge) {
  double sum = 0, weights = 0, squares = 0, n = 0;
  for (size_t i = 0; i < edge->count; i++) {
    const fg_disc_station *s = &edge->stations[i];
    if (!(s->weight > 0) || !isfinite(s->split_px) || !(s->u_split_px > 0)) continue;
    double weight = 1 / ((double)s->u_split_px * (double)s->u_split_px);
    sum += weight * (double)s->split_px;
    squares += weight * (double)s->split_px * (double)s->split_px;
    weights += weight;
    n++;
  }
  if (n < 2) return 0;
  double mean = sum / weights;
  double variance = fmax(1, (squares - sum * mean) / (n - 1)) / weights;
  if (mean * mean <= SPLIT_DEVIATIONS * SPLIT_DEVIATIONS * variance) return 0;
  return copysign(sqrt(mean * mean - variance), mean);
}

/* Uncertainty of an edge's place by its level, px. */
static double find_uncertainty(const flat_work *w, const fg_disc_edge *found) {
  double curvature = found->circle.radius;
  double contrast = fabs(found->inside - found->outside), ratio = fabs(found->blur_px / curvature);
  double loss_px = fg_loss_edge_px(w->m->file.jpeg_quality, contrast, found->blur_px);
  double level_px =
      fg_level_uncertainty(&w->m->design, &found->picture, 0) * fg_level_shift(found->blur_px);
  double tone_px = hypot(w->tone.gamma == 1 ? 0 : TONE_U_PX, level_px);
  double curved_px = CURVED_U * ratio * ratio * 0.5 * ratio * found->blur_px;
  return hypot(hypot(found->level_u_px, loss_px), tone_px) + curved_px;
}

static fg_status copy_edge(fg_context *ctx, const flat_work *w, const fg_stretch *side,
                           const fg_disc_edge *found, double overlap_px, fg_beam_edge *edge) {
  double mm = w->view.shape.um / 1000;
  const double origin[2] = {(double)w->origin_px[0] * w->view.shape.scale[0],
                            (double)w->origin_px[1] * w->view.shape.scale[1]};
  FG_TRY(fg_memory_allocate(ctx, found->count, sizeof *edge->stations, (void **)&edge->stations));
  edge->count = found->count;
  for (size_t i = 0; i < found->count; i++) {
    const fg_disc_station *s = &found->stations[i];
    double share = ((double)i + 0.5) / (double)found->count;
    fg_point p = fg_stretch_point(side, share, s->weight > 0 ? (double)s->edge_px : 0);
    edge->stations[i] = (fg_disc_point){.at = {(p.x + origin[0]) * mm, (p.y + origin[1]) * mm},
                                        .u = (double)s->u_px * mm,
                                        .split = (double)s->split_px * mm,
                                        .u_split = (double)s->u_split_px * mm,
                                        .used = s->weight > 0};
  }
  edge->round = !fg_line_end_is_flat(side);
  edge->radius_mm = edge->round ? side->radius * mm : 0;
  edge->blur_mm = found->blur_px * mm;
  edge->row_mm = w->view.shape.scale[1] * mm;
  edge->split_mm = find_split(found) * mm;
  edge->u_mm_of_level = find_uncertainty(w, found) * mm;
  edge->u_mm_of_next = overlap_px * mm;
  edge->shape_ratio = found->shape_ratio;
  edge->loss_share = fg_loss_turn_variance(w->m->file.jpeg_quality);
  return FG_OK;
}

static fg_point to_mm(const flat_work *w, fg_point p) {
  double mm = w->view.shape.um / 1000;
  return (fg_point){(p.x + (double)w->origin_px[0] * w->view.shape.scale[0]) * mm,
                    (p.y + (double)w->origin_px[1] * w->view.shape.scale[1]) * mm};
}

/* Corrects the apex of a round floor: blur along it moves the apex, and that is the blur of the
 * beam's long edges; its own blur was used before. */
static void mend_curved(const flat_work *w, const fg_beam_edge *left, fg_disc_edge *found) {
  double along_px = left->blur_mm * 1000 / w->view.shape.um, radius = -found->circle.radius;
  if (isinf(radius) || !left->count) return;
  double shift = (found->blur_px * found->blur_px - along_px * along_px) / (2 * radius);
  for (size_t i = 0; i < found->count; i++)
    found->stations[i].edge_px += (float)shift;
}

/* Offset of the count of half the light from the middle of an edge's levels, as a share. */
static double level_of(double gamma, const fg_disc_edge *edge) {
  double light = 0.5 * (fg_edge_light(gamma, edge->inside) + fg_edge_light(gamma, edge->outside));
  double off = fg_edge_count(gamma, light) - edge->inside;
  return off / (edge->outside - edge->inside) - 0.5;
}

/* Adds the uncertainty of a tone that is stated as linear when the edges show another one. */
static void u_linear(const flat_work *w, fg_disc_edge *edge) {
  if (w->bent_gamma == 1) return;
  edge->picture.level = 0;
  edge->picture.u_level = hypot(isnan(edge->picture.u_level) ? 0 : edge->picture.u_level,
                                level_of(w->bent_gamma, edge));
  edge->picture.gamma = w->bent_gamma;
  if (fabs(log(w->bent_gamma)) > BENT_MIN) edge->picture.findings |= FG_PICTURE_TONE_CURVE;
}

/* Scanner and driver as a beam's edges before this one tell of them. */
static fg_line_tone tone_beside(const flat_work *w, const fg_beam *beam,
                                const fg_found_driver *driver) {
  double px = 1000 / w->view.shape.um;
  const fg_beam_edge *left = &beam->edges[FG_BEAM_LEFT], *tip = &beam->edges[FG_BEAM_TIP];
  return (fg_line_tone){.tone = w->tone,
                        .driver = driver,
                        .blur_along = px * (tip->count ? tip : left)->blur_mm,
                        .blur_across = px * left->blur_mm};
}

static fg_status measure_edge(fg_context *ctx, const flat_work *w, const fg_stretch *place,
                              const fg_found_driver *driver, fg_line_found *found, fg_beam *beam,
                              fg_beam_edge *edge) {
  const fg_line_tone tone = tone_beside(w, beam, driver);
  fg_stretch end = *place, *side = &end;
  fg_disc_edge *at = &found->edge;
  *found = (fg_line_found){.next_px = INFINITY};
  fg_status status = fg_line_end_measure(ctx, &w->view, &tone, side, found);
  if (status == FG_OK) {
    double overlap_px = fg_line_edge_overlap(found->next_px, at->blur_px);
    if (overlap_px > NARROW_PX) beam->flags |= FG_BEAM_NARROW_CUT;
    mend_curved(w, &beam->edges[FG_BEAM_LEFT], at);
    u_linear(w, at);
    fg_picture_merge(&beam->picture, &at->picture);
    status = copy_edge(ctx, w, side, at, overlap_px, edge);
  }
  fg_disc_edge_free(at);
  return status == FG_ERR_NUMERIC ? FG_OK : status;
}

/* Measures tip and floor, which are short, with the driver of a long edge, so that its error
 * cancels between them. */
static fg_status measure_sides(fg_context *ctx, const flat_work *w, const fg_beam_place *place,
                               fg_beam *beam, fg_found_driver drivers[2]) {
  fg_line_found found;
  fg_found_driver driver = w->common ? *w->common : (fg_found_driver){.found = false};
  for (int side = 0; side < FG_BEAM_SIDES; side++) {
    if (!place->there[side]) continue;
    const fg_found_driver *known = w->common || side >= FG_BEAM_TIP ? &driver : NULL;
    FG_TRY(measure_edge(ctx, w, &place->sides[side], known, &found, beam, &beam->edges[side]));
    if (side >= FG_BEAM_TIP) continue;
    drivers[side] = found.driver;
    if (!driver.found) driver = found.driver;
  }
  return FG_OK;
}

/* Returns true when an edge of it ends at the border of the scan, which is the view's; its other
 * borders are far away. */
static bool is_at_border(const flat_work *w, const fg_beam_place *place) {
  const double high[2] = {(double)w->view.tiles->width_px - BORDER_PX,
                          (double)w->view.tiles->height_px - BORDER_PX};
  for (int side = 0; side < FG_BEAM_SIDES; side++)
    for (int end = 0; end < 2 && place->there[side]; end++) {
      fg_point p = end ? place->sides[side].to : place->sides[side].from;
      double x = p.x / w->view.shape.scale[0], y = p.y / w->view.shape.scale[1];
      if (x < BORDER_PX || y < BORDER_PX || x > high[0] || y > high[1]) return true;
    }
  return false;
}

/* Measures the edges of one beam, and its place as far as it is known. */
static fg_status measure_edges(fg_context *ctx, void *shared, size_t i) {
  flat_work *w = shared;
  const fg_beam_place *place = &w->places.list[i];
  fg_beam *beam = &w->beams[i];
  beam->root_mm = to_mm(w, place->root);
  beam->tip_mm = to_mm(w, place->tip);
  beam->direction_deg =
      atan2(beam->tip_mm.y - beam->root_mm.y, beam->tip_mm.x - beam->root_mm.x) * 180 / M_PI;
  beam->picture = fg_picture_unknown();
  if (is_at_border(w, place)) beam->flags |= FG_BEAM_TOUCHES_BORDER;
  return measure_sides(ctx, w, place, beam, w->drivers + 2 * i);
}

static fg_status make_part(fg_context *ctx, flat_work *w, size_t r, fg_flat_part *part) {
  const fg_rim *rim = &w->rims.list[r];
  const fg_polygon *polygon = &w->polygons[r];
  size_t count = 0;
  part->hole = rim->hole;
  part->touches_border = rim->touches_border;
  for (int k = 0; k < 4; k++)
    part->box_px[k] = rim->box_px[k] + (k < 2 ? w->origin_px[k] : 0);
  FG_TRY(fg_memory_allocate(ctx, polygon->count, sizeof *part->corners, (void **)&part->corners));
  for (size_t i = 0; i < polygon->count; i++)
    part->corners[part->corner_count++] = to_mm(w, rim->points[polygon->sides[i].first]);
  for (size_t i = 0; i < w->places.count; i++)
    count += w->place_rim[i] == r;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *part->beams, (void **)&part->beams));
  for (size_t i = 0; i < w->places.count; i++) {
    if (w->place_rim[i] != r) continue;
    part->beams[part->beam_count++] = w->beams[i];
    memset(&w->beams[i], 0, sizeof w->beams[i]);
  }
  return FG_OK;
}

static fg_status make_parts(fg_context *ctx, flat_work *w, bool light, fg_flat_parts *parts) {
  for (size_t r = 0; r < w->rims.count; r++) {
    fg_flat_part *part;
    FG_TRY(fg_memory_reserve(ctx, parts->count + 1, sizeof *parts->list, &parts->capacity,
                             (void **)&parts->list));
    part = &parts->list[parts->count++];
    *part = (fg_flat_part){.light = light};
    FG_TRY(make_part(ctx, w, r, part));
  }
  parts->specks += w->rims.specks;
  return FG_OK;
}

/* Finds the common tone. A stated tone stays in force; its contradiction by the edges is their
 * uncertainty. */
static void find_common_tone(flat_work *w, size_t count) {
  const fg_tone shown = fg_tone_pool_within(w->tones, count, range_of_gamma);
  w->bent_gamma = 1;
  w->tone = shown;
  if (w->m->design.tone != FG_TONE_LINEAR) return;
  w->bent_gamma = shown.gamma;
  w->tone = fg_tone_linear();
  w->tone.found = shown.found;
  w->tone.u_found = shown.u_found;
}

static bool is_masked(const fg_found_driver *driver) {
  return driver->found && driver->driver.values[FG_DRIVER_AMOUNT] != 0;
}

/* A driver affects all edges. Deviations of half of them or less are their own roughness. A tone
 * curve with an unsharp mask can imitate a sharper edge without either, so where half of the edges
 * or less have a mask, none has: all take the model without one that tells the edge's place best,
 * if most of the others have one. False: every edge keeps its own. */
static bool find_common_driver(const flat_work *w, size_t count, fg_found_driver *common) {
  size_t driven = 0, masked = 0;
  *common = (fg_found_driver){.found = false};
  for (size_t i = 0; i < count; i++) {
    const fg_found_driver *driver = &w->drivers[i];
    driven += driver->found;
    masked += is_masked(driver);
    bool better = !common->found || driver->u_edge_px < common->u_edge_px;
    if (driver->found && !is_masked(driver) && better) *common = *driver;
  }
  if (!driven || (2 * driven > count && (!masked || 2 * masked > count))) return false;
  if (2 * (driven - masked) <= count - masked) *common = (fg_found_driver){.found = false};
  return true;
}

static fg_status measure_places(fg_context *ctx, flat_work *w, unsigned threads) {
  size_t count = w->places.count;
  fg_found_driver common;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *w->beams, (void **)&w->beams));
  FG_TRY(fg_memory_allocate(ctx, 2 * count, sizeof *w->tones, (void **)&w->tones));
  FG_TRY(fg_memory_allocate(ctx, 2 * count, sizeof *w->drivers, (void **)&w->drivers));
  FG_TRY(fg_parallel_run(ctx, threads, 2 * count, find_tone, w));
  find_common_tone(w, 2 * count);
  FG_TRY(fg_parallel_run(ctx, threads, count, measure_edges, w));
  if (!find_common_driver(w, 2 * count, &common)) return FG_OK;
  w->common = &common;
  for (size_t i = 0; i < count; i++)
    fg_beam_free(&w->beams[i]);
  memset(w->beams, 0, count * sizeof *w->beams);
  fg_status status = fg_parallel_run(ctx, threads, count, measure_edges, w);
  w->common = NULL;
  return status;
}

static void free_work(flat_work *w) {
  for (size_t i = 0; w->polygons && i < w->rims.count; i++)
    fg_polygon_free(&w->polygons[i]);
  for (size_t i = 0; w->beams && i < w->places.count; i++)
    fg_beam_free(&w->beams[i]);
  fg_rims_free(&w->rims);
  free(w->polygons);
  free(w->places.list);
  free(w->place_rim);
  free(w->tones);
  free(w->beams);
  free(w->drivers);
}

fg_status fg_flat_island_measure(fg_context *ctx, const fg_flat_island *island,
                                 const fg_measurement *m, unsigned threads, fg_flat_parts *parts) {
  const fg_two_levels levels = fg_two_levels_find(island->view, island->island);
  flat_work w = {.view = {.tiles = island->view,
                          .shape = fg_pixel_shape_of(m->dpi),
                          .middle = 0.5 * (levels.low + levels.high)},
                 .origin_px = island->origin_px,
                 .m = m};
  double background = island->background;
  bool light = fabs(background - levels.low) <= fabs(background - levels.high);
  const fg_rim_options options = {w.view.middle, light, min_px(m, &w.view.shape)};
  fg_status status = FG_OK;
  if (!levels.found) {
    parts->specks++;
    return FG_OK;
  }
  FG_TRY_EXIT(fg_rims_trace(ctx, island->view, island->island, &options, &w.rims));
  FG_TRY_EXIT(find_places(ctx, &w, threads));
  FG_TRY_EXIT(measure_places(ctx, &w, threads));
  FG_TRY_EXIT(make_parts(ctx, &w, light, parts));
exit:
  free_work(&w);
  return status;
}

static void free_part(fg_flat_part *part) {
  for (size_t i = 0; i < part->beam_count; i++)
    fg_beam_free(&part->beams[i]);
  free(part->beams);
  free(part->corners);
  memset(part, 0, sizeof *part);
}

void fg_flat_parts_free(fg_flat_parts *parts) {
  for (size_t i = 0; i < parts->count; i++)
    free_part(&parts->list[i]);
  free(parts->list);
  memset(parts, 0, sizeof *parts);
}

fg_status fg_flat_parts_move(fg_context *ctx, fg_flat_parts *from, fg_flat_parts *to) {
  FG_TRY(fg_memory_reserve(ctx, to->count + from->count, sizeof *to->list, &to->capacity,
                           (void **)&to->list));
  if (from->count) memcpy(to->list + to->count, from->list, from->count * sizeof *from->list);
  to->count += from->count;
  to->specks += from->specks;
  from->count = 0;
  return FG_OK;
}

/* By the crossings of a ray to the right. */
static bool is_inside(const fg_flat_part *outline, fg_point p) {
  bool inside = false;
  for (size_t i = 0; i < outline->corner_count; i++) {
    fg_point a = outline->corners[i];
    fg_point b = outline->corners[i + 1 < outline->corner_count ? i + 1 : 0];
    if ((a.y > p.y) == (b.y > p.y)) continue;
    if (p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
  }
  return inside;
}

/* Returns the smallest outline around a hole, or the outline itself; NULL without one. */
static fg_flat_part *find_outline(const fg_flat_parts *parts, fg_flat_part *part) {
  fg_flat_part *best = NULL;
  if (!part->hole) return part;
  for (size_t i = 0; i < parts->count; i++) {
    fg_flat_part *other = &parts->list[i];
    if (other->hole || !is_inside(other, part->corners[0])) continue;
    if (!best || other->box_px[2] * other->box_px[3] < best->box_px[2] * best->box_px[3])
      best = other;
  }
  return best;
}

/* Moves a hole's beams to its outline. */
static fg_status move_beams(fg_context *ctx, fg_flat_part *from, fg_flat_part *to) {
  size_t capacity = to->beam_count;
  if (from == to || !from->beam_count) return FG_OK;
  FG_TRY(fg_memory_reserve(ctx, to->beam_count + from->beam_count, sizeof *to->beams, &capacity,
                           (void **)&to->beams));
  memcpy(to->beams + to->beam_count, from->beams, from->beam_count * sizeof *from->beams);
  to->beam_count += from->beam_count;
  from->beam_count = 0;
  return FG_OK;
}

static void place_foil(const fg_flat_part *part, const fg_measurement *m, fg_foil *foil) {
  for (int k = 0; k < 4; k++) {
    foil->strip.box_px[k] = part->box_px[k];
    foil->place_mm[k] = (double)part->box_px[k] * 25.4 / m->dpi[k % 2];
  }
  if (part->touches_border) foil->flags |= FG_FOIL_TOUCHES_BORDER;
}

static fg_status make_foil(fg_context *ctx, fg_flat_part *part, fg_measurement *m) {
  fg_foil *foil = &m->foils[m->foil_count++];
  fg_foil_give_up(foil, "");
  foil->flags = 0;
  foil->strip.picture = fg_picture_unknown();
  place_foil(part, m, foil);
  foil->beams = part->beams;
  foil->beam_count = part->beam_count;
  for (size_t i = 0; i < foil->beam_count; i++)
    fg_picture_merge(&foil->strip.picture, &foil->beams[i].picture);
  part->beams = NULL;
  part->beam_count = 0;
  return fg_beams_measure(ctx, &m->design, foil);
}

fg_status fg_flat_foils_assemble(fg_context *ctx, fg_flat_parts *parts, fg_measurement *m) {
  size_t light = 0;
  for (size_t i = 0; i < parts->count; i++) {
    fg_flat_part *outline = find_outline(parts, &parts->list[i]);
    if (outline) FG_TRY(move_beams(ctx, &parts->list[i], outline));
    light += parts->list[i].light;
  }
  m->light_on_dark = 2 * light >= parts->count;
  m->specks += parts->specks;
  FG_TRY(fg_memory_allocate(ctx, parts->count, sizeof *m->foils, (void **)&m->foils));
  for (size_t i = 0; i < parts->count; i++) {
    if (parts->list[i].beam_count)
      FG_TRY(make_foil(ctx, &parts->list[i], m));
    else if (!parts->list[i].hole)
      m->specks++;
  }
  return FG_OK;
}
