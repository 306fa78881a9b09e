/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Residual tests behind the verdict `clean`, beside all effects sought by name. Repeated runs show
 * deviations of their means from the model (lack of fit). Rows further apart than neighbours show a
 * pattern along the order that no listed effect describes (Ljung and Box 1978, each lag scaled by
 * its own products). Both are compared with residuals in another order. */
#include "table_loop/residual_tests.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "core/memory.h"
#include "core/splitmix.h"
#include "table_loop/run.h"

/* Level of all residual tests together. The effects sought by name use most of FG_LOOP_ACCEPT_P. */
#define RESIDUAL_TESTS_P 0.0015
/* Lags of the sum (a tenth of the usual n / 2 would miss a week, all would hide it), and of a
 * single lag: a month of days, five years of months. */
enum { SUM_LAGS = 10, SUM_SHARE = 5, ONE_LAGS = 60, ONE_SHARE = 4 };
/* Maximum number of draws; they end when every test has been exceeded so often (Besag and Clifford
 * 1991). */
enum { DRAWS = 3999, SURPASSED = 20 };
/* As in judge.c: with fewer rows beyond the parameters a new order is no new sample. */
enum { PERMUTED_DOF = 12 };
#define RESIDUAL_TESTS_SEED 0x9e3779b97f4a7c15u

typedef struct residual_tests {
  fg_engine_training training;
  fg_engine_noise noise;
  fg_engine_span null;
  size_t sum_lags, one_lags; /* 0: the rows have no order */
  double *white, *kept;      /* the residual; each row's at its own variance */
  fg_engine_cells cells[2];  /* of the declared settings; of all that are recorded */
} residual_tests;

static bool has_order(const fg_engine_run *run) {
  for (size_t c = run->means; c < run->candidates; c++)
    if (fg_engine_is_serial(&run->candidate[c])) return true;
  return false;
}

static size_t smaller(size_t a, size_t b) {
  return a < b ? a : b;
}

static void choose_lags(residual_tests *b) {
  size_t longest = 0;
  for (size_t k = 0; k < b->training.blocks; k++) {
    size_t length = b->training.start[k + 1] - b->training.start[k];
    if (length > longest) longest = length;
  }
  b->sum_lags = smaller(longest / SUM_SHARE, SUM_LAGS);
  b->one_lags = smaller(longest / ONE_SHARE, ONE_LAGS);
  if (b->sum_lags < 2) b->sum_lags = b->one_lags = 0;
}

/* Opens the cells of repeated rows. They need independent rows: correlated neighbours, and groups
 * that share a level, differ by too little. */
static fg_status open_cells(fg_context *ctx, residual_tests *b) {
  bool independent = b->noise.rho == 0 && b->training.levels == 0;
  for (int recorded = 0; independent && recorded < 2; recorded++)
    FG_TRY(fg_engine_cells_open(ctx, &b->training, b->null.rank, recorded, &b->cells[recorded]));
  if (b->cells[0].cell && b->cells[1].cell && b->cells[0].count == b->cells[1].count)
    fg_engine_cells_close(&b->cells[1]);
  return FG_OK;
}

static fg_status open_residual_tests(fg_context *ctx, const fg_engine_run *run,
                                     fg_engine_noise noise, residual_tests *b) {
  fg_engine_training *training = &b->training;
  b->noise = noise;
  FG_TRY(fg_engine_training_build(ctx, run->problem, run->train, &run->set, training));
  FG_TRY(fg_engine_span_open(ctx, training, noise, 0, &b->null));
  size_t n = training->n, size = sizeof(double);
  FG_TRY(fg_memory_allocate(ctx, n, size, (void **)&b->white));
  FG_TRY(fg_memory_allocate(ctx, n, size, (void **)&b->kept));
  memcpy(b->white, training->y, n * size);
  fg_engine_whiten(training, noise, b->white);
  fg_engine_project_out(n, b->null.basis, b->null.rank, b->white);
  for (size_t i = 0; i < n; i++)
    b->kept[i] = b->white[i] / fg_engine_span_kept_sd(&b->null, i);
  if (has_order(run)) choose_lags(b);
  return open_cells(ctx, b);
}

