/* A bearing's clearance over the azimuths. */
#include <math.h>

#include "core/small_solve.h"
#include "foilgauge/distribution.h"
#include "load_test/analysis.h"

/* A line through the bearing comes back after 180 degrees: further apart, azimuths are those of
 * sides. */
static const double half_turn_deg = 180.5;

/* A direction that is known no better than this is none. */
static const double u_direction_max_deg = 40;

enum { STEPS = 720, COEFFICIENTS_MAX = 1 + 2 * FG_LOAD_HARMONICS };

/* Which cosines and sines the columns are. */
typedef struct curve {
  int order[COEFFICIENTS_MAX];
  bool sine[COEFFICIENTS_MAX];
  size_t count;
  double turn_deg;
  double x[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX];
} curve;

static bool is_of(const fg_load_test *test, size_t i, size_t bearing) {
  return test->directions[i].bearing == bearing && isfinite(test->directions[i].clearance.value);
}

/* Different azimuths, taken modulo a turn. */
static size_t count_places(const fg_load_test *test, size_t bearing, double turn_deg) {
  size_t count = 0;
  for (size_t i = 0; i < test->direction_count; i++) {
    bool again = false;
    for (size_t k = 0; k < i && is_of(test, i, bearing); k++) {
      double apart = test->directions[i].azimuth_deg - test->directions[k].azimuth_deg;
      again = again || (is_of(test, k, bearing) && fabs(remainder(apart, turn_deg)) < 1);
    }
    count += is_of(test, i, bearing) && !again;
  }
  return count;
}

