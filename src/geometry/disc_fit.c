/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "geometry/disc_fit.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/small_solve.h"
#include "core/spread.h"

enum { ROUNDS = 4, BAND_FIRST = 12, HARMONICS_MAX = 400 };
/* Limits of an outlier: robust deviations, and a distance. */
#define OUTLIER_DEVIATIONS 5.0
#define OUTLIER_MIN_MM     0.0003
#define OUTLIERS_SHARE     0.01
/* Max probability of chance at which neighbouring bands of the spectrum have different levels. */
#define BAND_P 0.01
/* Factor of the variance by the edge's shape. It was fitted to the same pixels, so its noise moves
 * whole turns of stations together, invisibly in their spectrum. Measured on renders. */
#define SHAPE_VARIANCE 1.12
/* Min difference between the edge's core and flanks, in its own deviations. */
#define SPLIT_DEVIATIONS 3.0
/* Max rms deviation from the circle, as a share of the radius; beyond it an edge is flagged. */
#define POOR_SHARE 0.006

typedef struct fit_work {
  fg_disc_point *points;
  size_t count, used;
  fg_point *at;    /* of the points */
  double *weights; /* 0: not used; mean 1 over those used */
  double *residuals;
  double *scratch;
  fg_circle_fit fit;
} fit_work;

static void find_residuals(fit_work *w) {
  const fg_circle *c = &w->fit.circle;
  for (size_t i = 0; i < w->count; i++)
    w->residuals[i] = hypot(w->at[i].x - c->x, w->at[i].y - c->y) - c->radius;
}

/* Robust sd of the residuals in the fit. */
static double residual_scatter(fit_work *w) {
  size_t n = 0;
  for (size_t i = 0; i < w->count; i++)
    if (w->points[i].used) w->scratch[n++] = fabs(w->residuals[i]);
  return fg_robust_sd(w->scratch, n);
}

/* Weights 1/(u² + s²): s is the edge's own scatter, beyond the pixels' noise. */
static void weigh_stations(fit_work *w, double scatter) {
  size_t n = 0;
  for (size_t i = 0; i < w->count; i++)
    if (w->points[i].used) w->scratch[n++] = w->points[i].u * w->points[i].u;
  double noise = fg_upper_median(w->scratch, n), rough = fmax(0, scatter * scatter - noise),
         sum = 0;
  for (size_t i = 0; i < w->count; i++) {
    double u = w->points[i].u;
    w->weights[i] = w->points[i].used ? 1 / (u * u + rough + 1e-16) : 0;
    sum += w->weights[i];
  }
  for (size_t i = 0; i < w->count; i++)
    w->weights[i] *= (double)n / sum;
  w->used = n;
}

static fg_status fit_robust(fg_context *ctx, fit_work *w) {
  double scatter = 0;
  size_t min = w->count / 2;
  for (int round = 0; round < ROUNDS; round++) {
    weigh_stations(w, scatter);
    if (w->used < min || w->used < 8)
      return fg_fail(ctx, FG_ERR_NUMERIC, "only %zu of %zu points of the edge are usable", w->used,
                     w->count);
    FG_TRY(fg_circle_fit_geometric(ctx, w->at, w->weights, w->count, NULL, &w->fit));
    find_residuals(w);
    scatter = residual_scatter(w);
    double limit = fmax(OUTLIER_DEVIATIONS * scatter, OUTLIER_MIN_MM);
    for (size_t i = 0; i < w->count && round + 1 < ROUNDS; i++)
      w->points[i].used = w->points[i].used && fabs(w->residuals[i]) <= limit;
  }
  return FG_OK;
}

/* Mean power of harmonics [from, to) of the weighted residuals: the variance, if they were white.
 */
static double band_power(const fit_work *w, size_t from, size_t to) {
  double total = 0;
  for (size_t k = from; k < to; k++) {
    double re = 0, im = 0, turn = 2 * M_PI * (double)k / (double)w->count;
    for (size_t i = 0; i < w->count; i++) {
      if (w->weights[i] == 0) continue;
      double z = w->residuals[i] * sqrt(w->weights[i]);
      re += z * cos(turn * (double)i);
      im += z * sin(turn * (double)i);
    }
    total += (re * re + im * im) / (double)w->used;
  }
  return total / (double)(to - from);
}

