/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/arc_step.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "core/spread.h"
#include "geometry/jump.h"

/* PLACES: of a jump that are tried over an arc's extent along an axis. */
enum { PLACES = 128, BUMPS_MIN = 5, STATIONS_MIN = 16 };
/* Min share of the edges' crossings on either side of a jump. */
#define SIDE_MIN 0.04
/* Of noise, over both axes: places that are as good as independent, and the median over arcs of the
 * largest gain, in variances of the noise. */
#define TRIES        15.0
#define MEDIAN_GAIN  4.0
#define DOF_PER_BUMP 2.0
/* An oval explains an arc as well where it gains this share. */
#define OVER_SMOOTH 1.1
/* Max variance that a jump leaves, over the median of all bumps. */
#define VARIANCE_LEFT 2.25

/* Chances of a jump below which u holds it, and below which the bump is flagged; min rms that a
 * flagged jump explains: without noise the edge model itself deviates by as much. */
#define COUNTED_CHANCE 0.007
#define FLAGGED_CHANCE 1e-6
#define FLAGGED_RMS_MM 0.0001

/* A station of an arc. `jump` is its residual's change by a displacement of 1 of those of its edges
 * that the jump has passed. */
typedef struct arc_station {
  double jump, edge_mm[2][2]; /* by edge and axis */
} arc_station;

typedef struct arc_work {
  arc_station *stations;
  fg_distance *distances; /* of the stations from the arc's circle */
  size_t *next;           /* per edge of a station: the next one at the same place */
  size_t count, edges;
} arc_work;

static void list_stations(const fg_datum_line *line, const fg_arc *arc, arc_work *work) {
  work->count = 0;
  work->edges = line->is_edge ? 1 : 2;
  for (size_t k = arc->ranges[0].first; k <= arc->ranges[0].last; k++) {
    if (!fg_arc_used(line, arc, k)) continue;
    const fg_station *s = &line->strip->stations[k];
    fg_point p = line->points[k], first = line->is_edge ? p : s->left;
    double dx = p.x - arc->circle.x, dy = p.y - arc->circle.y, d = sqrt(dx * dx + dy * dy);
    work->distances[work->count] = fg_distance_at(dx / d, dy / d, d - arc->circle.radius);
    work->stations[work->count++] =
        (arc_station){.edge_mm = {{first.x, first.y}, {s->right.x, s->right.y}}};
  }
}

/* Adds edge e, which the jump passes, to the jump's column: each edge of a station moves the datum
 * line by its share. */
static void pass_edge(arc_work *work, size_t e, int axis, fg_jump_sums *sums) {
  arc_station *s = &work->stations[e / work->edges];
  const fg_distance *distance = &work->distances[e / work->edges];
  double more = distance->row[axis] / (double)work->edges;
  for (int k = 0; k < FG_CIRCLE_TERMS; k++)
    sums->with_row[k] += more * distance->row[k];
  sums->with_residual += more * fg_jump_residual(sums, distance);
  sums->with_itself += more * (more + 2 * s->jump);
  s->jump += more;
}

/* Places of a jump: the best one, and mean squares of the circle's change over all, weighted by
 * their likelihoods. */
typedef struct jump_search {
  fg_arc_step *step;
  double variance; /* of the noise, mm²; 0: the best place is sought */
  double weight, sum[FG_CIRCLE_TERMS][FG_CIRCLE_TERMS];
} jump_search;

/* Weighs a place. Which part of the scan is displaced is open, so half of the jump moves the
 * centre. */
static void weigh_jump(double gain, double jump_mm, int axis, const double *change,
                       jump_search *search) {
  double weight = exp((gain - search->step->gain) / (2 * search->variance));
  search->weight += weight;
  for (int p = 0; p < FG_CIRCLE_TERMS; p++)
    for (int q = 0; q < FG_CIRCLE_TERMS; q++)
      search->sum[p][q] += weight * change[p] * change[q];
  search->sum[axis][axis] += weight * jump_mm * jump_mm / 4;
}

