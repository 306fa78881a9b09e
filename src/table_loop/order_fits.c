/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An order k is s sin(w (x - low)) + c cos(w (x - low)), w = 2 pi k / P: amplitude A = |(s, c)|,
 * peak at w (x - low) = atan2(s, c). A phase counts from x = 0, where an uncertain P has turned it
 * by -low d(w). */
#include "table_loop/order_fits.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* Covariances are of s, c and P, in this order. */
typedef struct order_covariance {
  double of[3][3];
} order_covariance;

static order_covariance read_covariance(const fg_engine_fit *wide,
                                        const fg_engine_cycle_place *place, size_t own) {
  const size_t at[3] = {place->first + own, place->first + own + 1, place->slope};
  size_t count = place->moved ? 3 : 2;
  order_covariance covariance = {{{0}}};
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < count; k++)
      covariance.of[i][k] = place->variance * wide->inverse[at[i] * wide->columns + at[k]];
  return covariance;
}

static double propagate(const order_covariance *covariance, const double gradient[3]) {
  double sum = 0;
  for (size_t i = 0; i < 3; i++)
    for (size_t k = 0; k < 3; k++)
      sum += gradient[i] * gradient[k] * covariance->of[i][k];
  return sqrt(fmax(sum, 0));
}

static void describe_order(const fg_loop_coordinate *at, double period, const double *coefficient,
                           const order_covariance *covariance, fg_loop_order_fit *fit) {
  double s = coefficient[0], c = coefficient[1], a = hypot(s, c), w = 2 * pi / period;
  double peak = atan2(s, c), middle = (at->high - at->low) / 2;
  double turns = round((w * middle - peak) / (2 * pi)), place = (peak + 2 * pi * turns) / w;
  double base = (double)fit->order * period;
  if (!(a > 0)) return;
  const double by_amplitude[3] = {s / a, c / a, 0};
  const double by_place[3] = {c / (a * a) / w, -s / (a * a) / w, place / base};
  const double by_phase[3] = {c / (a * a), -s / (a * a), -at->low * w / base};
  fit->amplitude = a;
  fit->amplitude_u = propagate(covariance, by_amplitude);
  fit->peak_at = at->low + place;
  fit->peak_at_u = propagate(covariance, by_place);
  double phase = fmod(peak + w * at->low, 2 * pi);
  fit->phase_deg = (phase < 0 ? phase + 2 * pi : phase) * 180 / pi;
  fit->phase_u_deg = propagate(covariance, by_phase) * 180 / pi;
}

void fg_engine_describe_orders(const fg_loop_problem *problem, const fg_engine_fit *wide,
                               const fg_engine_cycle_place *place, fg_loop_claim *claim) {
  const fg_loop_coordinate *at = &problem->coordinate[claim->candidate.a];
  claim->orders = 0;
  for (size_t k = 1; k <= FG_LOOP_ORDER_MAX; k++) {
    if (!fg_loop_has_order(&claim->candidate, k)) continue;
    size_t own = 2 * claim->orders;
    order_covariance covariance = read_covariance(wide, place, own);
    fg_loop_order_fit *fit = &claim->order[claim->orders++];
    fit->order = k;
    describe_order(at, claim->shape[0] / (double)k, claim->coefficient + own, &covariance, fit);
  }
}
