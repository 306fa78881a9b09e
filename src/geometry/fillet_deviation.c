/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The place between two bumps is fitted as a whole: a land, which is a piece of the overall circle
 * at a distance and a slope of its own, and a fillet on either side, a circle that touches the land
 * and the bump's circle. A jump of the line between the arc and the land moves one against the
 * other, and no such circle fits: its radius is wrong, or the line leaves it. */
#include "geometry/fillet_deviation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/small_solve.h"
#include "core/spread.h"

/* Length of the arc that counts, beyond the fillet. */
#define REACH_MM 0.05
/* Limits of the radius of a bump over the median, and of its scatter. */
#define SOUND_RADIUS 1.6
#define SOUND_RMS    2.0
/* Scatter of an arc that jumps over the median: as it is, and of its two pieces. */
#define JUMP_RMS    3.0
#define JUMP_LEAVES 1.5
#define BESIDE_MM   0.1 /* of a jump in an arc, on either side */
/* Min deviation of a radius that counts: in robust standard deviations of all, and relative. */
#define SIGMAS       10.0
#define RADIUS_MIN   0.015
#define BOTH_EDGES   0.75
#define WIDTH_SIGMAS 4.0
#define SAME_WIDTH   0.03 /* max deviation of the strip's width, relative */
#define MAX_STEP     0.3  /* of the logarithm of a radius */
#define CONVERGED    1e-3
enum {
  LEVEL,
  SLOPE,
  FILLETS,
  VALUES = FILLETS + 2,
  FIT_ROUNDS = 12,
  FILLETS_MIN = 6,
  JUMP_TERMS = 4
};

/* A fillet's circle; its arc lies within the directions from `axis` by the half angle. */
typedef struct fillet {
  fg_circle circle;
  fg_point axis;
  double half_cosine;
  fg_point to_land; /* from the bump's end of the arc to the land's */
} fillet;

/* The place between two bumps, or beyond the first or the last. */
typedef struct gap {
  fg_range range;
  size_t middle;  /* stations before it belong to the first fillet */
  bool has[2];    /* the bump before, the bump after */
  bool hidden[2]; /* too little of the fillet is usable */
  double half_width, width_limit;
  fg_circle bumps[2];
  fg_circle overall;
  fg_point tangent;     /* of the land */
  double value[VALUES]; /* mm, mm/mm, logarithms of the radii in mm */
  enum { BOTH, LEFT, RIGHT } edge;
  bool fitted;
} gap;

static fg_circle place_land(const gap *g, const double value[VALUES]) {
  fg_circle land = g->overall;
  land.x += value[SLOPE] * land.radius * g->tangent.x;
  land.y += value[SLOPE] * land.radius * g->tangent.y;
  land.radius += value[LEVEL];
  return land;
}

/* Its centre is R + r from C and R0 - r from O, on the side of the gap. */
static bool place_fillet(const gap *g, const fg_circle *land, int side, double radius, fillet *f) {
  const fg_circle *bump = &g->bumps[side];
  double dx = bump->x - land->x, dy = bump->y - land->y, x = hypot(dx, dy);
  double from_c = bump->radius + radius, from_o = land->radius - radius;
  double along = (from_o * from_o - from_c * from_c + x * x) / (2 * x);
  double square = from_o * from_o - along * along;
  if (!(square > 0) || !(from_o > 0)) return false;
  double across = sqrt(square) / x;
  if ((dx * g->tangent.y - dy * g->tangent.x > 0) == (side == 1)) across = -across;
  along /= x;
  double fx = land->x + along * dx - across * dy, fy = land->y + along * dy + across * dx;
  fg_point to_bump = {(bump->x - fx) / from_c, (bump->y - fy) / from_c};
  fg_point to_land = {(fx - land->x) / from_o, (fy - land->y) / from_o};
  double nx = to_bump.x + to_land.x, ny = to_bump.y + to_land.y, n = hypot(nx, ny);
  if (!(n > 0)) return false;
  *f = (fillet){{fx, fy, radius},
                {nx / n, ny / n},
                (nx * to_land.x + ny * to_land.y) / n,
                {to_land.x - to_bump.x, to_land.y - to_bump.y}};
  return true;
}

