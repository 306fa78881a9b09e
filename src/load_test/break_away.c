/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The straight line of a break-away test: friction coefficient and preload. */
#include "load_test/break_away.h"

#include <math.h>

#include "core/small_solve.h"
#include "foilgauge/distribution.h"
#include "load_test/analysis.h"

/* Straight lines fail the test for a curve this often, and are suspected of one. */
static const double p_curved_max = 0.01, p_suspected_max = 0.1;

/* Minimum ratio of the slope to its u. P is the intercept over the slope: with a less certain slope
 * its interval is useless. */
static const double slope_known = 3;

/* U = 2 u. */
static const double reach = 2;

/* Squares of residuals below this share of the squares themselves are those of rounding. */
static const double rounding = 1e-20;

/* Minimum numbers of pulls and weights: a line has two parameters; curvature shows from the third
 * weight on. */
enum { PULLS_MIN = 3, CHECKED_PULLS_MIN = 4, CHECKED_WEIGHTS_MIN = 3 };

const fg_load_flag *fg_break_away_flags(void) {
  static const fg_load_flag flags[] = {
      {FG_BREAK_TOO_FEW, "too_few_pulls",
       "too few pulls: a line takes three, at two dead weights at least"},
      {FG_BREAK_CURVED, "not_straight",
       "friction over dead weight is no straight line: neither coefficient nor preload follow from "
       "it"},
      {FG_BREAK_SUSPECTED, "curve_suspected",
       "friction over dead weight may be bent (p < 0.1): more pulls, at more weights, would tell"},
      {FG_BREAK_SLOPE, "slope_not_known",
       "the friction coefficient is known no better than to a third: heavier weights, or more "
       "pulls, would tell the preload"},
      {FG_BREAK_BELOW_ZERO, "below_rig",
       "without a weight less friction than the rig's by more than U: are the torque's zero and "
       "--rig-torque right?"},
      {FG_BREAK_NONE_SHOWN, "no_preload_shown", "the preload lies within U of none"},
      {FG_BREAK_GAP, "preload_beside_gap",
       "the load test has a gap, where nothing presses the rotor: what counts as preload here is "
       "other friction"},
      {FG_BREAK_RIG_NOT_GIVEN, "rig_friction_not_given",
       "the rig's own friction counts as preload: give it by --rig-torque"},
      {FG_BREAK_UNCHECKED, "line_not_checked",
       "too few weights or pulls to say whether the line is straight: that takes three weights and "
       "four pulls"},
      {FG_BREAK_WEIGHTS, "weights_differ",
       "pulls of one weight resemble each other more than the line fits the weights (p < 0.1): "
       "each weight counts once; hang every weight anew for every pull"},
      {0, NULL, NULL},
  };
  return flags;
}

/* The pulls of a bearing, the weights over the heaviest; by weight: the means of each weight's. */
typedef struct pulls {
  const fg_load_test *test;
  size_t bearing, count, weights;
  double low_n, high_n;
  bool by_weight;
} pulls;

static bool is_of_bearing(const pulls *p, size_t i) {
  return p->test->pulls[i].bearing == p->bearing;
}

static bool has_weight(const pulls *p, size_t i, double weight_n) {
  return is_of_bearing(p, i) && p->test->pulls[i].weight_n == weight_n;
}

static bool is_weight_again(const pulls *p, size_t i) {
  for (size_t k = 0; k < i; k++)
    if (has_weight(p, k, p->test->pulls[i].weight_n)) return true;
  return false;
}

static bool is_of(const pulls *p, size_t i) {
  return is_of_bearing(p, i) && !(p->by_weight && is_weight_again(p, i));
}

static pulls find_pulls(const fg_load_test *test, size_t bearing) {
  pulls p = {test, bearing, 0, 0, INFINITY, -INFINITY, false};
  for (size_t i = 0; i < test->pull_count; i++) {
    double weight = test->pulls[i].weight_n;
    if (!is_of(&p, i)) continue;
    p.count++;
    p.weights += !is_weight_again(&p, i);
    p.low_n = fmin(p.low_n, weight), p.high_n = fmax(p.high_n, weight);
  }
  return p;
}

static double weight_mean(const pulls *p, double weight_n) {
  double mean = 0, count = 0;
  for (size_t i = 0; i < p->test->pull_count; i++)
    if (has_weight(p, i, weight_n)) mean += (p->test->pulls[i].friction_n - mean) / ++count;
  return mean;
}

static double friction_of(const pulls *p, size_t i) {
  const fg_break_away_pull *pull = &p->test->pulls[i];
  return p->by_weight ? weight_mean(p, pull->weight_n) : pull->friction_n;
}

enum { LINE = 2, CURVE = 3 };

typedef struct line {
  double x[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX];
  double squares, all_squares; /* of residuals; of F */
} line;

static void make_row(const pulls *p, size_t i, double row[CURVE]) {
  row[0] = 1;
  row[1] = p->test->pulls[i].weight_n / p->high_n;
  row[2] = row[1] * row[1];
}

