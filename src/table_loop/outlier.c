/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outlier rows: one or several responses with residuals beyond the scatter of the others.
 *
 * Rows are removed one after the other, the largest residual first; the outliers are all up to the
 * last one that the remaining rows do not explain (generalised extreme studentised deviates: Rosner
 * 1983), so that two do not hide each other. The tails of the remaining rows are unknown: the
 * probability of such a residual is averaged over tails with the posterior weights from the
 * remaining rows, and is smaller where the row has leverage (row_tails.h). In addition, outliers
 * must be likelier than one heavy tail of all rows: a likelihood ratio exceeds 1 / p by chance less
 * often than p. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "core/memory.h"
#include "effect/table_effects.h"
#include "table_loop/assess.h"
#include "table_loop/row_tails.h"
#include "table_loop/tails.h"

/* Share of its own error in a row's residual, below which the model alone fits the row: it cannot
 * be recognised as an outlier. */
#define HELD_ALONE 1e-9
/* At most one row in so many is an outlier. */
enum { ONE_IN = 6 };

/* Several rows are outliers when the last of them lies so many times farther out than the next row.
 */
#define GAP 1.5

/* The p-value of a row against possible tails is too high for normal noise, because heavy tails
 * have a prior probability; it is divided by this and by the rows' share. By simulation (rows of 16
 * to 200: tests/bench/loop_rows.c) 1 in 100 tables of normal noise or fewer then reach 0.1. */
#define CAUTION 4.5

/* Logarithm of the likelihood ratio of outliers over a heavy tail at which their p-value is that of
 * acceptance, and how fast it falls: chosen by simulation (tests/bench/loop_rows.c). Of tables
 * whose noise is Student's t with 3 or 4 dof, and that hold no wrong row, 2 in 100 reach it,
 * and 5 reach 0.1. No test that keeps this sees more than half of wrong values of 10 standard
 * errors in 24 rows: two densities alone, t of 3 dof and normal, allow 45 of 100 at 1 in 100. In
 * 126 rows nearly all are seen. */
#define WRONG_RATIO 5.8
#define WRONG_SLOPE 1.92

typedef struct outlier_rows {
  const fg_engine_training *training;
  fg_engine_noise noise;
  size_t n, rank;
  double *basis; /* orthonormal, whitened: the null's columns, then the rows taken out */
  double *white; /* n: whitened residual of the response */
  double *unit;  /* n: one row's whitened indicator */
  double *t;     /* n: residual of a row over its own sd (not over the noise's) */
  double *kept;  /* n: |M W e|² */
  double *rest;  /* n: t of the rows that are left */
  double taken[FG_LOOP_OUTLIER_ROWS + 1]; /* of those taken out: t before they were, as_tail */
  bool *out;
  double rss;
} outlier_rows;

static fg_status open_rows(fg_context *ctx, const fg_engine_training *training,
                           fg_engine_noise noise, const fg_engine_span *null, outlier_rows *rows) {
  size_t n = training->n, columns = null->rank + FG_LOOP_OUTLIER_ROWS + 1;
  *rows = (outlier_rows){.training = training, .noise = noise, .n = n};
  FG_TRY(fg_memory_allocate(ctx, n, columns * sizeof *rows->basis, (void **)&rows->basis));
  FG_TRY(fg_memory_allocate(ctx, n, 5 * sizeof *rows->white, (void **)&rows->white));
  FG_TRY(fg_memory_allocate(ctx, n, sizeof *rows->out, (void **)&rows->out));
  rows->unit = rows->white + n;
  rows->t = rows->white + 2 * n;
  rows->kept = rows->white + 3 * n;
  rows->rest = rows->white + 4 * n;
  rows->rank = null->rank;
  memcpy(rows->basis, null->basis, n * null->rank * sizeof *rows->basis);
  memcpy(rows->kept, null->kept, n * sizeof *rows->kept);
  memcpy(rows->white, training->y, n * sizeof *rows->white);
  fg_engine_whiten(training, noise, rows->white);
  rows->rss = fg_engine_project_out(n, rows->basis, rows->rank, rows->white);
  return FG_OK;
}

static void close_rows(outlier_rows *rows) {
  free(rows->basis);
  free(rows->white);
  free(rows->out);
}

static bool whole_covariance(const outlier_rows *rows) {
  return rows->n <= FG_ENGINE_SMALL_ROWS && !fg_engine_independent(rows->noise);
}

static void fill_unit(const outlier_rows *rows, size_t i) {
  memset(rows->unit, 0, rows->n * sizeof *rows->unit);
  rows->unit[i] = 1;
  if (whole_covariance(rows)) fg_engine_whiten(rows->training, rows->noise, rows->unit);
}

