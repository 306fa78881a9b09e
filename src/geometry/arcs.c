/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/arcs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/spread.h"

#define OUTLIER_SIGMAS 5.0
#define OUTLIER_MIN_MM 0.0003
enum { POINTS_MIN = 8, ROUNDS_MAX = 6 };
/* Departures from an arc's circle that are its fillet and no noise: from this many of its scatter
 * on, but no less than FOOT_MIN_MM, and over FOOT_REACH_MM, where a fillet's departure is still
 * parabolic. */
#define FOOT_SCATTERS 4.0
#define FOOT_MIN_MM   0.0004
#define FOOT_REACH_MM 0.02

fg_status fg_datum_line_build(fg_context *ctx, const fg_strip *strip, fg_datum datum,
                              bool inner_is_right, fg_datum_line *line) {
  memset(line, 0, sizeof *line);
  line->strip = strip;
  line->is_edge = datum != FG_DATUM_MID;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, strip->count, sizeof *line->points, (void **)&line->points));
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, strip->count, sizeof *line->half_width, (void **)&line->half_width));
  bool right = (datum == FG_DATUM_INNER) == inner_is_right;
  for (size_t i = 0; i < strip->count; i++) {
    const fg_station *s = &strip->stations[i];
    fg_point middle = {0.5 * (s->left.x + s->right.x), 0.5 * (s->left.y + s->right.y)};
    line->points[i] = datum == FG_DATUM_MID ? middle : right ? s->right : s->left;
    line->half_width[i] = 0.5 * hypot(s->right.x - s->left.x, s->right.y - s->left.y);
  }
  double l = strip->blur_left_um, r = strip->blur_right_um;
  double square = datum == FG_DATUM_MID ? 0.5 * (l * l + r * r) : right ? r * r : l * l;
  line->blur_mm = 1e-3 * sqrt(square);
exit:
  if (status != FG_OK) fg_datum_line_free(line);
  return status;
}

void fg_datum_line_free(fg_datum_line *line) {
  if (!line) return;
  free(line->points);
  free(line->half_width);
  memset(line, 0, sizeof *line);
}

/* Blur moves an edge of radius R towards the centre by blur²/(2R). */
static double blur_shift(const fg_datum_line *line, double radius) {
  return line->blur_mm * line->blur_mm / (2 * radius);
}

double fg_circle_distance(const fg_circle *circle, fg_point p) {
  return hypot(p.x - circle->x, p.y - circle->y) - circle->radius;
}

double fg_arc_residual(const fg_datum_line *line, const fg_circle *circle, size_t station) {
  if (!(line->strip->stations[station].weight > 0)) return NAN;
  fg_point p = line->points[station];
  double dx = p.x - circle->x, dy = p.y - circle->y;
  return sqrt(dx * dx + dy * dy) - circle->radius + blur_shift(line, circle->radius);
}

static double outlier_limit(const fg_arc *arc) {
  return fmax(OUTLIER_SIGMAS * arc->scatter_mm, OUTLIER_MIN_MM);
}

bool fg_arc_used(const fg_datum_line *line, const fg_arc *arc, size_t station) {
  double r = fg_arc_residual(line, &arc->circle, station);
  return isfinite(r) && fabs(r) <= outlier_limit(arc);
}

static size_t count_stations(const fg_arc *arc) {
  size_t count = 0;
  for (size_t i = 0; i < arc->range_count; i++)
    count += arc->ranges[i].last - arc->ranges[i].first + 1;
  return count;
}

/* Robust sd about the circle; `work` holds all stations of the arc. */
static double find_scatter(const fg_datum_line *line, const fg_arc *arc, double *work) {
  size_t n = 0;
  for (size_t i = 0; i < arc->range_count; i++)
    for (size_t k = arc->ranges[i].first; k <= arc->ranges[i].last; k++) {
      double r = fg_arc_residual(line, &arc->circle, k);
      if (isfinite(r)) work[n++] = fabs(r);
    }
  return n ? fg_robust_sd(work, n) : 0;
}

