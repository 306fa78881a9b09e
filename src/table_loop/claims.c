/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coefficients and uncertainties of the effects found, shapes included. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "core/memory.h"
#include "table_loop/between.h"
#include "table_loop/departures.h"
#include "table_loop/fit.h"
#include "table_loop/order_fits.h"

/* d(effect)/d(shape) at fixed coefficients: columns × n, where the shape may move by small steps.
 */
static fg_status shape_slope(fg_context *ctx, const fg_engine_training *training,
                             const fg_loop_candidate *candidate, const double *shape, size_t d,
                             const double *beta, double *slope) {
  size_t count = fg_engine_candidate_columns(training->problem, candidate), n = training->n;
  double *columns = NULL, moved[FG_LOOP_SHAPES];
  double step = shape[d] != 0 ? 1e-4 * fabs(shape[d]) : 1e-12;
  FG_TRY(fg_memory_allocate(ctx, n, count * sizeof *columns, (void **)&columns));
  fg_status status = FG_OK;
  memset(slope, 0, n * sizeof *slope);
  for (int side = -1; side <= 1 && status == FG_OK; side += 2) {
    memcpy(moved, shape, sizeof moved);
    moved[d] += side * step;
    status = fg_engine_gather(ctx, training, candidate, moved, columns);
    for (size_t k = 0; k < count; k++)
      for (size_t i = 0; i < n; i++)
        slope[i] += side * beta[k] * columns[k * n + i] / (2 * step);
  }
  free(columns);
  return status;
}

/* Returns the number of shapes that the fit has moved by small steps. */
static size_t moved_shapes(const fg_loop_effect *effect) {
  return effect->stepwise || effect->held ? 0 : effect->shapes;
}

/* The training's columns and, behind them, the slopes of all shapes. */
static fg_status append_slopes(fg_context *ctx, fg_engine_training *training,
                               const fg_engine_set *set, const fg_engine_fit *fit) {
  size_t n = training->n, extra = 0, first = training->problem->parameters;
  for (size_t m = 0; m < set->count; m++)
    extra += moved_shapes(set->candidate[m].effect);
  if (extra == 0) return FG_OK;
  double *x = NULL;
  FG_TRY(fg_memory_allocate(ctx, n, (training->columns + extra) * sizeof *x, (void **)&x));
  memcpy(x, training->x, n * training->columns * sizeof *x);
  free(training->x);
  training->x = x;
  for (size_t m = 0; m < set->count; m++) {
    const fg_loop_effect *effect = set->candidate[m].effect;
    for (size_t d = 0; d < moved_shapes(effect); d++)
      FG_TRY(shape_slope(ctx, training, &set->candidate[m], set->shape[m], d, fit->beta + first,
                         x + n * training->columns++));
    if (!fg_engine_is_exchange(&set->candidate[m]) && !fg_engine_is_noise(&set->candidate[m]))
      first += fg_engine_candidate_columns(training->problem, &set->candidate[m]);
  }
  return FG_OK;
}

/* Computes half the range over the rows, with extremes at rows a and b; its gradient by the
 * coefficients (and shapes) is half the difference of the columns there. */
static void amplitude(const fg_engine_training *training, const fg_engine_fit *fit,
                      const fg_engine_fit *wide, size_t first, size_t count, size_t slope,
                      size_t slopes, double variance, fg_loop_claim *claim) {
  size_t n = training->n, low = 0, high = 0, index[FG_LOOP_COLUMNS + FG_LOOP_SHAPES];
  double lowest = INFINITY, highest = -INFINITY, gradient[FG_LOOP_COLUMNS + FG_LOOP_SHAPES];
  for (size_t i = 0; i < n; i++) {
    double value = 0;
    for (size_t k = first; k < first + count; k++)
      value += fit->beta[k] * training->x[k * n + i];
    if (value < lowest) lowest = value, low = i;
    if (value > highest) highest = value, high = i;
  }
  for (size_t k = 0; k < count + slopes; k++) {
    index[k] = k < count ? first + k : slope + k - count;
    gradient[k] = (training->x[index[k] * n + high] - training->x[index[k] * n + low]) / 2;
  }
  double sum = 0;
  for (size_t i = 0; i < count + slopes; i++)
    for (size_t k = 0; k < count + slopes; k++)
      sum += gradient[i] * gradient[k] * wide->inverse[index[i] * wide->columns + index[k]];
  claim->amplitude = (highest - lowest) / 2;
  claim->amplitude_u = sqrt(fmax(sum, 0) * variance);
}

