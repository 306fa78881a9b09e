/* SPDX-License-Identifier: GPL-3.0-or-later */
/* With A = W'MW the residual sum is y'Ay. Exchanging the responses of i and j, d apart, changes it
 * by 2 d (Ay_i - Ay_j) + d² (A_ii + A_jj - 2 A_ij). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "table_loop/assess.h"

/* An exchange that changes less of the residual sum than this changes rounding. */
#define CHANGES 1e-6
/* Number of rows of either sign with the largest residuals that are tried: a useful exchange
 * reduces both. */
enum { TRIED = 16 };

static fg_status fill_products(fg_context *ctx, fg_engine_exchange *exchange) {
  const fg_engine_training *training = exchange->training;
  size_t n = exchange->n;
  double *work = NULL;
  FG_TRY(fg_memory_allocate(ctx, n, n * sizeof *work, (void **)&work));
  for (size_t i = 0; i < n; i++) {
    double *v = work + i * n;
    v[i] = 1;
    fg_engine_whiten(training, exchange->noise, v);
    fg_engine_project_out(n, exchange->null->basis, exchange->null->rank, v);
  }
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j <= i; j++) {
      double sum = 0;
      for (size_t k = 0; k < n; k++)
        sum += work[i * n + k] * work[j * n + k];
      exchange->a[i * n + j] = exchange->a[j * n + i] = sum;
    }
  free(work);
  return FG_OK;
}

/* Computes the response expected by the null: the measured response less the residual. */
static fg_status fill_mean(fg_context *ctx, fg_engine_exchange *exchange) {
  const fg_engine_training *training = exchange->training;
  fg_engine_fit fit;
  FG_TRY(fg_engine_least_squares(ctx, training, exchange->noise, &fit));
  fg_engine_fit_residual(training, &fit, exchange->mean);
  for (size_t i = 0; i < training->n; i++)
    exchange->mean[i] = fg_engine_response(training, i) - exchange->mean[i];
  fg_engine_fit_free(&fit);
  return FG_OK;
}

fg_status fg_engine_exchange_open(fg_context *ctx, const fg_engine_training *training,
                                  fg_engine_noise noise, const fg_engine_span *null,
                                  fg_engine_exchange *exchange) {
  size_t n = training->n;
  fg_status status = FG_OK;
  *exchange = (fg_engine_exchange){.training = training, .noise = noise, .null = null, .n = n};
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, sizeof *exchange->a, (void **)&exchange->mean));
  if (!fg_engine_independent(noise)) {
    FG_TRY_EXIT(fg_memory_allocate(ctx, n, n * sizeof *exchange->a, (void **)&exchange->a));
    FG_TRY_EXIT(fill_products(ctx, exchange));
  }
  FG_TRY_EXIT(fill_mean(ctx, exchange));
exit:
  if (status != FG_OK) fg_engine_exchange_close(exchange);
  return status;
}

void fg_engine_exchange_close(fg_engine_exchange *exchange) {
  free(exchange->a);
  free(exchange->mean);
  *exchange = (fg_engine_exchange){0};
}

static double scale_of(const fg_engine_exchange *exchange, size_t i) {
  return exchange->training->scale ? exchange->training->scale[i] : 1;
}

/* A_ij. */
static double product(const fg_engine_exchange *exchange, size_t i, size_t j) {
  size_t n = exchange->n;
  if (exchange->a) return exchange->a[i * n + j];
  double sum = i == j;
  for (size_t k = 0; k < exchange->null->rank; k++)
    sum -= exchange->null->basis[k * n + i] * exchange->null->basis[k * n + j];
  return sum / (scale_of(exchange, i) * scale_of(exchange, j));
}

static double apply_independent(const fg_engine_exchange *exchange, const double *y, double *ay) {
  size_t n = exchange->n;
  for (size_t i = 0; i < n; i++)
    ay[i] = y[i] / scale_of(exchange, i);
  double sum = fg_engine_project_out(n, exchange->null->basis, exchange->null->rank, ay);
  for (size_t i = 0; i < n; i++)
    ay[i] /= scale_of(exchange, i);
  return sum;
}

/* ay = A y, and y'Ay. */
static double apply_quadratic(const fg_engine_exchange *exchange, const double *y, double *ay) {
  double sum = 0;
  if (!exchange->a) return apply_independent(exchange, y, ay);
  for (size_t i = 0; i < exchange->n; i++) {
    ay[i] = 0;
    for (size_t k = 0; k < exchange->n; k++)
      ay[i] += exchange->a[i * exchange->n + k] * y[k];
  }
  for (size_t i = 0; i < exchange->n; i++)
    sum += ay[i] * y[i];
  return sum;
}

/* The rows with the largest ay times sign, descending. */
static size_t largest(size_t n, const double *ay, double sign, size_t row[TRIED]) {
  size_t count = 0;
  for (size_t i = 0; i < n; i++) {
    double value = sign * ay[i];
    if (count == TRIED && value <= sign * ay[row[TRIED - 1]]) continue;
    size_t k = count < TRIED ? count++ : TRIED - 1;
    for (; k > 0 && sign * ay[row[k - 1]] < value; k--)
      row[k] = row[k - 1];
    row[k] = i;
  }
  return count;
}

double fg_engine_exchange_best(const fg_engine_exchange *exchange, const double *y,
                               const double *response, double *work, size_t row[2]) {
  size_t n = exchange->n, high[TRIED], low[TRIED];
  double rss = apply_quadratic(exchange, y, work), best = INFINITY;
  size_t highs = largest(n, work, 1, high), lows = largest(n, work, -1, low);
  for (size_t p = 0; p < highs; p++)
    for (size_t q = 0; q < lows; q++) {
      size_t i = high[p], j = low[q];
      if (i == j) continue;
      double d = response[j] - response[i];
      double change =
          2 * d * (work[i] - work[j]) +
          d * d * (product(exchange, i, i) + product(exchange, j, j) - 2 * product(exchange, i, j));
      double ratio = fmax(1 + change / rss, FG_ENGINE_RATIO_MIN);
      if (!(ratio < fmin(best, 1 - CHANGES))) continue;
      best = ratio;
      row[0] = i < j ? i : j;
      row[1] = i < j ? j : i;
    }
  return best;
}
