/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/land_step.h"

#include <math.h>

#include "core/small_solve.h"

/* An oval explains the distances as well where it leaves so many times the jump's squares. */
#define OVAL_SQUARES 2.0

enum { CIRCLE_TERMS = 3, TERMS = 5, LANDS_MIN = 8, LANDS_MAX = 256 };

/* Mean distances of lands from the circle, outwards, and their directions from its centre. */
typedef struct land_list {
  double distance_mm[LANDS_MAX], psi[LANDS_MAX];
  size_t count;
} land_list;

static void list_lands(const fg_layout *layout, land_list *lands) {
  const fg_circle *circle = &layout->overall.circle;
  lands->count = 0;
  for (size_t i = 0; i < layout->land_count && lands->count < LANDS_MAX; i++) {
    const fg_range land = layout->lands[i];
    double distance_mm = fg_layout_land_distance(layout, land);
    if (!isfinite(distance_mm)) continue;
    fg_point p = fg_strip_middle(layout->line.strip, (land.first + land.last) / 2);
    lands->distance_mm[lands->count] = distance_mm;
    lands->psi[lands->count++] = atan2(p.y - circle->y, p.x - circle->x);
  }
}

/* Least squares of the distances: a circle's moves, with two more terms for lands from `first` on:
 * a displacement, or with `oval` an oval's. Returns the sum of squares left, infinite where it has
 * no solution. */
static double fit_lands(const land_list *lands, size_t first, bool oval, double x[FG_SMALL_MAX]) {
  fg_normal_equations system;
  double left = 0;
  fg_normal_clear(&system, first < lands->count ? TERMS : CIRCLE_TERMS);
  for (int solved = 0; solved < 2; solved++) {
    for (size_t i = 0; i < lands->count; i++) {
      double psi = lands->psi[i], more = i >= first, by = oval ? 2 : 1;
      const double row[TERMS] = {cos(psi), sin(psi), 1, more * cos(by * psi), more * sin(by * psi)};
      double rest = lands->distance_mm[i];
      for (size_t k = 0; solved && k < system.unknowns; k++)
        rest -= row[k] * x[k];
      if (solved)
        left += rest * rest;
      else
        fg_normal_add(&system, row, rest, 1);
    }
    if (!solved && !fg_normal_solve(&system, 0, x, NULL)) return INFINITY;
  }
  return left;
}

fg_land_step fg_land_step_find(const fg_layout *layout) {
  fg_land_step step = {.chance = 1, .jump_mm = NAN};
  land_list lands;
  double x[FG_SMALL_MAX], best = INFINITY;
  list_lands(layout, &lands);
  if (lands.count < LANDS_MIN) return step;
  for (size_t first = 2; first + 2 <= lands.count; first++) {
    double left = fit_lands(&lands, first, false, x);
    if (left >= best) continue;
    best = left;
    for (int k = 0; k < 2; k++)
      step.change[k] = x[k] + x[CIRCLE_TERMS + k] / 2;
    step.change[2] = x[2];
    step.jump_mm = hypot(x[CIRCLE_TERMS], x[CIRCLE_TERMS + 1]);
  }
  double none = fit_lands(&lands, lands.count, false, x), oval = fit_lands(&lands, 0, true, x);
  if (!(best * OVAL_SQUARES < oval)) return step;
  /* The F test of two more terms, for as many places as were tried. */
  double one = pow(best / none, 0.5 * (double)(lands.count - TERMS));
  step.chance = fmin(one * (double)(lands.count - 3), 1);
  return step;
}
