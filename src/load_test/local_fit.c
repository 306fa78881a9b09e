/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "load_test/local_fit.h"

#include <math.h>

/* Samples and places of the smallest window; a window grows by a quarter. */
enum { SAMPLES_MIN = 12, PLACES_MIN = 4 };
static const double window_growth = 1.25, window_share_max = 0.5;

/* Minimum window as a share of the stroke: near a turn, samples lie so close that the
 * displacement's noise would flatten a narrower fit. */
static const double window_share_min = 1.0 / 60;

/* Reach of the intervals that must agree, in standard uncertainties. It is small: a window slightly
 * too small costs noise, which u includes; one too large costs bias, which u does not include.
 * tests/bench/stiffness.py measures the coverage. */
static const double interval_reach[] = {[FG_LOCAL_VALUE] = 1.0, [FG_LOCAL_SLOPE] = 2.0};
static const double window_taken = 0.64;

/* Number of places for finding the force along a stroke, and samples of a window there: enough that
 * noise is not mistaken for the force in the gap. */
enum { LOOK_PLACES = 120, LOOK_SAMPLES = 24, SOLVE_STEPS = 6 };

/* Inverse of a symmetric 3 × 3 matrix. */
static bool invert(const double m[3][3], double inverse[3][3]) {
  double determinant = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
      inverse[j][i] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
    }
  for (int i = 0; i < 3; i++)
    determinant += m[0][i] * inverse[i][0];
  if (!(determinant > 1e-12 * m[0][0] * m[1][1] * m[2][2])) return false;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      inverse[i][j] /= determinant;
  return true;
}

/* Sums over the window with z = (x - x0) / h, weights of the tricube. */
typedef struct sums {
  double left[3][3], right[3], noise[3][3];
  size_t count;
} sums;

/* Finds the first sample and the one after the last within the window about x, without crossing
 * unsampled stretches; false: x lies in one. */
static bool find_window(const fg_load_stroke *s, double x, double window, size_t *first,
                        size_t *end) {
  size_t at = fg_load_stroke_from(s, x);
  if (at < s->count && s->after_hole[at] && x < s->x[at]) return false;
  *first = *end = at;
  while (*first > 0 && s->x[*first - 1] >= x - window &&
         (*first == s->count || !s->after_hole[*first]))
    --*first;
  while (*end < s->count && s->x[*end] < x + window && (*end == at || !s->after_hole[*end]))
    ++*end;
  return true;
}

static sums sum_window(const fg_load_stroke *s, double x, double window) {
  sums all = {0};
  size_t first, end;
  if (!find_window(s, x, window, &first, &end)) return all;
  for (size_t i = first; i < end; i++) {
    double z = (s->x[i] - x) / window, w = 1 - fabs(z * z * z), power[3] = {1, z, z * z};
    w *= w * w;
    all.count += w > 0.01;
    for (int r = 0; r < 3; r++) {
      all.right[r] += w * power[r] * s->f[i];
      for (int c = 0; c < 3; c++) {
        all.left[r][c] += w * power[r] * power[c];
        all.noise[r][c] += w * w * power[r] * power[c] * s->variance[i];
      }
    }
  }
  return all;
}

bool fg_local_fit_at(const fg_load_stroke *stroke, double x, double window_mm, fg_local_fit *fit) {
  sums all = sum_window(stroke, x, window_mm);
  double inverse[3][3], solution[3] = {0}, variance[2] = {0};
  if (all.count < SAMPLES_MIN / 2 || !invert((const double(*)[3])all.left, inverse)) return false;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      solution[r] += inverse[r][c] * all.right[c];
  for (int k = 0; k < 2; k++)
    for (int r = 0; r < 3; r++)
      for (int c = 0; c < 3; c++)
        variance[k] += inverse[k][r] * all.noise[r][c] * inverse[c][k];
  *fit = (fg_local_fit){solution[0],
                        sqrt(variance[0]),
                        solution[1] / window_mm,
                        sqrt(variance[1]) / window_mm,
                        window_mm,
                        0};
  return true;
}

