/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/beam_line.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/correlation.h"
#include "core/memory.h"
#include "core/small_solve.h"
#include "core/spread.h"

enum { ROUNDS = 6, MIN_STATIONS = 4, BLOCK = 64, BLOCKS_MIN = 6, BESIDE = 2 };
/* Limits of an outlier: robust deviations, and a distance. */
#define OUTLIER_DEVIATIONS 4.5
#define OUTLIER_MIN_MM     0.0004
/* Min ratio at which long stretches scatter more than the lags predict. */
#define LONG_RANGE_MIN 1.5
/* The shape of the edge was fitted to the same pixels (geometry/disc_fit.c). */
#define SHAPE_VARIANCE 1.12

static const fg_disc_point *station_at(const fg_beam_line *line, size_t i) {
  return &line->edge->stations[i];
}

static double place_along(const fg_beam_line *line, fg_point p) {
  return line->along.x * (p.x - line->at.x) + line->along.y * (p.y - line->at.y);
}

/* Distance across. The void is to the left of a rim as seen: to the right where y points up. */
static double place_across(const fg_beam_line *line, fg_point p) {
  return line->along.y * (p.x - line->at.x) - line->along.x * (p.y - line->at.y);
}

static double step_of(const fg_beam_line *line) {
  size_t n = line->edge->count;
  fg_point a = station_at(line, 0)->at, b = station_at(line, n - 1)->at;
  double size = hypot(b.x - a.x, b.y - a.y), twice = 2 * line->edge->radius_mm;
  if (line->edge->round) size = twice * asin(fmin(1, size / twice));
  return size / (double)(n - 1);
}

