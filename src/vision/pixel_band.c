/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/pixel_band.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

/* A run of stations whose normal lies nearer to one axis. Within it the line crosses every lattice
 * line of the other axis once: columns when the strip is level, rows when it is steep. Swapping x
 * and y turns the second case into the first (and mirrors: the normal's sign changes). */
typedef struct run {
  const fg_tiles *tiles;
  const fg_reference *reference;
  size_t first, last; /* stations; a pixel belongs to the run when its station does */
  bool steep;
  double reach_px;
} run;

/* A station as the run sees it: u along the lattice's running axis, v across. */
typedef struct view {
  double u, v, tu, tv;
} view;

static view view_station(const run *r, size_t i) {
  const fg_reference_station *s = &r->reference->stations[i];
  if (r->steep) return (view){s->y, s->x, s->ty, s->tx};
  return (view){s->x, s->y, s->tx, s->ty};
}

/* Finds the station nearest to a pixel, from a guess, and the pixel's distance from the line:
 * measured from that station's own osculating circle, at most half a step away, so that a line
 * whose curvature changes (the start of a fillet) does not bend the scale. */
static long project_pixel(const fg_reference *line, double x, double y, long station,
                          double *across) {
  double along, half = 0.5 * line->step_px;
  *across = INFINITY;
  for (int i = 0; i < 4; i++) {
    if (station < 0 || station >= (long)line->count) return -1;
    const fg_reference_station *s = &line->stations[station];
    double dx = x - s->x, dy = y - s->y;
    fg_reference_project(s->curvature, dx * s->tx + dy * s->ty, dy * s->tx - dx * s->ty, &along,
                         across);
    if (fabs(along) <= half) break;
    long move = (long)(along / line->step_px + (along > 0 ? 0.5 : -0.5));
    if (move == 0 || i == 3) break;
    station += move;
  }
  return station;
}

/* Collects all pixels of one lattice line that crosses the reference between stations i and i+1. */
static fg_status collect_line(fg_context *ctx, const run *r, size_t i, const view *a, const view *b,
                              int64_t u, fg_pixel_band *band) {
  double step = r->reference->step_px, f = ((double)u - a->u) / (b->u - a->u);
  double v0 = (1 - f) * a->v + f * b->v;
  double span = r->reach_px / fabs(a->tu) * 1.05 + 1;
  /* A first guess of the station: along the chord's direction, stretched by the curvature. */
  const fg_reference_station *s = &r->reference->stations[i];
  double slope = a->tv / step, bend = s->curvature * (r->steep ? -a->tu : a->tu);
  int64_t from = (int64_t)ceil(v0 - span), to = (int64_t)floor(v0 + span);
  if (from > to) return FG_OK;
  size_t needed = band->count + (size_t)(to - from + 1);
  FG_TRY(fg_memory_reserve(ctx, needed, sizeof *band->pixels, &band->capacity,
                           (void **)&band->pixels));
  for (int64_t v = from; v <= to; v++) {
    double dv = (double)v - v0, across;
    double guess = (double)i + f + dv * slope / (1 - bend * dv);
    int64_t x = r->steep ? v : u, y = r->steep ? u : v;
    long station = project_pixel(r->reference, (double)x, (double)y, (long)(guess + 0.5), &across);
    if (station < (long)r->first || station > (long)r->last) continue;
    if (fabs(across) > r->reach_px) continue;
    float value = fg_tiles_pixel(r->tiles, x, y);
    if (isnan(value)) continue;
    band->pixels[band->count++] = (fg_band_pixel){(float)across, value, (int32_t)station};
  }
  return FG_OK;
}

static fg_status collect_run(fg_context *ctx, const run *r, fg_pixel_band *band) {
  /* Pixels of the run's first and last stations may lie on lattice lines that cross beyond it. */
  size_t margin = (size_t)(1.2 * r->reach_px / r->reference->step_px) + 2;
  size_t from = r->first, to = r->last;
  for (size_t i = 0; i < margin && from > 0 && fabs(view_station(r, from - 1).tu) > 0.3; i++)
    from--;
  for (size_t i = 0;
       i < margin && to + 1 < r->reference->count && fabs(view_station(r, to + 1).tu) > 0.3; i++)
    to++;
  for (size_t i = from; i < to; i++) {
    view a = view_station(r, i), b = view_station(r, i + 1);
    if (b.u == a.u) continue;
    /* Half-open, so that a line through a station is counted once. */
    int64_t first = b.u > a.u ? (int64_t)ceil(a.u) : (int64_t)floor(b.u) + 1;
    int64_t last = b.u > a.u ? (int64_t)ceil(b.u) - 1 : (int64_t)floor(a.u);
    for (int64_t u = first; u <= last; u++)
      FG_TRY(collect_line(ctx, r, i, &a, &b, u, band));
  }
  return FG_OK;
}

static bool is_steep(const fg_reference_station *s) {
  return fabs(s->ty) > fabs(s->tx);
}

/* Puts pixels of `stations` stations from `first` on in the order of their stations, those of one
 * as they came. */
static fg_status sort_by_station(fg_context *ctx, size_t first, size_t stations,
                                 fg_pixel_band *band) {
  size_t *next = NULL;
  fg_band_pixel *sorted = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, stations + 1, sizeof *next, (void **)&next));
  FG_TRY_EXIT(fg_memory_allocate(ctx, band->count, sizeof *sorted, (void **)&sorted));
  for (size_t i = 0; i < band->count; i++)
    next[(size_t)band->pixels[i].station - first + 1]++;
  for (size_t i = 1; i < stations; i++)
    next[i] += next[i - 1];
  for (size_t i = 0; i < band->count; i++)
    sorted[next[(size_t)band->pixels[i].station - first]++] = band->pixels[i];
  free(band->pixels);
  band->pixels = sorted;
  band->capacity = band->count;
exit:
  free(next);
  return status;
}

fg_status fg_pixel_band_collect(fg_context *ctx, const fg_tiles *tiles,
                                const fg_reference *reference, size_t first, size_t last,
                                double reach_px, fg_pixel_band *band) {
  memset(band, 0, sizeof *band);
  double area = (double)(last - first + 1) * reference->step_px * (2 * reach_px + 1);
  fg_status status = fg_memory_reserve(ctx, (size_t)(1.1 * area) + 256, sizeof *band->pixels,
                                       &band->capacity, (void **)&band->pixels);
  for (size_t next = first; next <= last && status == FG_OK;) {
    run r = {.tiles = tiles, .reference = reference, .first = next, .reach_px = reach_px};
    r.steep = is_steep(&reference->stations[next]);
    r.last = next;
    while (r.last < last && is_steep(&reference->stations[r.last + 1]) == r.steep)
      r.last++;
    status = collect_run(ctx, &r, band);
    next = r.last + 1;
  }
  if (status == FG_OK) status = sort_by_station(ctx, first, last - first + 1, band);
  if (status != FG_OK) fg_pixel_band_free(band);
  return status;
}

void fg_pixel_band_free(fg_pixel_band *band) {
  if (!band) return;
  free(band->pixels);
  memset(band, 0, sizeof *band);
}
