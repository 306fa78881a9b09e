/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "core/select.h"

enum { GROW_ROUNDS = 3, LAND_POINTS_MIN = 24, GAPS_MAX = 512 };
/* Limits of an arc's end inside and outside the turning point, and its place beyond them. */
#define END_EARLY_MM  0.30
#define END_LATE_MM   0.12
#define END_INSIDE_MM 0.12
/* Max distance of a whole land from the circle of the others. */
#define LAND_OFF_MM 0.05
/* A gap that is longer than this many usual ones has an empty place. */
#define LONG_GAP 1.5

/* Bounds of the stretches between bumps, and beyond the outer two: the places of lands. */
static fg_range gap_bounds(const fg_layout *layout, size_t i) {
  const fg_turning *t = &layout->turning;
  size_t last = layout->line.strip->count - 1;
  fg_range gap = {0, last};
  if (i > 0)
    gap.first = t->bumps[i - 1].last;
  else if (t->lip_first)
    gap.first = t->lip_end[0];
  if (i < t->bump_count)
    gap.last = t->bumps[i].first;
  else if (t->lip_last)
    gap.last = t->lip_end[1];
  return gap;
}

static fg_range middle_part(fg_range range, double share) {
  double length = (double)(range.last - range.first);
  size_t inset = (size_t)(0.5 * (1 - share) * length);
  return (fg_range){range.first + inset, range.last - inset};
}

/* Stations between neighbouring bumps: the lower quartile, or by the design's pitch, which keeps
 * its length along the strip, if that is less. */
static double usual_gap(const fg_layout *layout, const fg_design *design) {
  double gaps[GAPS_MAX], bumps[GAPS_MAX];
  size_t count = 0;
  for (size_t i = 1; i < layout->turning.bump_count && count < GAPS_MAX; i++, count++) {
    const fg_range gap = gap_bounds(layout, i);
    gaps[count] = (double)(gap.last - gap.first);
    bumps[count] = (double)(layout->turning.bumps[i].last - gap.last);
  }
  if (!count) return 0;
  double pitch_mm = design->bumps.pitch_deg * M_PI / 180 * design->overall_radius_mm;
  double designed =
      pitch_mm / layout->line.strip->step_mm - fg_select(bumps, count, (count - 1) / 2);
  double usual = fg_select(gaps, count, (count - 1) / 4);
  return designed > LAND_POINTS_MIN ? fmin(usual, designed) : usual;
}

/* The part of a gap that is as long as the usual one and nearest to its first bump: where the gap
 * is longer, a bump between may be too flat to be seen. */
static fg_range nearest_land(fg_range gap, double usual) {
  if ((double)(gap.last - gap.first) > LONG_GAP * usual) gap.last = gap.first + (size_t)usual;
  return gap;
}

/* A first overall circle through the middles of the gaps between bumps; with fewer than three
 * bumps the end lands help. */
static fg_status start_overall(fg_context *ctx, const fg_design *design, fg_layout *layout) {
  size_t bumps = layout->turning.bump_count, n = 0;
  double usual = usual_gap(layout, design);
  for (size_t i = 1; i < bumps; i++)
    layout->lands[n++] = middle_part(nearest_land(gap_bounds(layout, i), usual), 0.25);
  for (size_t end = 0; end < 2 && bumps < 4; end++) {
    fg_range gap = gap_bounds(layout, end ? bumps : 0);
    if (gap.last > gap.first + 40) layout->lands[n++] = middle_part(gap, 0.3);
  }
  layout->land_count = n;
  layout->overall.ranges = layout->lands;
  layout->overall.range_count = n;
  return fg_arc_estimate(ctx, &layout->line, &layout->overall);
}

/* Max distance from the circle at which a station is near it. */
static double near_limit(const fg_layout *layout) {
  return fmax(6 * layout->overall.scatter_mm, 0.003);
}

