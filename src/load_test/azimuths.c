/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bearing's clearance over the azimuths. */
#include <math.h>

#include "core/small_solve.h"
#include "foilgauge/distribution.h"
#include "load_test/analysis.h"

/* Period of azimuths: travel from push to pull along an azimuth equals that along the opposite one,
 * so azimuths are axes, and the travel has even orders only. */
static const double half_turn_deg = 180;

/* Azimuths nearer to each other than this are one axis. */
static const double same_axis_deg = 1;

/* Minimum number of axes for each order: five would fit the 4th order exactly, without a check. */
enum { SECOND_ORDER_AXES_MIN = 3, FOURTH_ORDER_AXES_MIN = 6 };

/* An axis is named when noise alone would make one with less than this probability, and when no
 * other minimum lies within this many standard uncertainties of it. */
static const double p_axis = 0.01, rival_reach = 2;

enum { STEPS = 720, COEFFICIENTS_MAX = 1 + FG_LOAD_ORDER_MAX, KNOWN_DOF = 1000000 };

/* Cosines and sines of the columns. */
typedef struct curve {
  int order[COEFFICIENTS_MAX];
  bool sine[COEFFICIENTS_MAX];
  size_t count;
  double x[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX];
} curve;

static bool is_of(const fg_load_test *test, size_t i, size_t bearing) {
  return test->directions[i].bearing == bearing && isfinite(test->directions[i].clearance.value);
}

static bool is_same_axis(const fg_load_direction *a, const fg_load_direction *b) {
  return fabs(remainder(a->azimuth_deg - b->azimuth_deg, half_turn_deg)) < same_axis_deg;
}

static size_t count_axes(const fg_load_test *test, size_t bearing) {
  size_t count = 0;
  for (size_t i = 0; i < test->direction_count; i++) {
    bool again = false;
    for (size_t k = 0; k < i; k++)
      again = again ||
              (is_of(test, k, bearing) && is_same_axis(&test->directions[i], &test->directions[k]));
    count += is_of(test, i, bearing) && !again;
  }
  return count;
}

static void add_order(int order, curve *c) {
  for (int sine = 0; sine < 2; sine++) {
    c->order[c->count] = order;
    c->sine[c->count++] = sine;
  }
}

static curve make_curve(size_t axes) {
  curve c = {.count = 1};
  if (axes >= SECOND_ORDER_AXES_MIN) add_order(2, &c);
  if (axes >= FOURTH_ORDER_AXES_MIN) add_order(4, &c);
  return c;
}

static double term(const curve *c, size_t k, double deg) {
  double angle = c->order[k] * deg * M_PI / 180;
  return c->sine[k] ? sin(angle) : cos(angle);
}

static double turned_term(const curve *c, size_t k, double deg, int derivative) {
  return pow(c->order[k], derivative) *
         term(c, k, deg + (c->order[k] ? 90.0 * derivative / c->order[k] : 0));
}

static double curve_value_at(const curve *c, double deg, int derivative) {
  double sum = 0;
  for (size_t k = derivative ? 1 : 0; k < c->count; k++)
    sum += c->x[k] * turned_term(c, k, deg, derivative);
  return sum;
}

static bool fit_curve(const fg_load_test *test, size_t bearing, curve *c,
                      fg_load_scatter *scatter) {
  fg_normal_equations system;
  fg_normal_clear(&system, c->count);
  scatter->dof = -(double)c->count;
  for (size_t i = 0; i < test->direction_count; i++) {
    const fg_load_direction *d = &test->directions[i];
    double row[COEFFICIENTS_MAX];
    if (!is_of(test, i, bearing)) continue;
    for (size_t k = 0; k < c->count; k++)
      row[k] = term(c, k, d->azimuth_deg);
    fg_normal_add(&system, row, d->clearance.value, 1 / pow(d->clearance.u_repeat, 2));
    scatter->dof++;
  }
  if (!fg_normal_solve(&system, 0, c->x, c->inverse)) return false;
  scatter->chi2 = system.sum_squares;
  for (size_t k = 0; k < c->count; k++)
    scatter->chi2 -= c->x[k] * system.right[k];
  return true;
}