/* Gathers the usable stations; with `all` outliers too. */
static size_t gather_stations(const fg_datum_line *line, const fg_arc *arc, bool all,
                              fg_point *points) {
  size_t n = 0;
  for (size_t i = 0; i < arc->range_count; i++)
    for (size_t k = arc->ranges[i].first; k <= arc->ranges[i].last; k++)
      if (all ? line->strip->stations[k].weight > 0 : fg_arc_used(line, arc, k))
        points[n++] = line->points[k];
  return n;
}

/* A method to find a circle through points; sets the circle and rms_mm. */
typedef fg_status circle_method(fg_context *ctx, const fg_point *points, size_t count, fg_arc *arc);

static fg_status by_estimate(fg_context *ctx, const fg_point *points, size_t count, fg_arc *arc) {
  return fg_circle_estimate(ctx, points, NULL, count, &arc->circle);
}

static fg_status by_fit(fg_context *ctx, const fg_point *points, size_t count, fg_arc *arc) {
  fg_circle_fit fit;
  FG_TRY(fg_circle_fit_geometric(ctx, points, NULL, count, NULL, &fit));
  arc->circle = fit.circle;
  arc->rms_mm = fit.rms;
  return FG_OK;
}

static fg_status fit_once(fg_context *ctx, const fg_datum_line *line, circle_method *method,
                          const fg_point *points, size_t count, fg_arc *arc) {
  if (count < POINTS_MIN)
    return fg_fail(ctx, FG_ERR_NUMERIC, "%zu edge points are too few for a circle", count);
  FG_TRY(method(ctx, points, count, arc));
  arc->circle.radius += blur_shift(line, arc->circle.radius);
  arc->points = count;
  return FG_OK;
}

/* Fits, drops outliers, and fits again until the points stay the same. */
static fg_status fit_robustly(fg_context *ctx, const fg_datum_line *line, circle_method *method,
                              fg_arc *arc) {
  size_t stations = count_stations(arc), usable = 0, before = 0;
  fg_point *points = NULL;
  double *work = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, stations, sizeof *points, (void **)&points));
  FG_TRY_EXIT(fg_memory_allocate(ctx, stations, sizeof *work, (void **)&work));
  usable = gather_stations(line, arc, true, points);
  FG_TRY_EXIT(fit_once(ctx, line, method, points, usable, arc));
  before = usable;
  for (int round = 0; round < ROUNDS_MAX; round++) {
    arc->scatter_mm = find_scatter(line, arc, work);
    size_t used = gather_stations(line, arc, false, points);
    if (used == before) break;
    FG_TRY_EXIT(fit_once(ctx, line, method, points, used, arc));
    before = used;
  }
  arc->outliers = usable - arc->points;
exit:
  free(points);
  free(work);
  return status;
}

/* A circle of one line. */
typedef struct line_arc {
  const fg_datum_line *line;
  const fg_arc *arc;
} line_arc;

/* Inward shift of a station beyond that of a round blur: the blur along it moves a curved edge. */
static double uneven_shift(const void *user, size_t station) {
  const line_arc *of = user;
  const fg_picture_state *picture = &of->line->strip->picture;
  const fg_station *s = &of->line->strip->stations[station];
  const fg_point *at = &of->line->points[station];
  const fg_circle *circle = &of->arc->circle;
  double max = picture->blur_px[0] * picture->blur_px[0];
  double min = picture->blur_px[1] * picture->blur_px[1];
  double axis = picture->blur_direction_deg * M_PI / 180;
  double across = s->normal.x * cos(axis) + s->normal.y * sin(axis);
  double along = max + (min - max) * across * across;
  bool outwards = (at->x - circle->x) * s->normal.x + (at->y - circle->y) * s->normal.y > 0;
  double excess = 2 * along / (max + min) - 1;
  return (outwards ? 1 : -1) * excess * blur_shift(of->line, circle->radius);
}

