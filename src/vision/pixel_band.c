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

/* Pixels as they are found. */
typedef struct found_pixel {
  float across_px, value;
  int32_t station; /* station whose step contains it */
} found_pixel;

typedef struct found_pixels {
  found_pixel *list; /* owned */
  size_t count, capacity;
} found_pixels;

enum { BATCH = 64 }; /* pixels of a lattice line that are placed at a time */

/* Pixels of one lattice line, one after the other across the strip, with the place of each by the
 * station that was guessed for it: its offsets along the tangent and the normal, and by the circle
 * that osculates there (fg_reference_project). */
typedef struct batch {
  int64_t u, from; /* pixel j lies at (u, from + j) */
  size_t count;
  double guess[BATCH];    /* station, plus 1/2 */
  int32_t station[BATCH]; /* -1: beyond the line's ends */
  double a[BATCH], b[BATCH], curvature[BATCH], along[BATCH], across[BATCH];
  float value[BATCH]; /* NaN: not kept */
} batch;

/* A lattice line where it crosses the reference: at v0, `at` stations from the line's start. Across
 * it stations change by `slope` a pixel, stretched by the curvature (`bend`). */
typedef struct crossing {
  double v0, at, slope, bend;
} crossing;

__attribute__((target_clones("avx2", "default"))) static void guess_stations(const crossing *c,
                                                                             batch *line) {
  double first = (double)line->from - c->v0;
  for (size_t j = 0; j < BATCH; j++) {
    double dv = first + (double)(int32_t)j;
    line->guess[j] = c->at + dv * c->slope / (1 - c->bend * dv) + 0.5;
  }
}

__attribute__((target_clones("avx2", "default"))) static void project_batch(batch *line) {
  for (size_t j = 0; j < BATCH; j++)
    fg_reference_project(line->curvature[j], line->a[j], line->b[j], &line->along[j],
                         &line->across[j]);
}

static void set_offsets(const run *r, const fg_reference_station *s, size_t j, batch *line) {
  int64_t v = line->from + (int64_t)j;
  double dx = (double)(r->steep ? v : line->u) - s->x;
  double dy = (double)(r->steep ? line->u : v) - s->y;
  line->a[j] = dx * s->tx + dy * s->ty;
  line->b[j] = dy * s->tx - dx * s->ty;
  line->curvature[j] = s->curvature;
}

static void place_batch(const run *r, const crossing *c, batch *line) {
  double count = (double)r->reference->count;
  guess_stations(c, line);
  for (size_t j = 0; j < line->count; j++) {
    bool inside = line->guess[j] > -1 && line->guess[j] < count;
    line->station[j] = inside ? (int32_t)line->guess[j] : -1;
    set_offsets(r, &r->reference->stations[inside ? line->station[j] : 0], j, line);
  }
  for (size_t j = line->count; j < BATCH; j++)
    line->a[j] = line->b[j] = line->curvature[j] = 0;
  project_batch(line);
}

/* Moves a pixel to the station nearest to it, where the guess was another. A pixel's distance from
 * the line is measured from that station's own osculating circle, at most half a step away, so that
 * a line whose curvature changes (the start of a fillet) does not bend the scale. */
static void move_pixel(const run *r, size_t j, batch *line) {
  const fg_reference *reference = r->reference;
  double step = reference->step_px;
  for (int i = 0; i < 3; i++) {
    double along = line->along[j];
    if (fabs(along) <= 0.5 * step) return;
    long move = (long)(along / step + (along > 0 ? 0.5 : -0.5));
    if (move == 0) return;
    long station = line->station[j] + move;
    bool inside = station >= 0 && station < (long)reference->count;
    line->station[j] = inside ? (int32_t)station : -1;
    if (!inside) return;
    set_offsets(r, &reference->stations[station], j, line);
    fg_reference_project(line->curvature[j], line->a[j], line->b[j], &line->along[j],
                         &line->across[j]);
  }
}

/* Reads pixels in a row or column of the scan, tile by tile. */
static void read_batch(const run *r, batch *line) {
  const fg_tiles *tiles = r->tiles;
  int64_t end = r->steep ? tiles->width_px : tiles->height_px;
  int64_t across_end = r->steep ? tiles->height_px : tiles->width_px;
  bool known = line->u >= 0 && line->u < across_end;
  size_t step = r->steep ? 1 : FG_TILE_PX;
  for (size_t j = 0, next; j < line->count; j = next) {
    int64_t v = line->from + (int64_t)j;
    next = j + 1;
    line->value[j] = NAN;
    if (!known || v < 0 || v >= end) continue;
    size_t x = (size_t)(r->steep ? v : line->u), y = (size_t)(r->steep ? line->u : v);
    const fg_tile *tile = fg_tiles_at(tiles, (int32_t)(x / FG_TILE_PX), (int32_t)(y / FG_TILE_PX));
    next = j + FG_TILE_PX - (size_t)v % FG_TILE_PX;
    if (next > line->count) next = line->count;
    if (next - j > (size_t)(end - v)) next = j + (size_t)(end - v);
    size_t at = y % FG_TILE_PX * FG_TILE_PX + x % FG_TILE_PX;
    for (size_t k = j; k < next; k++, at += step)
      line->value[k] = tile ? fg_tile_value(tiles, tile, at) : NAN;
  }
}