static bool is_minimum(const curve *c, double deg, double step) {
  double here = curve_value_at(c, deg, 0);
  return here < curve_value_at(c, deg - step, 0) && here <= curve_value_at(c, deg + step, 0);
}

/* Variance of the curve's value at one place less that at another. */
static double variance_between(const curve *c, double a_deg, double b_deg) {
  double variance = 0, row[COEFFICIENTS_MAX];
  for (size_t i = 1; i < c->count; i++)
    row[i] = term(c, i, a_deg) - term(c, i, b_deg);
  for (size_t i = 1; i < c->count; i++)
    for (size_t k = 1; k < c->count; k++)
      variance += row[i] * c->inverse[i][k] * row[k];
  return variance;
}

/* Returns true when another minimum lies within the uncertainty of the smallest. */
static bool has_rival(const curve *c, double best, double birge) {
  double step = half_turn_deg / STEPS;
  for (int i = 0; i < STEPS; i++) {
    double deg = i * step;
    if (fabs(remainder(deg - best, half_turn_deg)) < 2 * step || !is_minimum(c, deg, step))
      continue;
    double more = curve_value_at(c, deg, 0) - curve_value_at(c, best, 0);
    if (more < rival_reach * birge * sqrt(variance_between(c, deg, best))) return true;
  }
  return false;
}

/* Axis where the curve is smallest, and its uncertainty. */
static fg_load_axis find_axis(const curve *c, double birge, fg_load_bearing *sum) {
  double best = 0, variance = 0;
  for (int i = 1; i < STEPS; i++)
    if (curve_value_at(c, i * half_turn_deg / STEPS, 0) < curve_value_at(c, best, 0))
      best = i * half_turn_deg / STEPS;
  for (int i = 0; i < 8; i++) /* derivatives are per radian */
    best -= curve_value_at(c, best, 1) / fmax(curve_value_at(c, best, 2), 1e-12) * 180 / M_PI;
  for (size_t i = 1; i < c->count; i++)
    for (size_t k = 1; k < c->count; k++)
      variance += turned_term(c, i, best, 1) * c->inverse[i][k] * turned_term(c, k, best, 1);
  double bend = curve_value_at(c, best, 2), u = birge * sqrt(variance) / bend * 180 / M_PI;
  if (!(bend > 0 && u > 0)) return FG_LOAD_AXIS_ROUND;
  if (has_rival(c, best, birge)) return FG_LOAD_AXIS_RIVALS;
  sum->min_at_deg = best - half_turn_deg * floor(best / half_turn_deg);
  sum->u_min_at_deg = u;
  return FG_LOAD_AXIS_KNOWN;
}

static void take_harmonics(const curve *c, double birge, fg_load_bearing *sum) {
  for (size_t k = 1; k < c->count; k += 2) {
    int order = c->order[k];
    double a = c->x[k], b = c->x[k + 1], size = hypot(a, b);
    double variance = a * a * c->inverse[k][k] + b * b * c->inverse[k + 1][k + 1] +
                      2 * a * b * c->inverse[k][k + 1];
    sum->harmonic[order] = true;
    sum->cosine_mm[order] = a;
    sum->sine_mm[order] = b;
    sum->amplitude_mm[order] = size;
    sum->u_amplitude_mm[order] = size > 0 ? birge * sqrt(variance) / size : NAN;
  }
}

static void take_extremes(const fg_load_test *test, size_t bearing, fg_load_bearing *sum) {
  double stiffness = 0, u = 0, count = 0;
  const fg_load_direction *min = NULL, *max = NULL;
  for (size_t i = 0; i < test->direction_count; i++) {
    const fg_load_direction *d = &test->directions[i];
    if (d->bearing != bearing) continue;
    sum->directions++;
    if (isfinite(d->stiffness.value)) {
      stiffness += d->stiffness.value;
      u += d->stiffness.u_repeat; /* bias by windows is the same in all directions */
      count++;
    }
    if (!is_of(test, i, bearing)) continue;
    sum->measured++;
    if (!min || d->clearance.value < min->clearance.value) min = d;
    if (!max || d->clearance.value > max->clearance.value) max = d;
  }
  double scale = hypot(test->options.u_force_pct, test->options.u_displacement_pct) / 100;
  double mean = stiffness / count;
  sum->stiffness = (fg_load_value){mean, hypot(u / count, scale * mean), u / count};
  if (!min) return;
  sum->min = min->clearance;
  sum->max = max->clearance;
  sum->min_measured_at_deg = min->azimuth_deg;
  sum->max_measured_at_deg = max->azimuth_deg;
}