/* Slopes of levels are the coefficients, and of the last level less their sum. Returns u of the
 * difference of the largest and the smallest. */
static double difference_of_slopes(const fg_engine_fit *fit, const fg_engine_fit *wide,
                                   size_t first, size_t count, double variance) {
  size_t low = count, high = count;
  double lowest = 0, highest, sum = 0;
  for (size_t k = 0; k < count; k++)
    lowest -= fit->beta[first + k];
  highest = lowest;
  for (size_t k = 0; k < count; k++) {
    double slope = fit->beta[first + k];
    if (slope < lowest) lowest = slope, low = k;
    if (slope > highest) highest = slope, high = k;
  }
  for (size_t i = 0; i < count; i++)
    for (size_t k = 0; k < count; k++) {
      double of_i = (high == count ? -1 : high == i) - (low == count ? -1 : low == i);
      double of_k = (high == count ? -1 : high == k) - (low == count ? -1 : low == k);
      sum += of_i * of_k * wide->inverse[(first + i) * wide->columns + first + k];
    }
  return sqrt(fmax(sum, 0) * variance);
}

/* Share of the 5 % that lie beyond the interval of the highest level above the lowest of `levels`.
 * Both are chosen by the data: with about half of the levels alike at either end, chance has that
 * many differences to choose from. Student's t at this share holds 95 to 98 % of them from 4 to 7
 * levels, whether one level stands out, two, half of them, or none; t itself holds 92 to 82 %. */
static double share_of_extremes(size_t levels) {
  return levels > 3 ? 8 / ((double)(levels * levels) - 1) : 1;
}

/* Does the claim compare the extremes of several levels? */
static bool compares_levels(const fg_loop_candidate *candidate) {
  return candidate->effect->reads == FG_LOOP_READS_LEVELS ||
         candidate->effect->reads == FG_LOOP_READS_SLOPES;
}

/* The noise as it was estimated, and a row's sd. */
typedef struct noise_fit {
  fg_engine_noise at;
  double sd;
} noise_fit;

/* Single rows are taken out or exchanged, and the scatter weighs rows: none of them is fitted by
 * columns that could be constant in groups. */
static bool has_columns(const fg_loop_candidate *candidate) {
  return !fg_engine_is_outlier(candidate) && !fg_engine_is_exchange(candidate) &&
         !fg_engine_is_noise(candidate);
}

/* Columns that are constant in groups are tested between groups, with as many fewer dof. */
static double dof_of(const fg_engine_training *training, size_t first, size_t count, double dof) {
  const double *x = training->x + first * training->n;
  if (!training->levels || !fg_engine_constant_in_levels(training, x, count)) return dof;
  double levels = (double)training->levels, outers = (double)training->outers;
  if (fg_engine_constant_in_outer_levels(training, x, count))
    levels = outers;
  else if (training->outers)
    levels -= outers - 1;
  return fmax(levels - 1 - (double)count, 1);
}

/* Variance of the mean of a group's rows beside its level, over their own variance, on average. */
static double mean_of_rows(const fg_engine_training *training) {
  double sum = 0;
  for (size_t b = 0; b < training->levels; b++)
    sum += 1 / (double)(training->level_start[b + 1] - training->level_start[b]);
  return sum / (double)training->levels;
}

