/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/arc_foil.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "geometry/foil_uncertainty.h"

/* Number of stretches of the circle; their differences test that it is one. */
enum { STRETCHES = 12, ROUNDS = 5, STATIONS_MIN = 64, BUMPS_MIN = 3 };
/* Share of the strip in the first fit, around the middle: a lip is shorter than the remainder. */
#define MIDDLE_SHARE 0.6
/* Departure from the circle, in thicknesses, that is a bend. Springback deviates from a circle by
 * less: 0.1 mm. */
#define AWAY_THICKNESSES 1.0
/* Begin of a lip's bend before that departure, in thicknesses: the line leaves with the square of
 * the distance, t = w² / (2 r) with a bend of r = 10 t. */
#define BEND_THICKNESSES 5.0
/* Min length of a departure, in thicknesses: at an end a lip, within the strip a bump or a dent. */
#define LIP_THICKNESSES  3.0
#define BUMP_THICKNESSES 5.0
/* Min share of the strip on the circle; below it the object is no such strip. */
#define COVER_SHARE 0.5

static double away_mm(const fg_strip *strip) {
  return AWAY_THICKNESSES * strip->thickness_mm;
}

/* Cuts stations [from, to] of the strip into stretches of equal length. */
static void cut_stretches(fg_layout *layout, size_t from, size_t to) {
  size_t count = to - from + 1;
  for (size_t i = 0; i < STRETCHES; i++)
    layout->lands[i] =
        (fg_range){from + i * count / STRETCHES, from + (i + 1) * count / STRETCHES - 1};
  layout->land_count = STRETCHES;
  layout->overall.ranges = layout->lands;
  layout->overall.range_count = STRETCHES;
}

/* Returns the farthest station on the circle from the middle in the direction of `step`. */
static size_t reach_of_circle(const fg_layout *layout, int step) {
  const fg_strip *strip = layout->line.strip;
  double limit = away_mm(strip), gone = 0;
  size_t last = strip->count / 2;
  for (size_t k = strip->count / 2; k < strip->count; k += (size_t)step) {
    double r = fg_arc_residual(&layout->line, &layout->overall.circle, k);
    if (!isfinite(r)) continue;
    if (fabs(r) <= limit) {
      last = k;
      gone = 0;
    } else if ((gone += strip->step_mm) > strip->step_mm * (double)strip->count / 4) {
      break; /* on the other side of a full turn it may come back */
    }
  }
  return last;
}

static size_t end_station(const fg_strip *strip, bool last) {
  for (size_t k = 0; k < strip->count; k++) {
    size_t i = last ? strip->count - 1 - k : k;
    if (strip->stations[i].weight > 0) return i;
  }
  return last ? strip->count - 1 : 0;
}

static size_t stations_in(const fg_strip *strip, double mm) {
  return (size_t)ceil(mm / strip->step_mm);
}

/* Finds one end of the circle's part. A remainder beyond it is a lip, unless it is shorter than
 * LIP_THICKNESSES.
 */
static size_t arc_end(fg_layout *layout, bool last) {
  const fg_strip *strip = layout->line.strip;
  size_t at = reach_of_circle(layout, last ? 1 : -1), end = end_station(strip, last);
  size_t beyond = last ? end - at : at - end, middle = strip->count / 2;
  if (beyond < stations_in(strip, LIP_THICKNESSES * strip->thickness_mm)) return end;
  *(last ? &layout->turning.lip_last : &layout->turning.lip_first) = true;
  layout->turning.lip_end[last] = at;
  size_t back = stations_in(strip, BEND_THICKNESSES * strip->thickness_mm);
  size_t room = last ? at - middle : middle - at;
  if (back > room) back = room;
  return last ? at - back : at + back;
}

static fg_status fit_arc_ends(fg_context *ctx, fg_layout *layout) {
  size_t count = layout->line.strip->count;
  size_t inset = (size_t)(0.5 * (1 - MIDDLE_SHARE) * (double)count);
  cut_stretches(layout, inset, count - 1 - inset);
  FG_TRY(fg_arc_estimate(ctx, &layout->line, &layout->overall));
  for (int round = 0; round < ROUNDS; round++) {
    layout->turning.lip_first = layout->turning.lip_last = false;
    size_t from = arc_end(layout, false), to = arc_end(layout, true);
    if (to < from + STATIONS_MIN)
      return fg_fail(ctx, FG_ERR_NUMERIC, "too little of the strip lies on one circle");
    cut_stretches(layout, from, to);
    FG_TRY(fg_arc_estimate(ctx, &layout->line, &layout->overall));
  }
  return fg_arc_fit(ctx, &layout->line, &layout->overall);
}

