/* One wrong response, or two that changed places: judged against noise with heavy tails.
 *
 * With A = W'MW the residual sum is y'Ay. A row with its own parameter takes (Ay)_i² / A_ii away;
 * exchanging the responses of i and j, d apart, changes it by 2 d (Ay_i - Ay_j) + d² (A_ii + A_jj
 * - 2 A_ij). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cdf.h>

#include "core/memory.h"
#include "core/select.h"
#include "effect/table_effects.h"
#include "loop/engine_random.h"
#include "loop/permute.h"

/* A row whose residual keeps less of its own error than this is held by the model alone: nothing
 * can tell that it is wrong. */
#define HELD_ALONE 1e-9
/* In many rows an outlier is judged against the tails of t with so many degrees of freedom, those
 * of fg_engine_random_heavy. */
#define TAIL_FREEDOM 4

typedef struct lone_bench {
  size_t n;
  double *a; /* n × n; only the diagonal where rows are many */
  double *diagonal;
  double *mean; /* fitted response */
} lone_bench;

typedef struct lone_best {
  size_t row[2];
  double ratio[2]; /* outlier, exchange */
  size_t pair[2];
} lone_best;

static bool nested(const fg_loop_problem *problem) {
  return problem->group_level;
}

/* ay = A y, and y'Ay. */
static double apply(const lone_bench *bench, const double *y, double *ay) {
  double sum = 0;
  for (size_t i = 0; i < bench->n; i++) {
    ay[i] = 0;
    for (size_t k = 0; k < bench->n; k++)
      ay[i] += bench->a[i * bench->n + k] * y[k];
  }
  for (size_t i = 0; i < bench->n; i++)
    sum += ay[i] * y[i];
  return sum;
}

static void best_outlier(const lone_bench *bench, const double *ay, double rss, lone_best *best) {
  best->ratio[0] = INFINITY;
  for (size_t i = 0; i < bench->n; i++) {
    if (bench->diagonal[i] < HELD_ALONE) continue;
    double ratio = fmax(1 - ay[i] * ay[i] / bench->diagonal[i] / rss, FG_ENGINE_RATIO_LEAST);
    if (ratio < best->ratio[0]) {
      best->ratio[0] = ratio;
      best->row[0] = i;
    }
  }
}

static void best_exchange(const lone_bench *bench, const double *response, const double *ay,
                          double rss, lone_best *best) {
  size_t n = bench->n;
  best->ratio[1] = INFINITY;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < i; j++) {
      double d = response[j] - response[i];
      double change = 2 * d * (ay[i] - ay[j]) +
                      d * d * (bench->diagonal[i] + bench->diagonal[j] - 2 * bench->a[i * n + j]);
      double ratio = fmax(1 + change / rss, FG_ENGINE_RATIO_LEAST);
      if (ratio < best->ratio[1]) {
        best->ratio[1] = ratio;
        best->pair[0] = j;
        best->pair[1] = i;
      }
    }
}

static fg_status fill(fg_context *ctx, const fg_engine_training *training, fg_engine_noise noise,
                      lone_bench *bench) {
  size_t n = training->n;
  fg_status status = FG_OK;
  double *null = NULL, *work = NULL;
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, (training->columns + 1) * sizeof *null, (void **)&null));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, n * sizeof *work, (void **)&work));
  size_t rank = fg_engine_null_basis(training, noise, null);
  for (size_t i = 0; i < n; i++) {
    double *v = work + i * n;
    v[i] = 1;
    fg_engine_whiten(training, noise, v);
    fg_engine_project_out(n, null, rank, v);
  }
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) {
      double sum = 0;
      for (size_t k = 0; k < n; k++)
        sum += work[i * n + k] * work[j * n + k];
      bench->a[i * n + j] = sum;
      if (i == j) bench->diagonal[i] = sum;
    }
exit:
  free(null);
  free(work);
  return status;
}

/* The response that the null expects: what was measured less the residual. */
static fg_status fill_mean(fg_context *ctx, const fg_engine_training *training,
                           fg_engine_noise noise, lone_bench *bench) {
  fg_engine_fit fit;
  FG_TRY(fg_engine_least_squares(ctx, training, noise, &fit));
  for (size_t i = 0; i < training->n; i++) {
    double residual = training->y[i];
    for (size_t k = 0; k < training->columns; k++)
      residual -= fit.beta[k] * training->x[k * training->n + i];
    size_t row = training->row[i];
    bench->mean[i] = training->y[i] - training->problem->residual[row] +
                     training->problem->response[row] - residual;
  }
  fg_engine_fit_free(&fit);
  return FG_OK;
}

typedef struct lone_null {
  size_t draws;
  double accept_p;  /* of all families */
  double *ratio[2]; /* sorted */
} lone_null;

/* One draw: heavy noise of the fitted size about the fitted response. */
static void draw(const fg_engine_training *training, fg_engine_noise noise, const lone_bench *bench,
                 double sd, uint64_t *seed, double *work, lone_best *best) {
  size_t n = bench->n;
  double *y = work, *ay = work + n, *response = work + 2 * n;
  for (size_t i = 0; i < n; i++)
    y[i] = sd * fg_engine_random_heavy(seed);
  fg_engine_colour(training, noise, y);
  for (size_t i = 0; i < n; i++)
    response[i] = bench->mean[i] + y[i];
  double rss = apply(bench, y, ay);
  best_outlier(bench, ay, rss, best);
  if (!nested(training->problem)) best_exchange(bench, response, ay, rss, best);
}

