/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/colour_stations.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

/* Length of a cross-section along the strip: it must hold enough pixels for its own fit. */
#define ALONG_PX 3.0
#define RUN_PX   5.0 /* reach to either side for the strip's bend */
/* Max number; more are of no use, and cost time. */
#define STATIONS_MAX 20000
/* Reach of the pixels from the edges: that of their blur, and the possible distance of the
 * channels. */
#define REACH_BLURS 3.5
#define APART_PX    4.0
#define REACH_MAX   24.0

typedef struct chooser {
  const fg_measurement *m;
  double pixel_mm[2];
  fg_colour_stations *to;
  double stride; /* in lengths of a cross-section */
} chooser;

static fg_status add_station(fg_context *ctx, const chooser *c, fg_colour_station *s) {
  fg_colour_stations *to = c->to;
  double up = fabs(s->ny) * s->half_across_px + fabs(s->nx) * s->half_along_px;
  double wide = fabs(s->nx) * s->half_across_px + fabs(s->ny) * s->half_along_px;
  s->top = (int64_t)floor(s->y - up);
  s->bottom = (int64_t)ceil(s->y + up);
  if (s->top < 0 || s->bottom >= c->m->file.height_px || s->x - wide < 0 ||
      s->x + wide > (double)(c->m->file.width_px - 1))
    return FG_OK;
  FG_TRY(
      fg_memory_reserve(ctx, to->count + 1, sizeof *to->list, &to->capacity, (void **)&to->list));
  to->list[to->count++] = *s;
  if (s->bottom - s->top + 1 > to->rows_max) to->rows_max = s->bottom - s->top + 1;
  return FG_OK;
}

static double reach_px(double blur_px) {
  return fmin(REACH_BLURS * blur_px + APART_PX, REACH_MAX);
}

/* The strip's width and blur, px, of all its directions. */
static fg_colour_known known_of(const fg_strip *strip, const double pixel_mm[2]) {
  double mm = sqrt(pixel_mm[0] * pixel_mm[1]);
  return (fg_colour_known){
      .half_width_px = 0.5 * strip->thickness_mm / mm,
      .blur_px = fmax(0.5, 0.5e-3 * (strip->blur_left_um + strip->blur_right_um) / mm)};
}

static fg_colour_station across_strip(const chooser *c, const fg_station *from,
                                      const fg_colour_known *known, int part) {
  fg_point middle = {0.5 * (from->left.x + from->right.x), 0.5 * (from->left.y + from->right.y)};
  double nx = from->normal.x * c->pixel_mm[0], ny = from->normal.y * c->pixel_mm[1];
  double norm = hypot(nx, ny), mm = sqrt(c->pixel_mm[0] * c->pixel_mm[1]);
  /* The strip has the number of pixels along this normal, as the resolutions may differ. */
  double share =
      mm * (from->normal.x * nx / c->pixel_mm[0] + from->normal.y * ny / c->pixel_mm[1]) / norm;
  fg_colour_known here = {known->half_width_px * share, known->blur_px};
  return (fg_colour_station){.x = middle.x / c->pixel_mm[0],
                             .y = middle.y / c->pixel_mm[1],
                             .nx = nx / norm,
                             .ny = ny / norm,
                             .half_along_px = 0.5 * ALONG_PX,
                             .half_across_px = here.half_width_px + reach_px(here.blur_px),
                             .known = here,
                             .part = part};
}

/* Turns the normal to the strip's direction at a cross-section by its neighbours, and finds its
 * bend there. Where the strip begins to bend, the normal of the edges' search is some 0.02 rad off,
 * and a shift along the strip would look like one across it. */
static void find_run(const chooser *c, const fg_strip *strip, size_t i, fg_colour_station *s) {
  double mm = sqrt(c->pixel_mm[0] * c->pixel_mm[1]), across[2], along[2];
  size_t reach = (size_t)fmax(1, ceil(RUN_PX * mm / strip->step_mm));
  if (i < reach || i + reach >= strip->count) return;
  for (int side = 0; side < 2; side++) {
    const fg_station *at = &strip->stations[side ? i + reach : i - reach];
    if (at->weight <= 0) return;
    double dx = 0.5 * (at->left.x + at->right.x) / c->pixel_mm[0] - s->x;
    double dy = 0.5 * (at->left.y + at->right.y) / c->pixel_mm[1] - s->y;
    across[side] = dx * s->nx + dy * s->ny;
    along[side] = dy * s->nx - dx * s->ny;
  }
  /* The parabola through three points. */
  double a = along[0], b = along[1];
  if (a * b * (a - b) == 0) return;
  s->bend = 2 * (across[0] / a - across[1] / b) / (a - b);
  double slope = across[0] / a - 0.5 * s->bend * a, norm = hypot(1, slope), nx = s->nx;
  s->nx = (nx + slope * s->ny) / norm;
  s->ny = (s->ny - slope * nx) / norm;
}

