/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The order of rows for which none was declared. A column of time or of runs is one. The number of
 * a row in its file is one, too, unless the file is sorted by a column, or gathered by one, so that
 * neighbours are alike in it: they may then be alike in the response because of their levels, and
 * not because they were measured one after the other. */
#include <float.h>
#include <math.h>
#include <string.h>
#include <strings.h>

#include "core/text.h"
#include "table_loop/parts.h"

static bool is_monotone(const fg_loop_coordinate *at, size_t rows) {
  size_t up = 0, down = 0;
  for (size_t i = 1; i < rows; i++) {
    up += at->value[i] > at->value[i - 1];
    down += at->value[i] < at->value[i - 1];
  }
  return !at->levels && (up + 1 == rows || down + 1 == rows);
}

static bool has_name_of_time(const fg_loop_coordinate *at) {
  static const char *const times[] = {"year", "month", "week",     "day",     "date",
                                      "hour", "time",  "minute",   "quarter", "read",
                                      "run",  "order", "sequence", "trial"};
  for (size_t i = 0; i < sizeof times / sizeof *times; i++)
    if (strcasestr(at->name, times[i])) return true;
  return false;
}

/* Numbers in equal steps that the declared model does not use. */
static bool is_counted(const fg_loop_coordinate *at, size_t rows) {
  if (at->roles & FG_LOOP_DECLARED) return false;
  double step = (at->value[rows - 1] - at->value[0]) / ((double)rows - 1);
  double rounding = 4 * DBL_EPSILON * fmax(fabs(at->low), fabs(at->high)); /* far from 0 */
  for (size_t i = 1; i < rows; i++)
    if (fabs(at->value[i] - at->value[i - 1] - step) > 1e-6 * fabs(step) + rounding) return false;
  return true;
}

static bool begins_with_word(const char *name, const char *word) {
  size_t length = strlen(word);
  return !strncasecmp(name, word, length) && (name[length] == '_' || !name[length]);
}

/* A place or a setting by its name or the unit in it, from any origin and in any unit; all other
 * numbers in equal steps through a sorted file are those that it gives its rows. */
static bool is_named_as_measured(const fg_loop_coordinate *at) {
  static const char *const units[] = {
      "_mm",  "_um",  "_nm",  "_cm", "_m",  "_km", "_in", "_ft",  "_deg", "_rad",
      "_rev", "_C",   "_K",   "_F",  "_kg", "_g",  "_mg", "_N",   "_kN",  "_Nm",
      "_Pa",  "_kPa", "_V",   "_mV", "_A",  "_mA", "_W",  "_kW",  "_Hz",  "_kHz",
      "_rpm", "_pct", "_ppm", "_l",  "_ml", "_J",  "_kJ", "_MPa", "_bar", "_turn"};
  static const char *const words[] = {
      "x",        "y",       "z",           "position",  "distance",     "place",
      "angle",    "azimuth", "theta",       "depth",     "height",       "length",
      "width",    "radius",  "level",       "frequency", "pressure",     "speed",
      "velocity", "force",   "temperature", "humidity",  "voltage",      "current",
      "dose",     "load",    "power",       "feed",      "concentration"};
  for (size_t i = 0; i < sizeof units / sizeof *units; i++)
    if (fg_loop_table_name_ends(at->name, units[i])) return true;
  for (size_t i = 0; i < sizeof words / sizeof *words; i++)
    if (begins_with_word(at->name, words[i])) return true;
  return false;
}

/* Levels each in one piece. */
static bool is_in_blocks(const fg_loop_coordinate *at, size_t rows) {
  size_t pieces = 1;
  for (size_t i = 1; i < rows; i++)
    pieces += at->value[i] != at->value[i - 1];
  return pieces == at->distinct && at->distinct >= 2 && at->distinct < rows;
}

/* Days or shifts one after the other: rows in blocks of them are in order of time. */
static bool is_time_in_blocks(const fg_loop_coordinate *at, size_t rows) {
  if (!has_name_of_time(at) || !is_in_blocks(at, rows)) return false;
  for (size_t i = 1; i < rows; i++)
    if (!at->levels && at->value[i] < at->value[i - 1]) return false;
  return true;
}

/* Deviate of neighbours that are alike, from which on rows are not in a random order: one in 10^4
 * random orders. */
#define ALIKE 3.72

/* Returns true when neighbours have the same level oftener than in a random order: the number of
 * pieces against its mean and variance (Mood 1940). */
static bool has_few_pieces(const fg_loop_coordinate *at, size_t rows) {
  double n = (double)rows, squares = 0, cubes = 0, pieces = 1;
  for (size_t k = 0; k < at->levels; k++) {
    double count = 0;
    for (size_t i = 0; i < rows; i++)
      count += at->value[i] == (double)k;
    squares += count * count;
    cubes += count * count * count;
  }
  for (size_t i = 1; i < rows; i++)
    pieces += at->value[i] != at->value[i - 1];
  double mean = (n * (n + 1) - squares) / n;
  double variance =
      (squares * (squares + n * (n + 1)) - 2 * n * cubes - n * n * n) / (n * n * (n - 1));
  return variance > 0 && pieces < mean - ALIKE * sqrt(variance);
}

