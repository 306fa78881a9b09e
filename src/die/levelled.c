/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "die/levelled.h"

#include <math.h>

#include "core/small_solve.h"

/* The change of a bump's radius over q sin 2 psi: 3/2 at its crown, less over its arc. */
static const double bump_share = 1.4;

/* Limits of q by the bumps' radii: standard deviations from none, size (a slope of 0.07 degrees,
 * which changes a radius by 0.17 %; an oval die of 12 um looks like it), and distance from q by the
 * lands as a share. */
static const double deviations_min = 6, slope_min = 0.0012, apart_max = 0.3;

enum { BUMPS_MIN = 5, TERMS = 4 };

typedef struct slope {
  double value, u;
} slope;

static double shear_at(const fg_layout *layout, const fg_bump *bump) {
  const fg_circle *o = &layout->overall.circle;
  return -bump_share * sin(2 * atan2(bump->centre_mm.y - o->y, bump->centre_mm.x - o->x));
}

/* Line of ln R over the shear of radii. */
static slope slope_of_bumps(const fg_layout *layout, const fg_die_trace *trace) {
  double n = (double)trace->bump_count, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  if (trace->bump_count < BUMPS_MIN) return (slope){NAN, NAN};
  for (size_t i = 0; i < trace->bump_count; i++) {
    const fg_bump *b = &trace->bumps[i];
    double at = shear_at(layout, b), log_radius = log(b->radius_mm);
    x += at, y += log_radius, xx += at * at, xy += at * log_radius;
  }
  double spread = xx - x * x / n, q = (xy - x * y / n) / spread;
  for (size_t i = 0; i < trace->bump_count; i++) {
    const fg_bump *b = &trace->bumps[i];
    yy += pow(log(b->radius_mm) - y / n - q * (shear_at(layout, b) - x / n), 2);
  }
  return (slope){q, sqrt(yy / (n - 2) / spread)};
}

/* Least squares of the lands' residuals over the circle's three terms and the shear's. */
static double slope_of_lands(const fg_layout *layout) {
  const fg_circle *o = &layout->overall.circle;
  fg_normal_equations system;
  double solution[TERMS];
  fg_normal_clear(&system, TERMS);
  for (size_t i = 0; i < layout->land_count; i++)
    for (size_t k = layout->lands[i].first; k <= layout->lands[i].last; k++) {
      double off = fg_arc_residual(&layout->line, o, k);
      if (!isfinite(off)) continue; /* outliers of the circle count: the shear makes them */
      fg_point p = layout->line.strip->stations[k].left;
      double psi = atan2(p.y - o->y, p.x - o->x);
      double term[TERMS] = {1, cos(psi), sin(psi), o->radius / 2 * sin(2 * psi)};
      fg_normal_add(&system, term, off, 1);
    }
  return fg_normal_solve(&system, 0, solution, NULL) ? solution[TERMS - 1] : NAN;
}

fg_status fg_die_check_levelled(fg_context *ctx, const char *path, const fg_layout *layout,
                                const fg_die_trace *trace) {
  slope bumps = slope_of_bumps(layout, trace);
  if (!(fabs(bumps.value) > fmax(slope_min, deviations_min * bumps.u))) return FG_OK;
  double q = slope_of_lands(layout), r = layout->overall.circle.radius;
  if (!(fabs(q - bumps.value) < apart_max * fabs(bumps.value))) return FG_OK;
  return fg_fail(
      ctx, FG_ERR_DATA,
      "%s: lands and bumps are sheared as if a line of %.2f degrees was subtracted from "
      "the heights (or the die is oval by %.0f um): such levelling is no rotation, and "
      "changes radii by up to %.2g %%; export the profile as measured, without levelling",
      path, fabs(atan(bumps.value)) * 180 / M_PI, 1000 * fabs(q) * r / 2, 150 * fabs(bumps.value));
}
