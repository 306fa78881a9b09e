/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shape of every station: the segments' fits, smoothed by direction and place. */
#include "vision/edge_work.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/small_solve.h"
#include "core/spread.h"
#include "vision/shape_curve.h"

enum { BASIS_MAX = 7 };

/* One value of the shape over all segments, and its curve. */
typedef struct strip_curve {
  const fg_edge_work *work;
  double (*basis)[BASIS_MAX]; /* per segment */
  double *values;             /* per segment; NaN where the fit failed */
  double *scratch;            /* per segment */
  const double *sd;           /* per segment */
  size_t unknowns;
  double *deviations; /* per segment, from the curve; NaN where the fit failed */
  double coefficients[BASIS_MAX];
  double real; /* share of the scatter about the curve beyond the fits' own */
} strip_curve;

/* Functions of the normal's direction (two harmonics) and of the place (linear), about -1 to 1. */
static void fill_basis(const fg_reference *reference, size_t station, double *basis) {
  const fg_reference_station *s = &reference->stations[station];
  const fg_reference_station *m = &reference->stations[reference->count / 2];
  double scale = 1.0 / (1 + (double)reference->count * reference->step_px * 0.5);
  double c = -s->ty, n = s->tx;
  basis[0] = 1;
  basis[1] = c;
  basis[2] = n;
  basis[3] = c * c - n * n;
  basis[4] = 2 * c * n;
  basis[5] = (s->x - m->x) * scale;
  basis[6] = (s->y - m->y) * scale;
}

static double evaluate_curve(const strip_curve *c, const double *basis) {
  double sum = 0;
  for (size_t b = 0; b < c->unknowns; b++)
    sum += c->coefficients[b] * basis[b];
  return sum;
}

/* Fits the curve to the segments within `limit` of the present one. The real share of the scatter
 * comes from the sum of squares against the fits' own variances. */
static bool fit_strip_curve(strip_curve *c, double limit) {
  fg_normal_equations system;
  fg_normal_clear(&system, c->unknowns);
  fg_shape_curve_sums sums = {0};
  for (size_t s = 0; s < c->work->segment_count; s++) {
    double deviation = c->values[s] - evaluate_curve(c, c->basis[s]);
    if (!isfinite(c->values[s]) || fabs(deviation) > limit) continue;
    sums.squares += deviation * deviation;
    sums.expected += c->sd[s] * c->sd[s];
    sums.count++;
    fg_normal_add(&system, c->basis[s], c->values[s], 1);
  }
  return fg_shape_curve_solve(&system, &sums, isfinite(limit), c->coefficients, &c->real);
}

static double deviation_limit(strip_curve *c) {
  size_t n = 0;
  for (size_t s = 0; s < c->work->segment_count; s++)
    if (isfinite(c->values[s]))
      c->scratch[n++] = fabs(c->values[s] - evaluate_curve(c, c->basis[s]));
  return fg_shape_curve_limit(c->scratch, n);
}

static void find_strip_curve(strip_curve *c) {
  memset(c->coefficients, 0, sizeof c->coefficients);
  c->real = 0;
  double limit = INFINITY;
  for (int round = 0; round < 3 && fit_strip_curve(c, limit); round++)
    limit = deviation_limit(c);
}

static float *station_value(fg_edge_station *s, int i) {
  float *values[FG_EDGE_SHAPE_VALUES] = {&s->plateau,  &s->step[0],    &s->step[1],   &s->slope[0],
                                         &s->slope[1], &s->blur_px[0], &s->blur_px[1]};
  return values[i];
}

static double segment_value(const fg_profile_fit *fit, int i) {
  const fg_edge_shape *s = &fit->shape;
  const double values[FG_EDGE_SHAPE_VALUES] = {
      s->plateau, s->level[0], s->level[1], s->slope[0], s->slope[1], s->blur_px[0], s->blur_px[1]};
  return fit->good ? values[i] : NAN;
}

static void find_deviations(strip_curve *c) {
  for (size_t s = 0; s < c->work->segment_count; s++)
    c->deviations[s] = c->values[s] - evaluate_curve(c, c->basis[s]);
}

/* The curve's value at a station, `at` segments along the strip, plus the real share of the
 * segments' own deviation, linear between their middles. */
static double spread_value(const strip_curve *c, const double *basis, double at) {
  double value = evaluate_curve(c, basis);
  size_t s0 = (size_t)at, s1 = s0 + 1 < c->work->segment_count ? s0 + 1 : s0;
  for (int side = 0; side < 2 && c->real > 0; side++) {
    double share = side ? at - (double)s0 : 1 - (at - (double)s0);
    double deviation = c->deviations[side ? s1 : s0];
    if (isfinite(deviation)) value += c->real * share * deviation;
  }
  return value;
}

/* Evaluates all curves at every station. */
static void spread_curves(const strip_curve *curves) {
  const fg_edge_work *work = curves->work;
  double basis[BASIS_MAX];
  for (size_t k = 0; k < work->reference->count; k++) {
    fill_basis(work->reference, k, basis);
    double at = ((double)k - FG_SEGMENT_STATIONS / 2.0) / FG_SEGMENT_STATIONS;
    at = fmin(fmax(at, 0), (double)work->segment_count - 1);
    for (int i = 0; i < FG_EDGE_SHAPE_VALUES; i++) {
      double value = spread_value(&curves[i], basis, at);
      *station_value(&work->stations[k], i) = (float)(i >= 5 ? fmax(value, 0.3) : value);
    }
  }
}

