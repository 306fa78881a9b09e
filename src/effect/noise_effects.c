/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Deviations from the declared noise: correlated neighbours, unequal spread, random levels. */
#include <math.h>
#include <string.h>

#include "effect/bases.h"
#include "effect/table_effects.h"

/* Minimum length of a series for estimating the correlation of neighbours. */
enum { SERIES_ROWS = 8 };

/* A level of its own for the spread needs so many rows. */
enum { ROWS_A_LEVEL = 4 };

static bool accepts_serial(const fg_loop_problem *problem, size_t a, size_t b) {
  unsigned roles = problem->coordinate[a].roles;
  (void)b;
  if (!problem->correlated || problem->rows < SERIES_ROWS) return false;
  return roles & (problem->group_level ? FG_LOOP_BUMP : FG_LOOP_ORDER);
}

static size_t no_columns(const fg_loop_problem *problem, const fg_loop_candidate *candidate) {
  (void)problem, (void)candidate;
  return 0;
}

static void no_basis(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                     const double *shape, double *columns) {
  (void)problem, (void)candidate, (void)shape, (void)columns;
}

/* Levels of the spread: words, and whole groups. */
static bool by_levels(const fg_loop_problem *problem, const fg_loop_coordinate *at) {
  return at->levels ||
         (problem->group_level && at->roles & FG_LOOP_ORDER && at->distinct <= FG_LOOP_COLUMNS);
}

static bool accepts_spread(const fg_loop_problem *problem, size_t a, size_t b) {
  const fg_loop_coordinate *at = &problem->coordinate[a];
  (void)b;
  if (at->roles & FG_LOOP_LEVEL) return at->distinct >= 3;
  if (by_levels(problem, at)) {
    size_t levels = fg_basis_level_count(at);
    return levels >= 2 && levels <= FG_LOOP_COLUMNS && problem->rows >= ROWS_A_LEVEL * levels;
  }
  return fg_basis_is_number(at) && problem->rows >= 2 * SERIES_ROWS;
}

bool fg_loop_spread_by_levels(const fg_loop_problem *problem, const fg_loop_candidate *candidate) {
  return by_levels(problem, fg_basis_first(problem, candidate));
}

static size_t spread_columns(const fg_loop_problem *problem, const fg_loop_candidate *candidate) {
  const fg_loop_coordinate *at = fg_basis_first(problem, candidate);
  return by_levels(problem, at) ? fg_basis_level_count(at) - 1 : 1;
}

static void spread_basis(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                         const double *shape, double *columns) {
  const fg_loop_coordinate *at = fg_basis_first(problem, candidate);
  if (by_levels(problem, at))
    fg_basis_level_columns(problem, at, columns);
  else
    fg_basis_linear(problem, candidate, shape, columns);
}

/* Levels from which on one variance stands for all: fewer tell it badly, and their differences are
 * of interest by themselves. */
enum { RANDOM_LEVELS = 8 };
/* Every second level has a second row, or most of the scatter within is unknown. */
#define ROWS_A_RANDOM_LEVEL 1.5
/* Limit of the indicators that are kept. */
enum { RANDOM_CELLS = 4000000 };

/* Levels of groups: rows of a group have one, and every second level a second group. */
static bool holds_groups(const fg_loop_problem *problem, const fg_loop_coordinate *at) {
  for (size_t i = 1; i < problem->rows; i++)
    if (problem->group[i] == problem->group[i - 1] && at->value[i] != at->value[i - 1])
      return false;
  return (double)problem->groups >= ROWS_A_RANDOM_LEVEL * (double)at->levels &&
         problem->rows * problem->groups <= RANDOM_CELLS;
}

static bool accepts_levels(const fg_loop_problem *problem, size_t a, size_t b) {
  const fg_loop_coordinate *at = &problem->coordinate[a];
  (void)b;
  if (at->levels < RANDOM_LEVELS) return false;
  if (problem->group_level) return holds_groups(problem, at);
  return (double)problem->rows >= ROWS_A_RANDOM_LEVEL * (double)at->levels &&
         problem->rows * at->levels <= RANDOM_CELLS;
}

static const fg_loop_effect noise_effects[] = {
    {.id = "table.serial_correlation",
     .sought = "neighbours that are alike",
     .scatter = FG_LOOP_SERIAL,
     .level = "runs",
     .frame = "order",
     .words = "serial correlation along",
     .accepts = accepts_serial,
     .columns = no_columns,
     .basis = no_basis},
    {.id = "table.spread",
     .sought = "scatter that changes",
     .scatter = FG_LOOP_SPREAD,
     .level = "runs",
     .frame = "column",
     .words = "a scatter that changes with",
     .accepts = accepts_spread,
     .columns = spread_columns,
     .basis = spread_basis,
     .own_levels = true},
    {.id = "table.random_levels",
     .sought = "levels that scatter",
     .scatter = FG_LOOP_LEVELS,
     .level = "runs",
     .frame = "column",
     .words = "levels that scatter over",
     .accepts = accepts_levels,
     .columns = no_columns,
     .basis = no_basis,
     .own_levels = true},
    {0},
};

const fg_loop_effect *fg_loop_noise_effects(void) {
  return noise_effects;
}

static const fg_loop_effect scale_effect = {
    .id = "table.response_scale",
    .scatter = FG_LOOP_SPREAD,
    .level = "runs",
    .frame = "response",
    .words = "a response whose effects add on another scale",
    .columns = no_columns,
    .basis = no_basis,
};

const fg_loop_effect *fg_loop_scale_effect(void) {
  return &scale_effect;
}