static void close_residual_tests(residual_tests *b) {
  fg_engine_cells_close(&b->cells[0]);
  fg_engine_cells_close(&b->cells[1]);
  fg_engine_span_close(&b->null);
  fg_engine_training_free(&b->training);
  free(b->white);
  free(b->kept);
}

/* NaN: the table offers no such test. */
static void score_tests(residual_tests *b, const double *white, double value[FG_LOOP_CHECKS],
                        size_t *lag) {
  double sum = 0, largest = 0;
  *lag = 0;
  for (size_t k = 0; k < 2; k++)
    value[FG_LOOP_CHECK_REPEATS + k] =
        b->cells[k].cell ? fg_engine_lack_of_fit(&b->training, &b->cells[k], white) : NAN;
  value[FG_LOOP_CHECK_LAGS] = value[FG_LOOP_CHECK_ONE_LAG] = NAN;
  if (!b->sum_lags) return;
  for (size_t k = 2; k <= b->one_lags || k <= b->sum_lags; k++) {
    double alike = fg_engine_lag_score(&b->training, white, k);
    if (k <= b->sum_lags) sum += alike * alike;
    if (k > b->one_lags || fabs(alike) <= largest) continue;
    largest = fabs(alike);
    *lag = k;
  }
  value[FG_LOOP_CHECK_LAGS] = sum;
  if (b->one_lags >= 2) value[FG_LOOP_CHECK_ONE_LAG] = largest;
}

static void draw_residuals(const residual_tests *b, bool permuted, uint64_t *seed, double *y) {
  size_t n = b->training.n;
  for (size_t i = 0; i < n; i++)
    y[i] = permuted ? b->kept[i] : fg_splitmix_normal(seed);
  for (size_t i = n; permuted && i > 1; i--) {
    size_t k = (size_t)(fg_splitmix_uniform(seed) * (double)i);
    double other = y[k];
    y[k] = y[i - 1];
    y[i - 1] = other;
  }
  fg_engine_project_out(n, b->null.basis, b->null.rank, y);
}

static fg_status p_by_draws(fg_context *ctx, residual_tests *b, const double *value, double *p) {
  size_t n = b->training.n, lag, draws = 0, often = 0, surpassed[FG_LOOP_CHECKS] = {0};
  bool permuted = n >= b->null.rank + PERMUTED_DOF;
  uint64_t seed = RESIDUAL_TESTS_SEED;
  double *y = NULL, other[FG_LOOP_CHECKS];
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *y, (void **)&y));
  while (draws < DRAWS && often < FG_LOOP_CHECKS) {
    draw_residuals(b, permuted, &seed, y);
    score_tests(b, y, other, &lag);
    draws++;
    often = 0;
    for (size_t k = 0; k < FG_LOOP_CHECKS; k++) {
      surpassed[k] += !(other[k] < value[k]);
      often += !isfinite(value[k]) || surpassed[k] >= SURPASSED;
    }
  }
  for (size_t k = 0; k < FG_LOOP_CHECKS; k++)
    p[k] = ((double)surpassed[k] + 1) / ((double)draws + 1);
  free(y);
  return FG_OK;
}

/* Many rows: sums of products are normal, and settings' means too. */
static void p_by_distribution(const residual_tests *b, const double *value, double *p) {
  for (size_t k = 0; k < 2; k++)
    if (b->cells[k].cell && isfinite(value[k]))
      p[k] = gsl_cdf_fdist_Q(value[k], b->cells[k].dof[0], b->cells[k].dof[1]);
  if (!b->sum_lags) return;
  p[FG_LOOP_CHECK_LAGS] = gsl_cdf_chisq_Q(value[FG_LOOP_CHECK_LAGS], (double)b->sum_lags - 1);
  double one = 2 * gsl_cdf_ugaussian_Q(value[FG_LOOP_CHECK_ONE_LAG]);
  p[FG_LOOP_CHECK_ONE_LAG] = -expm1(((double)b->one_lags - 1) * log1p(-one));
}

/* Names the settings with the largest deviations: the first row of each. */
static void name_worst(const residual_tests *b, const fg_engine_cells *cells,
                       fg_loop_checked *check) {
  enum { NAMED = 3 };
  double largest = INFINITY;
  while (check->worst_count < NAMED && check->worst_count < cells->count) {
    size_t best = cells->count;
    double size = -1;
    for (size_t c = 0; c < cells->count; c++) {
      double own = cells->sum[c] * cells->sum[c] / cells->weight[c];
      if (own < largest && own > size) {
        size = own;
        best = c;
      }
    }
    if (best == cells->count) return;
    largest = size;
    for (size_t i = 0; i < b->training.n; i++)
      if (cells->cell[i] == best) {
        check->worst[check->worst_count++] = b->training.row[i];
        break;
      }
  }
}