/* Assesses a row beside all others: the residual of its response along its own whitened indicator.
 */
static double assess_correlated(outlier_rows *rows, size_t i) {
  size_t n = rows->n;
  double along = 0, kept = 0;
  fill_unit(rows, i);
  for (size_t m = 0; m < n; m++) {
    along += rows->unit[m] * rows->white[m];
    kept += rows->unit[m] * rows->unit[m];
  }
  for (size_t k = 0; k < rows->rank; k++) {
    double part = 0;
    for (size_t m = 0; m < n; m++)
      part += rows->unit[m] * rows->basis[k * n + m];
    kept -= part * part;
  }
  rows->kept[i] = kept;
  return along;
}

/* Assesses rows; where they are many and correlated, by their innovations alone. */
static void assess_rows(outlier_rows *rows) {
  for (size_t i = 0; i < rows->n; i++) {
    double along = whole_covariance(rows) ? assess_correlated(rows, i) : rows->white[i];
    rows->t[i] = rows->kept[i] > HELD_ALONE ? along / sqrt(rows->kept[i]) : 0;
  }
}

static size_t worst_row(const outlier_rows *rows) {
  size_t worst = rows->n;
  for (size_t i = 0; i < rows->n; i++)
    if (!rows->out[i] && (worst == rows->n || fabs(rows->t[i]) > fabs(rows->t[worst]))) worst = i;
  return worst;
}

static void take_out(outlier_rows *rows, size_t i) {
  size_t n = rows->n;
  double *column = rows->basis + rows->rank * n;
  fill_unit(rows, i);
  memcpy(column, rows->unit, n * sizeof *column);
  double left = fg_engine_project_out(n, rows->basis, rows->rank, column);
  rows->out[i] = true;
  if (!(left > HELD_ALONE)) return;
  for (size_t m = 0; m < n; m++) {
    column[m] /= sqrt(left);
    if (!whole_covariance(rows)) rows->kept[m] -= column[m] * column[m];
  }
  rows->rank++;
  rows->rss = fg_engine_project_out(n, column, 1, rows->white);
}

/* Weighs the tails by the remaining rows; of removed rows only the fact that they lie beyond is
 * used. */
static void weigh_tails(const outlier_rows *rows, size_t out, double sd,
                        double weight[FG_ENGINE_TAILS]) {
  double largest = 0;
  for (size_t i = 0; i < rows->n; i++) {
    bool used = !rows->out[i] && rows->kept[i] > HELD_ALONE;
    rows->rest[i] = used ? rows->t[i] / sd : NAN;
    if (!rows->out[i]) largest = fmax(largest, fabs(rows->t[i]) / sd);
  }
  const fg_engine_tail_rows others = {rows->n, rows->rest, rows->kept, largest, out};
  fg_engine_tails_weigh(&others, weight);
}

/* Returns the p-value of a row at distance `t`, in sd of the noise, with `out` rows (itself among
 * them) removed. `own` is the share of its own error. */
static double row_p(const outlier_rows *rows, double t, double own, size_t out) {
  double dof = (double)rows->n - (double)rows->rank, weight[FG_ENGINE_TAILS];
  double sd = sqrt(rows->rss / dof);
  weigh_tails(rows, out, sd, weight);
  double p = fg_engine_tails_beyond(weight, fabs(t) / sd, own, dof);
  double left = (double)(rows->n - out + 1);
  return -expm1(left * log1p(-fmin(p, 0.5)));
}

/* Returns the p-value against a heavy tail of all rows, for the first `taken` rows and one more of
 * `size`. */
static double tail_p(outlier_rows *rows, size_t taken, double size) {
  size_t rest = 0;
  for (size_t i = 0; i < rows->n; i++)
    if (!rows->out[i] && rows->kept[i] > HELD_ALONE) rows->rest[rest++] = rows->t[i];
  if (rest < 2) return 1;
  if (size > 0) rows->taken[taken++] = size;
  double ratio = fg_engine_wrong_over_tail(rest, rows->rest, taken, rows->taken);
  return fmin(FG_LOOP_ACCEPT_P * exp(WRONG_SLOPE * (WRONG_RATIO - ratio)), 1);
}

/* Returns the smallest F ratio of one row that is accepted; where rows are many their tails are the
 * observed ones. */
