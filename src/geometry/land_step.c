/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/land_step.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

#include "geometry/jump.h"

/* An oval explains the distances as well where it leaves so many times the jump's squares. */
#define OVAL_SQUARES 2.0
/* Rows and columns per land that are as good as independent: a jump may cross a land, and ripples
 * look like it. */
#define ROWS_PER_LAND 8.0
/* Min rms of the lands' distances that a jump explains: without noise the edge model itself
 * deviates by as much. */
#define SEEN_MM 5e-5
/* Min share of a jump that no circle's move explains. */
#define SEEN_SHARE 1e-3

/* PLACES: of a jump of all beyond one row or column that are tried over the lands. */
enum {
  CIRCLE_TERMS = FG_JUMP_CIRCLE_TERMS,
  TERMS = 5,
  LANDS_MIN = 8,
  LANDS_MAX = 256,
  PLACES = 96
};

/* Mean distances of lands from the circle, outwards, their directions from its centre, and their
 * extents along x and y. */
typedef struct land_list {
  double distance_mm[LANDS_MAX], psi[LANDS_MAX], row[LANDS_MAX][CIRCLE_TERMS];
  double min_mm[LANDS_MAX][2], max_mm[LANDS_MAX][2];
  size_t count;
} land_list;

static void find_extent(const fg_datum_line *line, fg_range land, double min[2], double max[2]) {
  for (int axis = 0; axis < 2; axis++) {
    min[axis] = INFINITY;
    max[axis] = -INFINITY;
  }
  for (size_t k = land.first; k <= land.last; k++) {
    const double at[2] = {line->points[k].x, line->points[k].y};
    for (int axis = 0; axis < 2; axis++) {
      if (at[axis] < min[axis]) min[axis] = at[axis];
      if (at[axis] > max[axis]) max[axis] = at[axis];
    }
  }
}

static void list_lands(const fg_layout *layout, land_list *lands) {
  const fg_circle *circle = &layout->overall.circle;
  lands->count = 0;
  for (size_t i = 0; i < layout->land_count && lands->count < LANDS_MAX; i++) {
    const fg_range land = layout->lands[i];
    double distance_mm = fg_layout_land_distance(layout, land);
    if (!isfinite(distance_mm)) continue;
    fg_point p = fg_strip_middle(layout->line.strip, (land.first + land.last) / 2);
    lands->distance_mm[lands->count] = distance_mm;
    find_extent(&layout->line, land, lands->min_mm[lands->count], lands->max_mm[lands->count]);
    double psi = atan2(p.y - circle->y, p.x - circle->x);
    memcpy(lands->row[lands->count], (double[]){cos(psi), sin(psi), 1}, sizeof lands->row[0]);
    lands->psi[lands->count++] = psi;
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

/* The lands' distances from the best circle, and what a jump along an axis adds to each. */
typedef struct land_jump {
  const land_list *lands;
  fg_jump_sums sums;
  int axis;
  double gain; /* of the best jump so far, mm² */
} land_jump;

/* Tries a jump of all beyond a row or column, along y or x. A land may lie on both sides. */
static void try_row(double at_mm, land_jump *jump, fg_land_step *step) {
  const land_list *lands = jump->lands;
  fg_jump_sums *sums = &jump->sums;
  double change[CIRCLE_TERMS], jump_mm;
  sums->with_residual = sums->with_itself = 0;
  memset(sums->with_row, 0, sizeof sums->with_row);
  for (size_t i = 0; i < lands->count; i++) {
    double min = lands->min_mm[i][jump->axis], max = lands->max_mm[i][jump->axis];
    double share = at_mm >= max ? 0 : at_mm <= min ? 1 : (max - at_mm) / (max - min);
    const double *row = lands->row[i];
    double column = share * row[jump->axis], rest = lands->distance_mm[i];
    for (int k = 0; k < CIRCLE_TERMS; k++) {
      rest -= sums->moves[k] * row[k];
      sums->with_row[k] += column * row[k];
    }
    sums->with_residual += column * rest;
    sums->with_itself += column * column;
  }
  if (!fg_jump_solve(sums, jump->axis, SEEN_SHARE, &jump_mm, change)) return;
  if (!(sums->with_residual * jump_mm > jump->gain)) return;
  jump->gain = sums->with_residual * jump_mm;
  step->jump_mm = fabs(jump_mm);
  memcpy(step->change, change, sizeof change);
}

/* A jump of all beyond a row or column, which may displace lands in the middle of the foil. */
static fg_land_step find_row_step(const land_list *lands, double none, double oval) {
  fg_land_step step = {.chance = 1, .jump_mm = NAN};
  land_jump jump = {.lands = lands};
  fg_normal_equations system;
  fg_normal_clear(&system, CIRCLE_TERMS);
  for (size_t i = 0; i < lands->count; i++)
    fg_normal_add(&system, lands->row[i], lands->distance_mm[i], 1);
  if (!fg_normal_solve(&system, 0, jump.sums.moves, jump.sums.inverse)) return step;
  for (jump.axis = 0; jump.axis < 2; jump.axis++) {
    double min = INFINITY, max = -INFINITY;
    for (size_t i = 0; i < lands->count; i++) {
      min = fmin(min, lands->min_mm[i][jump.axis]);
      max = fmax(max, lands->max_mm[i][jump.axis]);
    }
    for (int place = 1; place < PLACES; place++)
      try_row(min + (max - min) * place / PLACES, &jump, &step);
  }
  double left = none - jump.gain;
  if (!(left * OVAL_SQUARES < oval) || jump.gain < SEEN_MM * SEEN_MM * (double)lands->count)
    return step;
  double dof = (double)lands->count - CIRCLE_TERMS - 1;
  double one = gsl_cdf_beta_P(fmax(left / none, 0), dof / 2, 0.5);
  step.chance = fmin(one * ROWS_PER_LAND * (double)(lands->count - 3), 1);
  return step;
}

static fg_land_step find_land_step(const fg_layout *layout) {
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
  /* The F test of two more terms, for as many places as were tried. */
  double one = pow(best / none, 0.5 * (double)(lands.count - TERMS));
  if (best * OVAL_SQUARES < oval) step.chance = fmin(one * (double)(lands.count - 3), 1);
  const fg_land_step row = find_row_step(&lands, none, oval);
  return row.chance < step.chance ? row : step;
}

void fg_land_step_find(fg_layout *layout) {
  layout->land_step = find_land_step(layout);
}