static void try_jump(const fg_jump_sums *sums, int axis, jump_search *search) {
  double change[FG_CIRCLE_TERMS], jump_mm;
  if (!fg_jump_solve(sums, axis, 0, &jump_mm, change)) return;
  double gain = sums->with_residual * jump_mm;
  if (search->variance > 0) {
    weigh_jump(gain, jump_mm, axis, change, search);
  } else if (gain > search->step->gain) {
    search->step->gain = gain;
    search->step->jump_mm = jump_mm;
  }
}

static double edge_place(const arc_work *work, size_t e, int axis) {
  return work->stations[e / work->edges].edge_mm[e % work->edges][axis];
}

/* Lists the edges by their place along an axis: heads[p] is the first edge at place p, work->next
 * leads on from it, and the number of edges ends a list. False: all edges lie at one place. */
static bool list_edges_by_place(arc_work *work, int axis, size_t heads[PLACES]) {
  size_t all = work->count * work->edges;
  double min = INFINITY, max = -INFINITY;
  for (size_t e = 0; e < all; e++) {
    double at = edge_place(work, e, axis);
    if (at < min) min = at;
    if (at > max) max = at;
  }
  if (!(max > min)) return false;
  for (size_t p = 0; p < PLACES; p++)
    heads[p] = all;
  for (size_t e = 0; e < all; e++) {
    size_t place = (size_t)((edge_place(work, e, axis) - min) / (max - min) * (PLACES - 1));
    work->next[e] = heads[place];
    heads[place] = e;
  }
  return true;
}

/* Tries all places along an axis. */
static void try_axis(arc_work *work, int axis, fg_jump_sums *sums, jump_search *search) {
  size_t heads[PLACES], all = work->count * work->edges, passed = 0;
  if (!list_edges_by_place(work, axis, heads)) return;
  fg_jump_clear(sums);
  for (size_t i = 0; i < work->count; i++)
    work->stations[i].jump = 0;
  double margin = SIDE_MIN * (double)all;
  for (size_t p = PLACES; p-- > 0;) {
    for (size_t e = heads[p]; e < all; e = work->next[e], passed++)
      pass_edge(work, e, axis, sums);
    if ((double)passed > margin && (double)(all - passed) > margin) try_jump(sums, axis, search);
  }
}

/* The best jump of one arc, or with a variance of the noise the mean squares over all. */
static void search_arc(const fg_datum_line *line, double variance, arc_work *work, fg_arc *arc) {
  fg_jump_sums sums;
  jump_search search = {.step = &arc->step, .variance = variance};
  list_stations(line, arc, work);
  if (work->count < STATIONS_MIN) return;
  const fg_distance *distances = work->distances;
  double oval = 0, circle;
  if (variance > 0)
    oval = fg_distances_fit(distances, work->count, FG_OVAL_TERMS, sums.moves, NULL);
  circle = fg_distances_fit(distances, work->count, FG_CIRCLE_TERMS, sums.moves, sums.inverse);
  if (!isfinite(oval + circle)) return;
  for (int axis = 0; axis < 2; axis++)
    try_axis(work, axis, &sums, &search);
  for (int p = 0; search.weight > 0 && p < FG_CIRCLE_TERMS; p++)
    for (int q = 0; q < FG_CIRCLE_TERMS; q++)
      arc->step.covariance[p][q] = search.sum[p][q] / search.weight;
  if (variance > 0)
    arc->step.smooth_gain = circle - oval;
  else
    arc->step.variance_left = (circle - arc->step.gain) / (double)work->count;
}

static size_t max_stations(const fg_layout *layout) {
  size_t max = 0;
  for (size_t i = 0; i < layout->turning.bump_count; i++) {
    size_t count = layout->bump_ranges[i].last - layout->bump_ranges[i].first + 1;
    if (layout->fitted[i] && count > max) max = count;
  }
  return max;
}

