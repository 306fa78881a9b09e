/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/land_step.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

#include "geometry/jump.h"

/* An oval explains the distances as well where it leaves this many times the jump's squares. */
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
enum { LANDS_MIN = 8, LANDS_MAX = 256, PLACES = 96 };

/* Lands with their mean distances from the circle, and their extents along x and y. */
typedef struct land_list {
  fg_distance distances[LANDS_MAX];
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
  lands->count = 0;
  for (size_t i = 0; i < layout->land_count && lands->count < LANDS_MAX; i++) {
    const fg_range land = layout->lands[i];
    const fg_distance distance = fg_layout_land_distance(layout, land);
    if (!isfinite(distance.mm)) continue;
    find_extent(&layout->line, land, lands->min_mm[lands->count], lands->max_mm[lands->count]);
    lands->distances[lands->count++] = distance;
  }
}

/* Sums of squares that explanations without a jump leave, mm². */
typedef struct smooth_fits {
  double circle, oval;
} smooth_fits;

/* A jump between two lands: the lands from one on are displaced, along any direction. In place of
 * an oval's terms the rows have the displacement. */
static fg_land_step find_step_between_lands(const land_list *lands, const smooth_fits *smooth) {
  fg_land_step step = {.chance = 1, .jump_mm = NAN};
  fg_distance displaced[LANDS_MAX];
  double x[FG_SMALL_MAX], best = INFINITY;
  for (size_t first = 2; first + 2 <= lands->count; first++) {
    for (size_t i = 0; i < lands->count; i++) {
      displaced[i] = lands->distances[i];
      for (int k = 0; k < 2; k++)
        displaced[i].row[FG_CIRCLE_TERMS + k] = i >= first ? displaced[i].row[k] : 0;
    }
    double left = fg_distances_fit(displaced, lands->count, FG_OVAL_TERMS, x, NULL);
    if (left >= best) continue;
    best = left;
    for (int k = 0; k < 2; k++)
      step.change[k] = x[k] + x[FG_CIRCLE_TERMS + k] / 2;
    step.change[2] = x[2];
    step.jump_mm = hypot(x[FG_CIRCLE_TERMS], x[FG_CIRCLE_TERMS + 1]);
  }
  if (!(best * OVAL_SQUARES < smooth->oval)) return step;
  /* The F test of two more terms, for as many places as were tried. */
  double one = pow(best / smooth->circle, 0.5 * (double)(lands->count - FG_OVAL_TERMS));
  step.chance = fmin(one * (double)(lands->count - 3), 1);
  return step;
}

/* Share of a land that lies beyond a row or column. */
static double share_beyond(double at_mm, double min_mm, double max_mm) {
  if (at_mm >= max_mm) return 0;
  return at_mm <= min_mm ? 1 : (max_mm - at_mm) / (max_mm - min_mm);
}

/* Tries a jump of all beyond a row or column, along y or x, against the best so far with its gain,
 * mm². */
static void try_row(const land_list *lands, double at_mm, int axis, fg_jump_sums *sums,
                    double *best_gain, fg_land_step *step) {
  double change[FG_CIRCLE_TERMS], jump_mm;
  fg_jump_clear(sums);
  for (size_t i = 0; i < lands->count; i++) {
    const fg_distance *distance = &lands->distances[i];
    double column =
        distance->row[axis] * share_beyond(at_mm, lands->min_mm[i][axis], lands->max_mm[i][axis]);
    for (int k = 0; k < FG_CIRCLE_TERMS; k++)
      sums->with_row[k] += column * distance->row[k];
    sums->with_residual += column * fg_jump_residual(sums, distance);
    sums->with_itself += column * column;
  }
  if (!fg_jump_solve(sums, axis, SEEN_SHARE, &jump_mm, change)) return;
  if (!(sums->with_residual * jump_mm > *best_gain)) return;
  *best_gain = sums->with_residual * jump_mm;
  step->jump_mm = fabs(jump_mm);
  memcpy(step->change, change, sizeof change);
}

/* A jump of all beyond a row or column, which may displace lands in the middle of the foil. A land
 * may lie on both sides. */
static fg_land_step find_row_step(const land_list *lands, const smooth_fits *smooth,
                                  fg_jump_sums *sums) {
  fg_land_step step = {.chance = 1, .jump_mm = NAN};
  double gain = 0;
  for (int axis = 0; axis < 2; axis++) {
    double min = INFINITY, max = -INFINITY;
    for (size_t i = 0; i < lands->count; i++) {
      min = fmin(min, lands->min_mm[i][axis]);
      max = fmax(max, lands->max_mm[i][axis]);
    }
    for (int place = 1; place < PLACES; place++)
      try_row(lands, min + (max - min) * place / PLACES, axis, sums, &gain, &step);
  }
  double left = smooth->circle - gain;
  if (!(left * OVAL_SQUARES < smooth->oval)) return step;
  if (gain < SEEN_MM * SEEN_MM * (double)lands->count) return step;
  double dof = (double)lands->count - FG_CIRCLE_TERMS - 1;
  double one = gsl_cdf_beta_P(fmax(left / smooth->circle, 0), dof / 2, 0.5);
  step.chance = fmin(one * ROWS_PER_LAND * (double)(lands->count - 3), 1);
  return step;
}

void fg_land_step_find(fg_layout *layout) {
  land_list lands;
  fg_jump_sums sums;
  double x[FG_SMALL_MAX];
  layout->land_step = (fg_land_step){.chance = 1, .jump_mm = NAN};
  list_lands(layout, &lands);
  if (lands.count < LANDS_MIN) return;
  const smooth_fits smooth = {
      .circle =
          fg_distances_fit(lands.distances, lands.count, FG_CIRCLE_TERMS, sums.moves, sums.inverse),
      .oval = fg_distances_fit(lands.distances, lands.count, FG_OVAL_TERMS, x, NULL)};
  if (!isfinite(smooth.circle)) return;
  const fg_land_step between = find_step_between_lands(&lands, &smooth);
  const fg_land_step row = find_row_step(&lands, &smooth, &sums);
  layout->land_step = row.chance < between.chance ? row : between;
}
