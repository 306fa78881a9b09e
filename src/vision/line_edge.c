/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/line_edge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "vision/picture.h"
#include "vision/round_end.h"

/* Min number of sectors for a driver's model, so those of a short stretch are shorter. */
enum { SECTORS_MAX = 24, SECTORS_WANTED = 10, STATIONS_MIN = 4, PLACES = 9 };
#define SECTOR_PX     96.0
#define SECTOR_MIN_PX 24.0
#define STATION_PX    1.5
/* Min length of the stations of a stretch that is too short for STATIONS_MIN long ones. */
#define STATION_MIN_PX 1.0
#define REACH_PX       15.0 /* of the band, on either side */
#define REACH_MIN      2.5
/* End of the band before the next edge, as a share of its distance. */
#define NEXT_EDGE_SHARE 0.45
/* End of an arc's band, as a share of its radius. */
#define RADIUS_SHARE 0.6
/* End of the band at a cut's end, as a share of the place of its darkest or brightest light. */
#define END_REACH 1.2
/* Min reach for levels with slopes. */
#define SLOPE_REACH_PX 10.0
#define CONTRAST_MIN   6.0
/* Dust differs from its side by this share of the contrast, at so many blurs and px from the edge.
 */
#define DUST_SHARE 0.2
#define DUST_BLURS 3.0
#define DUST_PX    1.5

/* The stretch as the band's frame: a straight one, or an arc about a centre. */
typedef struct frame {
  fg_point from, along; /* of a straight one: its start and direction */
  fg_point centre;      /* of an arc */
  double radius, start, length;
  const fg_round_end *end; /* NULL: pixels keep their distance from the stretch */
} frame;

double fg_stretch_length(const fg_stretch *s) {
  double chord = hypot(s->to.x - s->from.x, s->to.y - s->from.y);
  if (isinf(s->radius)) return chord;
  return 2 * s->radius * asin(fmin(1, 0.5 * chord / s->radius));
}

static frame frame_of(const fg_stretch *s) {
  double chord = hypot(s->to.x - s->from.x, s->to.y - s->from.y);
  frame f = {.from = s->from,
             .along = {(s->to.x - s->from.x) / chord, (s->to.y - s->from.y) / chord},
             .radius = s->radius,
             .length = fg_stretch_length(s)};
  if (isinf(s->radius)) return f;
  double off = sqrt(fmax(0, s->radius * s->radius - 0.25 * chord * chord));
  /* Outwards of the material is (y, -x) of the stretch's direction. */
  f.centre = (fg_point){0.5 * (s->from.x + s->to.x) + off * f.along.y,
                        0.5 * (s->from.y + s->to.y) - off * f.along.x};
  f.start = atan2(s->from.y - f.centre.y, s->from.x - f.centre.x);
  return f;
}

/* Point of the frame. The material lies outside of an arc, so it runs the other way round than a
 * disc's edge. */
static fg_point point_of(const frame *f, double along, double outwards) {
  if (isinf(f->radius))
    return (fg_point){f->from.x + along * f->along.x + outwards * f->along.y,
                      f->from.y + along * f->along.y - outwards * f->along.x};
  double angle = f->start - along / f->radius, r = f->radius - outwards;
  return (fg_point){f->centre.x + r * cos(angle), f->centre.y + r * sin(angle)};
}

fg_point fg_stretch_point(const fg_stretch *stretch, double share, double outwards) {
  frame f = frame_of(stretch);
  return point_of(&f, share * f.length, outwards);
}

/* Place of a pixel in the band. */
static void band_place(const frame *f, double x, double y, double *along, double *outwards) {
  if (isinf(f->radius)) {
    double dx = x - f->from.x, dy = y - f->from.y;
    *along = dx * f->along.x + dy * f->along.y;
    *outwards = dx * f->along.y - dy * f->along.x;
    return;
  }
  double dx = x - f->centre.x, dy = y - f->centre.y;
  *along = f->radius * remainder(f->start - atan2(dy, dx), 2 * M_PI);
  *outwards = f->radius - hypot(dx, dy);
}

/* Distance across of a pixel beside the end of a cut, by its light. */
static double place_by_light(const frame *f, double x, double y) {
  double dx = x - f->centre.x, dy = y - f->centre.y, r = hypot(dx, dy);
  double off = atan2(dy, dx) - (f->start - 0.5 * f->length / f->radius);
  return fg_round_end_distance(f->end, r * cos(off), r * sin(off));
}

/* Narrows [from, to] to the part with low <= at + rate x <= high. */
static void clip_range(double at, double rate, double low, double high, double *from, double *to) {
  if (fabs(rate) < 1e-12) {
    if (at < low || at > high) *to = *from - 1;
    return;
  }
  double a = (low - at) / rate, b = (high - at) / rate;
  *from = fmax(*from, fmin(a, b));
  *to = fmin(*to, fmax(a, b));
}

