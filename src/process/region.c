/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Best point of a quadratic surface in a convex region.
 *
 * The region is the intersection of simple sets, each with a projection in closed form. Dykstra's
 * algorithm combines these into the projection on the intersection; projected gradients then
 * descend to a local optimum from scattered starts. A quadratic may have several local optima on
 * the border of the region (a saddle has), so the starts are the best of many. */
#include <math.h>
#include <string.h>

#include "core/numerics.h"
#include "foilgauge/surface.h"

enum {
  MAX = FG_SURFACE_FACTORS,
  SETS = FG_REGION_PLANES + 2,
  SCATTERED = 2048, /* points that are looked at */
  STARTS = 24,      /* of these, where a walk starts */
  STEPS = 3000,
  SWEEPS = 2000
};

/* Distance from the region, as a share of its size, within which a point counts as inside. */
static const double SLACK = 1e-9;

static double distance_between(const double *a, const double *b, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sqrt(sum);
}

static double size_of(const fg_region *r) {
  return distance_between(r->low, r->high, r->factors);
}

bool fg_region_contains(const fg_region *r, const double *x, double tolerance) {
  for (size_t i = 0; i < r->factors; i++)
    if (!(x[i] >= r->low[i] - tolerance && x[i] <= r->high[i] + tolerance)) return false;
  if (distance_between(x, r->centre, r->factors) > r->radius + tolerance) return false;
  for (size_t p = 0; p < r->planes; p++) {
    double length = sqrt(fg_dot(r->normal[p], r->normal[p], r->factors));
    if (fg_dot(r->normal[p], x, r->factors) > r->limit[p] + tolerance * length) return false;
  }
  return true;
}

/* On one set: 0 the box, 1 the ball, then the half-spaces. */
static void project_on(const fg_region *r, size_t set, double *x) {
  size_t n = r->factors;
  if (set == 0) {
    for (size_t i = 0; i < n; i++)
      x[i] = fmin(fmax(x[i], r->low[i]), r->high[i]);
  } else if (set == 1) {
    double away = distance_between(x, r->centre, n);
    for (size_t i = 0; away > r->radius && i < n; i++)
      x[i] = r->centre[i] + (x[i] - r->centre[i]) * r->radius / away;
  } else {
    const double *normal = r->normal[set - 2];
    double beyond = fg_dot(normal, x, n) - r->limit[set - 2], square = fg_dot(normal, normal, n);
    for (size_t i = 0; beyond > 0 && square > 0 && i < n; i++)
      x[i] -= beyond / square * normal[i];
  }
}

/* Box and ball alone. By the conditions of Karush, Kuhn and Tucker the nearest point is that of the
 * box to centre + share (x - centre), with the largest share that is in the ball. Dykstra's
 * algorithm converges slowly there: the ball touches the box where axial runs are the farthest. */
static void project_on_box_and_ball(const fg_region *r, double *x) {
  double given[MAX], inside = 0, outside = 1;
  memcpy(given, x, r->factors * sizeof *x);
  project_on(r, 0, x);
  if (distance_between(x, r->centre, r->factors) <= r->radius) return;
  while (outside - inside > 1e-15) {
    double share = (inside + outside) / 2;
    for (size_t i = 0; i < r->factors; i++)
      x[i] = r->centre[i] + share * (given[i] - r->centre[i]);
    project_on(r, 0, x);
    if (distance_between(x, r->centre, r->factors) <= r->radius)
      inside = share;
    else
      outside = share;
  }
  for (size_t i = 0; i < r->factors; i++)
    x[i] = r->centre[i] + inside * (given[i] - r->centre[i]);
  project_on(r, 0, x);
}

/* Dykstra (1983): each set's previous correction is added back before its next projection. The
 * point may stay constant for many sweeps while the corrections still change, so the corrections
 * must converge (Birgin and Raydan 2005). */
static void project(const fg_region *r, double *x) {
  double given[SETS][MAX] = {{0}}, before[MAX];
  size_t sets = r->planes + 2;
  double converged = 1e-13 * size_of(r);
  if (fg_region_contains(r, x, 0)) return;
  if (!r->planes) {
    project_on_box_and_ball(r, x);
    return;
  }
  for (int sweep = 0; sweep < SWEEPS; sweep++) {
    double change = 0;
    for (size_t s = 0; s < sets; s++) {
      for (size_t i = 0; i < r->factors; i++)
        before[i] = x[i] += given[s][i];
      project_on(r, s, x);
      for (size_t i = 0; i < r->factors; i++) {
        change = fmax(change, fabs(before[i] - x[i] - given[s][i]));
        given[s][i] = before[i] - x[i];
      }
    }
    if (change <= converged) return;
  }
}