/* Level of the spectrum at its low end, as a variance per point: over the lowest band, widened
 * while the next band (of twice the width) has the same level. Student's factor corrects for the
 * few harmonics, so that twice the deviation still means 95 %. */
static double low_level(const fit_work *w) {
  size_t max = w->count / 2 < HARMONICS_MAX ? w->count / 2 : HARMONICS_MAX, first = 2;
  size_t width = max - first < BAND_FIRST ? max - first : BAND_FIRST;
  double level = band_power(w, first, first + width);
  while (first + 2 * width <= max) {
    size_t end = first + 3 * width < max ? first + 3 * width : max;
    double n1 = 2 * (double)width, n2 = 2 * (double)(end - first - width);
    double next = band_power(w, first + width, end), ratio = next / level;
    if (gsl_cdf_fdist_P(ratio, n2, n1) < BAND_P || gsl_cdf_fdist_Q(ratio, n2, n1) < BAND_P) break;
    level = (n1 * level + n2 * next) / (n1 + n2);
    width = end - first;
  }
  double student = gsl_cdf_tdist_Pinv(0.975, 2 * (double)width) / 1.959964;
  return level * student * student;
}

/* Adds the move of the parameters if the difference of the edge's core and flanks were an error of
 * the edge, where it is more than its own noise; `excess` is the ratio of the spectrum's low end to
 * white pixel noise. */
static void add_split(const fit_work *w, double excess, double covariance[3][3]) {
  fg_normal_equations system;
  double row[3], x[FG_SMALL_MAX], inverse[FG_SMALL_MAX][FG_SMALL_MAX];
  const fg_circle *c = &w->fit.circle;
  fg_normal_clear(&system, 3);
  for (size_t i = 0; i < w->count; i++) {
    const fg_disc_point *p = &w->points[i];
    if (!p->used || !isfinite(p->split) || !(p->u_split > 0)) continue;
    double d = hypot(p->at.x - c->x, p->at.y - c->y);
    row[0] = (p->at.x - c->x) / d;
    row[1] = (p->at.y - c->y) / d;
    row[2] = 1;
    fg_normal_add(&system, row, p->split, 1 / (p->u_split * p->u_split));
  }
  if (!fg_normal_solve(&system, 0, x, inverse)) return;
  for (int i = 0; i < 3; i++) {
    double variance = inverse[i][i] * fmax(1, excess);
    if (x[i] * x[i] > SPLIT_DEVIATIONS * SPLIT_DEVIATIONS * variance)
      covariance[i][i] += x[i] * x[i] - variance;
  }
}

static double mean_noise(const fit_work *w) {
  double sum = 0;
  for (size_t i = 0; i < w->count; i++)
    if (w->points[i].used) sum += w->points[i].u * w->points[i].u * w->weights[i];
  return sum / (double)w->used;
}

static void fill_circle(const fit_work *w, double level_u_mm, fg_disc *disc) {
  double level = SHAPE_VARIANCE * (1 + disc->loss_variance) * low_level(w);
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      disc->covariance[p][q] = level * w->fit.covariance[p][q];
  add_split(w, level / mean_noise(w), disc->covariance);
  disc->covariance[2][2] += level_u_mm * level_u_mm;
  const fg_circle *c = &w->fit.circle;
  disc->centre_mm = (fg_point){c->x, c->y};
  disc->radius_mm = c->radius;
  disc->diameter_mm = 2 * c->radius;
  for (int i = 0; i < 2; i++)
    disc->u_centre_mm[i] = sqrt(disc->covariance[i][i]);
  disc->u_radius_mm = sqrt(disc->covariance[2][2]);
  disc->u_diameter_mm = 2 * disc->u_radius_mm;
  disc->rms_um = 1000 * w->fit.rms;
  disc->coverage_deg = 360 * (double)w->used / (double)w->count;
}