/* Columns of a row that the band may hold. */
static void find_columns(const frame *f, double reach, double v, double *from, double *to) {
  if (isinf(f->radius)) {
    double dy = v - f->from.y;
    clip_range(dy * f->along.y - f->from.x * f->along.x, f->along.x, 0, f->length, from, to);
    clip_range(-dy * f->along.x - f->from.x * f->along.y, f->along.y, -reach, reach, from, to);
    return;
  }
  double far = f->radius + reach, dv = v - f->centre.y;
  clip_range(-f->centre.x, 1, -sqrt(fmax(0, far * far - dv * dv)),
             sqrt(fmax(0, far * far - dv * dv)), from, to);
}

static fg_status collect_row(fg_context *ctx, const fg_disc_work *work, const frame *f, int64_t y,
                             fg_ring *ring) {
  const double *scale = work->shape->scale;
  double v = (double)y * scale[1], from = 0, to = (double)(work->tiles->width_px - 1) * scale[0];
  find_columns(f, ring->reach_px, v, &from, &to);
  int64_t first = (int64_t)ceil(from / scale[0]), last = (int64_t)floor(to / scale[0]);
  if (first > last) return FG_OK;
  FG_TRY(fg_memory_reserve(ctx, ring->count + (size_t)(last - first + 1), sizeof *ring->pixels,
                           &ring->capacity, (void **)&ring->pixels));
  for (int64_t x = first; x <= last; x++) {
    float value = fg_tiles_pixel(work->tiles, x, y);
    double along, outwards;
    if (isnan(value)) continue;
    band_place(f, (double)x * scale[0], v, &along, &outwards);
    if (!(along >= 0 && along < f->length)) continue;
    if (f->end) outwards = place_by_light(f, (double)x * scale[0], v);
    if (fabs(outwards) > ring->reach_px) continue;
    size_t station = (size_t)(along / f->length * (double)ring->station_count);
    if (station >= ring->station_count) station = ring->station_count - 1;
    ring->pixels[ring->count++] = (fg_ring_pixel){(float)outwards, value, (int32_t)station};
  }
  return FG_OK;
}

/* Rows that the band may reach. */
static void find_rows(const fg_disc_work *work, const frame *f, int64_t rows[2]) {
  double low = INFINITY, high = -INFINITY, reach = work->ring.reach_px;
  for (int i = 0; i < PLACES; i++)
    for (int side = -1; side <= 1; side += 2) {
      double y = point_of(f, f->length * i / (PLACES - 1), side * reach).y;
      low = fmin(low, y);
      high = fmax(high, y);
    }
  double spare = isinf(f->radius) ? 0 : reach;
  rows[0] = (int64_t)fmax(0, ceil((low - spare) / work->shape->scale[1]));
  rows[1] = (int64_t)fmin((double)work->tiles->height_px - 1,
                          floor((high + spare) / work->shape->scale[1]));
}

static fg_status collect_band(fg_context *ctx, fg_disc_work *work, const frame *f) {
  int64_t rows[2];
  work->ring.count = 0;
  find_rows(work, f, rows);
  for (int64_t y = rows[0]; y <= rows[1]; y++)
    FG_TRY(collect_row(ctx, work, f, y, &work->ring));
  return FG_OK;
}

static double pixel_at(const fg_disc_work *work, fg_point at) {
  return (double)fg_tiles_pixel(work->tiles, (int64_t)lround(at.x / work->shape->scale[0]),
                                (int64_t)lround(at.y / work->shape->scale[1]));
}

/* Distance of the next edge from the stretch, on one side: where the count passes the middle. */
static double next_edge(const fg_disc_work *work, const frame *f, double along, int side,
                        double middle) {
  bool bright = pixel_at(work, point_of(f, along, 3 * side)) > middle;
  for (double out = 4; out < REACH_PX / NEXT_EDGE_SHARE; out++) {
    double value = pixel_at(work, point_of(f, along, side * out));
    if (!isnan(value) && (value > middle) != bright) return out - 0.5;
  }
  return INFINITY;
}

/* Half of the band's width: the median over places of the room before the next edge. The light of a
 * cut's end contains the cut's other side. */
static double find_reach(const fg_disc_work *work, const frame *f, double middle, double *near) {
  double void_px = f->end ? END_REACH * fg_round_end_distance(f->end, 0, 0) : INFINITY;
  double reach = fmin(REACH_PX, f->end ? void_px : RADIUS_SHARE * f->radius);
  *near = INFINITY;
  for (int side = -1; side <= (f->end ? -1 : 1); side += 2) {
    double next[PLACES];
    for (int i = 0; i < PLACES; i++)
      next[i] = next_edge(work, f, f->length * (i + 0.5) / PLACES, side, middle);
    double typical = fg_select(next, PLACES, PLACES / 2);
    *near = fmin(*near, typical);
    reach = fmin(reach, NEXT_EDGE_SHARE * typical);
  }
  return fmax(reach, REACH_MIN);
}