/* The longest stretch of a gap near the circle. */
static fg_range find_near(const fg_layout *layout, fg_range gap) {
  fg_range best = {0, 0}, open = {0, 0};
  double limit = near_limit(layout);
  bool inside = false;
  for (size_t k = gap.first; k <= gap.last; k++) {
    double r = fg_arc_residual(&layout->line, &layout->overall.circle, k);
    bool near = isfinite(r) && fabs(r) < limit;
    if (near && !inside) open.first = k;
    if (near) open.last = k;
    if (near && open.last - open.first > best.last - best.first) best = open;
    inside = near || (inside && !isfinite(r));
  }
  return best;
}

/* The longest stretch of a gap that runs along the circle at some distance. */
static fg_range find_along(const fg_layout *layout, fg_range gap, double *distance_mm) {
  fg_range best = {0, 0};
  double limit = near_limit(layout);
  for (size_t first = gap.first; first + (best.last - best.first) < gap.last; first++) {
    double min = INFINITY, max = -INFINITY;
    for (size_t k = first; k <= gap.last; k++) {
      double r = fg_arc_residual(&layout->line, &layout->overall.circle, k);
      if (k == first && !isfinite(r)) break;
      if (!isfinite(r)) continue;
      min = fmin(min, r);
      max = fmax(max, r);
      if (max - min > 2 * limit) break;
      if (fabs(max + min) > 2 * LAND_OFF_MM || k - first <= best.last - best.first) continue;
      best = (fg_range){first, k};
      *distance_mm = 0.5 * (min + max);
    }
  }
  return best;
}

/* Grows a land within `seen`, a stretch of a gap at a distance from the circle. False: on a badly
 * bent strip the core may have grown away from the land altogether. */
static bool grow_land(const fg_layout *layout, fg_range gap, fg_range seen, double distance_mm,
                      fg_range *land) {
  fg_arc shifted = layout->overall;
  shifted.circle.radius += distance_mm;
  *land = middle_part(seen, 0.7);
  fg_arc_grow(&layout->line, &shifted, -1, gap, land);
  if (land->first < seen.first) land->first = seen.first;
  if (land->last > seen.last) land->last = seen.last;
  return land->last > land->first;
}

/* Median number of stations of the lands found; 0 without any. */
static size_t usual_land(const fg_layout *layout) {
  double lengths[GAPS_MAX];
  size_t n = 0;
  for (size_t i = 0; i <= layout->turning.bump_count && n < GAPS_MAX; i++)
    if (layout->lands[i].last)
      lengths[n++] = (double)(layout->lands[i].last - layout->lands[i].first);
  return n ? (size_t)fg_select(lengths, n, n / 2) : 0;
}

fg_distance fg_layout_land_distance(const fg_layout *layout, fg_range land) {
  const fg_circle *circle = &layout->overall.circle;
  fg_point p = fg_strip_middle(layout->line.strip, (land.first + land.last) / 2);
  double dx = p.x - circle->x, dy = p.y - circle->y, d = hypot(dx, dy), sum = 0, n = 0;
  for (size_t k = land.first; k <= land.last; k++) {
    double r = fg_arc_residual(&layout->line, circle, k);
    if (!isfinite(r)) continue;
    sum += r;
    n++;
  }
  return fg_distance_at(dx / d, dy / d, sum / n);
}

/* Fits an oval to the mean distances of the lands found. */
static bool fit_oval(const fg_layout *layout, double oval[FG_SMALL_MAX]) {
  fg_distance distances[GAPS_MAX];
  size_t n = 0;
  for (size_t i = 0; i <= layout->turning.bump_count && n < GAPS_MAX; i++) {
    if (!layout->lands[i].last) continue;
    distances[n] = fg_layout_land_distance(layout, layout->lands[i]);
    n += isfinite(distances[n].mm);
  }
  return n > FG_OVAL_TERMS && isfinite(fg_distances_fit(distances, n, FG_OVAL_TERMS, oval, NULL));
}

/* Finds a land that lies away from the circle of the others as a whole. Of an oval foil it belongs
 * to the circle, which is the one through the part as it is; else the line has jumped. */