/* Rank of a row's value, the mean one of equal values. */
static double rank_of(const fg_loop_coordinate *at, size_t rows, size_t row) {
  double rank = 0.5;
  for (size_t i = 0; i < rows; i++)
    rank += at->value[i] < at->value[row] ? 1 : at->value[i] == at->value[row] ? 0.5 : 0;
  return rank;
}

/* Rows whose ranks are compared: a part of many is as good, and the work goes by their square. */
enum { RANKED = 2000 };

/* Returns true when neighbours have closer values than in a random order: von Neumann's ratio of
 * ranks (Bartels 1982). */
static bool has_close_neighbours(const fg_loop_coordinate *at, size_t rows) {
  size_t used = rows < RANKED ? rows : RANKED;
  double n = (double)used, middle = (n + 1) / 2, steps = 0, whole = 0, before = 0;
  for (size_t i = 0; i < used; i++) {
    double rank = rank_of(at, used, i);
    if (i > 0) steps += (rank - before) * (rank - before);
    whole += (rank - middle) * (rank - middle);
    before = rank;
  }
  double variance = 4 * (n - 2) * (5 * n * n - 2 * n - 9) / (5 * n * (n + 1) * (n - 1) * (n - 1));
  return whole > 0 && steps / whole < 2 - ALIKE * sqrt(variance);
}

/* Rows gathered by a column, as lots or places come together. */
static bool gathers(const fg_loop_coordinate *at, size_t rows) {
  return at->levels ? has_few_pieces(at, rows) : has_close_neighbours(at, rows);
}

/* Columns that say something of the rows' order; SIZE_MAX: none. */
typedef struct order_columns {
  size_t time, counted, sorting, gathering;
  bool chronological;
} order_columns;

static order_columns find_order_columns(const fg_loop_problem *problem, size_t columns) {
  order_columns found = {SIZE_MAX, SIZE_MAX, SIZE_MAX, SIZE_MAX, false};
  size_t rows = problem->rows;
  for (size_t c = 0; c < columns; c++) {
    const fg_loop_coordinate *at = &problem->coordinate[c];
    bool monotone = is_monotone(at, rows), counted = monotone && is_counted(at, rows);
    found.chronological |= is_time_in_blocks(at, rows);
    if (monotone && has_name_of_time(at) && found.time == SIZE_MAX) found.time = c;
    if (counted && found.counted == SIZE_MAX) found.counted = c;
    bool sorts = (monotone && !counted) || is_in_blocks(at, rows);
    if (sorts && found.sorting == SIZE_MAX) found.sorting = c;
    if (!counted && found.gathering == SIZE_MAX && gathers(at, rows)) found.gathering = c;
  }
  return found;
}

static fg_status leave_out_number(fg_context *ctx, const fg_loop_table_state *build,
                                  const char *name, const order_columns *found) {
  char why[2 * FG_LOOP_NAME + 160];
  const fg_loop_coordinate *at = build->out->problem.coordinate;
  if (found->sorting != SIZE_MAX)
    fg_text_clip(why, sizeof why,
                 "the rows are sorted by %s, so their number is the file's and no order in time "
                 "(--order COLUMN declares one)",
                 at[found->sorting].name);
  else
    fg_text_clip(why, sizeof why,
                 "neighbouring rows are alike in %s, so their number may be the file's and no "
                 "order in time (--order COLUMN declares one)",
                 at[found->gathering].name);
  return fg_loop_table_leave_out(ctx, build, name, why);
}

fg_status fg_loop_table_find_order(fg_context *ctx, const fg_loop_table_state *build) {
  fg_loop_problem *problem = &build->out->problem;
  size_t last = problem->coordinates - 1;
  if (!(problem->coordinate[last].roles & FG_LOOP_ORDER)) return FG_OK;
  order_columns found = find_order_columns(problem, last);
  bool sorted = (found.sorting != SIZE_MAX || found.gathering != SIZE_MAX) && !found.chronological;
  size_t order = found.time != SIZE_MAX ? found.time : sorted ? SIZE_MAX : found.counted;
  if (order != SIZE_MAX) {
    problem->coordinate[order].roles |= FG_LOOP_ORDER;
    fg_loop_table_drop(problem, last);
    return FG_OK;
  }
  if (!sorted) return FG_OK;
  problem->correlated = false;
  size_t counted = found.counted;
  bool own = counted != SIZE_MAX && !is_named_as_measured(&problem->coordinate[counted]);
  FG_TRY(leave_out_number(ctx, build, own ? problem->coordinate[counted].name : "row", &found));
  fg_loop_table_drop(problem, last);
  if (own) fg_loop_table_drop(problem, counted);
  return FG_OK;
}