/* Shift of an edge by the next one's blur. At the end of the band the next edge has changed the
 * level by Phi(-(1 - share) next / s) of the contrast. Half of that, over the profile's slope, is a
 * shift. Twice that covers the errors of renders. */
double fg_line_edge_overlap(double next_px, double blur_px) {
  double taken = 0.5 * erfc((1 - NEXT_EDGE_SHARE) * next_px / blur_px * M_SQRT1_2);
  return isinf(next_px) ? 0 : taken * blur_px * sqrt(2 * M_PI);
}

static size_t good_sectors(const fg_disc_work *work) {
  size_t good = 0;
  for (size_t s = 0; s < work->ring.sector_count; s++) {
    fg_step_fit *fit = &work->sectors[s];
    double step = fit->values[FG_STEP_OUTSIDE] - fit->values[FG_STEP_INSIDE];
    fit->good = fit->good && fabs(step) > CONTRAST_MIN;
    good += fit->good;
  }
  return good;
}

static fg_status check_sectors(fg_context *ctx, const fg_disc_work *work) {
  size_t good = good_sectors(work);
  if (good > 0 && 2 * good >= work->ring.sector_count) return FG_OK;
  return fg_fail(ctx, FG_ERR_NUMERIC, "no edge along a side");
}

/* Median of a value over the good sectors. */
static double typical_value(const fg_disc_work *work, int value) {
  double values[SECTORS_MAX];
  size_t n = 0;
  for (size_t s = 0; s < work->ring.sector_count; s++)
    if (work->sectors[s].good) values[n++] = work->sectors[s].values[value];
  return fg_select(values, n, n / 2);
}

static double level_count(const fg_disc_work *work, int value) {
  return 255 * pow(fmax(typical_value(work, value), 0) / 255, 1 / work->gamma);
}

/* Drops pixels of dust beside the edge: off the edge's blur, with a count that is not that of its
 * side. They would bias the levels of their sector. True when there were any. */
static bool drop_dust(fg_disc_work *work) {
  fg_ring *ring = &work->ring;
  double inside = level_count(work, FG_STEP_INSIDE), outside = level_count(work, FG_STEP_OUTSIDE);
  double edge = typical_value(work, FG_STEP_EDGE), blur = typical_value(work, FG_STEP_BLUR);
  double limit = DUST_SHARE * fabs(outside - inside), clear = DUST_BLURS * blur + DUST_PX;
  size_t kept = 0;
  for (size_t i = 0; i < ring->count; i++) {
    const fg_ring_pixel *p = &ring->pixels[i];
    double off = (double)p->across_px - edge, level = off > 0 ? outside : inside;
    if (fabs(off) > clear && fabs((double)p->value - level) > limit) continue;
    ring->pixels[kept++] = *p;
  }
  bool any = kept < ring->count;
  ring->count = kept;
  return any;
}

static size_t count_sectors(double length) {
  double wanted = fmin(SECTORS_WANTED, floor(length / SECTOR_MIN_PX));
  return (size_t)fmin(fmax(fmax(length / SECTOR_PX, wanted), 1), SECTORS_MAX);
}

static size_t count_stations(double length, size_t sectors) {
  size_t per_sector = (size_t)(length / STATION_PX / (double)sectors);
  return sectors * (sectors > 1 || per_sector > STATIONS_MIN ? per_sector : STATIONS_MIN);
}

/* Collects the band with its profiles, and fits a step without slopes to each. */
static fg_status open_band(fg_context *ctx, const fg_stretch *stretch, const fg_round_end *end,
                           double middle, fg_disc_work *work, double *next_px) {
  frame f = frame_of(stretch);
  f.end = end;
  fg_ring *ring = &work->ring;
  if (!(f.length >= STATIONS_MIN * STATION_MIN_PX))
    return fg_fail(ctx, FG_ERR_NUMERIC, "a side is too short");
  work->open = true;
  ring->circle.radius = stretch->radius;
  ring->reach_px = find_reach(work, &f, middle, next_px);
  ring->sector_count = count_sectors(f.length);
  ring->station_count = count_stations(f.length, ring->sector_count);
  FG_TRY(collect_band(ctx, work, &f));
  FG_TRY(fg_disc_stack_sectors(ctx, work));
  const unsigned held = 1u << FG_STEP_GAMMA | 1u << FG_STEP_SLOPE_IN | 1u << FG_STEP_SLOPE_OUT;
  fg_disc_fit_sectors(work, held);
  FG_TRY(check_sectors(ctx, work));
  if (!drop_dust(work)) return FG_OK;
  FG_TRY(fg_disc_stack_sectors(ctx, work));
  fg_disc_fit_sectors(work, held);
  return check_sectors(ctx, work);
}

