/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/polygon.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

/* Limits for joining two sides parted by something small, or by roughness. Their directions differ
 * by less than this angle and the one of so many tolerances over the shorter side. The ends between
 * them are as near to their common chord. The gap is at most this share of them, and neither is a
 * facet of the other. */
#define JOIN_RAD        0.03
#define JOIN_TOLERANCES 2.5
#define JOIN_SHARE      0.25
#define FACET_SHARE     0.12

double fg_polygon_turn(double from, double to) {
  return remainder(to - from, 2 * M_PI);
}

double fg_straight_left(const fg_straight *line, fg_point p) {
  return line->along.x * (p.y - line->at.y) - line->along.y * (p.x - line->at.x);
}

/* The farthest point from the chord of points[first] and points[last]; its distance. */
static double find_farthest(const fg_point *points, size_t count, size_t first, size_t last,
                            size_t *farthest) {
  const fg_point *a = &points[first], *b = &points[last % count];
  double dx = b->x - a->x, dy = b->y - a->y, length = hypot(dx, dy), max = -1;
  for (size_t i = first + 1; i < last; i++) {
    double x = points[i].x - a->x, y = points[i].y - a->y;
    double off = length > 1e-9 ? fabs(dx * y - dy * x) / length : hypot(x, y);
    if (off > max) {
      max = off;
      *farthest = i;
    }
  }
  return max;
}

typedef struct corners {
  size_t *at; /* in no order until sorted */
  size_t count, capacity;
} corners;

static fg_status push_corner(fg_context *ctx, corners *c, size_t at) {
  FG_TRY(fg_memory_reserve(ctx, c->count + 1, sizeof *c->at, &c->capacity, (void **)&c->at));
  c->at[c->count++] = at;
  return FG_OK;
}

/* Finds corners between two places of the line, by an explicit stack of the parts to be split. */
static fg_status split_line(fg_context *ctx, const fg_point *points, size_t count, double tolerance,
                            size_t first, size_t last, corners *found) {
  corners stack = {0};
  fg_status status = FG_OK;
  FG_TRY_EXIT(push_corner(ctx, &stack, last));
  while (stack.count) {
    size_t end = stack.at[stack.count - 1], farthest = 0;
    if (find_farthest(points, count, first, end, &farthest) > tolerance) {
      FG_TRY_EXIT(push_corner(ctx, &stack, farthest));
      continue;
    }
    FG_TRY_EXIT(push_corner(ctx, found, end));
    first = end;
    stack.count--;
  }
exit:
  free(stack.at);
  return status;
}

static void fill_side(const fg_polygon *p, size_t first, size_t last, fg_polygon_side *side) {
  const fg_point *a = &p->points[first], *b = &p->points[last];
  *side = (fg_polygon_side){.first = first,
                            .last = last,
                            .angle = atan2(b->y - a->y, b->x - a->x),
                            .length = hypot(b->x - a->x, b->y - a->y)};
}

static bool is_one(const fg_polygon *p, const fg_polygon_side *a, const fg_polygon_side *b,
                   double tolerance) {
  double between = (double)fg_polygon_span(p, a->last, b->first);
  if (between > JOIN_SHARE * (a->length + b->length)) return false;
  double shorter = fmin(a->length, b->length), longer = fmax(a->length, b->length);
  double near = JOIN_TOLERANCES * tolerance;
  if (shorter < FACET_SHARE * longer) return false;
  if (fabs(fg_polygon_turn(a->angle, b->angle)) > JOIN_RAD + near / shorter) return false;
  fg_polygon_side both;
  fill_side(p, a->first, b->last, &both);
  fg_straight chord = {p->points[a->first], {cos(both.angle), sin(both.angle)}};
  return fabs(fg_straight_left(&chord, p->points[a->last])) < near &&
         fabs(fg_straight_left(&chord, p->points[b->first])) < near;
}

/* Returns the next side after `i` that continues it; 0 where there is none. */
static size_t find_continuation(const fg_polygon *p, size_t i, double tolerance) {
  size_t best = 0;
  for (size_t k = 1; k + 1 < p->count && k < 12; k++) {
    const fg_polygon_side *next = &p->sides[(i + k) % p->count];
    if ((double)fg_polygon_span(p, p->sides[i].last, next->first) >
        JOIN_SHARE * (p->sides[i].length + next->length) + 200)
      break;
    if (is_one(p, &p->sides[i], next, tolerance)) best = k;
  }
  return best;
}

