/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Effects of single rows of a table, and the curves for the part that no listed effect explains. */
#include <math.h>
#include <string.h>

#include "effect/bases.h"
#include "effect/table_effects.h"

static size_t outlier_columns(const fg_loop_problem *problem, const fg_loop_candidate *candidate) {
  (void)problem;
  return candidate->effect->outlier == FG_LOOP_EXCHANGED_ROWS ? 1 : candidate->rows;
}

static void outlier_basis(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                          const double *shape, double *columns) {
  (void)shape;
  memset(columns, 0, outlier_columns(problem, candidate) * problem->rows * sizeof *columns);
  if (candidate->effect->outlier == FG_LOOP_EXCHANGED_ROWS) {
    columns[candidate->row[0]] = 1;
    columns[candidate->row[1]] = -1;
    return;
  }
  for (size_t k = 0; k < candidate->rows; k++)
    columns[k * problem->rows + candidate->row[k]] = 1;
}

static const fg_loop_effect outlier_effects[] = {
    {.id = "table.outlier",
     .reads = FG_LOOP_READS_ROWS,
     .sought = "lone wrong values",
     .outlier = FG_LOOP_WRONG_ROW,
     .level = "runs",
     .frame = "row",
     .words = "wrong responses",
     .columns = outlier_columns,
     .basis = outlier_basis},
    {.id = "table.exchanged_runs",
     .reads = FG_LOOP_READS_EXCHANGE,
     .outlier = FG_LOOP_EXCHANGED_ROWS,
     .level = "runs",
     .frame = "row",
     .words = "two responses that changed places",
     .columns = outlier_columns,
     .basis = outlier_basis},
    {.id = "table.exchanged_columns",
     .reads = FG_LOOP_READS_ROWS,
     .outlier = FG_LOOP_WRONG_ROW,
     .pair = true,
     .level = "runs",
     .frame = "row",
     .words = "values in each other's column",
     .columns = outlier_columns,
     .basis = outlier_basis},
};

const fg_loop_effect *fg_loop_outlier_effects(void) {
  return outlier_effects;
}

/* Curves: natural cubic splines with a few or more knots, and waves. */

static bool smooth(const fg_loop_problem *problem, size_t a, size_t b) {
  (void)b;
  const fg_loop_coordinate *at = &problem->coordinate[a];
  return fg_basis_is_number(at) && at->distinct >= 8;
}

static bool smooth_many(const fg_loop_problem *problem, size_t a, size_t b) {
  return smooth(problem, a, b) && problem->coordinate[a].distinct >= 20;
}

static size_t few_columns(const fg_loop_problem *problem, const fg_loop_candidate *candidate) {
  (void)problem, (void)candidate;
  return 4;
}

static size_t many_columns(const fg_loop_problem *problem, const fg_loop_candidate *candidate) {
  (void)problem, (void)candidate;
  return 7;
}

static double cubed(double x) {
  return x > 0 ? x * x * x : 0;
}

static bool smooth_max(const fg_loop_problem *problem, size_t a, size_t b) {
  return smooth(problem, a, b) && problem->coordinate[a].distinct >= 36;
}

static size_t max_columns(const fg_loop_problem *problem, const fg_loop_candidate *candidate) {
  (void)problem, (void)candidate;
  return 11;
}

/* Knots at quantiles, so that every piece rests on rows; evenly where quantiles coincide. */
static void place_knots(const fg_loop_coordinate *at, size_t knots, double *knot) {
  double width = at->high > at->low ? at->high - at->low : 1;
  bool distinct = true;
  for (size_t k = 0; k < knots; k++) {
    double place = (double)k / (double)(knots - 1) * FG_LOOP_COLUMNS;
    size_t below = (size_t)fmin(place, FG_LOOP_COLUMNS - 1);
    double share = place - (double)below;
    knot[k] =
        ((1 - share) * at->quantile[below] + share * at->quantile[below + 1] - at->low) / width;
    if (k > 0 && knot[k] - knot[k - 1] < 0.25 / (double)knots) distinct = false;
  }
  for (size_t k = 0; !distinct && k < knots; k++)
    knot[k] = (double)k / (double)(knots - 1);
}

/* Truncated powers of a natural spline (Hastie, Tibshirani and Friedman 2009, eq 5.4), without the
 * constant, which the model has. */