/* Returns half of a width with so many samples at so many places, or up to the next unsampled
 * stretches. A rotor at rest under weights leaves many samples at few places. */
static double window_of(const fg_load_stroke *s, double x, size_t samples, size_t places) {
  size_t low = fg_load_stroke_from(s, x), high = low, seen = 0;
  double window = window_share_min * (s->x[s->count - 1] - s->x[0]);
  double place = fg_load_stroke_place(s), lowest = x + place, highest = x - place;
  while (high - low < samples || seen < places) {
    bool lower = low > 0 && (low == s->count || !s->after_hole[low]);
    bool upper = high < s->count && (high == low || !s->after_hole[high]);
    if (!lower && !upper) break;
    if (lower && (!upper || x - s->x[low - 1] < s->x[high] - x)) {
      window = fmax(window, x - s->x[--low]);
      if (lowest - s->x[low] >= place) lowest = s->x[low], seen++;
    } else {
      window = fmax(window, s->x[high] - x);
      if (s->x[high] - highest >= place) highest = s->x[high], seen++;
      high++;
    }
  }
  return window;
}

static double smallest_window(const fg_load_stroke *s, double x) {
  return window_of(s, x, SAMPLES_MIN, PLACES_MIN);
}

bool fg_local_fit_near(const fg_load_stroke *stroke, double x, double window_mm,
                       fg_local_fit *fit) {
  if (stroke->count < SAMPLES_MIN) return false;
  return fg_local_fit_at(stroke, x, fmax(window_mm, 1.0001 * smallest_window(stroke, x)), fit);
}

/* Share of the difference from the wider window that counts as the narrower one's bias. At 0.64 of
 * the width a quarter to two fifths of the wider one's bias is left, which is a third to two thirds
 * of their difference; for a slope two thirds. At foil contact the force bends more sharply than
 * windows do: there the bias of a value falls only as the width, and the whole difference counts.
 */
static const double slope_share = 2.0 / 3;

static void narrow(const fg_local_fit *narrower, fg_local_fit *fit) {
  double value = fit->value - narrower->value, slope = slope_share * (fit->slope - narrower->slope);
  *fit = *narrower;
  fit->u_value = hypot(fit->u_value, value);
  fit->u_slope = hypot(fit->u_slope, slope);
}

bool fg_local_fit_with(const fg_load_stroke *stroke, double x, double window_mm,
                       fg_local_fit *fit) {
  fg_local_fit narrower;
  if (!fg_local_fit_at(stroke, x, window_mm, &narrower)) return false;
  if (!fg_local_fit_at(stroke, x, window_mm / window_taken, fit)) *fit = narrower;
  narrow(&narrower, fit);
  return true;
}

/* Returns the widest window: half of the stroke, within the nearest unsampled stretches. Wider
 * windows hold the same samples, and agree whatever their bias is. */
static double widest_window(const fg_load_stroke *s, double x) {
  size_t first, last;
  double widest = window_share_max * (s->x[s->count - 1] - s->x[0]);
  if (!fg_load_stroke_part(s, x, &first, &last)) return widest;
  return fmin(widest, fmax(x - s->x[first], s->x[last] - x));
}

bool fg_local_fit_adaptive(const fg_load_stroke *stroke, double x, fg_local_target target,
                           fg_local_fit *fit) {
  double span = stroke->x[stroke->count - 1] - stroke->x[0], low = -INFINITY, high = INFINITY;
  bool found = false;
  if (stroke->count < SAMPLES_MIN || !(span > 0)) return false;
  double window = fmax(1.0001 * smallest_window(stroke, x), 1e-9 * span);
  double widest = fmax(window, widest_window(stroke, x));
  for (; window <= widest; window *= window_growth) {
    fg_local_fit next;
    if (!fg_local_fit_at(stroke, x, window, &next)) continue;
    double value = target == FG_LOCAL_VALUE ? next.value : next.slope;
    double reach =
        interval_reach[target] * (target == FG_LOCAL_VALUE ? next.u_value : next.u_slope);
    low = fmax(low, value - reach);
    high = fmin(high, value + reach);
    if (low > high) break;
    *fit = next;
    found = true;
  }
  if (found) {
    fg_local_fit smaller;
    double taken = fmax(window_taken * fit->window_mm, 1.0001 * smallest_window(stroke, x));
    if (fg_local_fit_at(stroke, x, taken, &smaller)) narrow(&smaller, fit);
  }
  return found;
}