/* Share of the circle's part that lies on it, and the longest stretch that does not. */
static double arc_cover(const fg_layout *layout, double *longest_mm) {
  const fg_strip *strip = layout->line.strip;
  size_t from = layout->lands[0].first, to = layout->lands[STRETCHES - 1].last;
  size_t on = 0, all = 0, run = 0, longest = 0;
  for (size_t k = from; k <= to; k++) {
    double r = fg_arc_residual(&layout->line, &layout->overall.circle, k);
    if (!isfinite(r)) continue;
    bool away = fabs(r) > away_mm(strip);
    run = away ? run + 1 : 0;
    if (run > longest) longest = run;
    on += !away;
    all++;
  }
  *longest_mm = strip->step_mm * (double)longest;
  return all ? (double)on / (double)all : 0;
}

/* Finds the strip's sense of turning from three places of the middle. */
static bool centre_is_right(const fg_strip *strip) {
  size_t n = strip->count;
  fg_point a = fg_strip_middle(strip, n / 5), b = fg_strip_middle(strip, n / 2);
  fg_point c = fg_strip_middle(strip, n - 1 - n / 5);
  return (b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x) > 0;
}

/* Counts the strip's turns back: a foil with bumps has them. */
static fg_status count_bumps(fg_context *ctx, const fg_strip *strip, size_t *bumps) {
  fg_turning turning;
  FG_TRY(fg_turning_find(ctx, strip, &turning));
  *bumps = turning.bump_count;
  fg_turning_free(&turning);
  return FG_OK;
}

fg_status fg_arc_foil_layout(fg_context *ctx, const fg_design *design, const fg_strip *strip,
                             fg_layout *layout, unsigned *flags, const char **error) {
  size_t bumps;
  double away;
  fg_status status = FG_OK;
  memset(layout, 0, sizeof *layout);
  *error = NULL;
  FG_TRY(count_bumps(ctx, strip, &bumps));
  if (bumps >= BUMPS_MIN) {
    *flags |= FG_FOIL_BUMPS_ON_ARC;
    *error = "the strip has bumps, and the design's form is arc: a plain strip without any";
    return FG_OK;
  }
  if (strip->count < STATIONS_MIN) {
    *error = "the strip is too short for a circle";
    return FG_OK;
  }
  layout->inner_is_right = centre_is_right(strip);
  FG_TRY_EXIT(
      fg_datum_line_build(ctx, strip, design->datum, layout->inner_is_right, &layout->line));
  FG_TRY_EXIT(fg_memory_allocate(ctx, STRETCHES, sizeof(fg_range), (void **)&layout->lands));
  status = fit_arc_ends(ctx, layout);
  if (status == FG_ERR_NUMERIC || (status == FG_OK && arc_cover(layout, &away) < COVER_SHARE))
    *error = "the strip does not lie on one circle, as a design of form arc does";
  if (status == FG_ERR_NUMERIC) status = FG_OK;
  FG_TRY_EXIT(status);
  if (!*error && away > BUMP_THICKNESSES * strip->thickness_mm) *flags |= FG_FOIL_BUMPS_ON_ARC;
  if (layout->turning.lip_first || layout->turning.lip_last) *flags |= FG_FOIL_LIP;
exit:
  if (status != FG_OK) fg_layout_free(layout);
  return status;
}

/* Crossing of the cut and the datum line. */
static fg_point end_point(const fg_design *design, const fg_layout *layout,
                          const fg_strip_end *end) {
  fg_point inner = layout->inner_is_right ? end->right : end->left;
  fg_point outer = layout->inner_is_right ? end->left : end->right;
  if (design->datum == FG_DATUM_INNER) return inner;
  if (design->datum == FG_DATUM_OUTER) return outer;
  return (fg_point){0.5 * (inner.x + outer.x), 0.5 * (inner.y + outer.y)};
}

/* Variance of an end's place along the strip, mm²: the pixels' part; the direction of the cut where
 * the datum is an edge; and the mean roughness of the cut over the thickness, if it is as rough as
 * the sides. */
static double end_variance(const fg_design *design, const fg_foil *foil, const fg_strip_end *end) {
  double thickness = foil->thickness.mm, rough = 1e-3 * foil->noise.edge_rough_um;
  double share = fmin(1, foil->noise.correlation_mm / thickness);
  double skew = design->datum == FG_DATUM_MID ? 0 : 0.5 * thickness * end->u_skew;
  double shift = 1e-3 * FG_LINE_SHIFT_BLURS * end->blur_um;
  return 1e-6 * end->u_um * end->u_um + skew * skew + rough * rough * share + shift * shift;
}

/* Uncertainty of the length, mm, by both cuts: they move outwards or inwards together, as the edges
 * of the thickness do. */
static double cut_uncertainty(const fg_design *design, const fg_foil *foil) {
  const fg_strip *strip = &foil->strip;
  double sides = strip->blur_left_um + strip->blur_right_um;
  double ends = strip->ends[0].blur_um + strip->ends[1].blur_um;
  return fg_foil_width_u_um(design, foil) / 1000 * (sides > 0 ? ends / sides : 1);
}

