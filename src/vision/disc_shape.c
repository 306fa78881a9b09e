/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shape of a round edge around its turn: sectors' fits, smoothed by their first harmonics. */
#include "vision/disc_work.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "core/small_solve.h"
#include "vision/shape_curve.h"

enum { HARMONICS_MAX = 3, BASIS_MAX = 2 * HARMONICS_MAX + 1 };

/* One value of the shape around the turn, and its curve. */
typedef struct turn_curve {
  const fg_disc_work *work;
  int value;
  size_t unknowns;
  double coefficients[BASIS_MAX];
  double real;     /* share of the scatter about the curve beyond the fits' own */
  double *scratch; /* per sector */
} turn_curve;

static double sector_angle(const fg_disc_work *work, double sector) {
  return (sector + 0.5) * 2 * M_PI / (double)work->ring.sector_count;
}

/* Harmonics of a turn; of a stretch that does not close a straight line. */
static void fill_basis(const turn_curve *c, double angle, double row[BASIS_MAX]) {
  row[0] = 1;
  if (c->work->open) row[1] = angle / M_PI - 1;
  for (size_t k = 1; 2 * k < c->unknowns && !c->work->open; k++) {
    row[2 * k - 1] = cos((double)k * angle);
    row[2 * k] = sin((double)k * angle);
  }
}

static double evaluate_curve(const turn_curve *c, double angle) {
  double row[BASIS_MAX], sum = 0;
  fill_basis(c, angle, row);
  for (size_t k = 0; k < c->unknowns; k++)
    sum += c->coefficients[k] * row[k];
  return sum;
}

static double deviation_from_curve(const turn_curve *c, size_t sector) {
  const fg_step_fit *fit = &c->work->sectors[sector];
  return fit->good
             ? fit->values[c->value] - evaluate_curve(c, sector_angle(c->work, (double)sector))
             : NAN;
}

static bool fit_turn_curve(turn_curve *c, double limit) {
  fg_normal_equations system;
  fg_normal_clear(&system, c->unknowns);
  fg_shape_curve_sums sums = {0};
  double row[BASIS_MAX];
  for (size_t s = 0; s < c->work->ring.sector_count; s++) {
    const fg_step_fit *fit = &c->work->sectors[s];
    double off = deviation_from_curve(c, s), angle = sector_angle(c->work, (double)s);
    if (!fit->good || fabs(off) > limit) continue;
    fill_basis(c, angle, row);
    sums.squares += off * off;
    sums.expected += fit->sd[c->value] * fit->sd[c->value];
    sums.count++;
    fg_normal_add(&system, row, fit->values[c->value], 1);
  }
  return fg_shape_curve_solve(&system, &sums, isfinite(limit), c->coefficients, &c->real);
}

/* Starts the curve of a stretch from the median, and leaves out sectors beyond the limit. A stretch
 * has few sectors, and dust in one of them would bias the mean of all. */
static double start_open(turn_curve *c) {
  size_t n = 0;
  for (size_t s = 0; s < c->work->ring.sector_count; s++)
    if (c->work->sectors[s].good) c->scratch[n++] = c->work->sectors[s].values[c->value];
  if (n < 3) return INFINITY;
  c->coefficients[0] = fg_select(c->scratch, n, n / 2);
  n = 0;
  for (size_t s = 0; s < c->work->ring.sector_count; s++)
    if (c->work->sectors[s].good) c->scratch[n++] = fabs(deviation_from_curve(c, s));
  return fg_shape_curve_limit(c->scratch, n);
}

static void find_turn_curve(turn_curve *c) {
  double limit = INFINITY;
  c->real = 0;
  memset(c->coefficients, 0, sizeof c->coefficients);
  if (c->work->open) limit = start_open(c);
  for (int round = 0; round < 3 && fit_turn_curve(c, limit); round++) {
    size_t n = 0;
    for (size_t s = 0; s < c->work->ring.sector_count; s++)
      if (c->work->sectors[s].good) c->scratch[n++] = fabs(deviation_from_curve(c, s));
    limit = fg_shape_curve_limit(c->scratch, n);
  }
}

