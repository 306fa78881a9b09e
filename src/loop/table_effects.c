/* The effects of tables: of columns, of the order, of bumps, of the heat treatment. */
#include <math.h>
#include <string.h>

#include "loop/heat_forms.h"

static const double two_pi = 6.28318530717958647692;

static const fg_loop_coordinate *first(problem_t *problem, candidate_t *candidate) {
  return &problem->coordinate[candidate->a];
}

bool fg_engine_is_number(const fg_loop_coordinate *at) {
  return at->levels == 0 && !(at->roles & FG_LOOP_SENSITIVITY) && at->distinct >= 2;
}

static bool is_sequence(const fg_loop_coordinate *at) {
  return (at->roles & (FG_LOOP_ORDER | FG_LOOP_BUMP)) != 0;
}

/* -1 at the lowest value, +1 at the highest. */
static double scaled(const fg_loop_coordinate *at, size_t row) {
  return at->high > at->low ? (2 * at->value[row] - at->low - at->high) / (at->high - at->low) : 0;
}

static size_t one_column(problem_t *problem, candidate_t *candidate) {
  (void)problem, (void)candidate;
  return 1;
}

static size_t two_columns(problem_t *problem, candidate_t *candidate) {
  (void)problem, (void)candidate;
  return 2;
}

static bool accepts_linear(problem_t *problem, size_t a, size_t b) {
  const fg_loop_coordinate *at = &problem->coordinate[a];
  (void)b;
  return fg_engine_is_number(at) && !is_sequence(at);
}

static void linear_basis(problem_t *problem, candidate_t *candidate, const double *shape,
                         double *columns) {
  (void)shape;
  for (size_t i = 0; i < problem->rows; i++)
    columns[i] = scaled(first(problem, candidate), i);
}

static bool accepts_quadratic(problem_t *problem, size_t a, size_t b) {
  return accepts_linear(problem, a, b) && problem->coordinate[a].distinct >= 3;
}

static void quadratic_basis(problem_t *problem, candidate_t *candidate, const double *shape,
                            double *columns) {
  (void)shape;
  for (size_t i = 0; i < problem->rows; i++) {
    double x = scaled(first(problem, candidate), i);
    columns[i] = x;
    columns[problem->rows + i] = 2 * x * x - 1;
  }
}

/* Numbers with numbers; the difference in slope where one is a factor of few levels. */
static bool accepts_interaction(problem_t *problem, size_t a, size_t b) {
  const fg_loop_coordinate *x = &problem->coordinate[a], *y = &problem->coordinate[b];
  if (a >= b || is_sequence(x) || is_sequence(y)) return false;
  if (x->levels && y->levels) return false;
  if (x->levels) return fg_engine_is_number(y) && x->levels <= 4;
  if (y->levels) return fg_engine_is_number(x) && y->levels <= 4;
  return fg_engine_is_number(x) && fg_engine_is_number(y);
}

static size_t interaction_columns(problem_t *problem, candidate_t *candidate) {
  size_t levels =
      problem->coordinate[candidate->a].levels + problem->coordinate[candidate->b].levels;
  return levels ? levels - 1 : 1;
}

static void interaction_basis(problem_t *problem, candidate_t *candidate, const double *shape,
                              double *columns) {
  const fg_loop_coordinate *x = first(problem, candidate);
  const fg_loop_coordinate *y = &problem->coordinate[candidate->b];
  const fg_loop_coordinate *factor = x->levels ? x : y, *number = x->levels ? y : x;
  (void)shape;
  for (size_t i = 0; i < problem->rows; i++) {
    if (!factor->levels) {
      columns[i] = scaled(x, i) * scaled(y, i);
      continue;
    }
    for (size_t k = 1; k < factor->levels; k++)
      columns[(k - 1) * problem->rows + i] = factor->value[i] == (double)k ? scaled(number, i) : 0;
  }
}

/* Words, or numbers that take few values often. */
static bool accepts_factor(problem_t *problem, size_t a, size_t b) {
  const fg_loop_coordinate *at = &problem->coordinate[a];
  (void)b;
  if (at->levels) return at->levels >= 2 && at->levels <= FG_LOOP_COLUMNS;
  return fg_engine_is_number(at) && at->distinct >= 3 && at->distinct <= 10 &&
         problem->rows >= 4 * at->distinct;
}

static size_t factor_columns(problem_t *problem, candidate_t *candidate) {
  const fg_loop_coordinate *at = first(problem, candidate);
  return (at->levels ? at->levels : at->distinct) - 1;
}

