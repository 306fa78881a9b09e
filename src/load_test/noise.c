/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "load_test/noise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "load_test/local_fit.h"

/* ---- the step of a column ---- */

/* Tolerance of a rounding step: other distances must be multiples of the smallest one to this
 * share, and values must be far fewer than samples. */
static const double step_tolerance = 1e-3, values_share_max = 0.5;
enum { STEP_SAMPLES_MAX = 20000, STEP_SAMPLES_MIN = 48 };

static int by_value(const void *left, const void *right) {
  double a = *(const double *)left, b = *(const double *)right;
  return (a > b) - (a < b);
}

double fg_load_find_step(const fg_load_sample *samples, size_t count) {
  fg_context ignored = {0};
  double *x = NULL, min = INFINITY, step = 0;
  size_t n = count < STEP_SAMPLES_MAX ? count : STEP_SAMPLES_MAX, values = 1;
  if (n < STEP_SAMPLES_MIN || fg_memory_allocate(&ignored, n, sizeof *x, (void **)&x) != FG_OK)
    return 0;
  for (size_t i = 0; i < n; i++)
    x[i] = samples[i].x_mm;
  fg_sort_items(x, n, sizeof *x, by_value);
  double alike = 1e-9 * (x[n - 1] - x[0]); /* rounding of the numbers themselves */
  for (size_t i = 1; i < n; i++) {
    if (x[i] - x[i - 1] <= alike) continue;
    min = fmin(min, x[i] - x[i - 1]);
    values++;
  }
  bool stepped = (double)values < values_share_max * (double)n && isfinite(min);
  for (size_t i = 1; i < n && stepped; i++) {
    double steps = (x[i] - x[i - 1]) / min;
    stepped = fabs(steps - round(steps)) < step_tolerance * fmax(1, steps);
  }
  if (stepped) step = min;
  free(x);
  return step;
}

/* ---- the slope of the strokes, roughly ---- */

/* Number of places of the pilot's slopes, half of its window as a share of the span, and the share
 * of a stroke at each end where friction reverses and the slope is not the spring's. */
enum { PILOT = 96 };
static const double pilot_window = 0.04, end_left_out = 0.05;

typedef struct pilot {
  double low, high, square[PILOT]; /* of the slope */
} pilot;

static fg_status find_pilot(fg_context *ctx, const fg_load_strokes *strokes, int sense, pilot *p) {
  fg_load_stroke merged = {0};
  double last = 0;
  *p = (pilot){0};
  fg_status status = fg_load_strokes_merge_sense(ctx, strokes, sense, &merged);
  if (status == FG_OK && merged.count) {
    p->low = merged.x[0], p->high = merged.x[merged.count - 1];
    for (size_t k = 0; k < PILOT; k++) {
      double x = p->low + (p->high - p->low) * (double)k / (PILOT - 1);
      fg_local_fit fit;
      if (fg_local_fit_at(&merged, x, pilot_window * (p->high - p->low), &fit))
        last = fit.slope * fit.slope;
      p->square[k] = last;
    }
  }
  fg_load_stroke_free(&merged);
  return status;
}

static double square_at(const pilot *p, double x) {
  double place = p->high > p->low ? (x - p->low) / (p->high - p->low) * (PILOT - 1) : 0;
  size_t k = place > 0 ? (size_t)fmin(place, PILOT - 2) : 0;
  double share = fmin(1, fmax(0, place - (double)k));
  return (1 - share) * p->square[k] + share * p->square[k + 1];
}

/* ---- variance = force² + slope² displacement² ---- */

/* Iterations of weighted least squares, with weights from the previous variances; negative results
 * are set to zero. A sample where the force bends sharply is no noise: squares above this multiple
 * of the variance are cut there (0.3 % of samples of normal noise). */
enum { TURNS = 30 };
static const double largest_share = 9;

/* Median of the square of a normal deviate. */
static const double median_square = 0.4549;

typedef struct variances {
  double force, displacement;
} variances;

/* sum of weights times 1, k, k² of slopes squared, and times the squared scatter. */
typedef struct moments {
  double one, k, kk, q, kq;
} moments;

static void add_moments(const fg_load_stroke *s, const pilot *p, variances v, moments *m) {
  size_t left_out = (size_t)(end_left_out * (double)s->count) + 1;
  for (size_t i = left_out; i + left_out < s->count; i++) {
    double k = square_at(p, s->x[i]), variance = v.force + k * v.displacement;
    double q = fmin(s->scatter[i], largest_share * variance), w = 1 / (variance * variance);
    m->one += w, m->k += w * k, m->kk += w * k * k;
    m->q += w * q, m->kq += w * k * q;
  }
}

/* Solves with the displacement's variance at least `min`. */
static variances solve_variances(const moments *m, double min) {
  double determinant = m->one * m->kk - m->k * m->k;
  variances v = {m->q / m->one, 0};
  if (determinant > 1e-9 * m->one * m->kk) {
    v.displacement = (m->one * m->kq - m->k * m->q) / determinant;
    v.force = (m->kk * m->q - m->k * m->kq) / determinant;
  }
  if (v.force < 0) v = (variances){0, m->kq / m->kk};
  if (v.displacement < min) v = (variances){fmax(0, (m->q - min * m->k) / m->one), min};
  return v;
}

