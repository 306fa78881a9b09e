/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Places of a column: how far apart they are, and which orders of a base period they tell. */
#include "table_loop/places.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/text.h"
#include "table_loop/parts.h"

/* Places may differ from a grid by so much of its step: digits of a file. */
#define OFF_GRID 0.02
/* A grid with more steps than this many times the places is no grid of theirs. */
#define EMPTY 2

static double smallest_gap(const double *sorted, size_t rows) {
  double gap = INFINITY, min = 1e-9 * (sorted[rows - 1] - sorted[0]);
  for (size_t i = 1; i < rows; i++)
    if (sorted[i] - sorted[i - 1] > min) gap = fmin(gap, sorted[i] - sorted[i - 1]);
  return gap;
}

static bool lie_on_grid(const double *sorted, size_t rows, double step) {
  for (size_t i = 0; i < rows; i++) {
    double steps = (sorted[i] - sorted[0]) / step;
    if (fabs(steps - round(steps)) > OFF_GRID) return false;
  }
  return true;
}

void fg_loop_places_measure(const double *sorted, size_t rows, fg_loop_coordinate *at) {
  double range = at->high - at->low;
  at->spacing = 0;
  at->even = false;
  if (at->levels || at->distinct < 2) return;
  double steps = round(range / smallest_gap(sorted, rows));
  at->even =
      steps <= EMPTY * ((double)at->distinct - 1) && lie_on_grid(sorted, rows, range / steps);
  at->spacing = range / (at->even ? steps : (double)at->distinct - 1);
}

/* Number of different places within a base period. */
static fg_status count_phases(fg_context *ctx, const fg_loop_problem *problem,
                              const fg_loop_coordinate *at, size_t *count) {
  double *phase = NULL;
  size_t rows = problem->rows;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *phase, (void **)&phase));
  for (size_t i = 0; i < rows; i++) {
    double turns = (at->value[i] - at->low) / at->period;
    phase[i] = turns - floor(turns + 1e-6);
  }
  fg_sort(phase, rows);
  *count = 1;
  for (size_t i = 1; i < rows; i++)
    *count += phase[i] - phase[i - 1] > 1e-5;
  free(phase);
  return FG_OK;
}

static fg_status set_base(fg_context *ctx, const fg_loop_problem *problem, double period,
                          fg_loop_coordinate *at) {
  size_t phases;
  at->period = period;
  FG_TRY(count_phases(ctx, problem, at, &phases));
  at->order_max = phases / 2 < FG_LOOP_ORDER_MAX ? phases / 2 : FG_LOOP_ORDER_MAX;
  return FG_OK;
}

/* A turn in the unit of an angle's name; 0 for other columns, and for an angle that turns less than
 * three quarters: it may be a setting. */
static double turn_of(const fg_loop_coordinate *at) {
  static const struct {
    const char *end;
    double turn;
  } units[] = {{"_deg", 360}, {"_rad", 6.28318530717958647692}, {"_rev", 1}, {"_turn", 1}};
  static const char *const words[] = {"angle", "azimuth", "theta"};
  double turn = 0, range = at->high - at->low;
  for (size_t i = 0; i < sizeof units / sizeof *units; i++)
    if (fg_loop_table_name_ends(at->name, units[i].end)) turn = units[i].turn;
  for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
    const char *found = strcasestr(at->name, words[i]);
    if (turn == 0 && found && !found[strlen(words[i])]) turn = 360;
  }
  return turn > 0 && range >= 0.75 * turn ? turn : 0;
}

bool fg_loop_places_have_base(const fg_loop_table_spec *spec, const fg_loop_coordinate *at) {
  for (size_t i = 0; i < spec->periods; i++)
    if (!strcmp(spec->period[i].column, at->name)) return true;
  return !at->levels && turn_of(at) > 0;
}

static fg_status declare(fg_context *ctx, const fg_loop_table_state *build,
                         const fg_loop_known_period *known) {
  const fg_loop_problem *problem = &build->out->problem;
  fg_loop_coordinate *at = fg_loop_table_coordinate(problem, known->column);
  if (!at || at->levels)
    return fg_fail(ctx, FG_ERR_USAGE,
                   "--period %s=%.10g: %s is no column of numbers that can be a cause",
                   known->column, known->period, known->column);
  FG_TRY(set_base(ctx, problem, known->period, at));
  at->declared_period = true;
  if (at->high - at->low < 0.75 * known->period / (double)at->order_max)
    return fg_fail(ctx, FG_ERR_USAGE,
                   "--period %s=%.10g: %s ranges over %.10g only, and these places tell no order "
                   "of that period",
                   known->column, known->period, at->name, at->high - at->low);
  return FG_OK;
}

fg_status fg_loop_places_find_bases(fg_context *ctx, const fg_loop_table_state *build) {
  const fg_loop_problem *problem = &build->out->problem;
  for (size_t c = 0; c < problem->coordinates; c++) {
    fg_loop_coordinate *at = &problem->coordinate[c];
    double turn = at->levels ? 0 : turn_of(at);
    if (turn > 0) FG_TRY(set_base(ctx, problem, turn, at));
  }
  for (size_t i = 0; i < build->spec->periods; i++)
    FG_TRY(declare(ctx, build, &build->spec->period[i]));
  return FG_OK;
}