/* Variance of the weighted mean of an outer level's groups, in the same unit, on average. */
static double mean_of_groups(const fg_engine_training *training, double lambda) {
  double sum = 0;
  for (size_t o = 0; o < training->outers; o++) {
    double weight = 0;
    for (size_t k = training->outer_start[o]; k < training->outer_start[o + 1]; k++) {
      const size_t *start = training->level_start + training->outer_block[k];
      weight += 1 / (lambda + 1 / (double)(start[1] - start[0]));
    }
    sum += 1 / weight;
  }
  return sum / (double)training->outers;
}

/* Describes the sd of random levels: of a mean square between them less one of what lies within,
 * each with its dof (Satterthwaite 1946). */
static void describe_levels(const fg_engine_training *training, const noise_fit *noise, double dof,
                            fg_loop_claim *claim) {
  double row = noise->sd * noise->sd, levels = (double)training->levels;
  double within_dof = dof - levels + 1, between_dof = levels - 1;
  double variance = row * noise->at.lambda, within = row * mean_of_rows(training);
  bool outer = training->outers && fg_engine_is_outer_levels(training, &claim->candidate);
  if (outer) {
    variance = row * noise->at.outer;
    within = row * mean_of_groups(training, noise->at.lambda);
    between_dof = (double)training->outers - 1;
    within_dof = levels - (double)training->outers;
  } else if (training->outers) {
    between_dof = levels - (double)training->outers;
  }
  between_dof = fmax(fmin(between_dof, dof - 1), 1);
  double u =
      sqrt(2 * (pow(variance + within, 2) / between_dof + within * within / fmax(within_dof, 1)));
  double own = 2 * variance * variance / (u * u), sd = sqrt(variance);
  claim->noise_value = claim->amplitude = sd;
  claim->noise_value_u = claim->amplitude_u = sd > 0 ? u / (2 * sd) : NAN;
  if (!(own > 0)) return;
  claim->interval[0] = sd * sqrt(own / gsl_cdf_chisq_Qinv(0.025, own));
  claim->interval[1] = sd * sqrt(own / gsl_cdf_chisq_Pinv(0.025, own));
}

/* Describes correlation, or the ratio of the rows' extreme sd; the amplitude is half their
 * difference in the response's unit. Uncertainties are asymptotic. */
static void describe_noise(const fg_engine_training *training, const noise_fit *noise, double dof,
                           fg_loop_claim *claim) {
  double n = (double)training->n, low = INFINITY, high = 0;
  claim->interval[0] = claim->interval[1] = claim->amplitude = claim->amplitude_u = NAN;
  if (fg_engine_is_serial(&claim->candidate)) {
    claim->noise_value = noise->at.rho;
    claim->noise_value_u = sqrt((1 - noise->at.rho * noise->at.rho) / n);
    return;
  }
  if (fg_engine_is_levels(&claim->candidate)) {
    describe_levels(training, noise, dof, claim);
    return;
  }
  for (size_t i = 0; i < training->n; i++) {
    low = fmin(low, training->scale[i]);
    high = fmax(high, training->scale[i]);
  }
  claim->noise_value = high / low;
  claim->noise_value_u = claim->noise_value * sqrt(2 / n);
  claim->amplitude = noise->sd * (high - low) / 2;
}

