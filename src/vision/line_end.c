/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/line_end.h"

#include <math.h>

#include "core/small_solve.h"

enum { ROUNDS = 8, STATIONS_MIN = 4 };
#define MOVED_PX 2e-4
/* Range of the radius in half widths of the cut; beyond it an end is flat. */
#define RADIUS_MIN 0.7
#define RADIUS_MAX 50.0
/* Half chord of the arc at a flat end, which may have corners, in half widths. */
#define FLAT_SHARE 0.7

/* An end that has become as flat as this, in half widths, is tried as a flat one. It stays flat
 * unless its stations then drop towards the ends by so many standard uncertainties: noise would
 * make circles of flat ends, which reach deeper, and never the opposite. */
#define FLAT_TRIED       2.0
#define ROUND_DEVIATIONS 3.0

/* Deviation of the stations from the arc towards the material: at its apex, and at its ends against
 * that. */
typedef struct arc_change {
  double apex, ends, u_ends;
} arc_change;

static bool is_round_end(const arc_change *change) {
  return change->ends > ROUND_DEVIATIONS * change->u_ends;
}

bool fg_line_end_is_flat(const fg_stretch *s) {
  return isinf(s->radius) || (s->half_width > 0 && s->radius >= RADIUS_MAX * s->half_width);
}

static double half_angle(const fg_stretch *s) {
  return 0.5 * fg_stretch_length(s) / s->radius;
}

/* Finds the circle's deviation from the arc: at the direction f from the middle of the cut
 * a + b cos f + c sin f. */
static bool find_change(const fg_stretch *s, const fg_disc_edge *edge, arc_change *change) {
  double half = half_angle(s), x[FG_SMALL_MAX] = {0}, inverse[FG_SMALL_MAX][FG_SMALL_MAX];
  double variance = 0;
  fg_normal_equations system;
  size_t used = 0;
  fg_normal_clear(&system, 3);
  for (size_t i = 0; i < edge->count; i++) {
    const fg_disc_station *at = &edge->stations[i];
    if (!(at->weight > 0)) continue;
    double f = half * (2 * ((double)i + 0.5) / (double)edge->count - 1);
    const double row[3] = {1, (1 - cos(f)) / (1 - cos(half)), sin(f)};
    fg_normal_add(&system, row, -(double)at->edge_px, 1);
    variance += (double)at->u_px * (double)at->u_px;
    used++;
  }
  if (used < STATIONS_MIN || !fg_normal_solve(&system, 0, x, inverse)) return false;
  *change = (arc_change){x[0], x[1], sqrt(inverse[1][1] * variance / (double)used)};
  if (fg_line_end_is_flat(s) && !is_round_end(change))
    *change = (arc_change){.apex = x[0] + x[1] / 3}; /* the stations' mean: their drop is noise */
  return true;
}

/* Radius of the arc through the moved apex and ends; `tried` as a flat one before. */
static double find_radius(const fg_stretch *s, const arc_change *change, bool *tried) {
  double half = half_angle(s), flat = fmax(s->radius, RADIUS_MAX * s->half_width);
  double end = s->radius + change->apex + change->ends, across = end * sin(half);
  double drop = s->radius + change->apex - end * cos(half);
  if (!(drop > 0.5 * across * across / flat) || (fg_line_end_is_flat(s) && change->ends == 0))
    return flat;
  double radius = fmax(0.5 * (across * across + drop * drop) / drop, RADIUS_MIN * s->half_width);
  if (*tried || radius < FLAT_TRIED * s->half_width) return radius;
  *tried = true;
  return flat;
}

static double depth_of(double radius, double across) {
  return radius - sqrt(radius * radius - across * across);
}

static void move_arc(fg_stretch *s, const arc_change *change, bool *tried) {
  double chord = hypot(s->to.x - s->from.x, s->to.y - s->from.y), width = s->half_width;
  double radius = find_radius(s, change, tried),
         flat = FLAT_SHARE + (FG_END_SHARE - FLAT_SHARE) * width / radius;
  double across = fmin(FG_END_SHARE * radius, width * fmin(flat, FG_END_SHARE));
  double deep = change->apex + depth_of(s->radius, 0.5 * chord) - depth_of(radius, across);
  fg_point along = {(s->to.x - s->from.x) / chord, (s->to.y - s->from.y) / chord};
  /* The material lies to the left, where y points up. */
  fg_point middle = {0.5 * (s->from.x + s->to.x) - deep * along.y,
                     0.5 * (s->from.y + s->to.y) + deep * along.x};
  s->from = (fg_point){middle.x - across * along.x, middle.y - across * along.y};
  s->to = (fg_point){middle.x + across * along.x, middle.y + across * along.y};
  s->radius = radius;
}

fg_status fg_line_end_measure(fg_context *ctx, const fg_line_view *view, const fg_line_tone *tone,
                              fg_stretch *stretch, fg_line_found *found) {
  arc_change change;
  bool tried = false;
  FG_TRY(fg_line_edge_measure(ctx, view, stretch, tone, found));
  if (!fg_line_edge_has_end(stretch, tone)) return FG_OK;
  for (int round = 0; round < ROUNDS; round++) {
    if (!find_change(stretch, &found->edge, &change)) return FG_OK;
    if (fmax(fabs(change.apex), fabs(change.ends)) < MOVED_PX) return FG_OK;
    move_arc(stretch, &change, &tried);
    fg_disc_edge_free(&found->edge);
    FG_TRY(fg_line_edge_measure(ctx, view, stretch, tone, found));
  }
  return FG_OK;
}
