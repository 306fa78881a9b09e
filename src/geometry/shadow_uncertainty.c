/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Error of circles by a shadow: it falsifies the background's level right at the edges of some
 * bearings. These edges are displaced by an amount that changes slowly with the bearing. */
#include "geometry/shadow_uncertainty.h"

#include <math.h>

#include "foilgauge/foil.h"
#include "geometry/level_uncertainty.h"

/* Shift of an edge over depth × blur × sqrt(2 pi): half of the error of the background's level
 * counts, and that is about the depth. Over renders of known truth errors have at most that sd
 * (tests/bench/driver.py, kinds shadow and wall). */
#define SHIFT_PER_DEPTH 0.5
/* Share of the deepest band that edges without any get: shapes are smoothed over two harmonics of
 * the bearing and over stretches of a bump that turn by up to 50 degrees. */
#define CARRIED_SHARE 0.4
/* Depth of a band with the effect of a blur that differs over the bearing: the error of its shape's
 * smoothing. */
#define UNEVEN_DEPTH 0.005
enum { PARTS = FG_SHADOW_PARTS };

/* One independent part of the shifts: edges that face the bearing, or, without a part, all. */
typedef struct shift_part {
  const fg_datum_line *line;
  int part;        /* -1: all bearings alike */
  fg_point toward; /* middle of the part's bearings, a unit vector */
  double carried;  /* depth at every edge in addition to its own */
} shift_part;

static double depth_at(const fg_picture_state *picture, double bearing) {
  double at = bearing / (2 * M_PI) * FG_PICTURE_BEARINGS;
  double low = floor(at), share = at - low;
  int i = ((int)low % FG_PICTURE_BEARINGS + FG_PICTURE_BEARINGS) % FG_PICTURE_BEARINGS;
  return (1 - share) * picture->shadow_at[i] +
         share * picture->shadow_at[(i + 1) % FG_PICTURE_BEARINGS];
}

/* Weight of a part. Parts overlap, so that the squares of their weights add up to 1 at every
 * bearing. */
static double part_weight(const shift_part *p, double bearing) {
  if (p->part < 0) return 1;
  double step = 2 * M_PI / PARTS, off = fabs(remainder(bearing - p->part * step, 2 * M_PI));
  return off < step ? cos(M_PI / 2 * off / step) : 0;
}

/* Returns true where an edge faces none of the part's bearings for certain; saves an arc tangent.
 */
static bool faces_away(const shift_part *p, fg_point normal) {
  const double rounding = 1e-6;
  return p->part >= 0 &&
         normal.x * p->toward.x + normal.y * p->toward.y < cos(2 * M_PI / PARTS) - rounding;
}

/* Outward shift of an edge of one side, mm. */
static double edge_shift(const shift_part *p, const fg_station *s, bool right) {
  const fg_strip *strip = p->line->strip;
  double way = right ? 1 : -1;
  fg_point normal = {way * s->normal.x, way * s->normal.y};
  if (faces_away(p, normal)) return 0;
  double bearing = atan2(normal.y, normal.x);
  double blur_mm = (right ? strip->blur_right_um : strip->blur_left_um) / 1000;
  double depth = depth_at(&strip->picture, bearing);
  depth = p->part < 0 ? depth : hypot(depth, p->carried);
  return SHIFT_PER_DEPTH * depth * fg_level_shift(blur_mm) * part_weight(p, bearing);
}

/* Shift of the line's place at a station: of an edge or of the middle between both. */
static double line_shift(const void *user, size_t station) {
  const shift_part *p = user;
  const fg_station *s = &p->line->strip->stations[station];
  double left = edge_shift(p, s, false), right = edge_shift(p, s, true);
  if (!p->line->is_edge) return 0.5 * (right - left);
  const fg_point *at = &p->line->points[station];
  return hypot(at->x - s->right.x, at->y - s->right.y) < hypot(at->x - s->left.x, at->y - s->left.y)
             ? right
             : -left;
}

void fg_arc_find_shadow(const fg_datum_line *line, const fg_arc *arc, fg_arc_shadow *shadow) {
  const fg_picture_state *picture = &line->strip->picture;
  shift_part p = {.line = line};
  shadow->count = 0;
  if (!(picture->findings & (FG_PICTURE_SHADOW | FG_PICTURE_UNEVEN_BLUR))) return;
  for (int i = 0; i < FG_PICTURE_BEARINGS; i++)
    p.carried = fmax(p.carried, CARRIED_SHARE * fabs(picture->shadow_at[i]));
  if (picture->findings & FG_PICTURE_UNEVEN_BLUR) p.carried = hypot(p.carried, UNEVEN_DEPTH);
  for (p.part = -1; p.part < PARTS; p.part++) {
    double middle = p.part * 2 * M_PI / PARTS;
    p.toward = (fg_point){cos(middle), sin(middle)};
    if (!fg_arc_shift_by(line, arc, line_shift, &p, shadow->shifts[p.part + 1])) return;
  }
  shadow->count = PARTS + 1;
}

static void add_shifts(const fg_arc_shadow *shadow, double covariance[3][3]) {
  for (size_t i = 0; i < shadow->count; i++)
    for (int p = 0; p < 3; p++)
      for (int q = 0; q < 3; q++)
        covariance[p][q] += shadow->shifts[i][p] * shadow->shifts[i][q];
}

void fg_arc_add_shadow(const fg_datum_line *line, fg_arc *arc) {
  fg_arc_shadow shadow;
  fg_arc_find_shadow(line, arc, &shadow);
  add_shifts(&shadow, arc->covariance);
}

void fg_bump_add_shadow(const fg_arc_shadow *own, const fg_arc_shadow *lands,
                        const fg_design *design, const fg_nominal *nominal,
                        const fg_overall *overall, fg_bump *bump) {
  fg_arc_shadow both = {.count = own->count};
  double covariance[3][3] = {{0}};
  if (!own->count || lands->count != own->count) return;
  double dx = bump->centre_mm.x - overall->centre_mm.x;
  double dy = bump->centre_mm.y - overall->centre_mm.y, d = hypot(dx, dy);
  for (size_t k = 0; k < own->count; k++) {
    const double *a = own->shifts[k], *b = lands->shifts[k];
    both.shifts[k][0] = ((a[0] - b[0]) * dx + (a[1] - b[1]) * dy) / d;
    both.shifts[k][1] = a[2];
    both.shifts[k][2] = b[2];
  }
  add_shifts(&both, covariance);
  fg_bump_widen(design, nominal, overall, covariance, bump);
  add_shifts(own, bump->covariance);
  for (int axis = 0; axis < 2; axis++)
    bump->u_centre_mm[axis] = sqrt(bump->covariance[axis][axis]);
}