static void describe_claims(const fg_engine_training *training, const fg_engine_fit *fit,
                            const fg_engine_fit *wide, const fg_engine_set *set,
                            const noise_fit *noise, double dof, fg_loop_claim *claim) {
  double variance = noise->sd * noise->sd;
  size_t first = training->problem->parameters, slope = fit->columns;
  for (size_t m = 0; m < set->count; m++) {
    const fg_loop_candidate *candidate = &set->candidate[m];
    const fg_loop_effect *effect = candidate->effect;
    size_t slopes = moved_shapes(effect);
    size_t count = fg_engine_candidate_columns(training->problem, candidate);
    double own = has_columns(candidate) ? dof_of(training, first, count, dof) : dof;
    double share = compares_levels(candidate) ? share_of_extremes(count + 1) : 1;
    double t = gsl_cdf_tdist_Qinv(0.025 * share, own);
    memcpy(claim[m].shape, set->shape[m], sizeof claim[m].shape);
    claim[m].candidate = *candidate;
    if (fg_engine_is_noise(candidate)) {
      describe_noise(training, noise, dof, &claim[m]);
      continue;
    }
    claim[m].columns = count;
    if (fg_engine_is_exchange(candidate)) {
      const double *response = training->problem->response;
      claim[m].coefficient[0] = (response[candidate->row[0]] - response[candidate->row[1]]) / 2;
      claim[m].amplitude = fabs(claim[m].coefficient[0]);
      claim[m].amplitude_u = claim[m].coefficient_u[0] = sqrt(variance / 2);
    } else {
      for (size_t k = 0; k < count; k++) {
        size_t at = first + k;
        claim[m].coefficient[k] = fit->beta[at];
        claim[m].coefficient_u[k] = sqrt(variance * wide->inverse[at * wide->columns + at]);
      }
      amplitude(training, fit, wide, first, count, slope, slopes, variance, &claim[m]);
      claim[m].slopes_u = difference_of_slopes(fit, wide, first, count, variance);
      if (fg_engine_is_outlier(candidate) || effect->from_zero) {
        claim[m].amplitude = fabs(claim[m].coefficient[0]);
        claim[m].amplitude_u = claim[m].coefficient_u[0];
      }
      const fg_engine_cycle_place place = {first, slope, slopes > 0, variance};
      if (effect->cycle) fg_engine_describe_orders(training->problem, wide, &place, &claim[m]);
      first += count;
    }
    for (size_t d = 0; d < effect->shapes; d++)
      claim[m].shape_u[d] =
          d < slopes     ? sqrt(variance * wide->inverse[(slope + d) * wide->columns + slope + d])
          : effect->held ? 0
                         : NAN;
    slope += slopes;
    claim[m].interval[0] = claim[m].amplitude - t * claim[m].amplitude_u;
    claim[m].interval[1] = claim[m].amplitude + t * claim[m].amplitude_u;
  }
}

fg_status fg_engine_fit_claims(fg_context *ctx, const fg_loop_problem *problem, const bool *keep,
                               const fg_engine_set *set, fg_engine_noise noise,
                               fg_loop_claim *claim, double *parameter, double *parameter_u) {
  fg_status status = FG_OK;
  fg_engine_training training = {0};
  fg_engine_fit fit = {0}, wide = {0};
  FG_TRY_EXIT(fg_engine_training_build(ctx, problem, keep, set, &training));
  FG_TRY_EXIT(fg_engine_least_squares(ctx, &training, noise, &fit));
  FG_TRY_EXIT(append_slopes(ctx, &training, set, &fit));
  FG_TRY_EXIT(fg_engine_least_squares(ctx, &training, noise, &wide));
  FG_TRY_EXIT(fg_engine_take_departures(ctx, &training, set, &fit));
  FG_TRY_EXIT(fg_engine_take_departures(ctx, &training, set, &wide));
  /* The correlation was estimated too. */
  size_t used = wide.rank + training.serial;
  double dof = training.n > used ? (double)(training.n - used) : NAN;
  double variance = fit.rss / dof;
  const noise_fit row = {noise, sqrt(variance)};
  describe_claims(&training, &fit, &wide, set, &row, dof, claim);
  for (size_t k = 0; k < problem->parameters; k++) {
    parameter[k] = fit.beta[k];
    parameter_u[k] = sqrt(variance * wide.inverse[k * wide.columns + k]);
  }
exit:
  fg_engine_fit_free(&fit);
  fg_engine_fit_free(&wide);
  fg_engine_training_free(&training);
  return status;
}
