/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/disc_contour.h"

#include <math.h>
#include <string.h>

/* Min visible turn of a circle, degrees; and of a circle that is only a part of a longer outline,
 * for which a rounded corner or the end of a slot could be mistaken. */
#define TURN_MIN      200.0
#define TURN_MIN_PART 250.0
/* Tolerated rms of an outline's points about the circle: cells, and share of the radius. */
#define RMS_CELLS 0.6
#define RMS_SHARE 0.02
/* Max distance of a circle's points, in tolerances. */
#define INLIER_TOLERANCES 2.5
enum {
  REFITS = 4,
  TURN_BINS = 72,
  POINTS_MIN = 12,
  WINDOWS = 24,
  WINDOW_SHARE = 10,
  POINTS_PART_MAX = 40000
};

static double tolerance_of(const fg_outline *o, double radius) {
  return RMS_CELLS * o->cell + RMS_SHARE * radius;
}

/* Weighs the points of the circle 1, the others 0; counts them, their rms and their turn. */
static double weigh_points(fg_outline *o, fg_round *r) {
  bool seen[TURN_BINS] = {false};
  double sum = 0, limit = INLIER_TOLERANCES * tolerance_of(o, r->circle.radius);
  int bins = 0;
  r->inliers = 0;
  for (size_t i = 0; i < o->count; i++) {
    double dx = o->points[i].x - r->circle.x, dy = o->points[i].y - r->circle.y;
    double off = hypot(dx, dy) - r->circle.radius;
    o->weights[i] = fabs(off) <= limit;
    if (o->weights[i] == 0) continue;
    sum += off * off;
    r->inliers++;
    int bin = (int)((atan2(dy, dx) / (2 * M_PI) + 0.5) * TURN_BINS);
    seen[bin < TURN_BINS ? bin : TURN_BINS - 1] = true;
  }
  for (int i = 0; i < TURN_BINS; i++)
    bins += seen[i];
  r->rms = r->inliers ? sqrt(sum / (double)r->inliers) : INFINITY;
  return bins * 360.0 / TURN_BINS;
}

/* Refits to the inliers until they stay the same; returns the turn that they cover. */
static double iterate_fit(fg_outline *o, fg_round *r) {
  double turn = weigh_points(o, r);
  for (int i = 0; i < REFITS; i++) {
    size_t before = r->inliers;
    fg_circle next;
    if (before < POINTS_MIN ||
        fg_circle_estimate(NULL, o->points, o->weights, o->count, &next) != FG_OK)
      return 0;
    r->circle = next;
    turn = weigh_points(o, r);
    if (r->inliers == before) break;
  }
  return turn;
}

static bool is_round(const fg_outline *o, const fg_round *r, double turn, double turn_min) {
  /* A digital outline has about one point per cell, and at least 1/sqrt 2. */
  double expected = turn / 360 * 2 * M_PI * r->circle.radius / o->cell;
  return turn >= turn_min && r->circle.radius >= o->min_radius &&
         r->rms <= tolerance_of(o, r->circle.radius) && (double)r->inliers >= 0.6 * expected;
}

static bool try_whole(fg_outline *o, fg_round *r) {
  if (fg_circle_estimate(NULL, o->points, NULL, o->count, &r->circle) != FG_OK) return false;
  double turn = iterate_fit(o, r);
  return is_round(o, r, turn, TURN_MIN) && r->inliers * 10 >= o->count * 7;
}

static bool try_stretches(fg_outline *o, fg_round *best) {
  size_t window = o->count / WINDOW_SHARE;
  best->inliers = 0;
  if (window < POINTS_MIN || o->count > POINTS_PART_MAX) return false;
  for (size_t k = 0; k < WINDOWS; k++) {
    size_t first = k * (o->count - window) / (WINDOWS - 1);
    fg_round r = {0};
    if (fg_circle_estimate(NULL, o->points + first, NULL, window, &r.circle) != FG_OK) continue;
    if (r.circle.radius < 0.5 * o->min_radius) continue;
    double turn = iterate_fit(o, &r);
    if (is_round(o, &r, turn, TURN_MIN_PART) && r.inliers > best->inliers) *best = r;
  }
  return best->inliers > 0;
}

static void remove_inliers(fg_outline *o, fg_round *r) {
  size_t kept = 0;
  weigh_points(o, r);
  for (size_t i = 0; i < o->count; i++)
    if (o->weights[i] == 0) o->points[kept++] = o->points[i];
  o->count = kept;
}

bool fg_outline_extract_circle(fg_outline *outline, fg_round *round) {
  memset(round, 0, sizeof *round);
  if (outline->count < POINTS_MIN) return false;
  if (!try_whole(outline, round) && !try_stretches(outline, round)) return false;
  remove_inliers(outline, round);
  return true;
}
