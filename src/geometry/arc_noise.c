/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Correlation of the residuals along the strip. */
#include "geometry/arcs.h"

#include <math.h>
#include <string.h>

#include "core/correlation.h"

enum { RANGE_MAX = 4096 }; /* max number of used stations of one range */

/* Residuals along an arc: of the datum line from its circle, or of the half width from its mean. */
typedef struct arc_residuals {
  const fg_datum_line *line;
  const fg_arc *arc;
  fg_noise_of of;
  double mean_half_width;
} arc_residuals;

static double residual_at(const arc_residuals *r, size_t k) {
  if (!fg_arc_used(r->line, r->arc, k)) return NAN;
  if (r->of == FG_NOISE_OF_HALF_WIDTH) return r->line->half_width[k] - r->mean_half_width;
  return fg_arc_residual(r->line, &r->arc->circle, k);
}

static double mean_half_width(const fg_datum_line *line, const fg_arc *arc) {
  double sum = 0, n = 0;
  for (size_t r = 0; r < arc->range_count; r++)
    for (size_t k = arc->ranges[r].first; k <= arc->ranges[r].last; k++)
      if (fg_arc_used(line, arc, k)) {
        sum += line->half_width[k];
        n++;
      }
  return n > 0 ? sum / n : 0;
}

typedef struct lag_sums {
  double products[FG_NOISE_LAGS], pairs[FG_NOISE_LAGS];
} lag_sums;

/* Residuals of one range, 0 where a station is left out; at most RANGE_MAX of them. `used` is 1 or
 * 0. */
static size_t list_range(const arc_residuals *residuals, fg_range range, double *list,
                         double *used) {
  size_t n = range.last - range.first + 1;
  if (n > RANGE_MAX) n = RANGE_MAX;
  for (size_t i = 0; i < n; i++) {
    double value = residual_at(residuals, range.first + i);
    used[i] = isfinite(value);
    list[i] = isfinite(value) ? value : 0;
  }
  return n;
}

static void add_range(const double *restrict list, const double *restrict used, size_t n,
                      size_t lags, lag_sums *restrict sums) {
  for (size_t i = 0; i < n; i++) {
    size_t reach = n - i < lags ? n - i : lags;
    for (size_t lag = 0; used[i] > 0 && lag < reach; lag++) {
      sums->products[lag] += list[i] * list[i + lag];
      sums->pairs[lag] += used[i + lag];
    }
  }
}

static void add_arc(const fg_datum_line *line, const fg_arc *arc, fg_noise_of of, size_t lags,
                    lag_sums *sums) {
  const arc_residuals residuals = {line, arc, of, mean_half_width(line, arc)};
  double list[RANGE_MAX], used[RANGE_MAX];
  for (size_t r = 0; r < arc->range_count; r++) {
    size_t n = list_range(&residuals, arc->ranges[r], list, used);
    add_range(list, used, n, lags, sums);
  }
}

/* Number of points of the typical arc. A fit of three parameters removes variance of slow
 * residuals: the visible correlation is lower than the noise's. The difference follows for a
 * typical arc from the projection M = I - P: the mean of (M C M) over the diagonal of each lag,
 * against C. */
enum { TYPICAL_POINTS = 400 };

/* Columns that span the variance that a circle's fit removes from an arc of n points and half angle
 * `half`: 1, cos, sin of the angle, orthonormal. */
static void span_fit(double half, size_t n, double q[3][TYPICAL_POINTS]) {
  for (size_t i = 0; i < n; i++) {
    double angle = half * (2 * (double)i / (double)(n - 1) - 1);
    q[0][i] = 1;
    q[1][i] = cos(angle) - 1;
    q[2][i] = sin(angle);
  }
  for (int a = 0; a < 3; a++) {
    double square = 0;
    for (int b = 0; b < a; b++) {
      double dot = 0;
      for (size_t i = 0; i < n; i++)
        dot += q[a][i] * q[b][i];
      for (size_t i = 0; i < n; i++)
        q[a][i] -= dot * q[b][i];
    }
    for (size_t i = 0; i < n; i++)
      square += q[a][i] * q[a][i];
    for (size_t i = 0; i < n; i++)
      q[a][i] /= sqrt(square);
  }
}

