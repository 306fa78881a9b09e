/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bases over places: cycles over an order, a column, a base period that is known; reversal. */
#include <math.h>

#include "core/sincos.h"
#include "effect/bases.h"

static const double two_pi = 6.28318530717958647692;

/* Fewer places than these do not show a cycle. */
enum { PLACES = 8 };

/* Least cycles over the range of a column: a cycle that is seen less often is a bend. An order, and
 * an angle, which returns to its start, are sought from one cycle on. */
#define CYCLES_OF_A_COLUMN 2.0

/* Longest period of a known base, over the range. */
#define LONGEST 1.34

/* Distance of places by which the shortest cycle is known; of an order it is the mean one. */
static double spacing_of(const fg_loop_coordinate *at) {
  bool mean = fg_basis_is_sequence(at) || !(at->spacing > 0);
  return mean ? (at->high - at->low) / ((double)at->distinct - 1) : at->spacing;
}

bool fg_basis_accepts_periodic(const fg_loop_problem *problem, size_t a, size_t b) {
  const fg_loop_coordinate *at = &problem->coordinate[a];
  (void)b;
  return fg_basis_is_number(at) && !at->coded && at->distinct >= PLACES;
}

size_t fg_basis_periodic_columns(const fg_loop_problem *problem,
                                 const fg_loop_candidate *candidate) {
  size_t count = 0;
  (void)problem;
  for (size_t k = 1; k <= FG_LOOP_ORDER_MAX; k++)
    count += fg_loop_has_order(candidate, k);
  return 2 * count;
}

/* Angles that are taken together. */
enum { ANGLES = 64 };

void fg_basis_wave(size_t rows, const fg_loop_coordinate *at, double period, double *columns) {
  double phase[ANGLES];
  for (size_t from = 0; from < rows; from += ANGLES) {
    size_t count = rows - from < ANGLES ? rows - from : ANGLES;
    double *sine = columns + from;
    for (size_t i = 0; i < count; i++)
      phase[i] = two_pi * (at->value[from + i] - at->low) / period;
    fg_sincos(count, phase, sine, sine + rows);
    for (size_t i = 0; i < count; i++)
      if (fabs(sine[i]) < FG_BASIS_ROUNDING) sine[i] = 0;
  }
}

void fg_basis_periodic(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                       const double *shape, double *columns) {
  const fg_loop_coordinate *at = fg_basis_first(problem, candidate);
  for (size_t k = 1; k <= FG_LOOP_ORDER_MAX; k++) {
    if (!fg_loop_has_order(candidate, k)) continue;
    fg_basis_wave(problem->rows, at, shape[0] / (double)k, columns);
    columns += 2 * problem->rows;
  }
}

/* From few cycles over the range to a period of two places, half a cycle apart. */
size_t fg_basis_periodic_starts(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                                double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  const fg_loop_coordinate *at = fg_basis_first(problem, candidate);
  double range = at->high - at->low;
  double max = range / (2 * spacing_of(at)) * (1 + 1e-9);
  bool returns = fg_basis_is_sequence(at) || at->period > 0;
  size_t count = 0;
  for (double cycles = returns ? 1 : CYCLES_OF_A_COLUMN; cycles <= max && count < FG_LOOP_STARTS;
       cycles += 0.5)
    starts[count++][0] = range / cycles;
  return count;
}

static size_t lowest_order(const fg_loop_coordinate *at) {
  return (size_t)fmax(ceil(at->period / (LONGEST * (at->high - at->low))), 1);
}

bool fg_basis_accepts_orders(const fg_loop_problem *problem, size_t a, size_t b) {
  const fg_loop_coordinate *at = &problem->coordinate[a];
  return fg_basis_accepts_periodic(problem, a, b) && at->period > 0 &&
         lowest_order(at) <= at->order_max;
}

size_t fg_basis_order_starts(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                             double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  const fg_loop_coordinate *at = fg_basis_first(problem, candidate);
  size_t count = 0;
  for (size_t k = lowest_order(at); k <= at->order_max; k++)
    starts[count++][0] = at->period / (double)k;
  return count;
}

/* Places that are approached from two directions show a backlash, the same at all of them, as
 * levels of the direction; a hysteresis opens between the ends and closes there. */

/* Fewer places than these show no curve. */
enum { PLACES_OF_A_LOOP = 5 };

static bool has_direction(const fg_loop_coordinate *at) {
  return (at->roles & FG_LOOP_DIRECTION) != 0;
}

/* Places that are set, and so met again from the other side, or that the model declares. */
static bool is_swept(const fg_loop_problem *problem, const fg_loop_coordinate *at) {
  return at->roles & FG_LOOP_DECLARED || 4 * at->distinct <= 3 * problem->rows;
}

bool fg_basis_accepts_hysteresis(const fg_loop_problem *problem, size_t a, size_t b) {
  const fg_loop_coordinate *place = &problem->coordinate[a];
  return a != b && has_direction(&problem->coordinate[b]) && !has_direction(place) &&
         fg_basis_is_number(place) && !(place->roles & FG_LOOP_ORDER) &&
         place->distinct >= PLACES_OF_A_LOOP && is_swept(problem, place);
}

/* Half the difference of the directions at the ends, and in the middle: u² and 1 - u², u from -1 to
 * 1. Both together contain the backlash. */
void fg_basis_hysteresis(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                         const double *shape, double *columns) {
  const fg_loop_coordinate *place = fg_basis_first(problem, candidate);
  const fg_loop_coordinate *direction = &problem->coordinate[candidate->b];
  (void)shape;
  for (size_t i = 0; i < problem->rows; i++) {
    double sense = direction->value[i] > (direction->low + direction->high) / 2 ? 1 : -1;
    double u = (2 * place->value[i] - place->low - place->high) / (place->high - place->low);
    columns[i] = sense * u * u;
    columns[problem->rows + i] = sense * (1 - u * u);
  }
}