/* Median over the good segments of some value. */
static double median_of(const fg_edge_work *work, double *scratch,
                        double (*get)(const fg_profile_fit *)) {
  size_t n = 0;
  for (size_t s = 0; s < work->segment_count; s++)
    if (work->segments[s].fit.good) scratch[n++] = get(&work->segments[s].fit);
  return fg_upper_median(scratch, n);
}

static double get_left(const fg_profile_fit *fit) {
  return fit->edge_px[0];
}
static double get_right(const fg_profile_fit *fit) {
  return fit->edge_px[1];
}
static double get_step(const fg_profile_fit *fit) {
  return fabs(fit->shape.plateau - 0.5 * (fit->shape.level[0] + fit->shape.level[1]));
}
static double get_band(const fg_profile_fit *fit) {
  return fabs(fit->shape.level[1] - fit->shape.level[0]);
}
static double get_blur_left(const fg_profile_fit *fit) {
  return fit->shape.blur_px[0];
}
static double get_blur_right(const fg_profile_fit *fit) {
  return fit->shape.blur_px[1];
}
static double get_extreme(const fg_profile_fit *fit) {
  return fmax(fit->shape.plateau, fmax(fit->shape.level[0], fit->shape.level[1]));
}

static double get_plateau(const fg_profile_fit *fit) {
  return fit->shape.plateau;
}
static double get_level_left(const fg_profile_fit *fit) {
  return fit->shape.level[0];
}
static double get_level_right(const fg_profile_fit *fit) {
  return fit->shape.level[1];
}

/* Shift of both edges by another gamma. It puts them at another count, over the profile's slope
 * there, contrast / (s sqrt(2 pi)): the strip becomes wider or narrower on both sides. */
static double tone_shift(const fg_edge_work *work, double plateau, const double level[2]) {
  static const double step = 0.01;
  double shift = 0;
  for (int side = 0; side < 2; side++) {
    const double lights[2] = {plateau, level[side]};
    double counts[2];
    for (int i = 0; i < 2; i++)
      counts[i] = 255 * pow(fmax(lights[i], 1) / 255, 1 / work->gamma);
    double change = fg_edge_count_between(work->gamma * exp(step), counts) -
                    fg_edge_count_between(work->gamma * exp(-step), counts);
    shift +=
        fabs(change / (2 * step) / (counts[1] - counts[0])) * work->blur_px[side] * sqrt(2 * M_PI);
  }
  return isfinite(shift) ? shift : 0;
}

static void summarise_shape(fg_edge_work *work, double *scratch) {
  double left = median_of(work, scratch, get_left), right = median_of(work, scratch, get_right);
  work->thickness_px = right - left;
  work->contrast = median_of(work, scratch, get_step);
  work->blur_px[0] = median_of(work, scratch, get_blur_left);
  work->blur_px[1] = median_of(work, scratch, get_blur_right);
  const double level[2] = {median_of(work, scratch, get_level_left),
                           median_of(work, scratch, get_level_right)};
  double plateau = median_of(work, scratch, get_plateau), around = 0.5 * (level[0] + level[1]);
  work->tone_px = tone_shift(work, plateau, level);
  work->bright = plateau > around;
  work->side_band = median_of(work, scratch, get_band) > 0.08 * work->contrast;
  work->clipped |= median_of(work, scratch, get_extreme) > 253.5;
  for (size_t k = 0; k < work->reference->count; k++) {
    fg_edge_station *st = &work->stations[k];
    const fg_profile_fit *fit = &work->segments[k / FG_SEGMENT_STATIONS].fit;
    bool near = fit->good && fabs(fit->edge_px[1] - right) + fabs(fit->edge_px[0] - left) < 3;
    st->edge_px[0] = st->middle_px + (float)(near ? fit->edge_px[0] : left);
    st->edge_px[1] = st->middle_px + (float)(near ? fit->edge_px[1] : right);
    st->step[0] -= st->plateau;
    st->step[1] -= st->plateau;
  }
}

fg_status fg_edges_smooth_shape(fg_context *ctx, fg_edge_work *work, bool local) {
  size_t count = work->segment_count, good = work->good_segments;
  strip_curve c = {.work = work, .unknowns = good >= 20 ? BASIS_MAX : good >= 8 ? 3 : 1};
  strip_curve curves[FG_EDGE_SHAPE_VALUES];
  double *memory = NULL;
  FG_TRY(fg_memory_allocate(ctx, count, (BASIS_MAX + 3 + FG_EDGE_SHAPE_VALUES) * sizeof *memory,
                            (void **)&memory));
  c.basis = (double(*)[BASIS_MAX])memory;
  c.values = memory + BASIS_MAX * count;
  c.scratch = c.values + count;
  double *sd = c.scratch + count;
  c.sd = sd;
  for (size_t s = 0; s < count; s++) {
    size_t middle = s * FG_SEGMENT_STATIONS + FG_SEGMENT_STATIONS / 2;
    fill_basis(work->reference,
               middle < work->reference->count ? middle : work->reference->count - 1, c.basis[s]);
  }
  for (int i = 0; i < FG_EDGE_SHAPE_VALUES; i++) {
    for (size_t s = 0; s < count; s++) {
      c.values[s] = segment_value(&work->segments[s].fit, i);
      sd[s] = work->segments[s].fit.sd[i];
    }
    find_strip_curve(&c);
    if (!local) c.real = 0;
    curves[i] = c;
    curves[i].deviations = sd + (size_t)(1 + i) * count;
    find_deviations(&curves[i]);
  }
  spread_curves(curves);
  summarise_shape(work, c.scratch);
  free(memory);
  return FG_OK;
}
