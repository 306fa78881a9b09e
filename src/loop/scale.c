/* The size of every row's scatter where it changes: sd = exp(z'g), by the likelihood of the squared
 * residuals (a gamma model with logarithmic link: Smyth 1989), in turns with the mean. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>

#include "core/memory.h"
#include "loop/engine.h"

/* A scale is bounded: a level whose rows agree by luck must not decide alone. */
#define SCALE_MOST 12
enum { TURNS = 3, STEPS = 12 };

typedef struct scale_bench {
  fg_engine_training *training;
  size_t n, columns;
  double *z; /* columns × n; the first is 1 */
  double *eta, *square, *work;
  gsl_matrix *cross;
  gsl_vector *right, *gamma;
} scale_bench;

static size_t spread_columns(const fg_loop_problem *problem, const fg_engine_set *set) {
  size_t count = 0;
  for (size_t m = 0; set && m < set->count; m++)
    if (set->candidate[m].effect->scatter == FG_LOOP_SPREAD)
      count += fg_engine_candidate_columns(problem, &set->candidate[m]);
  return count;
}

static void close_bench(scale_bench *bench) {
  free(bench->z);
  free(bench->eta);
  gsl_matrix_free(bench->cross);
  gsl_vector_free(bench->right);
  gsl_vector_free(bench->gamma);
}

static fg_status open_bench(fg_context *ctx, const fg_engine_set *set, scale_bench *bench) {
  size_t n = bench->n, at = 1;
  FG_TRY(fg_memory_allocate(ctx, n, bench->columns * sizeof *bench->z, (void **)&bench->z));
  FG_TRY(fg_memory_allocate(ctx, n, 3 * sizeof *bench->eta, (void **)&bench->eta));
  bench->square = bench->eta + n;
  bench->work = bench->eta + 2 * n;
  bench->cross = gsl_matrix_alloc(bench->columns, bench->columns);
  bench->right = gsl_vector_alloc(bench->columns);
  bench->gamma = gsl_vector_alloc(bench->columns);
  if (!bench->cross || !bench->right || !bench->gamma)
    return fg_fail(ctx, FG_ERR_MEMORY, "no memory for the size of the scatter");
  for (size_t i = 0; i < n; i++)
    bench->z[i] = 1;
  for (size_t m = 0; m < set->count; m++) {
    if (set->candidate[m].effect->scatter != FG_LOOP_SPREAD) continue;
    FG_TRY(fg_engine_gather(ctx, bench->training, &set->candidate[m], set->shape[m],
                            bench->z + at * n));
    at += fg_engine_candidate_columns(bench->training->problem, &set->candidate[m]);
  }
  return FG_OK;
}

/* Squares of the residuals beside the mean's columns, of groups about their own level. */
static fg_status fill_squares(fg_context *ctx, scale_bench *bench) {
  const fg_engine_training *t = bench->training;
  fg_engine_fit fit;
  double sum = 0;
  FG_TRY(fg_engine_least_squares(ctx, t, (fg_engine_noise){0}, &fit));
  fg_engine_fit_residual(t, &fit, bench->work);
  fg_engine_fit_free(&fit);
  for (size_t b = 0; b < t->levels; b++) {
    double mean = 0, count = (double)(t->level_start[b + 1] - t->level_start[b]);
    for (size_t i = t->level_start[b]; i < t->level_start[b + 1]; i++)
      mean += bench->work[i] / count;
    for (size_t i = t->level_start[b]; i < t->level_start[b + 1]; i++)
      bench->work[i] -= mean;
  }
  for (size_t i = 0; i < t->n; i++) {
    bench->square[i] = bench->work[i] * bench->work[i];
    sum += bench->square[i];
  }
  for (size_t i = 0; sum > 0 && i < t->n; i++)
    bench->square[i] *= (double)t->n / sum;
  return FG_OK;
}

/* One step of scoring: eta is the logarithm of the variance. */
static bool step(scale_bench *bench) {
  size_t n = bench->n, columns = bench->columns;
  for (size_t j = 0; j < columns; j++) {
    double right = 0;
    for (size_t i = 0; i < n; i++)
      right += bench->z[j * n + i] *
               (bench->eta[i] + fmin(bench->square[i] / exp(bench->eta[i]), SCALE_MOST) - 1);
    gsl_vector_set(bench->right, j, right);
    for (size_t k = 0; k < columns; k++) {
      double cross = 0;
      for (size_t i = 0; i < n; i++)
        cross += bench->z[j * n + i] * bench->z[k * n + i];
      gsl_matrix_set(bench->cross, j, k, cross + (j == k ? 1e-9 * (double)n : 0));
    }
  }
  if (gsl_linalg_cholesky_decomp1(bench->cross) != GSL_SUCCESS) return false;
  gsl_linalg_cholesky_solve(bench->cross, bench->right, bench->gamma);
  double most = 2 * log(SCALE_MOST);
  for (size_t i = 0; i < n; i++) {
    double eta = 0;
    for (size_t j = 0; j < columns; j++)
      eta += gsl_vector_get(bench->gamma, j) * bench->z[j * n + i];
    bench->eta[i] = fmin(fmax(eta, -most), most);
  }
  return true;
}

static void take_scale(scale_bench *bench) {
  double sum = 0, *scale = bench->training->scale;
  for (size_t i = 0; i < bench->n; i++)
    sum += exp(bench->eta[i]) / (double)bench->n;
  for (size_t i = 0; i < bench->n; i++)
    scale[i] = exp(bench->eta[i] / 2) / sqrt(sum);
}

fg_status fg_engine_estimate_scale(fg_context *ctx, fg_engine_training *training,
                                   const fg_engine_set *set) {
  scale_bench bench = {.training = training, .n = training->n};
  fg_status status = FG_OK;
  size_t columns = spread_columns(training->problem, set);
  if (columns == 0) return FG_OK;
  bench.columns = columns + 1;
  FG_TRY_EXIT(open_bench(ctx, set, &bench));
  FG_TRY_EXIT(fg_memory_allocate(ctx, bench.n, sizeof *training->scale, (void **)&training->scale));
  for (size_t i = 0; i < bench.n; i++)
    training->scale[i] = 1;
  for (int turn = 0; turn < TURNS; turn++) {
    bool holds = true;
    FG_TRY_EXIT(fill_squares(ctx, &bench));
    for (int k = 0; k < STEPS && holds; k++)
      holds = step(&bench);
    if (holds) take_scale(&bench);
  }
exit:
  close_bench(&bench);
  return status;
}
