#include "vision/band.h"

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
  double u, v, tu, tv, nu, nv, curvature;
} view;

static view view_station(const run *r, size_t i) {
  const fg_reference_station *s = &r->reference->stations[i];
  if (r->steep) return (view){s->y, s->x, s->ty, s->tx, s->tx, -s->ty, s->curvature};
  return (view){s->x, s->y, s->tx, s->ty, -s->ty, s->tx, s->curvature};
}

static float pixel_at(const run *r, int64_t u, int64_t v) {
  return r->steep ? fg_tiles_pixel(r->tiles, v, u) : fg_tiles_pixel(r->tiles, u, v);
}

/* All pixels of one lattice line that crosses the reference between stations i and i+1. */
static fg_status collect_line(fg_context *ctx, const run *r, size_t i, const view *a,
                              const view *b, int64_t u, fg_band *band) {
  double step = r->reference->step_px, f = ((double)u - a->u) / (b->u - a->u);
  double k = (1 - f) * a->curvature + f * b->curvature;
  double tu = (1 - f) * a->tu + f * b->tu, tv = (1 - f) * a->tv + f * b->tv;
  double nu = (1 - f) * a->nu + f * b->nu, nv = (1 - f) * a->nv + f * b->nv;
  /* The line between stations lies beside its chord, away from the centre of curvature. */
  double sagitta = 0.5 * k * f * (1 - f) * step * step;
  double v0 = (1 - f) * a->v + f * b->v - sagitta * nv, u0 = (double)u - sagitta * nu;
  double span = r->reach_px / fabs(nv) * 1.05 + 1;
  int64_t from = (int64_t)ceil(v0 - span), to = (int64_t)floor(v0 + span);
  size_t needed = band->count + (size_t)(to - from + 1);
  FG_TRY(fg_memory_reserve(ctx, needed, sizeof *band->pixels, &band->capacity,
                           (void **)&band->pixels));
  for (int64_t v = from; v <= to; v++) {
    double du = (double)u - u0, dv = (double)v - v0, along, across;
    fg_reference_project(k, du * tu + dv * tv, du * nu + dv * nv, &along, &across);
    if (fabs(across) > r->reach_px) continue;
    double station = floor((double)i + f + along / step + 0.5);
    if (station < (double)r->first || station > (double)r->last) continue;
    float value = pixel_at(r, u, v);
    if (isnan(value)) continue;
    band->pixels[band->count++] = (fg_band_pixel){(float)across, value, (int32_t)station};
  }
  return FG_OK;
}

static fg_status collect_run(fg_context *ctx, const run *r, fg_band *band) {
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
    for (int64_t u = first; u <= last; u++) FG_TRY(collect_line(ctx, r, i, &a, &b, u, band));
  }
  return FG_OK;
}

static bool is_steep(const fg_reference_station *s) {
  return fabs(s->ty) > fabs(s->tx);
}

fg_status fg_band_collect(fg_context *ctx, const fg_tiles *tiles, const fg_reference *reference,
                          double reach_px, fg_band *band) {
  memset(band, 0, sizeof *band);
  fg_status status = FG_OK;
  size_t first = 0;
  while (first < reference->count && status == FG_OK) {
    run r = {.tiles = tiles, .reference = reference, .first = first, .reach_px = reach_px};
    r.steep = is_steep(&reference->stations[first]);
    r.last = first;
    while (r.last + 1 < reference->count && is_steep(&reference->stations[r.last + 1]) == r.steep)
      r.last++;
    status = collect_run(ctx, &r, band);
    first = r.last + 1;
  }
  if (status != FG_OK) fg_band_free(band);
  return status;
}

void fg_band_free(fg_band *band) {
  if (!band) return;
  free(band->pixels);
  memset(band, 0, sizeof *band);
}