/* Adds the batch's pixels that belong to the run. */
static void keep_batch(const run *r, batch *line, found_pixels *found) {
  double half = 0.5 * r->reference->step_px;
  for (size_t j = 0; j < line->count; j++) {
    if (line->station[j] >= 0 && fabs(line->along[j]) > half) move_pixel(r, j, line);
    if (line->station[j] < (int32_t)r->first || line->station[j] > (int32_t)r->last) continue;
    if (fabs(line->across[j]) > r->reach_px || isnan(line->value[j])) continue;
    found->list[found->count++] =
        (found_pixel){(float)line->across[j], line->value[j], line->station[j]};
  }
}

/* Collects all pixels of one lattice line that crosses the reference between stations i and i+1. */
static fg_status collect_line(fg_context *ctx, const run *r, size_t i, const view *a, const view *b,
                              int64_t u, batch *line, found_pixels *found) {
  double f = ((double)u - a->u) / (b->u - a->u);
  double span = r->reach_px / fabs(a->tu) * 1.05 + 1;
  double curvature = r->reference->stations[i].curvature;
  crossing c = {.v0 = (1 - f) * a->v + f * b->v,
                .at = (double)i + f,
                .slope = a->tv / r->reference->step_px,
                .bend = curvature * (r->steep ? -a->tu : a->tu)};
  int64_t from = (int64_t)ceil(c.v0 - span), to = (int64_t)floor(c.v0 + span);
  if (from > to) return FG_OK;
  size_t needed = found->count + (size_t)(to - from + 1);
  FG_TRY(
      fg_memory_reserve(ctx, needed, sizeof *found->list, &found->capacity, (void **)&found->list));
  line->u = u;
  for (line->from = from; line->from <= to; line->from += BATCH) {
    line->count = to - line->from < BATCH ? (size_t)(to - line->from + 1) : BATCH;
    place_batch(r, &c, line);
    read_batch(r, line);
    keep_batch(r, line, found);
  }
  return FG_OK;
}

static fg_status collect_run(fg_context *ctx, const run *r, found_pixels *found) {
  /* Pixels of the run's first and last stations may lie on lattice lines that cross beyond it. */
  size_t margin = (size_t)(1.2 * r->reach_px / r->reference->step_px) + 2;
  size_t from = r->first, to = r->last;
  batch line;
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
      FG_TRY(collect_line(ctx, r, i, &a, &b, u, &line, found));
  }
  return FG_OK;
}

static bool is_steep(const fg_reference_station *s) {
  return fabs(s->ty) > fabs(s->tx);
}

static fg_status allocate_band(fg_context *ctx, size_t first, size_t stations, size_t count,
                               fg_pixel_band *band) {
  *band = (fg_pixel_band){.first = first, .stations = stations, .count = count};
  FG_TRY(fg_memory_allocate(ctx, stations + 1, sizeof *band->begin, (void **)&band->begin));
  size_t room = 0;
  FG_TRY(fg_memory_reserve(ctx, 2 * count, sizeof *band->value, &room, (void **)&band->across_px));
  band->value = band->across_px + count;
  return FG_OK;
}

/* Puts pixels in the order of their stations, those of one as they came. */
static void sort_by_station(const found_pixels *found, fg_pixel_band *band) {
  size_t *next = band->begin; /* until all are placed: where a station's next pixel goes */
  for (size_t i = 0; i < found->count; i++)
    next[(size_t)found->list[i].station - band->first + 1]++;
  for (size_t k = 1; k <= band->stations; k++)
    next[k] += next[k - 1];
  for (size_t i = 0; i < found->count; i++) {
    size_t at = next[(size_t)found->list[i].station - band->first]++;
    band->across_px[at] = found->list[i].across_px;
    band->value[at] = found->list[i].value;
  }
  for (size_t k = band->stations; k > 0; k--)
    band->begin[k] = band->begin[k - 1];
  band->begin[0] = 0;
}

static fg_status find_pixels(fg_context *ctx, const fg_tiles *tiles, const fg_reference *reference,
                             size_t first, size_t last, double reach_px, found_pixels *found) {
  double area = (double)(last - first + 1) * reference->step_px * (2 * reach_px + 1);
  FG_TRY(fg_memory_reserve(ctx, (size_t)(1.1 * area) + 256, sizeof *found->list, &found->capacity,
                           (void **)&found->list));
  for (size_t next = first; next <= last;) {
    run r = {.tiles = tiles, .reference = reference, .first = next, .reach_px = reach_px};
    r.steep = is_steep(&reference->stations[next]);
    r.last = next;
    while (r.last < last && is_steep(&reference->stations[r.last + 1]) == r.steep)
      r.last++;
    FG_TRY(collect_run(ctx, &r, found));
    next = r.last + 1;
  }
  return FG_OK;
}

fg_status fg_pixel_band_collect(fg_context *ctx, const fg_tiles *tiles,
                                const fg_reference *reference, size_t first, size_t last,
                                double reach_px, fg_pixel_band *band) {
  found_pixels found = {0};
  memset(band, 0, sizeof *band);
  fg_status status = find_pixels(ctx, tiles, reference, first, last, reach_px, &found);
  if (status == FG_OK) status = allocate_band(ctx, first, last - first + 1, found.count, band);
  if (status == FG_OK) sort_by_station(&found, band);
  free(found.list);
  if (status != FG_OK) fg_pixel_band_free(band);
  return status;
}

void fg_pixel_band_free(fg_pixel_band *band) {
  if (!band) return;
  free(band->begin);
  free(band->across_px);
  memset(band, 0, sizeof *band);
}