/* Distance of a point from the arc, the fillet or the land, away from the foil's centre. */
static double gap_residual(const fillet *f, const fg_circle *bump, const fg_circle *land,
                           fg_point p) {
  double dx = p.x - f->circle.x, dy = p.y - f->circle.y, d = sqrt(dx * dx + dy * dy);
  if (dx * f->axis.x + dy * f->axis.y > f->half_cosine * d) return d - f->circle.radius;
  bool lands = dx * f->to_land.x + dy * f->to_land.y > 0;
  return lands ? fg_circle_distance(land, p) : -fg_circle_distance(bump, p);
}

/* Returns true when a station counts: it is usable, or on a hidden fillet, and the strip is as wide
 * there as elsewhere. Dust moves one edge, a jump both. */
static bool counts(const fg_datum_line *line, const gap *g, int side, size_t k) {
  double off = fabs(line->half_width[k] - g->half_width);
  if (line->strip->stations[k].weight > 0) return off < g->width_limit;
  return g->hidden[side] && off < SAME_WIDTH * g->half_width;
}

static void find_widths(const fg_datum_line *line, double *work, gap *g) {
  size_t n = 0;
  for (size_t k = g->range.first; k <= g->range.last; k++)
    if (line->strip->stations[k].weight > 0) work[n++] = line->half_width[k];
  g->half_width = n ? fg_median(work, n) : NAN;
  for (size_t i = 0; i < n; i++)
    work[i] = fabs(work[i] - g->half_width);
  g->width_limit = fg_spread_limit(work, n, WIDTH_SIGMAS);
}

/* The middle of the strip, as one edge alone shows it, or both. */
static fg_point point_at(const fg_datum_line *line, const gap *g, size_t k) {
  const fg_station *s = &line->strip->stations[k];
  double half = 0.5 * line->strip->thickness_mm;
  if (g->edge == BOTH) return line->points[k];
  if (g->edge == LEFT)
    return (fg_point){s->left.x + half * s->normal.x, s->left.y + half * s->normal.y};
  return (fg_point){s->right.x - half * s->normal.x, s->right.y - half * s->normal.y};
}

/* Fills the residuals of the stations of a gap that count, NaN for others. */
static bool fill_gap_residuals(const fg_datum_line *line, const gap *g, const double value[VALUES],
                               double *residuals) {
  fg_circle land = place_land(g, value);
  fillet fillets[2];
  for (int side = 0; side < 2; side++)
    if (g->has[side] && !place_fillet(g, &land, side, exp(value[FILLETS + side]), &fillets[side]))
      return false;
  for (size_t k = g->range.first; k <= g->range.last; k++) {
    int side = k < g->middle ? 0 : 1;
    size_t i = k - g->range.first;
    residuals[i] = NAN;
    if (counts(line, g, side, k))
      residuals[i] =
          g->has[side] ? gap_residual(&fillets[side], &g->bumps[side], &land, point_at(line, g, k))
                       : fg_circle_distance(&land, point_at(line, g, k));
  }
  return true;
}