/* Median over the bumps whose jump was sought, of its gain or of the mean square of residuals. */
static double median_over_bumps(const fg_layout *layout, bool of_gain, double *values,
                                size_t *count) {
  *count = 0;
  for (size_t i = 0; i < layout->turning.bump_count; i++) {
    const fg_arc *arc = &layout->bumps[i];
    if (layout->fitted[i] && arc->step.gain > 0)
      values[(*count)++] = of_gain ? arc->step.gain : arc->rms_mm * arc->rms_mm;
  }
  return *count ? fg_median(values, *count) : NAN;
}

/* Chance of a bump's best jump by the gains of all: the noise's variance is that of the other
 * bumps, hence Student's t. */
static double chance_of(const fg_arc *arc, double noise, double variance, size_t count) {
  if (!(arc->step.gain > 0) || arc->step.variance_left > VARIANCE_LEFT * variance) return 1;
  double deviations = sqrt(arc->step.gain / noise);
  return fmin(2 * TRIES * gsl_cdf_tdist_Q(deviations, DOF_PER_BUMP * (double)count), 1);
}

fg_status fg_arc_steps_find(fg_context *ctx, fg_layout *layout) {
  size_t bumps = layout->turning.bump_count, stations = max_stations(layout), count;
  arc_work work = {.count = 0};
  double *values = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, stations, sizeof *work.stations, (void **)&work.stations));
  FG_TRY_EXIT(fg_memory_allocate(ctx, stations, sizeof *work.distances, (void **)&work.distances));
  FG_TRY_EXIT(fg_memory_allocate(ctx, 2 * stations, sizeof *work.next, (void **)&work.next));
  FG_TRY_EXIT(fg_memory_allocate(ctx, bumps, sizeof *values, (void **)&values));
  for (size_t i = 0; i < bumps; i++) {
    layout->bumps[i].step = (fg_arc_step){.chance = 1, .jump_mm = NAN};
    if (layout->fitted[i]) search_arc(&layout->line, 0, &work, &layout->bumps[i]);
  }
  double variance = median_over_bumps(layout, false, values, &count);
  double noise = median_over_bumps(layout, true, values, &count) / MEDIAN_GAIN;
  for (size_t i = 0; count >= BUMPS_MIN && i < bumps; i++) {
    fg_arc *arc = &layout->bumps[i];
    if (layout->fitted[i]) arc->step.chance = chance_of(arc, noise, variance, count);
    if (arc->step.chance < COUNTED_CHANCE) search_arc(&layout->line, noise, &work, arc);
  }
exit:
  free(work.stations);
  free(work.distances);
  free(work.next);
  free(values);
  return status;
}

bool fg_arc_step_is_flagged(const fg_arc *arc) {
  const fg_arc_step *step = &arc->step;
  return step->chance < FLAGGED_CHANCE && step->gain > OVER_SMOOTH * step->smooth_gain &&
         step->gain > FLAGGED_RMS_MM * FLAGGED_RMS_MM * (double)arc->points;
}

void fg_arc_step_add(fg_layout *layout, size_t i) {
  fg_arc *arc = &layout->bumps[i];
  const fg_arc_step *step = &arc->step;
  double dx = arc->circle.x - layout->overall.circle.x;
  double dy = arc->circle.y - layout->overall.circle.y, d = hypot(dx, dy);
  for (int side = 0; side < 2; side++) {
    double off = layout->gap_off_mm[i + (size_t)side] / d;
    arc->covariance[0][0] += off * off * dx * dx;
    arc->covariance[0][1] += off * off * dx * dy;
    arc->covariance[1][0] += off * off * dx * dy;
    arc->covariance[1][1] += off * off * dy * dy;
  }
  if (!(step->chance < COUNTED_CHANCE)) return;
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      arc->covariance[p][q] += step->covariance[p][q];
}