static void find_displaced(fg_layout *layout, const double *oval, size_t usual, size_t i) {
  fg_range *land = &layout->lands[i], gap = gap_bounds(layout, i), found;
  double distance_mm = 0, expected_mm = 0;
  if (2 * (land->last - land->first) >= usual) return;
  fg_range along = find_along(layout, gap, &distance_mm);
  if (2 * (along.last - along.first) < usual) return;
  if (!grow_land(layout, gap, along, distance_mm, &found) || 2 * (found.last - found.first) < usual)
    return;
  const fg_distance distance = fg_layout_land_distance(layout, found);
  for (int k = 0; oval && k < FG_OVAL_TERMS; k++)
    expected_mm += oval[k] * distance.row[k];
  double off_mm = distance.mm - expected_mm;
  if (fabs(off_mm) < near_limit(layout)) {
    *land = found;
  } else {
    layout->land_displaced = true;
    layout->gap_off_mm[i] = off_mm;
  }
}

/* Regrows every gap's land from its stations nearest to the circle. End gaps have lip or free end
 * on one side. */
static void regrow_lands(fg_layout *layout) {
  size_t n = 0, gaps = layout->turning.bump_count + 1;
  for (size_t i = 0; i < gaps; i++) {
    fg_range gap = gap_bounds(layout, i), near = find_near(layout, gap);
    bool seen = near.last - near.first >= LAND_POINTS_MIN / 2;
    if (!seen || !grow_land(layout, gap, near, 0, &layout->lands[i]))
      layout->lands[i] = (fg_range){0, 0};
  }
  size_t usual = usual_land(layout);
  double oval[FG_SMALL_MAX];
  bool is_oval = fit_oval(layout, oval);
  layout->land_displaced = false;
  for (size_t i = 0; i < gaps; i++) {
    layout->gap_off_mm[i] = 0;
    find_displaced(layout, is_oval ? oval : NULL, usual, i);
    if (layout->lands[i].last) layout->lands[n++] = layout->lands[i];
  }
  layout->land_count = n;
  layout->overall.ranges = layout->lands;
  layout->overall.range_count = n;
}

/* Checks an arc's ends. The line's direction turns where a bump's arc meets its fillet: an end that
 * was found far from there (a rough edge left the circle early, or stayed near it too long) is put
 * a little inside of it. */
static void check_ends(const fg_layout *layout, const fg_turn *turns, fg_range *range) {
  double step = layout->line.strip->step_mm;
  long inside = lround(END_INSIDE_MM / step), early = lround(END_EARLY_MM / step);
  long late = lround(END_LATE_MM / step);
  long first = (long)range->first - (long)turns->first;
  long last = (long)turns->last - (long)range->last;
  if (2 * (inside + 1) > (long)(turns->last - turns->first)) return;
  if (first > early || first < -late) range->first = turns->first + (size_t)inside;
  if (last > early || last < -late) range->last = turns->last - (size_t)inside;
}

/* One bump: its arc is grown on algebraic circles, the last one is fitted. */
static fg_status fit_bump(fg_context *ctx, void *shared, size_t i) {
  fg_layout *layout = shared;
  fg_arc *arc = &layout->bumps[i];
  const fg_turn *s = &layout->turning.bumps[i];
  fg_range bounds = {s->first, s->last};
  size_t wide = (s->last - s->first) / 8;
  bounds.first = bounds.first > wide ? bounds.first - wide : 0;
  if (bounds.last + wide < layout->line.strip->count) bounds.last += wide;
  layout->bump_ranges[i] = middle_part((fg_range){s->first, s->last}, 0.5);
  arc->ranges = &layout->bump_ranges[i];
  arc->range_count = 1;
  fg_status status = fg_arc_estimate(ctx, &layout->line, arc);
  for (int round = 0; round < GROW_ROUNDS && status == FG_OK; round++) {
    fg_arc_grow(&layout->line, arc, 1, bounds, &layout->bump_ranges[i]);
    check_ends(layout, s, &layout->bump_ranges[i]);
    status = fg_arc_estimate(ctx, &layout->line, arc);
  }
  if (status == FG_OK) status = fg_arc_fit(ctx, &layout->line, arc);
  layout->fitted[i] = status == FG_OK;
  return status == FG_ERR_NUMERIC ? FG_OK : status;
}