static double critical_f(outlier_rows *rows, double level, double accept_p) {
  double dof = (double)rows->n - (double)rows->rank, weight[FG_ENGINE_TAILS], low = 1, high = 1e6;
  double one = level / (double)rows->n, sd = sqrt(rows->rss / dof);
  bool few = rows->n <= FG_ENGINE_SMALL_ROWS;
  weigh_tails(rows, 0, sd, weight);
  for (int i = 0; i < 60; i++) {
    double middle = sqrt(low * high), p = fg_engine_tails_beyond(weight, middle, 1, dof);
    if (p > one || (few && tail_p(rows, 0, middle * sd) > accept_p))
      low = middle;
    else
      high = middle;
  }
  return high * high;
}

/* The t of a row without leverage that would be as rare a tail. */
static double as_tail(const outlier_rows *rows, double t, double own) {
  double sd = sqrt(rows->rss / ((double)rows->n - (double)rows->rank));
  return sd > 0 ? sd * fg_engine_tails_equivalent(t / sd, own) : t;
}

static void sort_rows(fg_loop_candidate *candidate) {
  for (size_t i = 1; i < candidate->rows; i++)
    for (size_t k = i; k > 0 && candidate->row[k] < candidate->row[k - 1]; k--) {
      size_t other = candidate->row[k];
      candidate->row[k] = candidate->row[k - 1];
      candidate->row[k - 1] = other;
    }
}

/* Heavy tails thin out row by row; wrong responses lie beyond a gap. */
static bool stands_apart(const outlier_rows *rows, double t) {
  size_t next = worst_row(rows);
  return next == rows->n || fabs(t) > GAP * fabs(rows->t[next]);
}

/* Were the noise surely normal. */
static double normal_p(const outlier_rows *rows, double size) {
  double dof = (double)rows->n - (double)rows->rank;
  return fmin((double)rows->n * 2 * gsl_cdf_tdist_Q(size, dof), 1);
}

static void search_outliers(outlier_rows *rows, fg_engine_level level, fg_engine_outlier *outlier) {
  const fg_engine_training *training = rows->training;
  fg_loop_candidate taken = outlier->candidate;
  double whole = rows->rss, alike = 1;
  size_t max = rows->n / ONE_IN < FG_LOOP_OUTLIER_ROWS ? rows->n / ONE_IN : FG_LOOP_OUTLIER_ROWS;
  for (size_t j = 1; j <= (max ? max : 1); j++) {
    size_t worst = worst_row(rows);
    if (worst == rows->n || rows->rank + 3 >= rows->n) break;
    double t = rows->t[worst], own = fmin(rows->kept[worst], 1);
    take_out(rows, worst);
    assess_rows(rows);
    rows->taken[j - 1] = as_tail(rows, t, own);
    taken.row[taken.rows++] = training->row[worst];
    double p = fmin(row_p(rows, t, own, j) / (CAUTION * level.share), 1);
    if (j == 1) {
      outlier->first = taken;
      outlier->known = true;
      outlier->size = fabs(t) / sqrt(rows->rss / ((double)rows->n - (double)rows->rank));
      outlier->normal_p = normal_p(rows, outlier->size);
    }
    if (j > 1 && !(p < level.accept_p && stands_apart(rows, t))) continue;
    outlier->candidate = taken;
    outlier->ratio = rows->rss / whole;
    outlier->apart_p = p;
    alike = tail_p(rows, j, 0);
  }
  outlier->p_value = fmax(outlier->apart_p, alike);
  sort_rows(&outlier->candidate);
}

fg_status fg_engine_assess_outlier(fg_context *ctx, const fg_engine_training *training,
                                   fg_engine_noise noise, const fg_engine_span *null,
                                   fg_engine_level level, fg_engine_outlier *outlier) {
  outlier_rows rows = {0};
  double sum = 0;
  fg_status status = FG_OK;
  *outlier = (fg_engine_outlier){
      .ratio = 1, .p_value = 1, .apart_p = 1, .normal_p = 1, .f_critical = INFINITY};
  outlier->candidate.effect = &fg_loop_outlier_effects()[0];
  if (!training->problem->exchangeable || training->n < training->columns + 5) return FG_OK;
  FG_TRY_EXIT(open_rows(ctx, training, noise, null, &rows));
  if (!(rows.rss > 0)) goto exit;
  assess_rows(&rows);
  for (size_t i = 0; i < rows.n; i++)
    sum += rows.kept[i];
  outlier->length = sum / (double)rows.n;
  outlier->f_critical = critical_f(&rows, level.accept_p * CAUTION * level.share, level.accept_p);
  search_outliers(&rows, level, outlier);
exit:
  close_rows(&rows);
  return status;
}