static void clear_arc(fg_foil_arc *arc) {
  *arc = (fg_foil_arc){NAN, NAN, NAN, NAN, NAN, NAN};
}

/* alpha = psi_2 - psi_1, the directions of the ends from O; d psi / dO = (sin, -cos) / r. */
static void fill_arc_values(const fg_design *design, const fg_layout *layout, fg_foil *foil) {
  const fg_overall *o = &foil->overall;
  double psi[2], gradient[3] = {0}, sense = layout->inner_is_right ? 1 : -1, cuts = 0;
  for (int i = 0; i < 2; i++) {
    const fg_strip_end *end = &foil->strip.ends[i];
    fg_point p = end_point(design, layout, end);
    double dx = p.x - o->centre_mm.x, dy = p.y - o->centre_mm.y, r2 = dx * dx + dy * dy;
    double sign = i ? sense : -sense;
    psi[i] = atan2(dy, dx);
    gradient[0] += sign * dy / r2;
    gradient[1] -= sign * dx / r2;
    cuts += end_variance(design, foil, end);
  }
  double alpha = sense * (psi[1] - psi[0]), radius = o->radius_mm, angle = 0, length = 0;
  if (alpha < 0) alpha += 2 * M_PI;
  cuts += pow(cut_uncertainty(design, foil), 2);
  const double by_length[3] = {radius * gradient[0], radius * gradient[1], alpha};
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) {
      angle += gradient[a] * o->covariance[a][b] * gradient[b];
      length += by_length[a] * o->covariance[a][b] * by_length[b];
    }
  double u_rad = sqrt(fmax(angle, 0) + cuts / (radius * radius));
  foil->arc = (fg_foil_arc){.subtended_angle_deg = alpha * 180 / M_PI,
                            .u_subtended_angle_deg = u_rad * 180 / M_PI,
                            .length_mm = radius * alpha,
                            .u_length_mm = sqrt(fmax(length, 0) + cuts)};
  double design_deg = design->arc.subtended_angle_deg;
  foil->arc.subtended_angle_error_pct =
      100 * (foil->arc.subtended_angle_deg - design_deg) / design_deg;
  foil->arc.u_subtended_angle_error_pct = 100 * foil->arc.u_subtended_angle_deg / design_deg;
}

/* Widens by a bend. The intensity model's shift of the line along its normal differs along the
 * strip. A bend of that size from the middle to the ends is no residual: the circle absorbs it. It
 * changes R by the bend over 1 - cos of half the angle, and moves the centre away from the middle
 * of the arc by as much (reports/accuracy_arcs.md). */
static void widen_bend(fg_foil *foil) {
  fg_overall *o = &foil->overall;
  const fg_strip *strip = &foil->strip;
  double blur_mm = fg_strip_blur_um(strip) / 1000;
  double half_rad = 0.5 * strip->stations[strip->count - 1].s_mm / o->radius_mm;
  double by_mm = FG_LINE_SHIFT_BLURS * blur_mm / (1 - cos(fmin(half_rad, M_PI / 2)));
  double middle = foil->rotation_deg * M_PI / 180;
  const double move[3] = {-by_mm * cos(middle), -by_mm * sin(middle), by_mm};
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      o->covariance[a][b] += move[a] * move[b];
}

static void fill_uncertainties(const fg_design *design, fg_overall *o) {
  for (int i = 0; i < 2; i++)
    o->u_centre_mm[i] = sqrt(o->covariance[i][i]);
  o->u_radius_mm = sqrt(o->covariance[2][2]);
  o->u_springback_error_pct = 100 * o->u_radius_mm / design->overall_radius_mm;
}

void fg_arc_foil_derive(const fg_design *design, const fg_layout *layout, fg_foil *foil) {
  const fg_strip_end *ends = foil->strip.ends;
  double c = 0, s = 0;
  for (size_t i = 0; i < layout->land_count; i++) {
    const fg_range *land = &layout->lands[i];
    fg_point p = fg_strip_middle(&foil->strip, (land->first + land->last) / 2);
    double psi = atan2(p.y - foil->overall.centre_mm.y, p.x - foil->overall.centre_mm.x);
    c += cos(psi);
    s += sin(psi);
  }
  foil->rotation_deg = atan2(s, c) * 180 / M_PI;
  clear_arc(&foil->arc);
  widen_bend(foil);
  fill_uncertainties(design, &foil->overall);
  bool lip = layout->turning.lip_first || layout->turning.lip_last;
  for (int i = 0; i < 2; i++) {
    bool bent = i ? layout->turning.lip_last : layout->turning.lip_first;
    if (ends[i].at_border) foil->flags |= FG_FOIL_TOUCHES_BORDER;
    if (!ends[i].found && !ends[i].at_border && !bent) foil->flags |= FG_FOIL_NO_END;
  }
  if (!lip && ends[0].found && ends[1].found) fill_arc_values(design, layout, foil);
}