static void join_sides(fg_polygon *p, double tolerance) {
  for (size_t i = 0; i < p->count;) {
    size_t rest = find_continuation(p, i, tolerance);
    if (!rest || i + rest >= p->count) {
      i++;
      continue;
    }
    fill_side(p, p->sides[i].first, p->sides[i + rest].last, &p->sides[i]);
    memmove(p->sides + i + 1, p->sides + i + rest + 1,
            (p->count - i - rest - 1) * sizeof *p->sides);
    p->count -= rest;
  }
}

/* Returns a corner to start at: the point farthest from the line's middle one. */
static size_t find_start(const fg_point *points, size_t count, const fg_point *from) {
  double max = -1;
  size_t start = 0;
  for (size_t i = 0; i < count; i++) {
    double off = hypot(points[i].x - from->x, points[i].y - from->y);
    if (off > max) {
      max = off;
      start = i;
    }
  }
  return start;
}

fg_status fg_polygon_make(fg_context *ctx, const fg_point *points, size_t count, double tolerance,
                          fg_polygon *polygon) {
  corners found = {0};
  fg_point *turned = NULL;
  fg_status status = FG_OK;
  *polygon = (fg_polygon){.points = points, .point_count = count};
  size_t start = find_start(points, count, &points[0]);
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *turned, (void **)&turned));
  for (size_t i = 0; i < count; i++)
    turned[i] = points[(start + i) % count];
  size_t other = find_start(turned, count, &turned[0]);
  FG_TRY_EXIT(split_line(ctx, turned, count, tolerance, 0, other, &found));
  FG_TRY_EXIT(split_line(ctx, turned, count, tolerance, other, count, &found));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, found.count, sizeof *polygon->sides, (void **)&polygon->sides));
  size_t first = 0;
  for (size_t i = 0; i < found.count; i++) {
    size_t last = found.at[i] % count;
    fill_side(polygon, (first + start) % count, (last + start) % count,
              &polygon->sides[polygon->count++]);
    first = last;
  }
  join_sides(polygon, tolerance);
exit:
  free(turned);
  free(found.at);
  return status;
}

void fg_polygon_free(fg_polygon *polygon) {
  free(polygon->sides);
  memset(polygon, 0, sizeof *polygon);
}

/* Fits a line to the points of a stretch within `limit` of a line. */
static fg_straight fit_line(const fg_polygon *p, size_t first, size_t n, const fg_straight *near,
                            double limit) {
  double sx = 0, sy = 0, xx = 0, xy = 0, yy = 0, used = 0;
  fg_point o = p->points[first % p->point_count];
  for (size_t i = 0; i < n; i++) {
    fg_point q = p->points[(first + i) % p->point_count];
    if (near && fabs(fg_straight_left(near, q)) > limit) continue;
    double x = q.x - o.x, y = q.y - o.y;
    sx += x;
    sy += y;
    xx += x * x;
    xy += x * y;
    yy += y * y;
    used++;
  }
  sx /= used;
  sy /= used;
  double angle = 0.5 * atan2(2 * (xy / used - sx * sy), xx / used - sx * sx - yy / used + sy * sy);
  return (fg_straight){.at = {o.x + sx, o.y + sy}, .along = {cos(angle), sin(angle)}};
}

fg_straight fg_polygon_straight(const fg_polygon *polygon, size_t first, size_t last, double trim) {
  size_t n = fg_polygon_span(polygon, first, last), cut = (size_t)(trim * (double)n);
  const fg_point *a = &polygon->points[first], *b = &polygon->points[last];
  fg_straight line = fit_line(polygon, first + cut, n - 2 * cut, NULL, 0);
  line = fit_line(polygon, first + cut, n - 2 * cut, &line, 3);
  if (line.along.x * (b->x - a->x) + line.along.y * (b->y - a->y) < 0)
    line.along = (fg_point){-line.along.x, -line.along.y};
  return line;
}

fg_point fg_straight_meet(const fg_straight *a, const fg_straight *b) {
  double cross = a->along.x * b->along.y - a->along.y * b->along.x;
  if (fabs(cross) < 1e-6) return (fg_point){NAN, NAN};
  double t = ((b->at.x - a->at.x) * b->along.y - (b->at.y - a->at.y) * b->along.x) / cross;
  return (fg_point){a->at.x + t * a->along.x, a->at.y + t * a->along.y};
}
