/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "render/curve.h"

#include <math.h>
#include <stdio.h>

enum { STEPS = 16 }; /* steps per interval in the search for extremes */

/* The interval of a place. */
typedef struct span {
  size_t left, right;
  double width, t; /* t: 0 at the left knot, 1 at the right one */
} span;

static double width_after(const fg_curve *curve, size_t i) {
  if (i + 1 < curve->count) return curve->at[i + 1] - curve->at[i];
  return curve->at[0] + curve->period - curve->at[i];
}

/* Finds the interval. Outside of the spline (before the first knot, after the last, no period) the
 * width is 0. */
static span find_span(const fg_curve *curve, double at) {
  size_t last = curve->count - 1, low = 0, high = last;
  if (curve->period > 0) at -= curve->period * floor((at - curve->at[0]) / curve->period);
  if (at >= curve->at[last] && curve->period > 0) {
    double width = width_after(curve, last);
    return (span){last, 0, width, (at - curve->at[last]) / width};
  }
  if (!(at > curve->at[0])) return (span){0, 0, 0, 0};
  if (at >= curve->at[last]) return (span){last, last, 0, 0};
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    if (at < curve->at[middle])
      high = middle;
    else
      low = middle;
  }
  double width = curve->at[high] - curve->at[low];
  return (span){low, high, width, (at - curve->at[low]) / width};
}

double fg_curve_value_um(const fg_curve *curve, double at) {
  span s = find_span(curve, at);
  double b = s.t, a = 1 - b;
  return a * curve->value_um[s.left] + b * curve->value_um[s.right] +
         (a * (a * a - 1) * curve->bend[s.left] + b * (b * b - 1) * curve->bend[s.right]) *
             s.width * s.width / 6;
}

/* At the first and last knot the slope is the curve's own, not that beyond. */
double fg_curve_slope_um(const fg_curve *curve, double at) {
  span s = find_span(curve, at);
  size_t last = curve->count - 1;
  if (s.width == 0 && at != curve->at[s.left]) return 0;
  if (s.width == 0)
    s = s.left == 0 ? (span){0, 1, width_after(curve, 0), 0}
                    : (span){last - 1, last, width_after(curve, last - 1), 1};
  double b = s.t, a = 1 - b;
  return (curve->value_um[s.right] - curve->value_um[s.left]) / s.width +
         ((1 - 3 * a * a) * curve->bend[s.left] + (3 * b * b - 1) * curve->bend[s.right]) *
             s.width / 6;
}

static double largest_value(const fg_curve *curve, double (*of)(const fg_curve *, double)) {
  double result = 0;
  size_t spans = curve->period > 0 ? curve->count : curve->count - 1;
  for (size_t i = 0; i < spans; i++)
    for (int k = 0; k <= STEPS; k++)
      result =
          fmax(result, fabs(of(curve, curve->at[i] + width_after(curve, i) * (double)k / STEPS)));
  return result;
}

double fg_curve_largest_um(const fg_curve *curve) {
  return largest_value(curve, fg_curve_value_um);
}

/* Solves for the second derivatives: h[i-1] m[i-1] + 2 (h[i-1] + h[i]) m[i] + h[i] m[i+1] = 6 × the
 * change of the slope. The diagonal is twice the sum of its row's other terms, so a sweep of
 * Gauss-Seidel at least halves the error, closed or not: 64 sweeps are exact. */
static void solve_bends(fg_curve *curve) {
  size_t n = curve->count, first = curve->period > 0 ? 0 : 1, end = curve->period > 0 ? n : n - 1;
  for (size_t i = 0; i < n; i++)
    curve->bend[i] = 0;
  for (int sweep = 0; sweep < 64; sweep++)
    for (size_t i = first; i < end; i++) {
      size_t before = (i + n - 1) % n, after = (i + 1) % n;
      double h0 = width_after(curve, before), h1 = width_after(curve, i);
      double change = (curve->value_um[after] - curve->value_um[i]) / h1 -
                      (curve->value_um[i] - curve->value_um[before]) / h0;
      curve->bend[i] =
          (6 * change - h0 * curve->bend[before] - h1 * curve->bend[after]) / (2 * (h0 + h1));
    }
}

static fg_status parse_knot(const fg_place *place, int index, const cJSON *item,
                            const fg_curve_axis *axis, fg_curve *curve) {
  char name[32], what[128];
  snprintf(name, sizeof name, "knots[%d]", index);
  if (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != 2) {
    snprintf(what, sizeof what, "must be [%s, um]", axis->unit);
    return fg_member_fail(place, name, item, what);
  }
  fg_place inner = fg_place_inside(place, name);
  FG_TRY(
      fg_member_number(&inner, axis->unit, item->child, axis->low, axis->high, &curve->at[index]));
  FG_TRY(fg_member_number(&inner, "um", item->child->next, -1000, 1000, &curve->value_um[index]));
  if (index > 0 && !(curve->at[index] > curve->at[index - 1])) {
    snprintf(what, sizeof what, "knots must ascend, and the one before is at %g",
             curve->at[index - 1]);
    return fg_member_fail(place, name, item, what);
  }
  return FG_OK;
}

fg_status fg_curve_parse(const fg_place *place, const cJSON *knots, const fg_curve_axis *axis,
                         fg_curve *curve) {
  if (!knots) return fg_member_fail(place, "knots", NULL, "the effect's curve, [[at, um], ...]");
  if (!cJSON_IsArray(knots) || cJSON_GetArraySize(knots) < 2 ||
      cJSON_GetArraySize(knots) > FG_CURVE_KNOTS_MAX)
    return fg_member_fail(place, "knots", knots, "must be an array of 2 to 64 knots");
  int index = 0;
  const cJSON *item;
  cJSON_ArrayForEach(item, knots) FG_TRY(parse_knot(place, index++, item, axis, curve));
  curve->count = (size_t)index;
  curve->period = axis->period;
  if (axis->period > 0 && curve->at[index - 1] - curve->at[0] >= axis->period)
    return fg_member_fail(place, "knots", knots, "0 and 360 are one direction: leave one out");
  solve_bends(curve);
  double steepest = largest_value(curve, fg_curve_slope_um);
  if (axis->steepest_um_mm > 0 && steepest > axis->steepest_um_mm) {
    char what[128];
    snprintf(what, sizeof what, "the curve changes by %.4g um per mm; at most %g", steepest,
             axis->steepest_um_mm);
    return fg_member_fail(place, "knots", knots, what);
  }
  return FG_OK;
}
