/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bases over a column of a table: numbers, levels, products of two columns. */
#include <math.h>
#include <string.h>

#include "effect/bases.h"

/* -1 at the lowest value, +1 at the highest. */
static double scaled(const fg_loop_coordinate *at, size_t row) {
  return at->high > at->low ? (2 * at->value[row] - at->low - at->high) / (at->high - at->low) : 0;
}

bool fg_basis_accepts_linear(const fg_loop_problem *problem, size_t a, size_t b) {
  const fg_loop_coordinate *at = &problem->coordinate[a];
  (void)b;
  return fg_basis_is_number(at) && !fg_basis_is_sequence(at);
}

void fg_basis_linear(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                     const double *shape, double *columns) {
  (void)shape;
  for (size_t i = 0; i < problem->rows; i++)
    columns[i] = scaled(fg_basis_first(problem, candidate), i);
}

bool fg_basis_accepts_quadratic(const fg_loop_problem *problem, size_t a, size_t b) {
  return fg_basis_accepts_linear(problem, a, b) && problem->coordinate[a].distinct >= 3;
}

void fg_basis_quadratic(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                        const double *shape, double *columns) {
  (void)shape;
  for (size_t i = 0; i < problem->rows; i++) {
    double x = scaled(fg_basis_first(problem, candidate), i);
    columns[i] = x;
    columns[problem->rows + i] = 2 * x * x - 1;
  }
}

/* Levels with a slope of their own: few, and so many rows each. */
enum { SLOPES = 8, ROWS_A_SLOPE = 5 };

static bool slopes_hold(const fg_loop_problem *problem, size_t levels) {
  return levels <= SLOPES && (levels <= 4 || problem->rows >= ROWS_A_SLOPE * levels);
}

/* Returns true when every level of `inner` lies in one of `outer`: then both together tell no more
 * than it does alone. */
static bool is_nested(const fg_loop_problem *problem, const fg_loop_coordinate *inner,
                      const fg_loop_coordinate *outer) {
  double of[FG_LOOP_COLUMNS + 2];
  if (inner->levels > FG_LOOP_COLUMNS + 1) return false;
  for (size_t k = 0; k < inner->levels; k++)
    of[k] = -1;
  for (size_t i = 0; i < problem->rows; i++) {
    double *first = &of[(size_t)inner->value[i]];
    if (*first >= 0 && *first != outer->value[i]) return false;
    *first = outer->value[i];
  }
  return true;
}

/* Two factors that cross, of few enough combinations. */
static bool factors_cross(const fg_loop_problem *problem, const fg_loop_coordinate *x,
                          const fg_loop_coordinate *y) {
  return (x->levels - 1) * (y->levels - 1) <= FG_LOOP_COLUMNS && !is_nested(problem, x, y) &&
         !is_nested(problem, y, x);
}

/* Numbers with numbers; the difference in slope where one is a factor of few levels. */
bool fg_basis_accepts_interaction(const fg_loop_problem *problem, size_t a, size_t b) {
  const fg_loop_coordinate *x = &problem->coordinate[a], *y = &problem->coordinate[b];
  if (a >= b || (x->roles | y->roles) & FG_LOOP_ORDER) return false;
  if (x->levels && y->levels) return factors_cross(problem, x, y);
  if (x->levels) return fg_basis_is_number(y) && slopes_hold(problem, x->levels);
  if (y->levels) return fg_basis_is_number(x) && slopes_hold(problem, y->levels);
  return fg_basis_is_number(x) && fg_basis_is_number(y);
}

size_t fg_basis_interaction_columns(const fg_loop_problem *problem,
                                    const fg_loop_candidate *candidate) {
  size_t a = problem->coordinate[candidate->a].levels, b = problem->coordinate[candidate->b].levels;
  return (a ? a - 1 : 1) * (b ? b - 1 : 1);
}

/* Level k of a factor against its last: the levels of a column add to nothing. */
static double contrast(const fg_loop_coordinate *at, size_t row, size_t k) {
  size_t level = (size_t)at->value[row];
  return level == k ? 1 : level + 1 == at->levels ? -1 : 0;
}

static void cross_factors(const fg_loop_problem *problem, const fg_loop_coordinate *x,
                          const fg_loop_coordinate *y, double *columns) {
  for (size_t j = 0; j + 1 < x->levels; j++)
    for (size_t k = 0; k + 1 < y->levels; k++, columns += problem->rows)
      for (size_t i = 0; i < problem->rows; i++)
        columns[i] = contrast(x, i, j) * contrast(y, i, k);
}

void fg_basis_interaction(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                          const double *shape, double *columns) {
  const fg_loop_coordinate *x = fg_basis_first(problem, candidate);
  const fg_loop_coordinate *y = &problem->coordinate[candidate->b];
  const fg_loop_coordinate *factor = x->levels ? x : y, *number = x->levels ? y : x;
  (void)shape;
  if (x->levels && y->levels) {
    cross_factors(problem, x, y, columns);
    return;
  }
  for (size_t i = 0; i < problem->rows; i++) {
    if (!factor->levels) columns[i] = scaled(x, i) * scaled(y, i);
    for (size_t k = 0; k + 1 < factor->levels; k++)
      columns[k * problem->rows + i] = contrast(factor, i, k) * scaled(number, i);
  }
}