static void fit_once(fg_beam_line *line) {
  double n = 0, sx = 0, sy = 0, xx = 0, xy = 0, yy = 0;
  fg_point o = station_at(line, 0)->at;
  for (size_t i = 0; i < line->edge->count; i++) {
    if (isnan(line->across[i])) continue;
    double x = station_at(line, i)->at.x - o.x, y = station_at(line, i)->at.y - o.y;
    n++;
    sx += x;
    sy += y;
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  sx /= n;
  sy /= n;
  double angle = 0.5 * atan2(2 * (xy / n - sx * sy), xx / n - sx * sx - yy / n + sy * sy);
  fg_point last = station_at(line, line->edge->count - 1)->at;
  line->at = (fg_point){o.x + sx, o.y + sy};
  line->along = (fg_point){cos(angle), sin(angle)};
  if (line->along.x * (last.x - o.x) + line->along.y * (last.y - o.y) < 0)
    line->along = (fg_point){-line->along.x, -line->along.y};
}

/* Uses the stations within the limit of the fit whose neighbours are, too: a disturbance reaches
 * neighbouring stations. */
static void use_within(fg_beam_line *line, const double *off, double limit) {
  double squares = 0;
  line->used = 0;
  for (size_t i = 0; i < line->edge->count; i++) {
    bool use = true;
    for (size_t k = i < BESIDE ? 0 : i - BESIDE; k <= i + BESIDE && k < line->edge->count; k++)
      use = use && station_at(line, k)->used && fabs(off[k]) <= limit;
    line->across[i] = use ? off[i] : NAN;
    line->used += use;
    squares += use ? off[i] * off[i] : 0;
  }
  line->rms_mm = sqrt(squares / (double)line->used);
}

static double find_limit(const fg_beam_line *line, const double *off, double *scratch) {
  size_t n = 0;
  for (size_t i = 0; i < line->edge->count; i++)
    if (station_at(line, i)->used) scratch[n++] = fabs(off[i]);
  return fmax(fg_spread_limit(scratch, n, OUTLIER_DEVIATIONS), OUTLIER_MIN_MM);
}

/* The circle of a round floor about its apex: q = a + b cos f + c sin f of a station's distance
 * from a centre, f its direction from there against the axis. Its apex lies at a + b. */
typedef struct apex {
  fg_circle circle;
  fg_point axis; /* away from the tip */
} apex;

static void fit_apex(fg_beam_line *line, apex *a, double *off) {
  fg_normal_equations system;
  double x[FG_SMALL_MAX] = {0};
  fg_normal_clear(&system, 3);
  for (size_t i = 0; i < line->edge->count; i++) {
    double dx = station_at(line, i)->at.x - a->circle.x,
           dy = station_at(line, i)->at.y - a->circle.y;
    double r = hypot(dx, dy), c = (dx * a->axis.x + dy * a->axis.y) / r;
    double s = (dy * a->axis.x - dx * a->axis.y) / r;
    if (!isnan(line->across[i])) fg_normal_add(&system, (double[]){1, c, s}, r, 1);
  }
  fg_normal_solve(&system, 1e-12, x, NULL);
  for (size_t i = 0; i < line->edge->count; i++) {
    double dx = station_at(line, i)->at.x - a->circle.x,
           dy = station_at(line, i)->at.y - a->circle.y;
    double r = hypot(dx, dy), c = (dx * a->axis.x + dy * a->axis.y) / r;
    double s = (dy * a->axis.x - dx * a->axis.y) / r;
    off[i] = -(r - x[0] - x[1] * c - x[2] * s);
  }
  /* b and c are the centre's move along the axis and across it, so the circle's own apex is at the
   * sum. */
  line->at = (fg_point){a->circle.x + (x[0] + x[1]) * a->axis.x - x[2] * a->axis.y,
                        a->circle.y + (x[0] + x[1]) * a->axis.y + x[2] * a->axis.x};
  line->along = (fg_point){-a->axis.y, a->axis.x};
}

/* Mean cosine of the stations' directions from the circle's centre, which are evenly spaced. */
static double mean_cosine(const fg_beam_line *line) {
  size_t n = line->edge->count;
  fg_point a = station_at(line, 0)->at, b = station_at(line, n - 1)->at;
  double half = asin(fmin(1, 0.5 * hypot(b.x - a.x, b.y - a.y) / line->edge->radius_mm));
  double step = 2 * half / (double)(n - 1);
  return step > 0 ? sin(0.5 * (double)n * step) / ((double)n * sin(0.5 * step)) : 1;
}

/* Starts with the circle's known radius, whose centre lies towards the tip: the stations of a flat
 * end do not tell on which side it is. The centre must be near: the fit is linear in its move. */
static void start_apex(const fg_beam_line *line, fg_point axis, apex *a) {
  double n = (double)line->edge->count, x = 0, y = 0, radius = line->edge->radius_mm;
  double off = radius * mean_cosine(line);
  for (size_t i = 0; i < line->edge->count; i++) {
    x += station_at(line, i)->at.x / n;
    y += station_at(line, i)->at.y / n;
  }
  a->circle = (fg_circle){x + off * axis.x, y + off * axis.y, radius};
  a->axis = (fg_point){-axis.x, -axis.y};
}

static fg_status fit_rounds(fg_context *ctx, fg_point axis, double *off, double *scratch,
                            fg_beam_line *line) {
  apex a;
  if (line->edge->round) start_apex(line, axis, &a);
  for (int round = 0; round < ROUNDS; round++) {
    if (line->edge->round)
      fit_apex(line, &a, off);
    else
      fit_once(line);
    for (size_t i = 0; i < line->edge->count && !line->edge->round; i++)
      off[i] = place_across(line, station_at(line, i)->at);
    if (round + 1 < ROUNDS) use_within(line, off, find_limit(line, off, scratch));
    if (line->used < MIN_STATIONS || 2 * line->used < line->edge->count)
      return fg_fail(ctx, FG_ERR_NUMERIC, "only %zu of %zu stations of an edge are usable",
                     line->used, line->edge->count);
  }
  for (size_t i = 0; i < line->edge->count; i++)
    if (!isnan(line->across[i])) line->across[i] = off[i];
  return FG_OK;
}

fg_status fg_beam_line_fit(fg_context *ctx, const fg_beam_edge *edge, fg_point axis,
                           fg_beam_line *line) {
  double *block = NULL;
  fg_status status = FG_OK;
  *line = (fg_beam_line){.edge = edge, .spread = 1};
  FG_TRY_EXIT(fg_memory_allocate(ctx, edge->count, sizeof *line->across, (void **)&line->across));
  FG_TRY_EXIT(fg_memory_allocate(ctx, edge->count, 2 * sizeof *block, (void **)&block));
  use_within(line, block, INFINITY); /* block is all 0: the usable stations */
  line->usable = line->used;
  if (line->usable < MIN_STATIONS || 2 * line->usable < edge->count)
    status = fg_fail(ctx, FG_ERR_NUMERIC, "only %zu of %zu stations of an edge are usable",
                     line->usable, edge->count);
  else
    status = fit_rounds(ctx, axis, block, block + edge->count, line);
exit:
  free(block);
  if (status != FG_OK) fg_beam_line_free(line);
  return status;
}

void fg_beam_line_free(fg_beam_line *line) {
  free(line->across);
  *line = (fg_beam_line){0};
}

/* Weights of the stations' places across in a property of the line. */
typedef struct asked {
  const fg_beam_line *line;
  double half; /* length */
  double n, xx, mean_square, qq;
} asked;

static double relative_along(const asked *a, size_t i) {
  return place_along(a->line, station_at(a->line, i)->at) / a->half;
}

static void prepare_weights(const fg_beam_line *line, asked *a) {
  double low = INFINITY, high = -INFINITY;
  *a = (asked){.line = line, .half = 1};
  for (size_t i = 0; i < line->edge->count; i++) {
    if (isnan(line->across[i])) continue;
    low = fmin(low, relative_along(a, i));
    high = fmax(high, relative_along(a, i));
  }
  a->half = 0.5 * (high - low);
  for (size_t i = 0; i < line->edge->count; i++) {
    if (isnan(line->across[i])) continue;
    double x = relative_along(a, i);
    a->n++;
    a->xx += x * x;
  }
  a->mean_square = a->xx / a->n;
  for (size_t i = 0; i < line->edge->count; i++) {
    if (isnan(line->across[i])) continue;
    double x = relative_along(a, i), q = x * x - a->mean_square;
    a->qq += q * q;
  }
}

static double weight_of(const asked *a, size_t i, fg_beam_property ask, double along_mm) {
  double x = relative_along(a, i);
  if (isnan(a->line->across[i])) return 0;
  if (ask == FG_BEAM_PLACE) return 1 / a->n + along_mm / a->half * x / a->xx;
  if (ask == FG_BEAM_SLOPE) return x / (a->xx * a->half);
  return (x * x - a->mean_square) / a->qq;
}

double fg_beam_line_parabola(const fg_beam_line *line) {
  asked a;
  double sum = 0;
  prepare_weights(line, &a);
  for (size_t i = 0; i < line->edge->count; i++)
    if (!isnan(line->across[i])) sum += weight_of(&a, i, FG_BEAM_PARABOLA, 0) * line->across[i];
  return sum;
}

/* Weights of the apex of a round floor: a row of (J'J)^-1 J' for a + b of fit_apex. */
static bool weigh_apex(const fg_beam_line *line, double *weights) {
  fg_normal_equations system;
  double x[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX], half = 0;
  fg_normal_clear(&system, 3);
  for (size_t i = 0; i < line->edge->count; i++)
    half = fmax(half, fabs(place_along(line, station_at(line, i)->at)));
  for (int fill = 0; fill < 2; fill++) {
    for (size_t i = 0; i < line->edge->count; i++) {
      double s = place_along(line, station_at(line, i)->at) / half;
      const double row[3] = {1, s, s * s};
      weights[i] = 0;
      if (isnan(line->across[i])) continue;
      if (!fill) fg_normal_add(&system, row, 0, 1);
      for (int k = 0; k < 3 && fill; k++)
        weights[i] += inverse[0][k] * row[k];
    }
    if (!fill && !fg_normal_solve(&system, 0, x, inverse)) return false;
  }
  return true;
}

static double sum_covariance(const double *weights, size_t n, const fg_beam_noise *noise) {
  double sum = 0;
  for (size_t lag = 0; lag < noise->lags; lag++) {
    double products = 0;
    for (size_t i = 0; i + lag < n; i++)
      products += weights[i] * weights[i + lag];
    sum += (lag ? 2 : 1) * noise->covariance[lag] * products;
  }
  return fmax(sum, 0);
}

/* Variance of the mean place by the shape of an edge beside another one: few pixels tell its levels
 * and its blur. */
static double shape_variance(const fg_beam_line *line) {
  double more = line->edge->shape_ratio - SHAPE_VARIANCE, squares = 0, n = (double)line->used;
  if (!(more > 0)) return 0;
  for (size_t i = 0; i < line->edge->count; i++)
    if (!isnan(line->across[i])) squares += station_at(line, i)->u * station_at(line, i)->u;
  return more * squares / (n * n);
}

/* Stations that are shorter than those of the long edges have fewer pixels, and scatter more. */
static double shortness(const fg_beam_line *line, const fg_beam_noise *noise) {
  return fmax(1, noise->step_mm / step_of(line));
}

fg_status fg_beam_line_variance(fg_context *ctx, const fg_beam_line *line,
                                const fg_beam_noise *noise, fg_beam_property ask, double along_mm,
                                double *variance) {
  double *weights;
  asked a;
  FG_TRY(fg_memory_allocate(ctx, line->edge->count, sizeof *weights, (void **)&weights));
  prepare_weights(line, &a);
  for (size_t i = 0; i < line->edge->count; i++)
    weights[i] = weight_of(&a, i, ask, along_mm);
  bool good = !line->edge->round || weigh_apex(line, weights);
  double by_noise =
      SHAPE_VARIANCE * shortness(line, noise) * sum_covariance(weights, line->edge->count, noise);
  if (ask == FG_BEAM_PLACE) by_noise += shape_variance(line);
  *variance = good ? (1 + line->edge->loss_share) * line->spread * by_noise : NAN;
  free(weights);
  return FG_OK;
}

/* Scatter of a long edge: its residual without line and parabola. */
static double scatter_at(const asked *a, size_t i, double parabola) {
  double x = relative_along(a, i);
  return a->line->across[i] - parabola * (x * x - a->mean_square);
}

/* Share of its start down to which the correlation is extended. */
#define TAIL_SHARE 0.01
/* Values removed by lines and parabolas of two edges; min dof, and max correction. */
#define FITTED_VALUES 6.0
#define DOF_MIN       4.0
#define MADE_UP_MAX   2.0

typedef struct sums {
  double products[FG_BEAM_LAGS], pairs[FG_BEAM_LAGS];
  double block_squares, blocks, block_stations;
} sums;

static void add_block(const double *values, size_t n, size_t first, sums *s) {
  double sum = 0, used = 0;
  for (size_t i = first; i < first + BLOCK && i < n; i++) {
    if (isnan(values[i])) continue;
    sum += values[i];
    used++;
  }
  if (2 * used < BLOCK) return;
  s->block_squares += sum * sum / (used * used);
  s->block_stations += used;
  s->blocks++;
}

static void add_edge(const fg_beam_line *line, double *values, sums *s) {
  asked a;
  size_t n = line->edge->count;
  double parabola = fg_beam_line_parabola(line);
  prepare_weights(line, &a);
  for (size_t i = 0; i < n; i++)
    values[i] = scatter_at(&a, i, parabola);
  for (size_t lag = 0; lag < FG_BEAM_LAGS && lag < n; lag++)
    for (size_t i = 0; i + lag < n; i++) {
      if (isnan(values[i]) || isnan(values[i + lag])) continue;
      s->products[lag] += values[i] * values[i + lag];
      s->pairs[lag]++;
    }
  for (size_t first = 0; first < n; first += BLOCK)
    add_block(values, n, first, s);
}

/* Ratio of the scatter of means over blocks to the one by the lags alone. */
static double compare_blocks(const sums *s, const fg_beam_noise *noise) {
  double expected = 0, n = s->block_stations / s->blocks;
  if (s->blocks < BLOCKS_MIN) return 1;
  for (size_t lag = 0; lag < noise->lags && (double)lag < n; lag++)
    expected += (lag ? 2 : 1) * noise->covariance[lag] * (n - (double)lag) / (n * n);
  double ratio = s->block_squares / s->blocks / expected;
  return ratio > LONG_RANGE_MIN ? ratio : 1;
}

/* Number of values that count as one: the integral of the correlation. */
static double integral_of(const fg_beam_noise *noise) {
  double integral = 1;
  for (size_t lag = 1; lag < noise->lags; lag++)
    integral += 2 * noise->covariance[lag] / noise->covariance[0];
  return integral;
}

/* Extends the correlation after the last significant lag as an exponential of the lags' length. */
static void extend_correlation(fg_beam_noise *noise) {
  double length = 0.5 * (integral_of(noise) - 1), ratio = length / (1 + length);
  if (noise->lags < 2) return;
  while (noise->lags < FG_BEAM_LAGS &&
         noise->covariance[noise->lags - 1] > TAIL_SHARE * noise->covariance[0]) {
    noise->covariance[noise->lags] = ratio * noise->covariance[noise->lags - 1];
    noise->lags++;
  }
}

/* Corrects for few dof. A line and a parabola removed three of the independent values of either
 * edge, and few values do not determine their variance well: Student's factor makes 2 u mean 95 %
 * all the same. */
static void correct_for_dof(double stations, fg_beam_noise *noise) {
  double count = stations / integral_of(noise), dof = fmax(count - FITTED_VALUES, DOF_MIN);
  double student = gsl_cdf_tdist_Pinv(0.975, dof) / 1.959964;
  for (size_t lag = 0; lag < noise->lags; lag++)
    noise->covariance[lag] *= fmin(count / dof, MADE_UP_MAX) * student * student;
}

fg_status fg_beam_noise_find(fg_context *ctx, const fg_beam_line *left, const fg_beam_line *right,
                             fg_beam_noise *noise) {
  sums s = {0};
  size_t n = left->edge->count > right->edge->count ? left->edge->count : right->edge->count;
  double *values;
  *noise = (fg_beam_noise){.long_range = 1, .step_mm = 0.5 * (step_of(left) + step_of(right))};
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *values, (void **)&values));
  add_edge(left, values, &s);
  add_edge(right, values, &s);
  free(values);
  noise->lags = fg_correlation_lags(s.products, s.pairs, FG_BEAM_LAGS);
  for (size_t lag = 0; lag < noise->lags; lag++)
    noise->covariance[lag] = s.products[lag] / s.pairs[lag];
  extend_correlation(noise);
  noise->long_range = compare_blocks(&s, noise);
  correct_for_dof(s.pairs[0], noise);
  return FG_OK;
}

double fg_beam_noise_length(const fg_beam_noise *noise) {
  return integral_of(noise) * noise->step_mm;
}