fg_status fg_line_edge_tone(fg_context *ctx, const fg_line_view *view, const fg_stretch *stretch,
                            fg_tone *tone) {
  fg_disc_work work = {.tiles = view->tiles, .shape = &view->shape, .gamma = 1};
  double next_px;
  fg_status status = FG_OK;
  FG_TRY_EXIT(open_band(ctx, stretch, NULL, view->middle, &work, &next_px));
  FG_TRY_EXIT(fg_disc_find_tone(ctx, &work, tone));
exit:
  fg_disc_work_free(&work);
  return status;
}

/* Fits slopes only where they are significant and the band is wide enough to tell them from the
 * edge's blur. */
static fg_status find_shape(fg_context *ctx, fg_disc_work *work) {
  unsigned held = 1u << FG_STEP_GAMMA;
  if (work->ring.reach_px < SLOPE_REACH_PX) return FG_OK;
  fg_disc_fit_sectors(work, held);
  good_sectors(work);
  for (int side = 0; side < 2; side++)
    if (!fg_disc_has_slope(work, FG_STEP_SLOPE_IN + side)) held |= 1u << (FG_STEP_SLOPE_IN + side);
  fg_disc_fit_sectors(work, held);
  return check_sectors(ctx, work);
}

/* The edge of an open band. */
static fg_status solve_band(fg_context *ctx, fg_disc_work *work, const fg_stretch *stretch,
                            const fg_line_tone *tone, fg_disc_edge *edge) {
  FG_TRY(find_shape(ctx, work));
  if (tone->driver) {
    FG_TRY(fg_disc_use_driver(ctx, work, tone->driver));
    FG_TRY(check_sectors(ctx, work));
  } else {
    FG_TRY(fg_disc_find_driver(ctx, work));
  }
  edge->gamma = work->gamma;
  bool by_light = fg_line_edge_has_end(stretch, tone);
  edge->circle = (fg_circle){.radius = by_light ? -INFINITY : -stretch->radius};
  edge->count = work->ring.station_count;
  FG_TRY(fg_memory_allocate(ctx, edge->count, sizeof *edge->stations, (void **)&edge->stations));
  FG_TRY(fg_disc_smooth_shape(ctx, work, edge));
  edge->level_u_px = fg_disc_level_uncertainty(work, &tone->tone, edge);
  return fg_disc_solve(ctx, work, edge);
}

bool fg_line_edge_has_end(const fg_stretch *stretch, const fg_line_tone *tone) {
  bool sharpened =
      tone->driver && tone->driver->found && tone->driver->driver.values[FG_DRIVER_AMOUNT] != 0;
  return isfinite(stretch->radius) && stretch->half_width > 0 && tone->blur_along > 0 &&
         tone->blur_across > 0 && !sharpened;
}

fg_status fg_line_edge_measure(fg_context *ctx, const fg_line_view *view, const fg_stretch *stretch,
                               const fg_line_tone *tone, fg_line_found *found) {
  const fg_round_end end = {stretch->radius, stretch->half_width, tone->blur_along,
                            tone->blur_across};
  const fg_round_end *by_light = fg_line_edge_has_end(stretch, tone) ? &end : NULL;
  fg_disc_work work = {.tiles = view->tiles,
                       .shape = &view->shape,
                       .gamma = tone->tone.gamma,
                       .blur_px = by_light ? end.blur_along : 0,
                       .linear = tone->tone.linear};
  fg_disc_edge *edge = &found->edge;
  memset(edge, 0, sizeof *edge);
  edge->picture = fg_picture_unknown();
  edge->gamma = tone->tone.gamma;
  fg_status status = open_band(ctx, stretch, by_light, view->middle, &work, &found->next_px);
  if (status == FG_OK) status = solve_band(ctx, &work, stretch, tone, edge);
  if (status == FG_OK) status = fg_picture_of_ring(ctx, &work, edge, &edge->picture);
  if (status == FG_OK && tone->tone.found > 0) {
    edge->picture.gamma = tone->tone.found;
    edge->picture.u_gamma = tone->tone.u_found;
  }
  if (status == FG_OK) fg_disc_describe_driver(&work, edge, &edge->picture);
  found->driver = fg_disc_found_driver(&work);
  fg_disc_work_free(&work);
  if (status != FG_OK) fg_disc_edge_free(edge);
  return status;
}