static fg_status fit_overall(fg_context *ctx, const fg_design *design, fg_layout *layout,
                             const char **error) {
  fg_status status = start_overall(ctx, design, layout);
  for (int round = 0; round < GROW_ROUNDS && status == FG_OK; round++) {
    regrow_lands(layout);
    if (!layout->land_count) break;
    status = fg_arc_estimate(ctx, &layout->line, &layout->overall);
  }
  if (status == FG_OK && layout->land_count)
    status = fg_arc_fit(ctx, &layout->line, &layout->overall);
  if (status == FG_ERR_MEMORY) return status;
  if (status != FG_OK || layout->land_count < 2)
    *error = "too little of the lands is seen for an overall circle";
  return FG_OK;
}

fg_status fg_layout_find(fg_context *ctx, const fg_design *design, const fg_strip *strip,
                         unsigned threads, fg_layout *layout, const char **error) {
  memset(layout, 0, sizeof *layout);
  *error = NULL;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_turning_find(ctx, strip, &layout->turning));
  size_t bumps = layout->turning.bump_count;
  if (!bumps) {
    *error = "no bumps along the strip";
    goto exit;
  }
  /* Bumps turn round their own centre, which lies on the sleeve's side: when they turn towards the
   * normal (to the right), the shaft is on the left. */
  layout->inner_is_right = layout->turning.sense < 0;
  FG_TRY_EXIT(
      fg_datum_line_build(ctx, strip, design->datum, layout->inner_is_right, &layout->line));
  FG_TRY_EXIT(fg_memory_allocate(ctx, bumps, sizeof(fg_range), (void **)&layout->bump_ranges));
  FG_TRY_EXIT(fg_memory_allocate(ctx, bumps, sizeof(fg_arc), (void **)&layout->bumps));
  FG_TRY_EXIT(fg_memory_allocate(ctx, bumps, sizeof(bool), (void **)&layout->fitted));
  FG_TRY_EXIT(fg_memory_allocate(ctx, bumps + 2, sizeof(fg_range), (void **)&layout->lands));
  FG_TRY_EXIT(fg_memory_allocate(ctx, bumps + 1, sizeof(double), (void **)&layout->gap_off_mm));
  FG_TRY_EXIT(fit_overall(ctx, design, layout, error));
  if (!*error) FG_TRY_EXIT(fg_parallel_run(ctx, threads, bumps, fit_bump, layout));
exit:
  if (status != FG_OK) fg_layout_free(layout);
  return status;
}

void fg_layout_free(fg_layout *layout) {
  if (!layout) return;
  fg_turning_free(&layout->turning);
  fg_datum_line_free(&layout->line);
  free(layout->bump_ranges);
  free(layout->bumps);
  free(layout->fitted);
  free(layout->lands);
  free(layout->gap_off_mm);
  memset(layout, 0, sizeof *layout);
}

void fg_layout_overall(const fg_layout *layout, const fg_design *design, fg_overall *o) {
  const fg_arc *arc = &layout->overall;
  o->centre_mm = (fg_point){arc->circle.x, arc->circle.y};
  o->radius_mm = arc->circle.radius;
  memcpy(o->covariance, arc->covariance, sizeof o->covariance);
  for (int i = 0; i < 2; i++)
    o->u_centre_mm[i] = sqrt(arc->covariance[i][i]);
  o->u_radius_mm = sqrt(arc->covariance[2][2]);
  o->springback_error_pct =
      100 * (design->overall_radius_mm - o->radius_mm) / design->overall_radius_mm;
  o->u_springback_error_pct = 100 * o->u_radius_mm / design->overall_radius_mm;
  o->rms_um = 1000 * arc->rms_mm;
  o->points = arc->points;
}
