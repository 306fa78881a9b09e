/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "vision/reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/small_solve.h"

/* A node: traced point i, smoothed. */
typedef fg_reference_station node;

/* Parabola in the chord parameter through the points within the window around i. The slope gives
 * the tangent, slope and second derivative the curvature. */
static bool smooth_node(const fg_point *points, const double *chord, size_t count, size_t i,
                        double window_px, node *out) {
  size_t from = i, to = i;
  while (from > 0 && (chord[i] - chord[from - 1] <= window_px || i - from < 3))
    from--;
  while (to + 1 < count && (chord[to + 1] - chord[i] <= window_px || to - i < 3))
    to++;
  fg_normal_equations sx, sy;
  fg_normal_clear(&sx, 3);
  fg_normal_clear(&sy, 3);
  for (size_t j = from; j <= to; j++) {
    double u = (chord[j] - chord[i]) / window_px, v = u / 1.5;
    double weight = v * v < 1 ? (1 - v * v) * (1 - v * v) : 1e-3;
    double row[3] = {1, u, u * u};
    fg_normal_add(&sx, row, points[j].x - points[i].x, weight);
    fg_normal_add(&sy, row, points[j].y - points[i].y, weight);
  }
  double cx[3], cy[3];
  if (!fg_normal_solve(&sx, 0, cx, NULL) || !fg_normal_solve(&sy, 0, cy, NULL)) return false;
  double speed = hypot(cx[1], cy[1]);
  if (!(speed > 0)) return false;
  *out = (node){.x = points[i].x + cx[0],
                .y = points[i].y + cy[0],
                .tx = cx[1] / speed,
                .ty = cy[1] / speed,
                .curvature = 2 * (cx[1] * cy[2] - cy[1] * cx[2]) / (speed * speed * speed)};
  return true;
}

/* Cubic Hermite between two nodes at the fraction f. */
static fg_reference_station point_between(const node *a, const node *b, double length, double f) {
  double f2 = f * f, f3 = f2 * f;
  double h0 = 2 * f3 - 3 * f2 + 1, h1 = f3 - 2 * f2 + f, h2 = 3 * f2 - 2 * f3, h3 = f3 - f2;
  double d0 = 6 * (f2 - f), d1 = 3 * f2 - 4 * f + 1, d3 = 3 * f2 - 2 * f;
  fg_reference_station s;
  s.x = h0 * a->x + h1 * length * a->tx + h2 * b->x + h3 * length * b->tx;
  s.y = h0 * a->y + h1 * length * a->ty + h2 * b->y + h3 * length * b->ty;
  s.tx = d0 * (a->x - b->x) / length + d1 * a->tx + d3 * b->tx;
  s.ty = d0 * (a->y - b->y) / length + d1 * a->ty + d3 * b->ty;
  double norm = hypot(s.tx, s.ty);
  s.tx /= norm;
  s.ty /= norm;
  s.curvature = (1 - f) * a->curvature + f * b->curvature;
  return s;
}

/* Length of the arc between two nodes: the chord, corrected for the curvature. */
static double arc_between(const node *a, const node *b) {
  double chord = hypot(b->x - a->x, b->y - a->y);
  double k = 0.5 * (a->curvature + b->curvature);
  return chord * (1 + k * k * chord * chord / 24);
}

static fg_status resample_nodes(fg_context *ctx, const node *nodes, size_t count, double step_px,
                                fg_reference *out) {
  double total = 0;
  for (size_t i = 1; i < count; i++)
    total += arc_between(&nodes[i - 1], &nodes[i]);
  size_t wanted = (size_t)(total / step_px) + 1;
  FG_TRY(fg_memory_allocate(ctx, wanted, sizeof *out->stations, (void **)&out->stations));
  double at = 0, next = 0;
  for (size_t i = 1; i < count; i++) {
    double length = arc_between(&nodes[i - 1], &nodes[i]);
    while (next <= at + length && out->count < wanted && length > 0) {
      out->stations[out->count++] =
          point_between(&nodes[i - 1], &nodes[i], length, (next - at) / length);
      next += step_px;
    }
    at += length;
  }
  out->step_px = step_px;
  return FG_OK;
}

/* Sets tangent and curvature of the line itself (central differences over two steps). A local
 * parabola's own slope and curvature belong to a smoother line than its positions do, and the
 * difference would shift pixels that lie obliquely to their station. */
static void differentiate_line(fg_reference *line) {
  enum { REACH = 2 };
  if (line->count <= 2 * REACH) return;
  double h = REACH * line->step_px;
  for (size_t i = REACH; i + REACH < line->count; i++) {
    fg_reference_station *s = &line->stations[i];
    double dx = s[REACH].x - s[-REACH].x, dy = s[REACH].y - s[-REACH].y;
    double bend_x = s[REACH].x - 2 * s->x + s[-REACH].x;
    double bend_y = s[REACH].y - 2 * s->y + s[-REACH].y;
    double norm = hypot(dx, dy);
    s->tx = dx / norm;
    s->ty = dy / norm;
    s->curvature = (s->tx * bend_y - s->ty * bend_x) / (h * h);
  }
}

fg_status fg_reference_build(fg_context *ctx, const fg_point *points, size_t count,
                             double window_px, double step_px, fg_reference *reference) {
  memset(reference, 0, sizeof *reference);
  fg_status status = FG_OK;
  double *chord = NULL;
  node *nodes = NULL;
  size_t kept = 0;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *chord, (void **)&chord));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *nodes, (void **)&nodes));
  for (size_t i = 1; i < count; i++)
    chord[i] = chord[i - 1] + hypot(points[i].x - points[i - 1].x, points[i].y - points[i - 1].y);
  for (size_t i = 0; i < count; i++)
    if (smooth_node(points, chord, count, i, window_px, &nodes[kept])) kept++;
  FG_TRY_EXIT(resample_nodes(ctx, nodes, kept, step_px, reference));
  differentiate_line(reference);
exit:
  free(chord);
  free(nodes);
  if (status != FG_OK) fg_reference_free(reference);
  return status;
}

void fg_reference_free(fg_reference *reference) {
  if (!reference) return;
  free(reference->stations);
  memset(reference, 0, sizeof *reference);
}