static void sum_noise(const fg_load_test *test, size_t bearing, fg_load_bearing *sum) {
  double count = 0;
  sum->noise_n = sum->noise_mm = sum->step_mm = 0;
  for (size_t i = 0; i < test->direction_count; i++) {
    const fg_load_direction *d = &test->directions[i];
    if (d->bearing != bearing || !isfinite(d->noise_n)) continue;
    sum->noise_n += d->noise_n;
    sum->noise_mm += d->noise_mm;
    sum->step_mm = fmax(sum->step_mm, d->step_mm);
    count++;
  }
  sum->noise_n /= count; /* NaN without one */
  sum->noise_mm /= count;
}

/* Sum of squares about the weighted mean. */
static bool fit_flat(const fg_load_test *test, size_t bearing, fg_load_scatter *scatter) {
  curve flat = {.count = 1};
  return fit_curve(test, bearing, &flat, scatter);
}

/* Chi-squared test of equal directions: the uncertainties are taken for known. */
static void test_alike(const fg_load_scatter *flat, fg_load_bearing *sum) {
  if (sum->measured < 2) return;
  sum->p_value = fg_distribution_f_upper(fmax(0, flat->chi2) / flat->dof, flat->dof, KNOWN_DOF);
}

/* Probability that noise alone makes orders this large. */
static double test_orders(const curve *c, const fg_load_scatter *flat,
                          const fg_load_scatter *scatter, double birge) {
  double orders = (double)c->count - 1;
  double gained = fmax(0, flat->chi2 - scatter->chi2) / (birge * birge);
  return fg_distribution_f_upper(gained / orders, orders, KNOWN_DOF);
}

const char *fg_load_axis_words(fg_load_axis axis) {
  static const char *const words[] = {
      [FG_LOAD_AXIS_KNOWN] = NULL,
      [FG_LOAD_AXIS_FEW] = "azimuths lie on fewer than three axes: 0 and 180 degrees are one",
      [FG_LOAD_AXIS_ROUND] = "no direction stands out of the noise",
      [FG_LOAD_AXIS_RIVALS] = "two axes may be the smallest",
  };
  return words[axis];
}

void fg_load_sum_bearing(const fg_load_test *test, size_t bearing, fg_load_bearing *sum) {
  fg_load_scatter scatter, flat;
  sum->min = sum->max = (fg_load_value){NAN, NAN, NAN};
  sum->mean_mm = sum->u_mean_mm = sum->p_value = NAN;
  sum->min_measured_at_deg = sum->max_measured_at_deg = NAN;
  sum->min_at_deg = sum->u_min_at_deg = NAN;
  sum->axis = FG_LOAD_AXIS_FEW;
  take_extremes(test, bearing, sum);
  sum_noise(test, bearing, sum);
  if (!sum->measured) return;
  curve c = make_curve(count_axes(test, bearing));
  if (!fit_curve(test, bearing, &c, &scatter) || !fit_flat(test, bearing, &flat)) return;
  double birge = fg_load_birge(&scatter), scale = test->options.u_displacement_pct / 100;
  sum->mean_mm = c.x[0];
  sum->u_mean_mm = hypot(birge * sqrt(c.inverse[0][0]), scale * c.x[0]);
  take_harmonics(&c, birge, sum);
  test_alike(&flat, sum);
  if (c.count == 1) return;
  sum->axis = FG_LOAD_AXIS_ROUND;
  if (test_orders(&c, &flat, &scatter, birge) < p_axis) sum->axis = find_axis(&c, birge, sum);
}