/* Between which places the force passes the level, seen from the largest displacement. */
typedef struct look_around {
  const fg_load_stroke *stroke;
  double level;
  double outer_x, outer_value, inner_x, inner_value;
} look_around;

/* False: the search continues. */
static bool visit(look_around *l, double x, double value) {
  l->inner_x = x, l->inner_value = value;
  if (value < l->level && l->outer_value >= l->level) return true;
  l->outer_x = x, l->outer_value = value;
  return false;
}

/* Force at a sample beside an unsampled stretch; the sample's own where it is almost alone. */
static double border_value(const fg_load_stroke *s, size_t i) {
  fg_local_fit fit;
  double window = 1.0001 * window_of(s, s->x[i], LOOK_SAMPLES, PLACES_MIN);
  return fg_local_fit_at(s, s->x[i], window, &fit) ? fit.value : s->f[i];
}

bool fg_local_across(const fg_load_stroke *stroke, double x, fg_local_fit *fit) {
  size_t i = fg_load_stroke_from(stroke, x);
  if (i == 0 || i >= stroke->count || !stroke->after_hole[i]) return false;
  double a = border_value(stroke, i - 1), b = border_value(stroke, i);
  double width = stroke->x[i] - stroke->x[i - 1], slope = (b - a) / width;
  *fit = (fg_local_fit){.value = a + slope * (x - stroke->x[i - 1]),
                        .u_value = hypot(fabs(b - a) / sqrt(12), sqrt(stroke->variance[i])),
                        .slope = slope,
                        .u_slope = fabs(slope),
                        .window_mm = width / 2};
  return true;
}

typedef enum looked { NOWHERE, SAMPLED, UNSAMPLED } looked;

/* Coarsely, at places of a grid and on both borders of every unsampled stretch. */
static looked find_crossing(look_around *l) {
  const fg_load_stroke *s = l->stroke;
  double low = s->x[0], high = s->x[s->count - 1], step = (high - low) / LOOK_PLACES;
  size_t i = s->count - 1;
  l->outer_value = NAN;
  for (int k = LOOK_PLACES; k >= 0; k--) {
    fg_local_fit fit;
    double at = low + k * step;
    for (; i > 0 && s->x[i] > at; i--) {
      if (!s->after_hole[i]) continue;
      if (visit(l, s->x[i], border_value(s, i))) return SAMPLED;
      if (visit(l, s->x[i - 1], border_value(s, i - 1))) return UNSAMPLED;
    }
    double window = fmax(2 * step, 1.0001 * window_of(s, at, LOOK_SAMPLES, PLACES_MIN));
    if (fg_local_fit_at(s, at, window, &fit) && visit(l, at, fit.value)) return SAMPLED;
  }
  return NOWHERE;
}

/* Factor by which the force in an unsampled stretch may be steeper than beside it. That bounds the
 * place: the middle of the bounds, with a rectangular distribution. */
static const double steeper_max = 2;