/* Returns the curve at a station, plus the real share of the sectors' own deviation, linear between
 * their middles. */
static double turn_curve_at(const turn_curve *c, double turn) {
  size_t count = c->work->ring.sector_count;
  double at = turn * (double)count - 0.5;
  double value = evaluate_curve(c, turn * 2 * M_PI);
  if (c->work->open) at = fmin(fmax(at, 0), (double)count - 1);
  if (at < 0) at += (double)count;
  size_t s0 = (size_t)at % count, s1 = c->work->open && s0 + 1 == count ? s0 : (s0 + 1) % count;
  double share = at - floor(at), d0 = deviation_from_curve(c, s0), d1 = deviation_from_curve(c, s1);
  if (isfinite(d0)) value += c->real * (1 - share) * d0;
  if (isfinite(d1)) value += c->real * share * d1;
  return value;
}

/* Returns the number of basis functions that this number of good sectors can determine. */
static size_t count_unknowns(const fg_disc_work *work, size_t good) {
  if (work->open) return good >= 8 ? 2 : 1;
  return good >= 24 ? 7 : good >= 14 ? 5 : 3;
}

static double typical_shape_ratio(const fg_disc_work *work, double *scratch) {
  size_t n = 0;
  for (size_t s = 0; s < work->ring.sector_count; s++)
    if (work->sectors[s].good) scratch[n++] = work->sectors[s].shape_ratio;
  return n ? fg_select(scratch, n, n / 2) : 1;
}

fg_status fg_disc_smooth_shape(fg_context *ctx, const fg_disc_work *work, fg_disc_edge *edge) {
  size_t good = 0;
  double *scratch;
  FG_TRY(fg_memory_allocate(ctx, work->ring.sector_count, sizeof *scratch, (void **)&scratch));
  for (size_t s = 0; s < work->ring.sector_count; s++)
    good += work->sectors[s].good;
  turn_curve c = {.work = work, .scratch = scratch};
  c.unknowns = count_unknowns(work, good);
  for (c.value = FG_STEP_EDGE; c.value <= FG_STEP_BLUR; c.value++) {
    find_turn_curve(&c);
    if (c.value == FG_STEP_EDGE) c.real = 1;
    for (size_t i = 0; i < edge->count; i++) {
      double value = turn_curve_at(&c, ((double)i + 0.5) / (double)edge->count);
      if (c.value == FG_STEP_BLUR) value = fmax(value, 0.3);
      edge->stations[i].shape[c.value] = (float)value;
      if (c.value == FG_STEP_EDGE) edge->stations[i].edge_px = (float)value;
    }
    if (c.value == FG_STEP_BLUR) edge->blur_px = c.coefficients[0];
    if (c.value == FG_STEP_INSIDE) edge->inside = c.coefficients[0];
    if (c.value == FG_STEP_OUTSIDE) edge->outside = c.coefficients[0];
  }
  edge->shape_ratio = typical_shape_ratio(work, scratch);
  free(scratch);
  return FG_OK;
}

bool fg_disc_has_slope(const fg_disc_work *work, int value) {
  double n = 0, sum = 0, weights = 0, squares = 0;
  for (size_t s = 0; s < work->ring.sector_count; s++) {
    const fg_step_fit *fit = &work->sectors[s];
    if (!fit->good || !(fit->sd[value] > 0)) continue;
    double weight = 1 / (fit->sd[value] * fit->sd[value]);
    sum += weight * fit->values[value];
    weights += weight;
    squares += weight * fit->values[value] * fit->values[value];
    n++;
  }
  return n > 0 && (sum * sum > 9 * weights || squares > n + 4 * sqrt(2 * n));
}