static void factor_basis(problem_t *problem, candidate_t *candidate, const double *shape,
                         double *columns) {
  const fg_loop_coordinate *at = first(problem, candidate);
  size_t count = at->levels ? at->levels : at->distinct;
  (void)shape;
  memset(columns, 0, factor_columns(problem, candidate) * problem->rows * sizeof *columns);
  for (size_t i = 0; i < problem->rows; i++)
    for (size_t k = 1; k < count; k++)
      if (at->value[i] == (at->levels ? (double)k : at->few[k]))
        columns[(k - 1) * problem->rows + i] = 1;
}

static bool accepts_threshold(problem_t *problem, size_t a, size_t b) {
  const fg_loop_coordinate *at = &problem->coordinate[a];
  (void)b;
  return fg_engine_is_number(at) && at->distinct >= 4;
}

/* Fewer rows than these on one side are rows, not a level. */
enum { SIDE_ROWS = 3 };

static void threshold_basis(problem_t *problem, candidate_t *candidate, const double *shape,
                            double *columns) {
  const fg_loop_coordinate *at = first(problem, candidate);
  for (size_t i = 0; i < problem->rows; i++)
    columns[i] = at->value[i] > shape[0] ? 1 : -1;
}

enum { THRESHOLDS = 23 };

static bool sides_hold(problem_t *problem, const fg_loop_coordinate *at, double place) {
  size_t above = 0;
  for (size_t i = 0; i < problem->rows; i++)
    above += at->value[i] > place;
  size_t least = problem->rows / 8 > SIDE_ROWS ? problem->rows / 8 : SIDE_ROWS;
  return above >= least && problem->rows - above >= least;
}

/* Between neighbouring values; where there are many, spread over the range. */
static size_t threshold_starts(problem_t *problem, candidate_t *candidate,
                               double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  const fg_loop_coordinate *at = first(problem, candidate);
  size_t count = 0;
  if (at->distinct <= FG_LOOP_COLUMNS + 1) {
    for (size_t i = 1; i < at->distinct; i++)
      if (sides_hold(problem, at, (at->few[i - 1] + at->few[i]) / 2))
        starts[count++][0] = (at->few[i - 1] + at->few[i]) / 2;
    return count;
  }
  for (size_t i = 1; i <= THRESHOLDS; i++) {
    double place = at->low + (at->high - at->low) * (double)i / (THRESHOLDS + 1);
    if (sides_hold(problem, at, place)) starts[count++][0] = place;
  }
  return count;
}

static bool accepts_drift(problem_t *problem, size_t a, size_t b) {
  const fg_loop_coordinate *at = &problem->coordinate[a];
  (void)b;
  return fg_engine_is_number(at) && is_sequence(at) && at->distinct >= 4;
}

static bool accepts_transient(problem_t *problem, size_t a, size_t b) {
  return accepts_drift(problem, a, b) && problem->coordinate[a].roles & FG_LOOP_ORDER;
}

static bool accepts_lip(problem_t *problem, size_t a, size_t b) {
  return accepts_drift(problem, a, b) && problem->coordinate[a].roles & FG_LOOP_BUMP;
}

/* From 1 at the first to nearly 0: half its range is half its height. */
static void decay_basis(problem_t *problem, candidate_t *candidate, const double *shape,
                        double *columns) {
  const fg_loop_coordinate *at = first(problem, candidate);
  for (size_t i = 0; i < problem->rows; i++)
    columns[i] = 2 * exp(-(at->value[i] - at->low) / shape[0]) - 1;
}

static size_t transient_starts(problem_t *problem, candidate_t *candidate,
                               double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  static const double share[] = {0.05, 0.1, 0.2, 0.4};
  const fg_loop_coordinate *at = first(problem, candidate);
  for (size_t i = 0; i < 4; i++)
    starts[i][0] = share[i] * (at->high - at->low);
  return 4;
}

static size_t lip_starts(problem_t *problem, candidate_t *candidate,
                         double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  static const double bumps[] = {0.6, 1.2, 2.4, 4};
  (void)problem, (void)candidate;
  for (size_t i = 0; i < 4; i++)
    starts[i][0] = bumps[i];
  return 4;
}

static bool accepts_periodic(problem_t *problem, size_t a, size_t b) {
  return accepts_drift(problem, a, b) && problem->coordinate[a].distinct >= 8;
}

static void periodic_basis(problem_t *problem, candidate_t *candidate, const double *shape,
                           double *columns) {
  const fg_loop_coordinate *at = first(problem, candidate);
  for (size_t i = 0; i < problem->rows; i++) {
    double phase = two_pi * (at->value[i] - at->low) / shape[0];
    columns[i] = sin(phase);
    columns[problem->rows + i] = cos(phase);
  }
}