static double residual(const pulls *p, const line *l, size_t unknowns, size_t i) {
  double row[CURVE], sum = friction_of(p, i);
  make_row(p, i, row);
  for (size_t k = 0; k < unknowns; k++)
    sum -= row[k] * l->x[k];
  return sum;
}

static bool fit_break_away_line(const pulls *p, size_t unknowns, line *l) {
  fg_normal_equations system;
  fg_normal_clear(&system, unknowns);
  for (size_t i = 0; i < p->test->pull_count; i++) {
    double row[CURVE];
    if (!is_of(p, i)) continue;
    make_row(p, i, row);
    fg_normal_add(&system, row, friction_of(p, i), 1);
  }
  if (!fg_normal_solve(&system, 0, l->x, l->inverse)) return false;
  l->squares = 0, l->all_squares = system.sum_squares;
  for (size_t i = 0; i < p->test->pull_count; i++)
    if (is_of(p, i)) l->squares += pow(residual(p, l, unknowns, i), 2);
  return true;
}

/* Covariance of the coefficients: sum of (r / (1 - h))² of every pull, h its leverage (HC3). */
static void find_covariance(const pulls *p, const line *l, size_t unknowns,
                            double covariance[CURVE][CURVE]) {
  for (size_t a = 0; a < unknowns; a++)
    for (size_t b = 0; b < unknowns; b++)
      covariance[a][b] = 0;
  for (size_t i = 0; i < p->test->pull_count; i++) {
    double row[CURVE], lever[CURVE] = {0}, leverage = 0;
    if (!is_of(p, i)) continue;
    make_row(p, i, row);
    for (size_t a = 0; a < unknowns; a++)
      for (size_t b = 0; b < unknowns; b++)
        lever[a] += l->inverse[a][b] * row[b];
    for (size_t a = 0; a < unknowns; a++)
      leverage += row[a] * lever[a];
    double square = pow(residual(p, l, unknowns, i) / fmax(1e-9, 1 - leverage), 2);
    for (size_t a = 0; a < unknowns; a++)
      for (size_t b = 0; b < unknowns; b++)
        covariance[a][b] += square * lever[a] * lever[b];
  }
}

/* Returns the probability that a straight line shows such a curvature; NaN where unknown. */
static double test_curve(const pulls *p, const line *straight) {
  line curve;
  double covariance[CURVE][CURVE];
  if (p->weights < CHECKED_WEIGHTS_MIN || p->count < CHECKED_PULLS_MIN) return NAN;
  if (!(straight->squares > rounding * straight->all_squares)) return 1;
  if (!fit_break_away_line(p, CURVE, &curve)) return NAN;
  if (!(curve.squares > rounding * curve.all_squares)) return 0;
  find_covariance(p, &curve, CURVE, covariance);
  double t = curve.x[CURVE - 1] / sqrt(covariance[CURVE - 1][CURVE - 1]);
  return fg_distribution_t_two_sided(t, (double)p->count - CURVE);
}

/* Returns true when the weights' means lie farther from the line than the scatter of pulls of one
 * weight explains. Hanging a weight sets the test up anew, and what that changes is in all of its
 * pulls alike: each weight then counts once. */
static bool weights_differ(const pulls *p, const line *l) {
  double within = 0, between = 0;
  double dof_within = (double)(p->count - p->weights), dof_between = (double)p->weights - LINE;
  if (!(dof_within > 0) || !(dof_between > 0)) return false;
  for (size_t i = 0; i < p->test->pull_count; i++) {
    if (!is_of(p, i)) continue;
    double own = p->test->pulls[i].friction_n - weight_mean(p, p->test->pulls[i].weight_n);
    within += own * own;
    between += pow(residual(p, l, LINE, i) - own, 2);
  }
  if (!(between > rounding * l->all_squares)) return false;
  double ratio = between / dof_between / (within / dof_within);
  return !(fg_distribution_f_upper(ratio, dof_between, dof_within) > p_suspected_max);
}

/* The rig's friction and its standard uncertainty at the rotor's surface. */
static double rig_friction(const fg_load_options *o, double *u) {
  *u = isfinite(o->rig_n_mm) ? o->u_rig_n_mm / (o->diameter_mm / 2) : 0;
  return isfinite(o->rig_n_mm) ? o->rig_n_mm / (o->diameter_mm / 2) : 0;
}

static double to_kpa(const fg_load_options *o, double newtons) {
  return 1000 * newtons / (M_PI * o->diameter_mm * o->length_mm); /* N/mm² is 1000 kPa */
}

/* Computes mu, mu P and P of the line. The load cell's scale is in F and so in mu and in mu P; in P
 * only through the rig's friction. The weights' scale is in mu and P. */