static bool bracket(const look_around *l, double *x, double *u_x, fg_local_fit *fit) {
  const fg_load_stroke *s = l->stroke;
  double width = l->outer_x - l->inner_x, rise = l->outer_value - l->inner_value;
  double slope = rise / width;
  fg_local_fit border;
  if (fg_local_fit_near(s, l->outer_x, 0, &border)) slope = fmax(slope, border.slope);
  double steepest = steeper_max * slope;
  double from = l->inner_x + (l->level - l->inner_value) / steepest;
  double to = l->outer_x - (l->outer_value - l->level) / steepest;
  size_t i = fg_load_stroke_from(s, l->outer_x);
  *x = (from + to) / 2;
  double u_within = (to - from) / sqrt(12);
  *u_x = hypot(u_within, sqrt(s->variance[i]) / slope);
  *fit = (fg_local_fit){.value = l->level,
                        .u_value = slope * *u_x,
                        .slope = slope,
                        .u_slope = slope,
                        .window_mm = width / 2,
                        .u_unsampled_mm = u_within};
  return true;
}

/* Mean force of the samples of one place, from sample `i` on outwards. */
static double place_mean(const fg_load_stroke *s, size_t i, int step) {
  double sum = 0, count = 0, from = s->x[i];
  for (; fabs(s->x[i] - from) <= fg_load_stroke_place(s); i = step > 0 ? i + 1 : i - 1) {
    sum += s->f[i];
    count++;
    if (step > 0 ? i + 1 == s->count : i == 0) break;
  }
  return sum / count;
}

/* Brackets a level that no regression passes, as between two rests of a rotor under weights: it
 * lies between the places on both sides. */
static bool bracket_places(look_around *l, double *x, double *u_x, fg_local_fit *fit) {
  const fg_load_stroke *s = l->stroke;
  size_t outer = fg_load_stroke_from(s, l->outer_x), inner = fg_load_stroke_from(s, l->inner_x);
  if (outer >= s->count || inner == 0) return false;
  l->outer_x = s->x[outer], l->outer_value = place_mean(s, outer, 1);
  l->inner_x = s->x[inner - 1], l->inner_value = place_mean(s, inner - 1, -1);
  if (l->outer_value < l->level || l->inner_value >= l->level) return false;
  bracket(l, x, u_x, fit);
  fit->u_unsampled_mm = 0;
  return true;
}

static bool is_within(const look_around *l, double x) {
  size_t first, last;
  if (!fg_load_stroke_part(l->stroke, (l->inner_x + l->outer_x) / 2, &first, &last)) return true;
  return x >= l->stroke->x[first] && x <= l->stroke->x[last];
}

static bool solve_crossing(const look_around *l, double *x, double *u_x, fg_local_fit *fit) {
  const fg_load_stroke *stroke = l->stroke;
  double window = 0, u = 0;
  *x = (l->inner_x + l->outer_x) / 2;
  for (int step = 0; step < SOLVE_STEPS; step++) {
    /* The window is that of the second place: the first is a guess. */
    if (step < 2 ? !fg_local_fit_adaptive(stroke, *x, FG_LOCAL_VALUE, fit)
                 : !fg_local_fit_at(stroke, *x, window, fit))
      return false;
    if (step < 2) window = fit->window_mm, u = fit->u_value;
    if (!(fit->slope > 0)) return false;
    *x += fmax(-window, fmin(window, (l->level - fit->value) / fit->slope));
    if (!is_within(l, *x)) return false;
  }
  if (!fg_local_fit_at(stroke, *x, window, fit) || !(fit->slope > 0)) return false;
  u = fmax(u, fit->u_value);
  if (fabs(fit->value - l->level) > u) return false; /* steps that wander in the noise */
  *u_x = u / fit->slope;
  return true;
}

bool fg_local_crossing(const fg_load_stroke *stroke, double level_n, double *x, double *u_x,
                       fg_local_fit *fit) {
  look_around l = {.stroke = stroke, .level = level_n};
  if (stroke->count < SAMPLES_MIN || !(stroke->x[stroke->count - 1] > stroke->x[0])) return false;
  looked where = find_crossing(&l);
  if (where == NOWHERE) return false;
  if (where == UNSAMPLED) return bracket(&l, x, u_x, fit);
  return solve_crossing(&l, x, u_x, fit) || bracket_places(&l, x, u_x, fit);
}