/* One step of Gauss and Newton; work has room for VALUES + 1 times the stations. */
static bool step_gap(const fg_datum_line *line, const gap *g, double *work, double *change) {
  static const double by[VALUES] = {1e-4, 1e-4, 1e-2, 1e-2};
  size_t count = g->range.last - g->range.first + 1, n = 0;
  int of[VALUES];
  double x[FG_SMALL_MAX];
  if (!fill_gap_residuals(line, g, g->value, work)) return false;
  for (int v = 0; v < VALUES; v++) {
    if (v >= FILLETS && !g->has[v - FILLETS]) continue;
    double value[VALUES];
    for (int k = 0; k < VALUES; k++)
      value[k] = g->value[k] + (k == v ? by[v] : 0);
    of[n++] = v;
    if (!fill_gap_residuals(line, g, value, work + n * count)) return false;
  }
  fg_normal_equations system;
  fg_normal_clear(&system, n);
  for (size_t i = 0; i < count; i++) {
    double row[VALUES];
    if (!isfinite(work[i])) continue;
    for (size_t v = 0; v < n; v++)
      row[v] = (work[(v + 1) * count + i] - work[i]) / by[of[v]];
    fg_normal_add(&system, row, -work[i], 1);
  }
  if (!fg_normal_solve(&system, 1e-9, x, NULL)) return false;
  for (int v = 0; v < VALUES; v++)
    change[v] = 0;
  for (size_t v = 0; v < n; v++)
    change[of[v]] = x[v];
  return true;
}

/* Fits a gap from a first radius of its fillets. */
static void fit_gap(const fg_datum_line *line, double radius_mm, double *work, gap *g) {
  g->value[LEVEL] = g->value[SLOPE] = 0;
  g->value[FILLETS] = g->value[FILLETS + 1] = log(radius_mm);
  for (int round = 0; round < FIT_ROUNDS; round++) {
    double change[VALUES], share = 1;
    if (!step_gap(line, g, work, change)) return;
    double largest = fmax(fabs(change[FILLETS]), fabs(change[FILLETS + 1]));
    if (largest > MAX_STEP) share = MAX_STEP / largest;
    for (int v = 0; v < VALUES; v++)
      g->value[v] += share * change[v];
    if (largest < CONVERGED) {
      g->fitted = true;
      return;
    }
  }
}

/* A bump whose circle says where its fillets are: neither crushed nor cut. */
static bool is_sound(const fg_layout *layout, size_t i, double radius_mm, double rms_mm) {
  const fg_arc *arc = &layout->bumps[i];
  return layout->fitted[i] && fabs(log(arc->circle.radius / radius_mm)) < log(SOUND_RADIUS) &&
         arc->rms_mm < SOUND_RMS * rms_mm;
}

static size_t min_of(size_t a, size_t b) {
  return a < b ? a : b;
}

static const fg_range *land_between(const fg_layout *layout, const fg_range *before,
                                    const fg_range *after) {
  for (size_t k = 0; k < layout->land_count; k++) {
    const fg_range *land = &layout->lands[k];
    if ((!before || land->first > before->last) && (!after || land->last < after->first))
      return land;
  }
  return NULL;
}

/* Of a fillet: stations between the arc and the land that are not usable, above half. */
static bool is_fillet_hidden(const fg_strip *strip, size_t first, size_t last) {
  size_t hidden = 0;
  for (size_t k = first; k <= last; k++)
    hidden += !(strip->stations[k].weight > 0);
  return 2 * hidden > last - first;
}

/* Prepares the gap before bump i; false: its land or both bumps are missing. */
static bool start_gap(const fg_layout *layout, size_t i, const bool *sound, gap *g) {
  const fg_strip *strip = layout->line.strip;
  size_t bumps = layout->turning.bump_count;
  size_t reach = (size_t)ceil(REACH_MM / strip->step_mm);
  const fg_range *before = i > 0 ? &layout->bump_ranges[i - 1] : NULL;
  const fg_range *after = i < bumps ? &layout->bump_ranges[i] : NULL;
  const fg_range *land = land_between(layout, before, after);
  if (!land) return false;
  if (before && !sound[i - 1]) before = NULL;
  if (after && !sound[i]) after = NULL;
  if (!before && !after) return false;
  fg_point p = layout->line.points[land->first], q = layout->line.points[land->last];
  double length = hypot(q.x - p.x, q.y - p.y);
  *g = (gap){
      .range = {before ? before->last - min_of(reach, before->last - before->first) : land->first,
                after ? min_of(after->first + reach, after->last) : land->last},
      .middle = before && after ? (land->first + land->last) / 2
                : before        ? land->last + 1
                                : land->first,
      .has = {before != NULL, after != NULL},
      .hidden = {before && is_fillet_hidden(strip, before->last, land->first),
                 after && is_fillet_hidden(strip, land->last, after->first)},
      .overall = layout->overall.circle,
      .tangent = {(q.x - p.x) / length, (q.y - p.y) / length}};
  if (before) g->bumps[0] = layout->bumps[i - 1].circle;
  if (after) g->bumps[1] = layout->bumps[i].circle;
  return length > 0;
}

