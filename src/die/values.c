/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quantities reported of a die: a row each. */
#include "die/values.h"

#include <math.h>
#include <stddef.h>

/* Row of a reported quantity: a bump's quantity, or the place, which is computed here. */
typedef struct source_row {
  fg_die_row row;
  size_t at, u_at; /* in fg_bump */
} source_row;

#define OF_BUMP(member) offsetof(fg_bump, member), offsetof(fg_bump, u_##member)
static const source_row rows[FG_DIE_QUANTITIES] = {
    [FG_DIE_RADIUS] = {{"radius_mm", "mm", "R", "bump radius", 4}, OF_BUMP(radius_mm)},
    [FG_DIE_RADIUS_ERROR] = {{"radius_error_pct", "%", "e_R", "bump radius, error", 3},
                             OF_BUMP(radius_error_pct)},
    [FG_DIE_ANGLE] = {{"bump_angle_deg", "°", "α", "bump angle", 2}, OF_BUMP(bump_angle_deg)},
    [FG_DIE_ANGLE_ERROR] = {{"bump_angle_error_pct", "%", "e_α", "bump angle, error", 2},
                            OF_BUMP(bump_angle_error_pct)},
    [FG_DIE_CENTRE] = {{"centre_to_centre_mm", "mm", "X", "bump centre to overall centre", 4},
                       OF_BUMP(centre_to_centre_mm)},
    [FG_DIE_HEIGHT] = {{"height_mm", "mm", "h", "bump height", 4}, OF_BUMP(height_mm)},
    [FG_DIE_INTERSECTION] = {{"intersection_angle_deg", "°", "θ", "intersection angle", 2},
                             OF_BUMP(intersection_angle_deg)},
    [FG_DIE_PLACE] = {{"place_error_deg", "°", "Δψ", "place along the die, error", 3}, 0, 0},
};
#undef OF_BUMP

const fg_die_row *fg_die_row_of(fg_die_quantity quantity) {
  return &rows[quantity].row;
}

double fg_die_nominal(const fg_design *design, const fg_nominal *nominal,
                      fg_die_quantity quantity) {
  switch (quantity) {
  case FG_DIE_RADIUS:
    return design->bumps.radius_mm;
  case FG_DIE_ANGLE:
    return design->bumps.angle_deg;
  case FG_DIE_CENTRE:
    return nominal->centre_to_centre_mm;
  case FG_DIE_HEIGHT:
    return nominal->height_mm;
  case FG_DIE_INTERSECTION:
    return nominal->intersection_angle_deg;
  case FG_DIE_RADIUS_ERROR:
  case FG_DIE_ANGLE_ERROR:
  case FG_DIE_PLACE:
  case FG_DIE_QUANTITIES:
    break;
  }
  return 0;
}

static double member(const fg_bump *bump, size_t at) {
  return *(const double *)((const char *)bump + at);
}

/* Direction of a bump seen from O, degrees, rising with its number. */
static double direction_deg(const fg_die_trace *trace, const fg_bump *bump) {
  double dx = bump->centre_mm.x - trace->overall.centre_mm.x;
  double dz = bump->centre_mm.y - trace->overall.centre_mm.y;
  double up = trace->half == FG_DIE_CONCAVE ? dz : -dz; /* a dome's centre lies below */
  double angle = atan2(dx, up) * 180 / M_PI;
  return trace->reversed ? -angle : angle;
}

/* From where the design has it, with the mean over the trace's bumps as the trace's rotation. */
static double place_error_deg(const fg_design *design, const fg_die_trace *trace,
                              const fg_bump *bump) {
  double mean = 0, here = direction_deg(trace, bump) - bump->number * design->bumps.pitch_deg;
  for (size_t i = 0; i < trace->bump_count; i++)
    mean +=
        direction_deg(trace, &trace->bumps[i]) - trace->bumps[i].number * design->bumps.pitch_deg;
  return here - mean / (double)trace->bump_count;
}

/* u of the direction: that of C across the line from O. */
static double u_place_deg(const fg_bump *bump) {
  return hypot(bump->u_centre_mm[0], bump->u_centre_mm[1]) / bump->centre_to_centre_mm * 180 / M_PI;
}

double fg_die_value_of(const fg_design *design, const fg_die_trace *trace, const fg_bump *bump,
                       fg_die_quantity q, double *u) {
  if (q == FG_DIE_PLACE) {
    *u = u_place_deg(bump);
    return place_error_deg(design, trace, bump);
  }
  *u = member(bump, rows[q].u_at);
  return member(bump, rows[q].at);
}

/* Errors common to all traces: the tip's radius moves R and R0 in opposite directions and leaves
 * the centres, the scale moves all three. */
void fg_die_systematic_u(const fg_die *die, const fg_die_trace *trace, const fg_bump *bump,
                         double u[FG_DIE_QUANTITIES]) {
  double tip = die->options.u_tip_um / 1000, scale = die->options.u_scale_ppm * 1e-6;
  const double by_tip[3] = {0, tip, -tip};
  const double by_scale[3] = {scale * bump->centre_to_centre_mm, scale * bump->radius_mm,
                              scale * trace->overall.radius_mm};
  double covariance[3][3];
  fg_bump bare = *bump;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      covariance[a][b] = by_tip[a] * by_tip[b] + by_scale[a] * by_scale[b];
  for (int q = 0; q < FG_DIE_QUANTITIES; q++)
    if (rows[q].u_at) *(double *)((char *)&bare + rows[q].u_at) = 0;
  fg_bump_widen(&die->design, &die->nominal, &trace->overall, covariance, &bare);
  for (int q = 0; q < FG_DIE_QUANTITIES; q++)
    u[q] = rows[q].u_at ? member(&bare, rows[q].u_at) : 0;
}
