/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A wall beside the edges of some bearings: its light is no straight line, and no driver's work. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "vision/edge_work.h"

/* Stretch beside an edge in which a wall shows: it begins where the edge's own blur has faded. */
#define BAND_FROM_BLURS 2.5
#define BAND_PX         6.0
/* Reach of the model beside the edges of a foil whose wall shows: there its light still is about a
 * line (reports/accuracy_wall.md). */
#define OUTER_BLURS  2.5
#define OUTER_MIN_PX 4.0
/* Min band over the contrast, and over the scatter of the edges that show none: the share that
 * moves an edge by its u. */
#define WALL_SHARE  0.03
#define WALL_SIGMAS 4.0
/* Width of the shortest interval with half of normal values, in sd. */
#define HALF_IN_SDS 1.349
enum { WALLS_MIN = 4, SIDES_MIN = 16 };

/* Light beside one edge of a segment over the background's, as a share of the contrast. */
static double band_share(const fg_edge_work *work, size_t segment, int side) {
  const fg_segment_profile *s = &work->segments[segment];
  size_t station = segment * FG_SEGMENT_STATIONS + FG_SEGMENT_STATIONS / 2;
  double sum = 0, weight = 0, from = BAND_FROM_BLURS * work->trace->blur_px, rate;
  if (!s->fit.good || station >= work->reference->count) return NAN;
  for (size_t i = 0; i < work->bin_count; i++) {
    const fg_profile_bin *b = &s->bins[i];
    double out = (side ? 1 : -1) * (b->across_px - s->fit.edge_px[side]);
    if (b->count <= 0 || out < from || out > from + BAND_PX) continue;
    sum += b->count * b->value;
    weight += b->count;
  }
  double background = (double)fg_edges_background(work, &work->reference->stations[station]);
  double plateau = fg_edges_count(work, fmax(s->fit.shape.plateau, 1e-3), &rate);
  return weight > 0 ? (sum / weight - background) / (plateau - background) : NAN;
}

/* Middle and width of the shortest interval that holds half of the values: of each station's two
 * edges at most one faces a wall. */
static double find_usual(double *values, size_t count, double *width) {
  size_t half = count / 2, best = 0;
  fg_sort(values, count);
  for (size_t i = 0; i + half < count; i++)
    if (values[i + half] - values[i] < values[best + half] - values[best]) best = i;
  *width = values[best + half] - values[best];
  return 0.5 * (values[best + half] + values[best]);
}

static void mark_walls(fg_edge_work *work, const double *shares, double usual, double limit) {
  size_t walls = 0;
  for (size_t i = 0; i < 2 * work->segment_count; i++) {
    bool wall = fabs(shares[i] - usual) > limit;
    work->segments[i / 2].wall[i % 2] = wall || isnan(shares[i]);
    walls += wall;
  }
  if (walls < WALLS_MIN) return;
  work->outer_px = fmax(OUTER_BLURS * work->trace->blur_px, OUTER_MIN_PX);
}

fg_status fg_edges_find_walls(fg_context *ctx, fg_edge_work *work) {
  size_t count = 2 * work->segment_count, n = 0;
  double *shares, width;
  FG_TRY(fg_memory_allocate(ctx, 2 * count, sizeof *shares, (void **)&shares));
  double *known = shares + count;
  for (size_t i = 0; i < count; i++) {
    shares[i] = band_share(work, i / 2, (int)(i % 2));
    if (isfinite(shares[i])) known[n++] = shares[i];
  }
  if (n >= SIDES_MIN) {
    double usual = find_usual(known, n, &width);
    mark_walls(work, shares, usual, fmax(WALL_SHARE, WALL_SIGMAS * width / HALF_IN_SDS));
  }
  free(shares);
  return FG_OK;
}

void fg_edges_reach(const fg_edge_work *work, const fg_segment_profile *segment, size_t *first,
                    size_t *count) {
  *first = 0;
  *count = work->bin_count;
  if (!(work->outer_px > 0) || !segment->fit.good) return;
  double half = work->width_px / 2 + work->reach_px, per_px = (double)work->bin_count / (2 * half);
  double from = (segment->fit.edge_px[0] - work->outer_px + half) * per_px;
  double to = (segment->fit.edge_px[1] + work->outer_px + half) * per_px;
  *first = (size_t)fmin(fmax(from, 0), (double)work->bin_count);
  *count = (size_t)fmin(fmax(to, (double)*first), (double)work->bin_count) - *first;
}