static void correct_uneven_blur(const fg_datum_line *line, fg_arc *arc) {
  double shift[3];
  const line_arc of = {line, arc};
  if (!(line->strip->picture.findings & FG_PICTURE_UNEVEN_BLUR) ||
      !fg_arc_shift_by(line, arc, uneven_shift, &of, shift))
    return;
  arc->circle.x += shift[0];
  arc->circle.y += shift[1];
  arc->circle.radius += shift[2];
}

fg_status fg_arc_fit(fg_context *ctx, const fg_datum_line *line, fg_arc *arc) {
  FG_TRY(fit_robustly(ctx, line, by_fit, arc));
  correct_uneven_blur(line, arc);
  return FG_OK;
}

fg_status fg_arc_estimate(fg_context *ctx, const fg_datum_line *line, fg_arc *arc) {
  return fit_robustly(ctx, line, by_estimate, arc);
}

/* Stations from low to high where the line may leave an arc's circle to one side, in the direction
 * of `step`, 1 or -1. */
typedef struct foot_search {
  const fg_datum_line *line;
  const fg_arc *arc;
  double side;
  long step, low, high;
} foot_search;

/* Mean departure over a few stations from `at` on; NaN outside. */
static double departure_mm(const foot_search *s, long at) {
  enum { MEAN_STATIONS = 3 };
  double sum = 0;
  int n = 0;
  for (int i = 0; i < MEAN_STATIONS; i++) {
    long k = at + s->step * i;
    if (k < s->low || k > s->high) break;
    double r = fg_arc_residual(s->line, &s->arc->circle, (size_t)k);
    if (!isfinite(r)) continue;
    sum += s->side * r;
    n++;
  }
  return n ? sum / n : NAN;
}

/* The tangent point beyond the core's end, in stations from it: the foot of sqrt(departure). */
static double find_foot(const foot_search *s, long end) {
  double min = fmax(FOOT_SCATTERS * s->arc->scatter_mm, FOOT_MIN_MM), max = min + FOOT_REACH_MM;
  double s0 = 0, s1 = 0, s2 = 0, r0 = 0, r1 = 0;
  long k = end;
  for (; k >= s->low && k <= s->high; k += s->step) {
    double d = departure_mm(s, k);
    if (d > max) break;
    if (d < min) s0 = s1 = s2 = r0 = r1 = 0; /* noise, not yet the fillet */
    if (!(d >= min)) continue;
    double x = (double)((k - end) * s->step), y = sqrt(d);
    s0 += 1;
    s1 += x;
    s2 += x * x;
    r0 += y;
    r1 += x * y;
  }
  double determinant = s0 * s2 - s1 * s1, reach = (double)((k - end) * s->step);
  if (s0 < 3 || determinant <= 0) return reach;
  double slope = (s0 * r1 - s1 * r0) / determinant, level = (r0 - slope * s1) / s0;
  /* The mean over stations ahead sees the departure one station early. */
  return slope > 0 ? fmin(-level / slope + 1, reach) : reach;
}

void fg_arc_grow(const fg_datum_line *line, const fg_arc *arc, double side, fg_range bounds,
                 fg_range *range) {
  long low = (long)bounds.first, high = (long)bounds.last;
  double margin = 1.5 * line->blur_mm / line->strip->step_mm + 1;
  /* Start inside the core: its ends may already lie on the fillets. */
  long inset = (long)(range->last - range->first) / 6;
  long a = (long)range->first + inset, b = (long)range->last - inset;
  foot_search search = {line, arc, side, -1, low, high};
  double back = find_foot(&search, a) - margin;
  search.step = 1;
  double ahead = find_foot(&search, b) - margin;
  long first = a - (long)floor(back), last = b + (long)floor(ahead);
  if (first < low) first = low;
  if (last > high) last = high;
  if (last - first < POINTS_MIN) return;
  range->first = (size_t)first;
  range->last = (size_t)last;
}