/* Adds a foil's cross-sections, but for cut or touched ones. */
static fg_status add_foil_stations(fg_context *ctx, const chooser *c, const fg_foil *foil,
                                   int part) {
  const fg_strip *strip = &foil->strip;
  const double mm = sqrt(c->pixel_mm[0] * c->pixel_mm[1]);
  fg_colour_known known = known_of(strip, c->pixel_mm);
  if (!strip->count || !(strip->step_mm > 0) || !isfinite(known.half_width_px)) return FG_OK;
  size_t step = (size_t)fmax(1, ceil(c->stride * ALONG_PX * mm / strip->step_mm));
  for (size_t i = step / 2; i < strip->count; i += step) {
    if (strip->stations[i].weight <= 0) continue;
    fg_colour_station s = across_strip(c, &strip->stations[i], &known, part);
    find_run(c, strip, i, &s);
    if (isfinite(s.x) && isfinite(s.y)) FG_TRY(add_station(ctx, c, &s));
  }
  return FG_OK;
}

static fg_status add_disc(fg_context *ctx, const chooser *c, const fg_disc *disc, int part) {
  const double mm = sqrt(c->pixel_mm[0] * c->pixel_mm[1]);
  double round_px = 2 * M_PI * disc->radius_mm / mm, blur = fmax(0.5, 1e-3 * disc->blur_um / mm);
  if (!disc->station_count) return FG_OK;
  size_t step =
      (size_t)fmax(1, ceil(c->stride * ALONG_PX * (double)disc->station_count / fmax(1, round_px)));
  for (size_t i = 0; i < disc->station_count; i += step) {
    const fg_disc_point *point = &disc->stations[i];
    double nx = (point->at.x - disc->centre_mm.x) * c->pixel_mm[0];
    double ny = (point->at.y - disc->centre_mm.y) * c->pixel_mm[1], norm = hypot(nx, ny);
    if (!point->used || norm == 0) continue;
    fg_colour_station s = {.x = point->at.x / c->pixel_mm[0],
                           .y = point->at.y / c->pixel_mm[1],
                           .nx = nx / norm,
                           .ny = ny / norm,
                           .half_along_px = 0.5 * ALONG_PX,
                           .half_across_px = reach_px(blur) + APART_PX,
                           .known = {.half_width_px = INFINITY, .blur_px = blur},
                           .part = part,
                           .outlier = true};
    FG_TRY(add_station(ctx, c, &s));
  }
  return FG_OK;
}

/* Returns the distance of cross-sections that keeps their number below the maximum. */
static double find_stride(const fg_measurement *m, const double pixel_mm[2]) {
  double length_mm = 0;
  for (size_t i = 0; i < m->foil_count; i++)
    length_mm += (double)m->foils[i].strip.count * m->foils[i].strip.step_mm;
  for (size_t i = 0; i < m->disc_count; i++)
    length_mm += 2 * M_PI * m->discs[i].radius_mm;
  return fmax(1, length_mm / sqrt(pixel_mm[0] * pixel_mm[1]) / ALONG_PX / STATIONS_MAX);
}

static int compare_bottoms(const void *a, const void *b, void *stations) {
  const fg_colour_station *list = stations;
  size_t i = *(const size_t *)a, k = *(const size_t *)b;
  if (list[i].bottom != list[k].bottom) return list[i].bottom < list[k].bottom ? -1 : 1;
  return (i > k) - (i < k);
}

static fg_status sort_stations(fg_context *ctx, fg_colour_stations *stations) {
  FG_TRY(
      fg_memory_allocate(ctx, stations->count, sizeof *stations->order, (void **)&stations->order));
  for (size_t i = 0; i < stations->count; i++)
    stations->order[i] = i;
  if (stations->count)
    qsort_r(stations->order, stations->count, sizeof *stations->order, compare_bottoms,
            stations->list);
  return FG_OK;
}

fg_status fg_colour_stations_choose(fg_context *ctx, const fg_measurement *m,
                                    fg_colour_stations *stations) {
  fg_status status = FG_OK;
  *stations = (fg_colour_stations){0};
  chooser c = {.m = m, .pixel_mm = {25.4 / m->dpi[0], 25.4 / m->dpi[1]}, .to = stations};
  c.stride = find_stride(m, c.pixel_mm);
  for (size_t i = 0; i < m->foil_count; i++)
    FG_TRY_EXIT(add_foil_stations(ctx, &c, &m->foils[i], (int)i));
  for (size_t i = 0; i < m->disc_count; i++)
    FG_TRY_EXIT(add_disc(ctx, &c, &m->discs[i], (int)(m->foil_count + i)));
  FG_TRY_EXIT(sort_stations(ctx, stations));
exit:
  if (status != FG_OK) fg_colour_stations_free(stations);
  return status;
}

void fg_colour_stations_free(fg_colour_stations *stations) {
  free(stations->list);
  free(stations->order);
  *stations = (fg_colour_stations){0};
}