/* Variance by the median of the scatter; its mean where half of it is nothing. */
static fg_status first_variance(fg_context *ctx, const fg_load_strokes *strokes, double *variance) {
  double *all = NULL, sum = 0;
  size_t total = 0, n = 0;
  for (size_t i = 0; i < strokes->count; i++)
    total += strokes->stroke[i].count;
  FG_TRY(fg_memory_allocate(ctx, total, sizeof *all, (void **)&all));
  for (size_t i = 0; i < strokes->count; i++)
    for (size_t k = 0; k < strokes->stroke[i].count; k++) {
      all[n] = strokes->stroke[i].scatter[k];
      sum += all[n++];
    }
  fg_sort_items(all, n, sizeof *all, by_value);
  *variance = fmax(all[n / 2] / median_square, 1e-4 * sum / (double)n);
  free(all);
  return FG_OK;
}

static variances find_variances(const fg_load_strokes *strokes, const pilot p[2], double first,
                                double min) {
  variances v = {first, 0};
  for (int turn = 0; turn < TURNS && first > 0; turn++) {
    moments m = {0};
    v.force = fmax(v.force, 1e-6 * first); /* weights stay finite */
    for (size_t i = 0; i < strokes->count; i++)
      add_moments(&strokes->stroke[i], &p[strokes->stroke[i].sense > 0], v, &m);
    if (!(m.one > 0)) break;
    v = solve_variances(&m, min);
  }
  return v;
}

/* ---- where strokes turn ---- */

/* Range about a turn for fitting a parabola over the samples' order: within this many times the
 * displacement's noise of its extreme. Where the noise is small, or the turn sharp, samples are too
 * few, and the extreme is as good as the noise. */
static const double turn_reach = 8;
enum { TURN_SAMPLES_MIN = 7, TURN_SAMPLES_MAX = 400 };

/* Returns the vertex of the parabola through the samples about `at`, or the sample itself. The
 * extreme of noisy samples lies beyond the true turn. */
static double turning_point(const fg_load_sample *s, size_t low, size_t high, size_t at,
                            double reach) {
  size_t first = at, last = at;
  while (first > low && at - first < TURN_SAMPLES_MAX &&
         fabs(s[first - 1].x_mm - s[at].x_mm) < reach)
    first--;
  while (last < high && last - at < TURN_SAMPLES_MAX && fabs(s[last + 1].x_mm - s[at].x_mm) < reach)
    last++;
  double n = (double)(last - first + 1), z2 = 0, z4 = 0, x = 0, xz = 0, xzz = 0;
  if (n < TURN_SAMPLES_MIN) return s[at].x_mm;
  double half = (n - 1) / 2;
  for (size_t i = first; i <= last; i++) {
    double z = ((double)(i - first) - half) / half, dx = s[i].x_mm - s[at].x_mm;
    z2 += z * z, z4 += z * z * z * z;
    x += dx, xz += dx * z, xzz += dx * z * z;
  }
  double a = (n * xzz - z2 * x) / (n * z4 - z2 * z2), b = xz / z2, c = (x - a * z2) / n;
  if (!(fabs(b) < 2 * fabs(a))) return s[at].x_mm; /* the way does not turn here */
  return s[at].x_mm + c - b * b / (4 * a);
}

static void find_turns(const fg_load_sample *samples, double noise_mm, fg_load_stroke *s) {
  double reach = turn_reach * noise_mm;
  double start = turning_point(samples, s->begin, s->last, s->first, reach);
  double end = turning_point(samples, s->first, s->end - 1, s->last, reach);
  s->low_mm = fmin(start, end);
  s->high_mm = fmax(start, end);
}

/* ---- dropping samples near turns ---- */

/* Distances from a turn within which samples are left out, in units of the displacement's noise and
 * of its step: samples crowd there, and their places have no information. */
static const double turn_left_out = 3, steps_left_out = 1.5;

static void trim(double noise_mm, double step_mm, fg_load_stroke *s) {
  double way = fmax(turn_left_out * noise_mm, steps_left_out * step_mm);
  size_t first = 0, last = s->count;
  while (first < last && s->x[first] < s->low_mm + way)
    first++;
  while (last > first && s->x[last - 1] > s->high_mm - way)
    last--;
  if (2 * (last - first) < s->count) return;
  s->count = last - first;
  memmove(s->x, s->x + first, s->count * sizeof *s->x);
  memmove(s->f, s->f + first, s->count * sizeof *s->f);
  memmove(s->variance, s->variance + first, s->count * sizeof *s->variance);
  memmove(s->scatter, s->scatter + first, s->count * sizeof *s->scatter);
}

static void mark_holes(double resolution_mm, fg_load_strokes *strokes) {
  for (size_t i = 0; i < strokes->count; i++) {
    strokes->stroke[i].resolution_mm = resolution_mm;
    fg_load_stroke_find_holes(&strokes->stroke[i]);
  }
}

fg_status fg_load_find_noise(fg_context *ctx, const fg_load_sample *samples, double step_mm,
                             fg_load_strokes *strokes) {
  pilot p[2];
  if (!strokes->count) return FG_OK;
  mark_holes(step_mm, strokes);
  for (int up = 0; up < 2; up++)
    FG_TRY(find_pilot(ctx, strokes, up ? 1 : -1, &p[up]));
  double first;
  FG_TRY(first_variance(ctx, strokes, &first));
  variances v = find_variances(strokes, p, first, step_mm * step_mm / 12);
  strokes->noise_n = sqrt(v.force);
  strokes->noise_mm = sqrt(v.displacement);
  for (size_t i = 0; i < strokes->count; i++) {
    fg_load_stroke *s = &strokes->stroke[i];
    for (size_t k = 0; k < s->count; k++)
      s->variance[k] = v.force + square_at(&p[s->sense > 0], s->x[k]) * v.displacement;
    find_turns(samples, strokes->noise_mm, s);
    trim(strokes->noise_mm, step_mm, s);
  }
  mark_holes(fmax(strokes->noise_mm, step_mm), strokes);
  return FG_OK;
}