/* Accepts words, or numbers with few values that recur. */
bool fg_basis_accepts_factor(const fg_loop_problem *problem, size_t a, size_t b) {
  const fg_loop_coordinate *at = &problem->coordinate[a];
  (void)b;
  if (at->levels) return at->levels >= 2 && at->levels <= FG_LOOP_COLUMNS;
  return fg_basis_is_number(at) && !at->coded && at->distinct >= 3 &&
         at->distinct <= FG_LOOP_COLUMNS && problem->rows >= 4 * at->distinct;
}

size_t fg_basis_factor_columns(const fg_loop_problem *problem, const fg_loop_candidate *candidate) {
  const fg_loop_coordinate *at = fg_basis_first(problem, candidate);
  return fg_basis_level_count(at) - 1;
}

void fg_basis_level_columns(const fg_loop_problem *problem, const fg_loop_coordinate *at,
                            double *columns) {
  size_t count = fg_basis_level_count(at);
  memset(columns, 0, (count - 1) * problem->rows * sizeof *columns);
  for (size_t i = 0; at->levels && i < problem->rows; i++) {
    size_t k = at->value[i] > 0 ? (size_t)at->value[i] : 0;
    if (k > 0 && k < count && at->value[i] == (double)k) columns[(k - 1) * problem->rows + i] = 1;
  }
  for (size_t i = 0; !at->levels && i < problem->rows; i++)
    for (size_t k = 1; k < count; k++)
      if (at->value[i] == at->few[k]) columns[(k - 1) * problem->rows + i] = 1;
}

void fg_basis_factor(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                     const double *shape, double *columns) {
  (void)shape;
  fg_basis_level_columns(problem, fg_basis_first(problem, candidate), columns);
}

bool fg_basis_accepts_threshold(const fg_loop_problem *problem, size_t a, size_t b) {
  const fg_loop_coordinate *at = &problem->coordinate[a];
  (void)b;
  return fg_basis_is_number(at) && at->distinct >= 4;
}

/* Fewer rows than these on one side are rows, not a level. */
enum { SIDE_ROWS = 3 };

void fg_basis_threshold(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                        const double *shape, double *columns) {
  const fg_loop_coordinate *at = fg_basis_first(problem, candidate);
  for (size_t i = 0; i < problem->rows; i++)
    columns[i] = at->value[i] > shape[0] ? 1 : -1;
}

enum { THRESHOLDS = 59 };

/* Those of the places, ascending, that have rows on both sides. */
static size_t keep_places(const fg_loop_problem *problem, const fg_loop_coordinate *at,
                          const double *place, size_t places,
                          double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  size_t rows[THRESHOLDS + 1] = {0}, below = 0, count = 0; /* rows: with so many places below */
  for (size_t i = 0; i < problem->rows; i++) {
    size_t low = 0, high = places;
    while (low < high) {
      size_t middle = (low + high) / 2;
      if (at->value[i] > place[middle])
        low = middle + 1;
      else
        high = middle;
    }
    rows[low]++;
  }
  size_t min = problem->rows / 8 > SIDE_ROWS ? problem->rows / 8 : SIDE_ROWS;
  for (size_t k = 0; k < places; k++) {
    below += rows[k];
    if (below >= min && problem->rows - below >= min) starts[count++][0] = place[k];
  }
  return count;
}

/* Share of the range by which a threshold keeps off a value on its grid: rounding, which differs
 * from unit to unit, would else say on which side the value is. */
#define BEFORE_A_VALUE 1e-7

/* Between neighbouring values; where there are many, spread over the range. */
size_t fg_basis_threshold_starts(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                                 double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  const fg_loop_coordinate *at = fg_basis_first(problem, candidate);
  double place[THRESHOLDS];
  size_t places = 0;
  if (at->distinct <= FG_LOOP_COLUMNS + 1)
    for (size_t i = 1; i < at->distinct; i++)
      place[places++] = (at->few[i - 1] + at->few[i]) / 2;
  else
    for (size_t i = 1; i <= THRESHOLDS; i++)
      place[places++] =
          at->low + (at->high - at->low) * ((double)i / (THRESHOLDS + 1) - BEFORE_A_VALUE);
  return keep_places(problem, at, place, places, starts);
}

bool fg_basis_accepts_sensitivity(const fg_loop_problem *problem, size_t a, size_t b) {
  (void)b;
  return (problem->coordinate[a].roles & FG_LOOP_SENSITIVITY) != 0;
}

void fg_basis_sensitivity(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                          const double *shape, double *columns) {
  const fg_loop_coordinate *at = fg_basis_first(problem, candidate);
  double scale = fmax(fabs(at->low), fabs(at->high));
  (void)shape;
  for (size_t i = 0; i < problem->rows; i++)
    columns[i] = scale > 0 ? at->value[i] / scale : 0;
}