/* Median over the bumps that have a circle. */
static double median_over_bumps(const fg_layout *layout, bool of_rms, double *work) {
  size_t n = 0;
  for (size_t i = 0; i < layout->turning.bump_count; i++)
    if (layout->fitted[i])
      work[n++] = of_rms ? layout->bumps[i].rms_mm : layout->bumps[i].circle.radius;
  return n ? fg_median(work, n) : NAN;
}

/* A jump of the line along x or y behind a station. Stations beside it, whose pixels come from both
 * sides, are left out. */
typedef struct arc_jump {
  size_t at, beside;
  bool along_x;
} arc_jump;

/* Mean squares of an arc's residuals, outliers too, from a circle without and with a jump. */
static bool find_squares(const fg_datum_line *line, const fg_arc *arc, const arc_jump *jump,
                         double squares[2]) {
  fg_normal_equations system;
  double change[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX], n = 0;
  fg_normal_clear(&system, JUMP_TERMS);
  for (size_t k = arc->ranges[0].first; k <= arc->ranges[0].last; k++) {
    double r = fg_arc_residual(line, &arc->circle, k);
    if (!isfinite(r) || (k + jump->beside >= jump->at && k <= jump->at + jump->beside)) continue;
    fg_point p = line->points[k];
    double x = (p.x - arc->circle.x) / arc->circle.radius;
    double y = (p.y - arc->circle.y) / arc->circle.radius;
    const double row[JUMP_TERMS] = {1, x, y, k > jump->at ? (jump->along_x ? x : y) : 0};
    fg_normal_add(&system, row, r, 1);
    n++;
  }
  if (n < 2 * JUMP_TERMS || !fg_normal_solve(&system, 1e-9, change, inverse)) return false;
  squares[1] = system.sum_squares;
  for (int i = 0; i < JUMP_TERMS; i++)
    squares[1] -= change[i] * system.right[i];
  double gain =
      change[JUMP_TERMS - 1] * change[JUMP_TERMS - 1] / inverse[JUMP_TERMS - 1][JUMP_TERMS - 1];
  squares[0] = (squares[1] + gain) / n;
  squares[1] /= n;
  return true;
}

/* Returns true when a bump's arc is no circle within its scatter, but two displaced pieces of one.
 */
static bool has_jump(const fg_layout *layout, const fg_arc *arc, double rms_mm) {
  const fg_datum_line *line = &layout->line;
  const fg_range range = arc->ranges[0];
  size_t beside = (size_t)ceil(BESIDE_MM / line->strip->step_mm);
  double square = rms_mm * rms_mm, squares[2];
  if (!arc->outliers && arc->rms_mm < JUMP_RMS * rms_mm) return false;
  for (size_t at = range.first + 2 * beside; at + 2 * beside < range.last; at += 2)
    for (int axis = 0; axis < 2; axis++)
      if (find_squares(line, arc, &(arc_jump){at, beside, axis}, squares) &&
          squares[0] > JUMP_RMS * JUMP_RMS * square &&
          squares[1] < JUMP_LEAVES * JUMP_LEAVES * square)
        return true;
  return false;
}