fg_status fg_region_project(fg_context *ctx, const fg_region *region, double *x) {
  bool bounded = region->radius >= 0;
  for (size_t i = 0; i < region->factors; i++)
    bounded =
        bounded && region->low[i] <= region->high[i] && isfinite(region->high[i] - region->low[i]);
  double point[MAX] = {0};
  memcpy(point, x, region->factors * sizeof *x);
  if (bounded) project(region, point);
  if (!bounded || !fg_region_contains(region, point, 1e-6 * fmax(size_of(region), 1e-300)))
    return fg_fail(ctx, FG_ERR_USAGE, "the region is empty: the limits contradict each other");
  memcpy(x, point, region->factors * sizeof *x);
  return FG_OK;
}

void fg_region_scale(const fg_region *region, fg_region *scaled, double scale[FG_SURFACE_FACTORS]) {
  *scaled = *region;
  for (size_t i = 0; i < region->factors; i++) {
    double half = (region->high[i] - region->low[i]) / 2;
    scale[i] = isinf(region->radius) && half > 0 ? half : 1;
    scaled->low[i] = (region->low[i] - region->centre[i]) / scale[i];
    scaled->high[i] = (region->high[i] - region->centre[i]) / scale[i];
    scaled->centre[i] = 0;
  }
  for (size_t p = 0; p < region->planes; p++) {
    scaled->limit[p] -= fg_dot(region->normal[p], region->centre, region->factors);
    for (size_t i = 0; i < region->factors; i++)
      scaled->normal[p][i] = region->normal[p][i] * scale[i];
  }
}

/* The polynomial of a surface in the same coordinates: all that the search reads. */
static void scale_surface(const fg_surface *s, const fg_region *r, const double *scale,
                          fg_surface *scaled) {
  *scaled = *s;
  scaled->constant = fg_surface_value(s, r->centre);
  for (size_t i = 0; i < s->factors; i++) {
    scaled->linear[i] =
        scale[i] * (s->linear[i] + 2 * fg_dot(s->quadratic[i], r->centre, s->factors));
    for (size_t j = 0; j < s->factors; j++)
      scaled->quadratic[i][j] = s->quadratic[i][j] * scale[i] * scale[j];
  }
}

/* Cost function and its gradient. */
typedef struct objective {
  const fg_surface *surface;
  fg_goal goal;
  double target;
} objective;

static double cost(const objective *o, const double *x) {
  double value = fg_surface_value(o->surface, x);
  if (o->goal == FG_GOAL_TARGET) return (value - o->target) * (value - o->target);
  return o->goal == FG_GOAL_HIGHEST ? -value : value;
}

static void gradient(const objective *o, const double *x, double *slope) {
  const fg_surface *s = o->surface;
  double factor = o->goal == FG_GOAL_HIGHEST ? -1 : 1;
  if (o->goal == FG_GOAL_TARGET) factor = 2 * (fg_surface_value(s, x) - o->target);
  for (size_t i = 0; i < s->factors; i++)
    slope[i] = factor * (s->linear[i] + 2 * fg_dot(s->quadratic[i], x, s->factors));
}

/* Descends by projected gradients. A step is accepted when it lowers the cost by a tenth of the
 * slope's prediction; it doubles after a success and halves after a failure. */
static double descend_from(const objective *o, const fg_region *r, double *x) {
  size_t n = r->factors;
  double here = cost(o, x), slope[MAX], next[MAX] = {0}, size = size_of(r);
  gradient(o, x, slope);
  double steepness = sqrt(fg_dot(slope, slope, n));
  double step = steepness > 0 ? 0.5 * size / steepness : 0;
  for (int i = 0; i < STEPS && step * steepness > 1e-15 * size; i++) {
    for (size_t k = 0; k < n; k++)
      next[k] = x[k] - step * slope[k];
    project(r, next);
    double there = cost(o, next), moved = distance_between(x, next, n);
    if (moved == 0) break;
    if (there > here - 0.1 * moved * moved / step) {
      step /= 2;
      continue;
    }
    memcpy(x, next, n * sizeof *x);
    here = there;
    gradient(o, x, slope);
    steepness = sqrt(fg_dot(slope, slope, n));
    step *= 2;
  }
  return here;
}