static void spline_basis(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                         const double *shape, double *columns) {
  const fg_loop_coordinate *at = &problem->coordinate[candidate->a];
  size_t count = candidate->effect->columns(problem, candidate), last = count;
  double knot[FG_LOOP_COLUMNS + 1], width = at->high > at->low ? at->high - at->low : 1;
  (void)shape;
  place_knots(at, count + 1, knot);
  for (size_t i = 0; i < problem->rows; i++) {
    double x = fmin(fmax((at->value[i] - at->low) / width, 0), 1);
    double end = cubed(x - knot[last]);
    double tail = (cubed(x - knot[last - 1]) - end) / (knot[last] - knot[last - 1]);
    columns[i] = x;
    for (size_t k = 0; k + 1 < last; k++)
      columns[(k + 1) * problem->rows + i] =
          (cubed(x - knot[k]) - end) / (knot[last] - knot[k]) - tail;
  }
}

static size_t two_columns(const fg_loop_problem *problem, const fg_loop_candidate *candidate) {
  (void)problem, (void)candidate;
  return 2;
}

static void wave_basis(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                       const double *shape, double *columns) {
  const fg_loop_coordinate *at = &problem->coordinate[candidate->a];
  fg_basis_wave(problem->rows, at, shape[0], columns);
}

/* Maximum number of waves over a coordinate that is no order, where long cycles are not expected.
 */
enum { WAVES = 20 };

static size_t wave_starts(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                          double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  const fg_loop_coordinate *at = &problem->coordinate[candidate->a];
  double range = at->high - at->low, max = fmin(WAVES, ((double)at->distinct - 1) / 2);
  size_t count = 0;
  for (double cycles = 1.5; cycles <= max && count < FG_LOOP_STARTS; cycles += 0.5)
    starts[count++][0] = range / cycles;
  return count;
}

/* A hump by itself: its middle and its width are looked for. */
static void hump_basis(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                       const double *shape, double *columns) {
  const fg_loop_coordinate *at = &problem->coordinate[candidate->a];
  double half = shape[1] / 2;
  for (size_t i = 0; i < problem->rows; i++) {
    double x = (at->value[i] - shape[0]) / half;
    columns[i] = fabs(x) < 1 ? (1 - x * x) * (1 - x * x) : 0;
  }
}

static size_t hump_starts(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                          double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  enum { MIDDLES = 9 };
  static const double widths[] = {0.3, 0.6};
  const fg_loop_coordinate *at = &problem->coordinate[candidate->a];
  double range = at->high - at->low;
  size_t count = 0;
  for (size_t w = 0; w < sizeof widths / sizeof *widths; w++)
    for (size_t m = 0; m < MIDDLES; m++) {
      starts[count][0] = at->low + range * (0.1 + 0.8 * (double)m / (MIDDLES - 1));
      starts[count++][1] = widths[w] * range;
    }
  return count;
}

static size_t one_column(const fg_loop_problem *problem, const fg_loop_candidate *candidate) {
  (void)problem, (void)candidate;
  return 1;
}

static bool humped(const fg_loop_problem *problem, size_t a, size_t b) {
  return smooth(problem, a, b) && problem->coordinate[a].distinct >= 12;
}

static const fg_loop_effect curve_effects[] = {
    {.id = "unattributed.smooth",
     .unattributed = true,
     .level = "any",
     .frame = "coordinate",
     .words = "a smooth curve over",
     .accepts = smooth,
     .columns = few_columns,
     .basis = spline_basis},
    {.id = "unattributed.curve",
     .unattributed = true,
     .level = "any",
     .frame = "coordinate",
     .words = "a curve over",
     .accepts = smooth_many,
     .columns = many_columns,
     .basis = spline_basis},
    {.id = "unattributed.winding",
     .unattributed = true,
     .level = "any",
     .frame = "coordinate",
     .words = "a winding curve over",
     .accepts = smooth_max,
     .columns = max_columns,
     .basis = spline_basis},
    {.id = "unattributed.hump",
     .unattributed = true,
     .level = "any",
     .frame = "coordinate",
     .words = "a hump over",
     .shapes = 2,
     .shape_name = {"middle", "width"},
     .accepts = humped,
     .columns = one_column,
     .basis = hump_basis,
     .starts = hump_starts,
     .stepwise = true},
    {.id = "unattributed.wave",
     .unattributed = true,
     .level = "any",
     .frame = "coordinate",
     .words = "a wave over",
     .shapes = 1,
     .shape_name = {"period"},
     .accepts = smooth,
     .columns = two_columns,
     .basis = wave_basis,
     .starts = wave_starts,
     .cycle = true},
    {0},
};

const fg_loop_effect *fg_loop_curve_effects(void) {
  return curve_effects;
}