/* Bridges gaps in the residuals: linear between the usable neighbours. */
static void bridge_gaps(fit_work *w) {
  size_t first = 0, n = w->count;
  while (first < n && !w->points[first].used)
    first++;
  size_t last = first;
  for (size_t k = 1; k <= n && first < n; k++) {
    size_t i = (first + k) % n, gap = (i + n - last) % n;
    if (!w->points[i].used) continue;
    for (size_t j = 1; j < gap; j++)
      w->residuals[(last + j) % n] =
          w->residuals[last] + (w->residuals[i] - w->residuals[last]) * (double)j / (double)gap;
    last = i;
  }
}

static fg_status fill_roundness(fg_context *ctx, fit_work *w, fg_disc *disc) {
  double roundness, u_roundness, sum = 0;
  for (size_t i = 0; i < w->count; i++)
    if (w->points[i].used) sum += w->points[i].u * w->points[i].u;
  bridge_gaps(w);
  FG_TRY(fg_roundness(ctx, w->residuals, w->count, sqrt(sum / (double)w->used), &roundness,
                      &u_roundness));
  disc->roundness_um = 1000 * roundness;
  disc->u_roundness_um = 1000 * u_roundness;
  return FG_OK;
}

static fg_status fill_points(fg_context *ctx, const fit_work *w, fg_disc *disc) {
  size_t n = 0;
  FG_TRY(fg_memory_allocate(ctx, w->used, sizeof *disc->edge, (void **)&disc->edge));
  FG_TRY(fg_memory_allocate(ctx, w->used, sizeof *disc->residual_um, (void **)&disc->residual_um));
  for (size_t i = 0; i < w->count; i++) {
    if (!w->points[i].used) continue;
    disc->edge[n] = w->at[i];
    disc->residual_um[n++] = (float)(1000 * w->residuals[i]);
  }
  disc->points = n;
  return FG_OK;
}

/* Fills the circle, covariance, roundness, rms, coverage, points, edge and residuals of `disc`,
 * FG_BUMP_OUTLIERS and FG_BUMP_POOR_FIT. `points` are in order; a point outside of the fit loses
 * its `used`. `level_u_mm` adds to the radius' uncertainty. FG_ERR_NUMERIC when fewer than half of
 * the points are usable. */
static fg_status fit_disc(fg_context *ctx, fg_disc_point *points, size_t count, double level_u_mm,
                          fg_disc *disc) {
  fit_work w = {.points = points, .count = count};
  double *block = NULL;
  size_t usable = 0;
  fg_status status = FG_OK;
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, 3 * sizeof *block, (void **)&block));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *w.at, (void **)&w.at));
  w.weights = block;
  w.residuals = block + count;
  w.scratch = block + 2 * count;
  for (size_t i = 0; i < count; i++) {
    w.at[i] = points[i].at;
    usable += points[i].used;
  }
  FG_TRY_EXIT(fit_robust(ctx, &w));
  if ((double)(usable - w.used) > OUTLIERS_SHARE * (double)usable) disc->flags |= FG_BUMP_OUTLIERS;
  fill_circle(&w, level_u_mm, disc);
  disc->radius_correction_mm = disc->u_radius_correction_mm = NAN;
  if (disc->rms_um > POOR_SHARE * 1000 * disc->radius_mm) disc->flags |= FG_BUMP_POOR_FIT;
  FG_TRY_EXIT(fill_points(ctx, &w, disc));
  FG_TRY_EXIT(fill_roundness(ctx, &w, disc));
exit:
  free(block);
  free(w.at);
  return status;
}

fg_status fg_disc_measure_again(fg_context *ctx, fg_disc *disc) {
  fg_disc_point *points;
  FG_TRY(fg_memory_allocate(ctx, disc->station_count, sizeof *points, (void **)&points));
  memcpy(points, disc->stations, disc->station_count * sizeof *points);
  free(disc->edge);
  free(disc->residual_um);
  disc->edge = NULL;
  disc->residual_um = NULL;
  disc->flags &= ~(unsigned)(FG_BUMP_OUTLIERS | FG_BUMP_POOR_FIT);
  fg_status status = fit_disc(ctx, points, disc->station_count, disc->level_u_mm, disc);
  free(points);
  return status;
}
