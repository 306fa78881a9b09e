/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/cut_floor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "vision/line_end.h"

/* Cosines of directions against the beam's side: across it, and back along it. */
#define ACROSS_FROM 0.96
#define ACROSS_TO   2.18
#define OPPOSITE    2.84
#define ALONG       0.5
/* Min length of the side that leads back, against the part across and in px; facets of a rounded
 * end lead back, too. */
#define OPPOSITE_SHARE 0.7
#define OPPOSITE_MIN   30.0
/* Distance of a blurred sharp corner from the crossing of its lines (its level line runs through
 * Phi(a)² = 1/2, and blur is about 1.5 px). A pixel's side is uncertain by a part of itself. */
#define CORNER_BLUR_PX 1.5
#define CORNER_SHARE   0.4142 /* sqrt(2) - 1: of a corner's radius */
/* A floor is round when it bulges by more than this share of its width, from its middle to halfway
 * out. A half circle bulges by 0.053. */
#define BULGE_SHARE 0.03
#define INNER_SHARE 0.08
#define OUTER_FROM  0.2
#define OUTER_TO    0.25
/* Parts of a round end: points used for its circle, and the arc about its apex. */
#define ROUND_SHARE 0.36
#define ARC_RAD     0.8
/* Margin from the corners of a floor; narrow floors have no more. */
#define FLOOR_MARGIN_PX 4.0
/* Max reach of a shoulder to the side, in widths. */
#define SHOULDER_WIDTHS 3.0

/* The rim from the beam's side to the other side of the cut. */
typedef struct rim_path {
  size_t first, last; /* points, in the rim's order */
  double across;      /* length of its part across the beam */
  size_t longest;     /* longest side in that part; FG_NO_SIDE: none */
  bool opposite;      /* it ends at a side that runs back along the beam */
  size_t other;       /* that side, or the last one inspected */
} rim_path;

static bool is_side_back(const fg_polygon_side *side, const rim_path *w) {
  return side->length > OPPOSITE_MIN && side->length > OPPOSITE_SHARE * w->across;
}

static void add_across(const fg_polygon *rim, size_t at, rim_path *w) {
  w->across += rim->sides[at].length;
  if (w->longest == FG_NO_SIDE || rim->sides[at].length > rim->sides[w->longest].length)
    w->longest = at;
}

static bool walk_to_floor(const fg_polygon *rim, size_t side, bool after, rim_path *w) {
  double turn = 0;
  size_t at = side % rim->count;
  *w =
      (rim_path){.first = rim->sides[at].last, .last = rim->sides[at].first, .longest = FG_NO_SIDE};
  for (size_t k = 1; k < rim->count; k++) {
    size_t next = after ? (at + 1) % rim->count : (at + rim->count - 1) % rim->count;
    turn += after ? fg_polygon_turn(rim->sides[at].angle, rim->sides[next].angle)
                  : fg_polygon_turn(rim->sides[next].angle, rim->sides[at].angle);
    at = next;
    if (-turn > OPPOSITE && is_side_back(&rim->sides[at], w)) {
      w->opposite = true;
      break;
    }
    if (turn > ALONG || (w->across > 0 && -turn < ALONG)) break;
    if (-turn > ACROSS_FROM && -turn < ACROSS_TO) add_across(rim, at, w);
  }
  w->other = at;
  if (after)
    w->last = rim->sides[at].first;
  else
    w->first = rim->sides[at].last;
  return w->opposite || w->across > 0;
}

double fg_corner_radius(const fg_polygon *rim, size_t first, size_t last, fg_point corner) {
  size_t n = fg_polygon_span(rim, first, last), wide = n < rim->point_count / 2 ? 40 : 0;
  double min = INFINITY;
  for (size_t i = 0; i < n + 2 * wide; i++) {
    const fg_point *p = &rim->points[(first + rim->point_count + i - wide) % rim->point_count];
    min = fmin(min, hypot(p->x - corner.x, p->y - corner.y));
  }
  return fmax(0, min - CORNER_BLUR_PX) / CORNER_SHARE;
}

/* The floor in its own frame: u towards the root, v across from the beam's side into the cut. */
typedef struct frame {
  const fg_polygon *rim;
  const fg_straight *line;
  double sign; /* sign of u along the line */
  double gap;  /* width of the cut at the floor */
  rim_path path;
} frame;

static void place_in(const frame *f, fg_point p, double *u, double *v) {
  const fg_straight *l = f->line;
  *u = f->sign * (l->along.x * (p.x - l->at.x) + l->along.y * (p.y - l->at.y));
  *v = -fg_straight_left(l, p);
}

static fg_point place_out(const frame *f, double u, double v) {
  const fg_straight *l = f->line;
  double t = f->sign * u;
  return (fg_point){l->at.x + t * l->along.x + v * l->along.y,
                    l->at.y + t * l->along.y - v * l->along.x};
}

/* Adds the part of a line of the rim whose v lies in a range: its width, and the integral of u. */
static void add_depth(const double from[2], const double to[2], double low, double high,
                      double sums[2]) {
  double a = fmax(low, fmin(from[1], to[1])), b = fmin(high, fmax(from[1], to[1]));
  if (!(b > a)) return;
  double middle = (0.5 * (a + b) - from[1]) / (to[1] - from[1]);
  sums[0] += b - a;
  sums[1] += (b - a) * (from[0] + middle * (to[0] - from[0]));
}

/* Mean of u over the rim whose v lies that far from the cut's middle; NaN without any. A narrow cut
 * has only a few points there. */