/* From one cycle over the order to a period of 2.2 steps, half a cycle apart. */
static size_t periodic_starts(problem_t *problem, candidate_t *candidate,
                              double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  const fg_loop_coordinate *at = first(problem, candidate);
  double range = at->high - at->low;
  double most = fmin(20, ((double)at->distinct - 1) / 2.2);
  size_t count = 0;
  for (double cycles = 1; cycles <= most && count < FG_LOOP_STARTS; cycles += 0.5)
    starts[count++][0] = range / cycles;
  return count;
}

static bool accepts_sensitivity(problem_t *problem, size_t a, size_t b) {
  (void)b;
  return (problem->coordinate[a].roles & FG_LOOP_SENSITIVITY) != 0;
}

static void sensitivity_basis(problem_t *problem, candidate_t *candidate, const double *shape,
                              double *columns) {
  const fg_loop_coordinate *at = first(problem, candidate);
  double scale = fmax(fabs(at->low), fabs(at->high));
  (void)shape;
  for (size_t i = 0; i < problem->rows; i++)
    columns[i] = scale > 0 ? at->value[i] / scale : 0;
}

static const fg_loop_effect effects[] = {
    {"table.linear",
     "runs",
     "column",
     "a trend with",
     false,
     0,
     {0},
     accepts_linear,
     one_column,
     linear_basis,
     NULL,
     false,
     false,
     false},
    {"table.quadratic",
     "runs",
     "column",
     "a bent trend with",
     false,
     0,
     {0},
     accepts_quadratic,
     two_columns,
     quadratic_basis,
     NULL,
     false,
     false,
     false},
    {"table.interaction",
     "runs",
     "column",
     "an interaction of",
     true,
     0,
     {0},
     accepts_interaction,
     interaction_columns,
     interaction_basis,
     NULL,
     false,
     false,
     false},
    {"table.factor",
     "runs",
     "column",
     "levels of",
     false,
     0,
     {0},
     accepts_factor,
     factor_columns,
     factor_basis,
     NULL,
     false,
     false,
     true},
    {"table.threshold",
     "runs",
     "column",
     "a step over",
     false,
     1,
     {"at"},
     accepts_threshold,
     one_column,
     threshold_basis,
     threshold_starts,
     true,
     false,
     false},
    {"table.order_drift",
     "runs",
     "order",
     "a drift over",
     false,
     0,
     {0},
     accepts_drift,
     one_column,
     linear_basis,
     NULL,
     false,
     false,
     false},
    {"table.order_transient",
     "runs",
     "order",
     "a warm-up that fades over",
     false,
     1,
     {"decay_length"},
     accepts_transient,
     one_column,
     decay_basis,
     transient_starts,
     false,
     false,
     false},
    {"table.periodic",
     "runs",
     "order",
     "a periodic change over",
     false,
     1,
     {"period"},
     accepts_periodic,
     two_columns,
     periodic_basis,
     periodic_starts,
     false,
     false,
     false},
    {"part.lip_decay",
     "bumps",
     "bump table",
     "a decay from the lip over",
     false,
     1,
     {"decay_length"},
     accepts_lip,
     one_column,
     decay_basis,
     lip_starts,
     false,
     false,
     false},
    {"part.stretch",
     "bumps",
     "bump table",
     "an arc length that differs,",
     false,
     0,
     {0},
     accepts_sensitivity,
     one_column,
     sensitivity_basis,
     NULL,
     false,
     true,
     false},
    {"process.arrhenius",
     "runs",
     "column",
     "a rate by Arrhenius of",
     false,
     1,
     {"activation_energy_kj_per_mol"},
     fg_engine_accepts_temperature,
     one_column,
     fg_engine_arrhenius_basis,
     fg_engine_arrhenius_starts,
     false,
     false,
     false},
    {"process.larson_miller",
     "runs",
     "column",
     "the Larson-Miller parameter of",
     true,
     0,
     {0},
     fg_engine_accepts_both,
     one_column,
     fg_engine_larson_miller_basis,
     NULL,
     false,
     false,
     false},
    {"process.log_time",
     "runs",
     "column",
     "the logarithm of",
     false,
     0,
     {0},
     fg_engine_accepts_duration,
     one_column,
     fg_engine_log_time_basis,
     NULL,
     false,
     false,
     false},
    {"process.jmak",
     "runs",
     "column",
     "a transformation (JMAK) over",
     false,
     2,
     {"time_constant", "exponent"},
     fg_engine_accepts_duration,
     one_column,
     fg_engine_jmak_basis,
     fg_engine_jmak_starts,
     false,
     false,
     false},
    {0},
};

const fg_loop_effect *fg_loop_table_effects(void) {
  return effects;
}