static curve make_curve(const fg_load_test *test, size_t bearing) {
  double low = INFINITY, high = -INFINITY;
  curve c = {.count = 1, .turn_deg = 180};
  for (size_t i = 0; i < test->direction_count; i++)
    if (is_of(test, i, bearing)) {
      low = fmin(low, test->directions[i].azimuth_deg);
      high = fmax(high, test->directions[i].azimuth_deg);
    }
  if (high - low > half_turn_deg) c.turn_deg = 360;
  size_t places = count_places(test, bearing, c.turn_deg);
  for (int order = c.turn_deg > 180 ? 1 : 2; order <= FG_LOAD_HARMONICS; order++) {
    if (places < c.count + 2) break;
    for (int sine = 0; sine < 2; sine++) {
      c.order[c.count] = order;
      c.sine[c.count++] = sine;
    }
  }
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

static double value_at(const curve *c, double deg, int derivative) {
  double sum = 0;
  for (size_t k = derivative ? 1 : 0; k < c->count; k++)
    sum += c->x[k] * turned_term(c, k, deg, derivative);
  return sum;
}

static bool fit(const fg_load_test *test, size_t bearing, curve *c, fg_load_scatter *scatter) {
  fg_normal_equations system;
  fg_normal_clear(&system, c->count);
  scatter->freedom = -(double)c->count;
  for (size_t i = 0; i < test->direction_count; i++) {
    const fg_load_direction *d = &test->directions[i];
    double row[COEFFICIENTS_MAX];
    if (!is_of(test, i, bearing)) continue;
    for (size_t k = 0; k < c->count; k++)
      row[k] = term(c, k, d->azimuth_deg);
    fg_normal_add(&system, row, d->clearance.value, 1 / pow(d->clearance.u_repeat, 2));
    scatter->freedom++;
  }
  if (!fg_normal_solve(&system, 0, c->x, c->inverse)) return false;
  scatter->chi2 = system.sum_squares;
  for (size_t k = 0; k < c->count; k++)
    scatter->chi2 -= c->x[k] * system.right[k];
  return true;
}

/* Where the curve is least, and by how far that is not known. */
static void find_least(const curve *c, double birge, fg_load_bearing *sum) {
  double best = 0, variance = 0;
  for (int i = 1; i < STEPS; i++)
    if (value_at(c, i * c->turn_deg / STEPS, 0) < value_at(c, best, 0))
      best = i * c->turn_deg / STEPS;
  for (int i = 0; i < 8; i++) /* derivatives are per radian */
    best -= value_at(c, best, 1) / fmax(value_at(c, best, 2), 1e-12) * 180 / M_PI;
  for (size_t i = 1; i < c->count; i++)
    for (size_t k = 1; k < c->count; k++)
      variance += turned_term(c, i, best, 1) * c->inverse[i][k] * turned_term(c, k, best, 1);
  double bend = value_at(c, best, 2), u = birge * sqrt(variance) / bend * 180 / M_PI;
  if (!(bend > 0 && u > 0 && u < u_direction_max_deg)) return;
  sum->least_at_deg = best - c->turn_deg * floor(best / c->turn_deg);
  sum->u_least_at_deg = u;
}

/* Without its first order, which is no more than doubt: both sides are as good. */
static curve alike_after_half_a_turn(const curve *c) {
  curve half = {.count = c->count - 2, .turn_deg = 180};
  for (size_t i = 0; i < half.count; i++) {
    size_t from = i ? i + 2 : 0;
    half.order[i] = c->order[from];
    half.sine[i] = c->sine[from];
    half.x[i] = c->x[from];
    for (size_t k = 0; k < half.count; k++)
      half.inverse[i][k] = c->inverse[from][k ? k + 2 : 0];
  }
  return half;
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
  const fg_load_direction *least = NULL, *most = NULL;
  for (size_t i = 0; i < test->direction_count; i++) {
    const fg_load_direction *d = &test->directions[i];
    if (d->bearing != bearing) continue;
    sum->directions++;
    if (isfinite(d->stiffness.value)) {
      stiffness += d->stiffness.value;
      u += d->stiffness.u_repeat; /* what windows bend is alike in all directions */
      count++;
    }
    if (!is_of(test, i, bearing)) continue;
    sum->measured++;
    if (!least || d->clearance.value < least->clearance.value) least = d;
    if (!most || d->clearance.value > most->clearance.value) most = d;
  }
  double scale = hypot(test->options.u_force_pct, test->options.u_displacement_pct) / 100;
  double mean = stiffness / count;
  sum->stiffness = (fg_load_value){mean, hypot(u / count, scale * mean), u / count};
  if (!least) return;
  sum->least = least->clearance;
  sum->most = most->clearance;
  sum->least_measured_at_deg = least->azimuth_deg;
  sum->most_measured_at_deg = most->azimuth_deg;
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

/* Whether the directions differ at all: by their weighted mean. */
static void test_alike(const fg_load_test *test, size_t bearing, fg_load_bearing *sum) {
  curve flat = {.count = 1};
  fg_load_scatter scatter;
  if (sum->measured < 2 || !fit(test, bearing, &flat, &scatter)) return;
  enum { KNOWN = 1000000 }; /* the uncertainties are taken for known */
  sum->p_value =
      fg_distribution_f_upper(fmax(0, scatter.chi2) / scatter.freedom, scatter.freedom, KNOWN);
}

void fg_load_sum_bearing(const fg_load_test *test, size_t bearing, fg_load_bearing *sum) {
  fg_load_scatter scatter;
  sum->least = sum->most = (fg_load_value){NAN, NAN, NAN};
  sum->mean_mm = sum->u_mean_mm = sum->p_value = NAN;
  sum->least_measured_at_deg = sum->most_measured_at_deg = NAN;
  sum->least_at_deg = sum->u_least_at_deg = NAN;
  take_extremes(test, bearing, sum);
  sum_noise(test, bearing, sum);
  if (!sum->measured) return;
  curve c = make_curve(test, bearing);
  if (!fit(test, bearing, &c, &scatter)) return;
  double birge = fg_load_birge(&scatter), scale = test->options.u_displacement_pct / 100;
  sum->mean_mm = c.x[0];
  sum->u_mean_mm = hypot(birge * sqrt(c.inverse[0][0]), scale * c.x[0]);
  take_harmonics(&c, birge, sum);
  test_alike(test, bearing, sum);
  if (c.count == COEFFICIENTS_MAX && sum->amplitude_mm[1] < 2 * sum->u_amplitude_mm[1])
    c = alike_after_half_a_turn(&c);
  if (c.count > 1) find_least(&c, birge, sum);
}