/* rms: of the deviations of the settings' means, or of the part of a row that the other row
 * predicts. */
static void describe_deviation(residual_tests *b, size_t lag, fg_loop_checked *check) {
  double mean_square = 0;
  for (size_t i = 0; i < b->training.n; i++)
    mean_square += b->white[i] * b->white[i] / (double)b->training.n;
  for (size_t k = 0; k < 2; k++) {
    fg_engine_cells *cells = &b->cells[k];
    fg_loop_checked *own = &check[FG_LOOP_CHECK_REPEATS + k];
    if (!cells->cell) continue;
    double ratio =
        fg_engine_lack_of_fit(&b->training, cells, b->white) * cells->dof[0] / cells->dof[1];
    memcpy(own->dof, cells->dof, sizeof own->dof);
    own->rms = sqrt(mean_square * ratio / (1 + ratio));
    name_worst(b, cells, own);
  }
  check[FG_LOOP_CHECK_LAGS].dof[0] = b->sum_lags ? (double)b->sum_lags - 1 : 0;
  check[FG_LOOP_CHECK_LAGS].lag = b->sum_lags;
  fg_loop_checked *one = &check[FG_LOOP_CHECK_ONE_LAG];
  one->lag = lag;
  one->correlation = lag ? fg_engine_lag_correlation(&b->training, b->white, lag) : NAN;
  one->rms = fabs(one->correlation) * sqrt(mean_square);
}

static fg_status keep_cells(fg_context *ctx, const residual_tests *b, size_t which,
                            fg_loop_result *result) {
  size_t rows = b->training.problem->rows;
  FG_TRY(fg_memory_allocate(ctx, rows, sizeof *result->setting, (void **)&result->setting));
  for (size_t i = 0; i < b->training.n; i++)
    result->setting[b->training.row[i]] = b->cells[which].cell[i] + 1;
  return FG_OK;
}

/* Selects the failed test that is most significant relative to its level. */
static fg_status choose_failed(fg_context *ctx, const residual_tests *b, const double *value,
                               const double *p, fg_loop_result *result) {
  double tests = 0, min = INFINITY;
  for (size_t k = 0; k < FG_LOOP_CHECKS; k++)
    tests += isfinite(value[k]);
  for (size_t k = 0; k < FG_LOOP_CHECKS; k++) {
    fg_loop_checked *check = &result->check[k];
    check->done = isfinite(value[k]);
    if (!check->done) continue;
    check->statistic = value[k];
    check->p_value = p[k];
    check->level = RESIDUAL_TESTS_P / tests;
    check->failed = p[k] < check->level;
    if (!check->failed || p[k] >= min) continue;
    min = p[k];
    result->fails = true;
    result->failed = (fg_loop_check)k;
  }
  bool settings = result->fails && result->failed < FG_LOOP_CHECK_LAGS;
  return settings ? keep_cells(ctx, b, result->failed, result) : FG_OK;
}

fg_status fg_engine_check(fg_context *ctx, const fg_engine_run *run, fg_engine_noise noise) {
  residual_tests b = {0};
  double value[FG_LOOP_CHECKS], p[FG_LOOP_CHECKS] = {1, 1, 1, 1};
  size_t lag;
  fg_status status = FG_OK;
  if (run->problem->few || !run->worth) return FG_OK;
  FG_TRY_EXIT(open_residual_tests(ctx, run, noise, &b));
  if (b.training.n < b.null.rank + 3) goto exit;
  score_tests(&b, b.white, value, &lag);
  describe_deviation(&b, lag, run->result->check);
  if (b.training.n <= FG_ENGINE_SMALL_ROWS)
    FG_TRY_EXIT(p_by_draws(ctx, &b, value, p));
  else
    p_by_distribution(&b, value, p);
  FG_TRY_EXIT(choose_failed(ctx, &b, value, p, run->result));
exit:
  close_residual_tests(&b);
  return status;
}