/* Halton's sequence: even cover without a seed. */
static double halton(size_t index, unsigned base) {
  double result = 0, share = 1;
  for (; index; index /= base) {
    share /= base;
    result += share * (double)(index % base);
  }
  return result;
}

void fg_region_scatter(const fg_region *r, size_t index, double *x) {
  static const unsigned primes[MAX] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};
  for (size_t i = 0; i < r->factors; i++)
    x[i] = r->low[i] + (r->high[i] - r->low[i]) * halton(index + 1, primes[i]);
  project(r, x);
}

typedef struct start {
  double cost, x[MAX];
} start;

/* Inserts a candidate into the list of the best STARTS, best first. */
static void keep_start(start *starts, size_t *count, const start *candidate) {
  size_t place = *count;
  while (place > 0 && candidate->cost < starts[place - 1].cost)
    place--;
  if (place == STARTS) return;
  size_t last = *count < STARTS ? (*count)++ : STARTS - 1;
  memmove(&starts[place + 1], &starts[place], (last - place) * sizeof *starts);
  starts[place] = *candidate;
}

/* Adds the candidates that are exact if they lie inside: stationary point, box, ball. */
static void keep_exact(const objective *o, const fg_region *r, start *starts, size_t *count) {
  start s = {0};
  bool highest = o->goal == FG_GOAL_HIGHEST;
  memcpy(s.x, r->centre, sizeof s.x);
  project(r, s.x);
  s.cost = cost(o, s.x);
  keep_start(starts, count, &s);
  if (o->goal == FG_GOAL_TARGET) return;
  if (fg_surface_optimum_box(NULL, o->surface, highest, r->low, r->high, s.x) != FG_OK) return;
  project(r, s.x);
  s.cost = cost(o, s.x);
  keep_start(starts, count, &s);
}

static fg_status search_region(fg_context *ctx, const fg_surface *surface, fg_goal goal,
                               double target, const fg_region *region, double *x) {
  const objective o = {surface, goal, target};
  start starts[STARTS + 1], s = {0};
  size_t count = 0, n = region->factors;
  double best = INFINITY, spread = 0;
  if (n != surface->factors)
    return fg_fail(ctx, FG_ERR_USAGE, "the region has %zu factors, the surface %zu", n,
                   surface->factors);
  memcpy(s.x, region->centre, sizeof s.x);
  FG_TRY(fg_region_project(ctx, region, s.x));
  for (size_t i = 0; i < SCATTERED; i++) {
    fg_region_scatter(region, i, s.x);
    s.cost = cost(&o, s.x);
    spread = fmax(spread, fabs(s.cost));
    keep_start(starts, &count, &s);
  }
  keep_exact(&o, region, starts, &count);
  for (size_t i = 0; i < count; i++) {
    starts[i].cost = descend_from(&o, region, starts[i].x);
    bool better = starts[i].cost < best - 1e-12 * spread;
    bool as_good = starts[i].cost <= best + 1e-12 * spread;
    bool nearer = distance_between(starts[i].x, region->centre, n) <
                  distance_between(x, region->centre, n) - SLACK;
    if (i > 0 && !better && !(as_good && nearer)) continue;
    best = starts[i].cost;
    memcpy(x, starts[i].x, n * sizeof *x);
  }
  return FG_OK;
}

/* One step is as long in every factor. */
fg_status fg_surface_optimum_region(fg_context *ctx, const fg_surface *surface, fg_goal goal,
                                    double target, const fg_region *region, double *x) {
  fg_region scaled_region;
  fg_surface scaled;
  double scale[MAX];
  if (!isinf(region->radius)) return search_region(ctx, surface, goal, target, region, x);
  fg_region_scale(region, &scaled_region, scale);
  scale_surface(surface, region, scale, &scaled);
  FG_TRY(search_region(ctx, &scaled, goal, target, &scaled_region, x));
  for (size_t i = 0; i < region->factors; i++)
    x[i] = fmin(fmax(region->centre[i] + scale[i] * x[i], region->low[i]), region->high[i]);
  return FG_OK;
}