/* seen[lag] = mean over i of (M C M)[i, i + lag] with M = I - QQ' and C banded by the noise. With
 * B = C Q and S = Q'C Q: M C M = C - B Q' - Q B' + Q S Q'. */
static void project_noise(double q[3][TYPICAL_POINTS], size_t n, const fg_noise_model *noise,
                          double *seen) {
  double b[3][TYPICAL_POINTS], s[3][3] = {{0}};
  for (int a = 0; a < 3; a++)
    for (size_t i = 0; i < n; i++) {
      b[a][i] = noise->covariance[0] * q[a][i];
      for (size_t lag = 1; lag < noise->lags; lag++) {
        if (i >= lag) b[a][i] += noise->covariance[lag] * q[a][i - lag];
        if (i + lag < n) b[a][i] += noise->covariance[lag] * q[a][i + lag];
      }
      for (int c = 0; c < 3; c++)
        s[c][a] += q[c][i] * b[a][i];
    }
  for (size_t lag = 0; lag < noise->lags; lag++) {
    double sum = 0;
    for (size_t i = 0; i + lag < n; i++)
      for (int a = 0; a < 3; a++) {
        sum -= b[a][i] * q[a][i + lag] + q[a][i] * b[a][i + lag];
        for (int c = 0; c < 3; c++)
          sum += q[a][i] * s[a][c] * q[c][i + lag];
      }
    seen[lag] = noise->covariance[lag] + sum / (double)(n - lag);
  }
}

/* Undoes the projection: computes the removed correlation for a typical arc from the visible one,
 * and adds it, twice. */
static void undo_projection(const fg_datum_line *line, const fg_arc *arc, fg_noise_model *noise) {
  double q[3][TYPICAL_POINTS], seen[FG_NOISE_LAGS], first[FG_NOISE_LAGS];
  size_t n = arc->ranges[0].last - arc->ranges[0].first + 1;
  double half = 0.5 * (double)n * line->strip->step_mm / arc->circle.radius;
  if (n > TYPICAL_POINTS) n = TYPICAL_POINTS;
  if (n < 2 * noise->lags || n < 16) return;
  span_fit(half, n, q);
  memcpy(first, noise->covariance, sizeof first);
  for (int round = 0; round < 2; round++) {
    project_noise(q, n, noise, seen);
    for (size_t lag = 0; lag < noise->lags; lag++)
      noise->covariance[lag] += first[lag] - seen[lag];
  }
}

void fg_noise_estimate(const fg_datum_line *line, const fg_arc *arcs, size_t count, fg_noise_of of,
                       fg_noise_model *noise) {
  memset(noise, 0, sizeof *noise);
  noise->integral_stations = 1;
  noise->lags = 1;
  lag_sums sums = {0};
  double correlation[FG_NOISE_LAGS], variance = 0;
  /* White noise is the common case: few lags are tested first. */
  size_t cut = 1;
  for (size_t lags = 8; lags <= FG_NOISE_LAGS; lags *= 2) {
    memset(&sums, 0, sizeof sums);
    for (size_t i = 0; i < count; i++)
      add_arc(line, &arcs[i], of, lags, &sums);
    if (!(sums.pairs[0] > 4) || !(sums.products[0] > 0)) return;
    variance = sums.products[0] / sums.pairs[0];
    for (size_t lag = 0; lag < lags; lag++)
      correlation[lag] = sums.pairs[lag] > 0 ? sums.products[lag] / sums.pairs[lag] / variance : 0;
    cut = fg_correlation_lags(sums.products, sums.pairs, lags);
    if (cut < lags) break;
  }
  if (cut == 1) {
    /* Three parameters of every circle removed their share of the variance. */
    noise->covariance[0] = sums.products[0] / fmax(sums.pairs[0] - 3.0 * (double)count, 1);
    return;
  }
  noise->lags = cut < FG_NOISE_LAGS ? cut : FG_NOISE_LAGS;
  for (size_t lag = 0; lag < noise->lags; lag++)
    noise->covariance[lag] = variance * correlation[lag];
  if (count > 0) undo_projection(line, &arcs[count / 2], noise);
  for (size_t lag = 1; lag < noise->lags; lag++)
    noise->integral_stations += 2 * noise->covariance[lag] / noise->covariance[0];
}