typedef struct fillet_search {
  const fg_layout *layout;
  double start_mm; /* of the radii */
  bool *sound;     /* per bump */
  double *work;
  double *radii; /* logarithms of the radii in mm */
  double *sizes;
  size_t *places; /* of the radii: twice the gap, and the side */
  size_t count;
} fillet_search;

/* Fits one gap by both edges or one. */
static bool fit_gap_by(const fillet_search *s, size_t i, int edge, gap *g) {
  const fg_datum_line *line = &s->layout->line;
  if (!start_gap(s->layout, i, s->sound, g)) return false;
  g->edge = edge;
  find_widths(line, s->work, g);
  fit_gap(line, s->start_mm, s->work, g);
  if (g->fitted) return true;
  g->hidden[0] = g->hidden[1] = true; /* too few usable stations on a fillet */
  fit_gap(line, s->start_mm, s->work, g);
  return g->fitted;
}

static void list_radii(fillet_search *s) {
  for (size_t i = 0; i <= s->layout->turning.bump_count; i++) {
    gap g;
    if (!fit_gap_by(s, i, BOTH, &g)) continue;
    for (size_t side = 0; side < 2; side++)
      if (g.has[side]) {
        s->places[s->count] = 2 * i + side;
        s->radii[s->count++] = g.value[FILLETS + side];
      }
  }
}

/* Returns true when each edge alone shows the fillet's radius off the median by nearly as
 * much as both do. Dust moves one edge. */
static bool is_in_both_edges(const fillet_search *s, size_t k, double median) {
  double off = s->radii[k] - median;
  for (int edge = LEFT; edge <= RIGHT; edge++) {
    gap g;
    if (!fit_gap_by(s, s->places[k] / 2, edge, &g)) return false;
    if (!((g.value[FILLETS + s->places[k] % 2] - median) / off > BOTH_EDGES)) return false;
  }
  return true;
}

static bool has_outlier(const fillet_search *s) {
  if (s->count < FILLETS_MIN) return false;
  memcpy(s->sizes, s->radii, s->count * sizeof *s->sizes);
  double median = fg_median(s->sizes, s->count);
  for (size_t i = 0; i < s->count; i++)
    s->sizes[i] = fabs(s->radii[i] - median);
  double limit = fmax(fg_spread_limit(s->sizes, s->count, SIGMAS), RADIUS_MIN);
  for (size_t i = 0; i < s->count; i++)
    if (fabs(s->radii[i] - median) > limit && is_in_both_edges(s, i, median)) return true;
  return false;
}

fg_status fg_fillet_deviation_find(fg_context *ctx, const fg_design *design,
                                   const fg_layout *layout, bool *deviates) {
  size_t bumps = layout->turning.bump_count, count = (VALUES + 1) * layout->line.strip->count;
  fillet_search s = {.layout = layout, .start_mm = design->bumps.fillet_radius_mm};
  fg_status status = FG_OK;
  *deviates = false;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count + 4 * bumps, sizeof *s.work, (void **)&s.work));
  FG_TRY_EXIT(fg_memory_allocate(ctx, bumps, sizeof *s.sound, (void **)&s.sound));
  FG_TRY_EXIT(fg_memory_allocate(ctx, 2 * bumps, sizeof *s.places, (void **)&s.places));
  s.radii = s.work + count;
  s.sizes = s.radii + 2 * bumps;
  double radius_mm = median_over_bumps(layout, false, s.radii);
  double rms_mm = median_over_bumps(layout, true, s.radii);
  for (size_t i = 0; i < bumps; i++) {
    s.sound[i] = is_sound(layout, i, radius_mm, rms_mm);
    if (layout->fitted[i] && has_jump(layout, &layout->bumps[i], rms_mm)) *deviates = true;
  }
  list_radii(&s);
  *deviates |= has_outlier(&s);
exit:
  free(s.places);
  free(s.sound);
  free(s.work);
  return status;
}