static double mean_depth(const frame *f, double from, double to) {
  size_t n = fg_polygon_span(f->rim, f->path.first, f->path.last);
  double sums[2] = {0, 0}, before[2], here[2];
  for (size_t i = 0; i < n; i++) {
    place_in(f, f->rim->points[(f->path.first + i) % f->rim->point_count], &here[0], &here[1]);
    for (int side = -1; i > 0 && side <= 1; side += 2) {
      double near = f->gap * (0.5 + side * from), far = f->gap * (0.5 + side * to);
      add_depth(before, here, fmin(near, far), fmax(near, far), sums);
    }
    memcpy(before, here, sizeof before);
  }
  return sums[0] > 0 ? sums[1] / sums[0] : NAN;
}

/* The stretch between two places of the frame, in the rim's order. */
static fg_stretch stretch_of(const frame *f, double u0, double v0, double u1, double v1,
                             double radius) {
  fg_point near = place_out(f, u0, v0), far = place_out(f, u1, v1);
  bool after = f->sign > 0;
  return (fg_stretch){after ? near : far, after ? far : near, radius,
                      f->path.opposite ? 0.5 * f->gap : 0};
}

/* u = a + b v over the middle of the floor. */
static void fit_floor(const frame *f, double share, double *a, double *b) {
  size_t n = fg_polygon_span(f->rim, f->path.first, f->path.last);
  double s = 0, sv = 0, su = 0, vv = 0, uv = 0, u, v;
  for (size_t i = 0; i < n; i++) {
    place_in(f, f->rim->points[(f->path.first + i) % f->rim->point_count], &u, &v);
    if (fabs(v / f->gap - 0.5) > share) continue;
    s++;
    sv += v;
    su += u;
    vv += v * v;
    uv += u * v;
  }
  double d = s * vv - sv * sv;
  *b = fabs(d) > 1e-9 ? (s * uv - su * sv) / d : 0;
  *a = s > 0 ? (su - *b * sv) / s : NAN;
}

static bool place_straight(const frame *f, fg_cut_floor *floor) {
  double a, b, gap = f->gap;
  fit_floor(f, OUTER_TO, &a, &b);
  fg_point near = place_out(f, a, 0), far = place_out(f, a + b * gap, gap);
  double corner[2] = {fg_corner_radius(f->rim, f->path.first, f->path.last, near),
                      f->path.opposite ? fg_corner_radius(f->rim, f->path.first, f->path.last, far)
                                       : 0};
  double from = corner[0] + FLOOR_MARGIN_PX, to = gap - corner[1] - FLOOR_MARGIN_PX;
  floor->corner = corner[0];
  floor->place = place_out(f, a + 0.5 * b * gap, 0.5 * gap);
  floor->stretch = stretch_of(f, a + b * from, from, a + b * to, to, INFINITY);
  return to - from >= FG_STRETCH_MIN_PX;
}

/* Places a round end by its circle. The parabola u = a + b v + c v² near the apex would do for its
 * place. But a cutter leaves the circle of half the cut's width, and its radius follows from the
 * points. */
static void place_round(const frame *f, fg_cut_floor *floor) {
  double top = mean_depth(f, 0, INNER_SHARE), gap = f->gap,
         side = mean_depth(f, OUTER_TO, ROUND_SHARE);
  double x = 0.5 * (OUTER_TO + ROUND_SHARE) * gap, sagitta = fmax(top - side, 0.01 * gap);
  double radius = fmin(fmax(0.5 * (x * x + sagitta * sagitta) / sagitta, 0.4 * gap), 4 * gap);
  double across = fmin(radius * sin(ARC_RAD), ROUND_SHARE * gap);
  if (f->path.opposite) { /* a start: the circle is found with the arc's stations */
    radius = 0.5 * gap;
    across = FG_END_SHARE * radius;
  }
  double low = top - radius + sqrt(radius * radius - across * across);
  floor->corner = fmin(radius, 0.5 * gap);
  floor->place = place_out(f, top, 0.5 * gap);
  floor->stretch = stretch_of(f, low, 0.5 * gap - across, low, 0.5 * gap + across, radius);
}

/* Width of the cut at its floor: to the other side's line, or to the end of a shoulder. */
static double find_gap(const frame *f, double width_px) {
  double u, v, depth = -INFINITY, gap = 0;
  size_t n = fg_polygon_span(f->rim, f->path.first, f->path.last);
  for (size_t i = 0; i < n; i++) {
    place_in(f, f->rim->points[(f->path.first + i) % f->rim->point_count], &u, &v);
    depth = fmax(depth, u);
    gap = fmax(gap, v);
  }
  if (!f->path.opposite) return fmin(gap, SHOULDER_WIDTHS * width_px);
  const fg_polygon_side *side = &f->rim->sides[f->path.other];
  fg_straight other = fg_polygon_straight(f->rim, side->first, side->last, 0.1);
  fg_straight across = {place_out(f, depth, 0), {f->line->along.y, -f->line->along.x}};
  fg_point meet = fg_straight_meet(&other, &across);
  place_in(f, meet, &u, &v);
  return v;
}

void fg_cut_floor_find(const fg_polygon *rim, size_t side, bool after, const fg_straight *line,
                       double width_px, fg_cut_floor *floor) {
  frame f = {.rim = rim, .line = line, .sign = after ? 1 : -1};
  *floor = (fg_cut_floor){.side = FG_NO_SIDE};
  if (!walk_to_floor(rim, side, after, &f.path)) return;
  f.gap = find_gap(&f, width_px);
  if (!(f.gap > 2)) return;
  double bulge = mean_depth(&f, 0, INNER_SHARE) - mean_depth(&f, OUTER_FROM, OUTER_TO);
  if (isnan(bulge)) return;
  if (!(bulge < BULGE_SHARE * f.gap && place_straight(&f, floor))) place_round(&f, floor);
  floor->found = true;
  floor->side = f.path.longest;
}