static void take_p(const lone_null *null, size_t kind, double ratio, double freedom,
                   fg_engine_lone *lone) {
  size_t below = 0;
  while (below < null->draws && null->ratio[kind][below] <= ratio + 1e-12)
    below++;
  lone->ratio = ratio;
  lone->p_value = fmin(1, FG_ENGINE_FAMILIES * (1 + (double)below) / (1 + (double)null->draws));
  double edge =
      null->ratio[kind][(size_t)((double)null->draws * null->accept_p / FG_ENGINE_FAMILIES)];
  lone->f_critical = (1 / edge - 1) * (freedom - 1);
}

static fg_status judge_small(fg_context *ctx, const fg_engine_training *training,
                             fg_engine_noise noise, const lone_bench *bench,
                             const fg_engine_null *how, fg_engine_lone lone[2]) {
  size_t n = training->n;
  fg_status status = FG_OK;
  double *work = NULL;
  lone_null null = {.draws = how->draws, .accept_p = how->accept_p};
  uint64_t seed = how->seed;
  lone_best best = {0}, one;
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, 3 * sizeof *work, (void **)&work));
  for (size_t k = 0; k < 2; k++)
    FG_TRY_EXIT(fg_memory_allocate(ctx, null.draws, sizeof **null.ratio, (void **)&null.ratio[k]));
  double rss = apply(bench, training->y, work);
  best_outlier(bench, work, rss, &best);
  double trace = 0, freedom = (double)(n - training->columns);
  for (size_t i = 0; i < n; i++) {
    size_t row = training->row[i];
    trace += bench->diagonal[i];
    work[n + i] =
        training->y[i] - training->problem->residual[row] + training->problem->response[row];
  }
  if (!nested(training->problem)) best_exchange(bench, work + n, work, rss, &best);
  for (size_t b = 0; b < null.draws; b++) {
    draw(training, noise, bench, sqrt(rss / freedom), &seed, work, &one);
    null.ratio[0][b] = one.ratio[0];
    null.ratio[1][b] = nested(training->problem) ? 1 : one.ratio[1];
  }
  for (size_t k = 0; k < 2; k++) {
    fg_sort(null.ratio[k], null.draws);
    lone[k].known = k == 0 || !nested(training->problem);
    lone[k].length = trace / (double)n;
    if (lone[k].known) take_p(&null, k, best.ratio[k], freedom, &lone[k]);
  }
  lone[0].candidate.row[0] = training->row[best.row[0]];
  lone[1].candidate.row[0] = training->row[best.pair[0]];
  lone[1].candidate.row[1] = training->row[best.pair[1]];
exit:
  free(work);
  free(null.ratio[0]);
  free(null.ratio[1]);
  return status;
}

/* Many rows: the residual over its sd against the tail of the heavy law, times the rows. Leverage
 * is small there. */
static fg_status judge_large(fg_context *ctx, const fg_engine_training *training,
                             fg_engine_noise noise, double accept_p, fg_engine_lone lone[2]) {
  fg_engine_fit fit;
  size_t worst = 0;
  double largest = 0, sum = 0;
  FG_TRY(fg_engine_least_squares(ctx, training, noise, &fit));
  for (size_t i = 0; i < training->n; i++) {
    double residual = training->y[i];
    for (size_t k = 0; k < training->columns; k++)
      residual -= fit.beta[k] * training->x[k * training->n + i];
    sum += residual * residual;
    if (fabs(residual) > largest) {
      largest = fabs(residual);
      worst = i;
    }
  }
  fg_engine_fit_free(&fit);
  double n = (double)training->n, rest = sqrt((sum - largest * largest) / n);
  lone[0].known = true;
  lone[0].ratio = 1 - largest * largest / sum;
  lone[0].length = 1;
  lone[0].p_value = fmin(1, FG_ENGINE_FAMILIES * 2 * n *
                                gsl_cdf_tdist_Q(sqrt(2.0) * largest / rest, TAIL_FREEDOM));
  lone[0].f_critical =
      pow(gsl_cdf_tdist_Qinv(accept_p / FG_ENGINE_FAMILIES / 2 / n, TAIL_FREEDOM), 2) / 2;
  lone[0].candidate.row[0] = training->row[worst];
  return FG_OK;
}

fg_status fg_engine_judge_lone(fg_context *ctx, const fg_engine_training *training,
                               fg_engine_noise noise, const fg_engine_null *null,
                               fg_engine_lone lone[2]) {
  const fg_loop_effect *effects = fg_loop_lone_effects();
  lone_bench bench = {.n = training->n};
  fg_status status = FG_OK;
  memset(lone, 0, 2 * sizeof *lone);
  for (size_t k = 0; k < 2; k++)
    lone[k].candidate.effect = &effects[k];
  if (!training->problem->exchangeable || training->n < training->columns + 4) return FG_OK;
  if (training->n > FG_ENGINE_SMALL_ROWS)
    return judge_large(ctx, training, noise, null->accept_p, lone);
  FG_TRY_EXIT(
      fg_memory_allocate(ctx, training->n, training->n * sizeof *bench.a, (void **)&bench.a));
  FG_TRY_EXIT(fg_memory_allocate(ctx, training->n, sizeof *bench.a, (void **)&bench.diagonal));
  FG_TRY_EXIT(fg_memory_allocate(ctx, training->n, sizeof *bench.a, (void **)&bench.mean));
  FG_TRY_EXIT(fill(ctx, training, noise, &bench));
  FG_TRY_EXIT(fill_mean(ctx, training, noise, &bench));
  FG_TRY_EXIT(judge_small(ctx, training, noise, &bench, null, lone));
exit:
  free(bench.a);
  free(bench.diagonal);
  free(bench.mean);
  return status;
}