static void fill_from_line(const pulls *p, const line *l, fg_load_bearing *sum) {
  const fg_load_options *o = &p->test->options;
  fg_break_away *out = &sum->break_away;
  double covariance[CURVE][CURVE], u_rig, rig = rig_friction(o, &u_rig);
  double force = o->u_force_pct / 100, weight = o->u_weight_pct / 100;
  double mu = l->x[1] / p->high_n, a = l->x[0] - rig, preload = a / mu;
  double dof = (double)p->count - LINE;
  double wide = fg_distribution_t_quantile(0.975, dof) / fg_distribution_normal_quantile(0.975);
  find_covariance(p, l, LINE, covariance);
  double u_a = wide * sqrt(covariance[0][0]), u_mu = wide * sqrt(covariance[1][1]) / p->high_n;
  double cross = wide * wide * covariance[0][1] / p->high_n;
  double u_preload =
      sqrt(fmax(0, u_a * u_a + preload * preload * u_mu * u_mu - 2 * preload * cross)) / fabs(mu);
  out->residual_n = sqrt(l->squares / dof);
  out->friction = (fg_load_value){mu, hypot(u_mu, mu * hypot(force, weight)), u_mu};
  out->intercept_n =
      (fg_load_value){a, sqrt(u_a * u_a + pow(force * l->x[0], 2) + u_rig * u_rig), u_a};
  double u = sqrt(u_preload * u_preload + pow(force * rig / mu, 2) + pow(weight * preload, 2) +
                  pow(u_rig / mu, 2));
  sum->preload_n = (fg_load_value){preload, u, u_preload};
}

static bool has_gap(const fg_load_test *test, size_t bearing) {
  for (size_t i = 0; i < test->direction_count; i++)
    if (test->directions[i].bearing == bearing && isfinite(test->directions[i].clearance.value))
      return true;
  return false;
}

/* Withholds values that the pulls do not support, each with its reason as a flag. */
static void withhold_unsupported(const pulls *p, fg_load_bearing *sum) {
  const fg_load_value none = {NAN, NAN, NAN};
  fg_break_away *out = &sum->break_away;
  bool curved = out->p_curved < p_curved_max;
  bool slope = out->friction.value > slope_known * out->friction.u_repeat;
  bool below = out->intercept_n.value < -reach * out->intercept_n.u;
  if (curved) out->flags |= FG_BREAK_CURVED;
  if (!curved && out->p_curved < p_suspected_max) out->flags |= FG_BREAK_SUSPECTED;
  if (!curved && !slope) out->flags |= FG_BREAK_SLOPE;
  if (!curved && slope && below) out->flags |= FG_BREAK_BELOW_ZERO;
  if (!isfinite(out->p_curved)) out->flags |= FG_BREAK_UNCHECKED;
  if (curved) out->friction = out->intercept_n = none;
  if (curved || !slope || below) {
    sum->preload_n = none;
    return;
  }
  bool shown = sum->preload_n.value > reach * sum->preload_n.u;
  if (!shown) out->flags |= FG_BREAK_NONE_SHOWN;
  if (shown && has_gap(p->test, p->bearing)) out->flags |= FG_BREAK_GAP;
  if (!isfinite(p->test->options.rig_n_mm)) out->flags |= FG_BREAK_RIG_NOT_GIVEN;
}

void fg_load_sum_break_away(const fg_load_test *test, size_t bearing, fg_load_bearing *sum) {
  const fg_load_value none = {NAN, NAN, NAN};
  const fg_load_options *o = &test->options;
  fg_break_away *out = &sum->break_away;
  pulls p = find_pulls(test, bearing);
  double unused;
  line straight;
  sum->preload_n = sum->preload_kpa = none;
  *out = (fg_break_away){.pulls = p.count,
                         .weights = p.weights,
                         .weight_low_n = p.low_n,
                         .weight_high_n = p.high_n,
                         .friction = none,
                         .intercept_n = none,
                         .rig_n = isfinite(o->rig_n_mm) ? rig_friction(o, &unused) : NAN,
                         .residual_n = NAN,
                         .p_curved = NAN};
  if (!p.count) return;
  if (p.count < PULLS_MIN || p.weights < LINE || !fit_break_away_line(&p, LINE, &straight)) {
    out->flags |= FG_BREAK_TOO_FEW;
    return;
  }
  out->p_curved = test_curve(&p, &straight);
  if (weights_differ(&p, &straight)) {
    out->flags |= FG_BREAK_WEIGHTS;
    p.by_weight = true;
    p.count = p.weights;
    if (!fit_break_away_line(&p, LINE, &straight)) return;
    if (p.count >= CHECKED_PULLS_MIN) out->p_curved = test_curve(&p, &straight);
  }
  fill_from_line(&p, &straight, sum);
  withhold_unsupported(&p, sum);
  sum->preload_kpa = (fg_load_value){to_kpa(o, sum->preload_n.value), to_kpa(o, sum->preload_n.u),
                                     to_kpa(o, sum->preload_n.u_repeat)};
}
