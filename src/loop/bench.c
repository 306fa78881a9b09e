/* The bench: candidates whitened, projected and orthonormal, for scoring many responses. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "loop/engine.h"

static size_t candidate_versions(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                                 double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  memset(starts, 0, sizeof(double[FG_LOOP_STARTS][FG_LOOP_SHAPES]));
  return candidate->effect->starts ? candidate->effect->starts(problem, candidate, starts) : 1;
}

static fg_status list_versions(fg_context *ctx, fg_engine_bench *bench) {
  const fg_loop_problem *problem = bench->training->problem;
  double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES];
  size_t count = 0;
  for (size_t c = 0; c < bench->candidates; c++)
    count += candidate_versions(problem, &bench->candidate[c], starts);
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *bench->version, (void **)&bench->version));
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *bench->shape, (void **)&bench->shape));
  for (size_t c = 0; c < bench->candidates; c++) {
    size_t here = candidate_versions(problem, &bench->candidate[c], starts);
    size_t columns = fg_engine_candidate_columns(problem, &bench->candidate[c]);
    for (size_t s = 0; s < here; s++) {
      bench->version[bench->versions] = (fg_engine_version){.candidate = c, .start = s};
      bench->version[bench->versions].first = bench->columns;
      memcpy(bench->shape[bench->versions++], starts[s], sizeof starts[s]);
      bench->columns += columns;
    }
  }
  return FG_OK;
}

/* Weights of the noise models by residual likelihood: with S the residual sum and f the freedom,
 * f log S - 2 log|W| + log|X'W'WX|, so that S exp(rest / f) compares. */
static fg_status weigh_noises(fg_context *ctx, fg_engine_bench *bench) {
  const fg_engine_training *training = bench->training;
  double terms[FG_ENGINE_NOISES], best = INFINITY, sums[FG_ENGINE_NOISES];
  bench->noises = fg_engine_noise_grid(training, bench->noise);
  for (size_t j = 0; j < bench->noises; j++) {
    fg_engine_fit fit;
    FG_TRY(fg_engine_least_squares(ctx, training, bench->noise[j], &fit));
    terms[j] = fg_engine_log_det(training, bench->noise[j]) + fit.log_det;
    sums[j] = fit.rss;
    bench->freedom = training->n > fit.rank ? training->n - fit.rank : 0;
    fg_engine_fit_free(&fit);
  }
  double freedom = bench->freedom ? (double)bench->freedom : 1;
  for (size_t j = 0; j < bench->noises; j++)
    best = fmin(best, terms[j]);
  for (size_t j = 0; j < bench->noises; j++)
    bench->weight[j] = exp((terms[j] - best) / freedom);
  if (training->n <= FG_ENGINE_SMALL_ROWS) return FG_OK;
  size_t chosen = 0;
  for (size_t j = 1; j < bench->noises; j++)
    if (sums[j] * bench->weight[j] < sums[chosen] * bench->weight[chosen]) chosen = j;
  bench->noise[0] = bench->noise[chosen];
  bench->weight[0] = 1;
  bench->noises = 1;
  return FG_OK;
}

/* Orthonormal columns of the null, whitened; those that are aliased stay zero. */
static fg_status null_basis(fg_context *ctx, const fg_engine_training *training,
                            fg_engine_noise noise, double **basis) {
  size_t n = training->n;
  FG_TRY(fg_memory_allocate(ctx, n, (training->columns + 1) * sizeof **basis, (void **)basis));
  size_t rank = fg_engine_null_basis(training, noise, *basis);
  memset(*basis + rank * n, 0, n * (training->columns + 1 - rank) * sizeof **basis);
  return FG_OK;
}

/* The version's columns, whitened, orthonormal beside the null: at most FG_LOOP_COLUMNS × n. */
static fg_status version_basis(fg_context *ctx, fg_engine_bench *bench, size_t v,
                               fg_engine_noise noise, const double *null, double *columns,
                               double *unit) {
  const fg_engine_training *training = bench->training;
  fg_engine_version *version = &bench->version[v];
  const fg_loop_candidate *candidate = &bench->candidate[version->candidate];
  size_t n = training->n, count = fg_engine_candidate_columns(training->problem, candidate);
  double lengths[FG_LOOP_COLUMNS], whole = 0;
  FG_TRY(fg_engine_gather(ctx, training, candidate, bench->shape[v], columns));
  for (size_t k = 0; k < count; k++) {
    fg_engine_whiten(training, noise, columns + k * n);
    for (size_t i = 0; i < n; i++)
      whole += columns[k * n + i] * columns[k * n + i];
  }
  version->rank = fg_engine_orthonormal(n, null, training->columns, columns, count, unit, lengths);
  version->length = 0;
  for (size_t k = 0; k < count; k++)
    version->length += lengths[k] / (double)count;
  version->share = whole > 0 ? version->length * (double)count / whole : 0;
  return FG_OK;
}

static void put_rows(size_t n, size_t width, size_t first, const double *columns, size_t count,
                     double *rows) {
  for (size_t k = 0; k < count; k++)
    for (size_t i = 0; i < n; i++)
      rows[i * width + first + k] = columns[k * n + i];
}

static fg_status fill_noise(fg_context *ctx, fg_engine_bench *bench, size_t j) {
  const fg_engine_training *training = bench->training;
  size_t n = training->n, width = training->columns + bench->columns;
  fg_status status = FG_OK;
  double *null = NULL, *work = NULL;
  size_t each = n * FG_LOOP_COLUMNS;
  FG_TRY_EXIT(null_basis(ctx, training, bench->noise[j], &null));
  FG_TRY_EXIT(fg_memory_allocate(ctx, each, 2 * sizeof *work, (void **)&work));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, width * sizeof *work, (void **)&bench->rows[j]));
  put_rows(n, width, 0, null, training->columns, bench->rows[j]);
  for (size_t v = 0; v < bench->versions; v++) {
    FG_TRY_EXIT(version_basis(ctx, bench, v, bench->noise[j], null, work, work + each));
    put_rows(n, width, training->columns + bench->version[v].first, work + each,
             bench->version[v].rank, bench->rows[j]);
  }
exit:
  free(null);
  free(work);
  return status;
}

fg_status fg_engine_bench_build(fg_context *ctx, const fg_engine_training *training,
                                const fg_loop_candidate *candidate, size_t candidates,
                                fg_engine_bench *bench) {
  fg_status status = FG_OK;
  *bench =
      (fg_engine_bench){.training = training, .candidate = candidate, .candidates = candidates};
  bench->rank = training->columns;
  FG_TRY_EXIT(list_versions(ctx, bench));
  FG_TRY_EXIT(weigh_noises(ctx, bench));
  size_t width = training->columns + bench->columns;
  FG_TRY_EXIT(fg_memory_allocate(ctx, width + bench->versions + training->n + 1,
                                 sizeof *bench->scratch, (void **)&bench->scratch));
  FG_TRY_EXIT(fg_memory_allocate(ctx, training->flips + 1, width * sizeof *bench->flip_scores + 1,
                                 (void **)&bench->flip_scores));
  for (size_t j = bench->noises; training->n <= FG_ENGINE_SMALL_ROWS && j-- > 0;)
    FG_TRY_EXIT(fill_noise(ctx, bench, j));
exit:
  if (status != FG_OK) fg_engine_bench_free(bench);
  return status;
}

void fg_engine_bench_tell(const fg_engine_bench *bench, size_t half, size_t done, size_t all) {
  const fg_engine_watch *watch = &bench->watch;
  if (watch->show && all)
    watch->show(watch->user, watch->found, 0.5 * (double)half + 0.5 * (double)done / (double)all);
}

void fg_engine_bench_free(fg_engine_bench *bench) {
  for (size_t j = 0; j < FG_ENGINE_NOISES; j++)
    free(bench->rows[j]);
  free(bench->version);
  free(bench->shape);
  free(bench->flip_scores);
  free(bench->scratch);
  *bench = (fg_engine_bench){0};
}

double fg_engine_version_freedom(const fg_engine_bench *bench, const fg_engine_version *version) {
  const fg_loop_effect *effect = bench->candidate[version->candidate].effect;
  return (double)version->rank + (double)effect->shapes;
}

/* Wilson and Hilferty's normal deviate of an F ratio: close enough to compare candidates of
 * different freedom, and monotone, so p-values from simulation stay exact. */
double fg_engine_deviate(double ratio, double k, double freedom) {
  double nu = freedom - k, f = (1 / ratio - 1) * nu / k;
  double root = cbrt(f), a = 2 / (9 * nu), b = 2 / (9 * k);
  return ((1 - a) * root - (1 - b)) / sqrt(a * root * root + b);
}

double fg_engine_deviate_to_f(double z, double k, double nu) {
  double low = 0, high = 1e9;
  for (int i = 0; i < 100; i++) {
    double f = sqrt((low + 1e-6) * high);
    double ratio = 1 / (1 + f * k / nu);
    if (fg_engine_deviate(ratio, k, nu + k) < z)
      low = f;
    else
      high = f;
  }
  return high < 0.99e9 ? high : INFINITY;
}

static void products(size_t n, size_t width, const double *rows, const double *y, double *sums) {
  memset(sums, 0, width * sizeof *sums);
  for (size_t i = 0; i < n; i++) {
    const double *row = rows + i * width;
    double value = y[i];
    for (size_t k = 0; k < width; k++)
      sums[k] += row[k] * value;
  }
}

static double sum_of_squares(const double *v, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += v[i] * v[i];
  return sum;
}

/* Takes in the residual sums at one noise model: the smallest weighted ones win. */
static void collect(const fg_engine_bench *bench, size_t j, double rss, const double *sums,
                    fg_engine_score *score) {
  for (size_t v = 0; v < bench->versions; v++) {
    const fg_engine_version *version = &bench->version[v];
    fg_engine_score *best = &score[version->candidate];
    if (version->rank == 0 ||
        fg_engine_version_freedom(bench, version) + 2 > (double)bench->freedom)
      continue;
    double left = rss - sum_of_squares(sums + version->first, version->rank);
    double weighted = fmax(left, FG_ENGINE_RATIO_LEAST * rss) * bench->weight[j];
    if (weighted < best->ratio) {
      best->ratio = weighted;
      best->version = v;
      best->noise = j;
    }
  }
}

static void finish_scores(const fg_engine_bench *bench, double null, fg_engine_score *score) {
  for (size_t c = 0; c < bench->candidates; c++) {
    if (!isfinite(score[c].ratio)) {
      score[c].z = NAN;
      continue;
    }
    double k = fg_engine_version_freedom(bench, &bench->version[score[c].version]);
    score[c].ratio = fmin(score[c].ratio / null, 1);
    score[c].z = fg_engine_deviate(score[c].ratio, k, (double)bench->freedom);
  }
}

static void clear_scores(const fg_engine_bench *bench, fg_engine_score *score) {
  for (size_t c = 0; c < bench->candidates; c++)
    score[c] = (fg_engine_score){.ratio = INFINITY, .z = NAN};
}

void fg_engine_bench_score(const fg_engine_bench *bench, const double *y, fg_engine_score *score,
                           size_t *null) {
  size_t n = bench->training->n, width = bench->rank + bench->columns;
  double *sums = bench->scratch, *white = bench->scratch + width, lowest = INFINITY;
  clear_scores(bench, score);
  for (size_t j = 0; j < bench->noises; j++) {
    memcpy(white, y, n * sizeof *white);
    fg_engine_whiten(bench->training, bench->noise[j], white);
    products(n, width, bench->rows[j], white, sums);
    double rss = sum_of_squares(white, n) - sum_of_squares(sums, bench->rank);
    if (rss * bench->weight[j] < lowest) {
      lowest = rss * bench->weight[j];
      if (null) *null = j;
    }
    collect(bench, j, rss, sums + bench->rank, score);
  }
  finish_scores(bench, lowest, score);
}

/* Adds u × residual to the sums of each flip group. */
static void add_scores(const fg_engine_bench *bench, const double *unit, size_t count, size_t first,
                       const double *residual) {
  const fg_engine_training *training = bench->training;
  size_t width = bench->rank + bench->columns;
  for (size_t k = 0; k < count; k++)
    for (size_t i = 0; i < training->n; i++)
      bench->flip_scores[training->flip[i] * width + first + k] +=
          unit[k * training->n + i] * residual[i];
}

static void total_scores(const fg_engine_bench *bench, fg_engine_score *score) {
  size_t width = bench->rank + bench->columns;
  double *sums = bench->scratch;
  memset(sums, 0, width * sizeof *sums);
  for (size_t g = 0; g < bench->training->flips; g++)
    for (size_t k = 0; k < width; k++)
      sums[k] += bench->flip_scores[g * width + k];
  clear_scores(bench, score);
  collect(bench, 0, bench->flip_rss, sums + bench->rank, score);
  finish_scores(bench, bench->flip_rss * bench->weight[0], score);
}

fg_status fg_engine_bench_prepare_flips(fg_context *ctx, fg_engine_bench *bench, size_t noise,
                                        fg_engine_score *score) {
  const fg_engine_training *training = bench->training;
  size_t n = training->n, width = bench->rank + bench->columns, each = n * FG_LOOP_COLUMNS;
  fg_status status = FG_OK;
  double *null = NULL, *work = NULL, *residual = NULL;
  FG_TRY_EXIT(null_basis(ctx, training, bench->noise[noise], &null));
  FG_TRY_EXIT(fg_memory_allocate(ctx, each, 2 * sizeof *work, (void **)&work));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, sizeof *residual, (void **)&residual));
  memcpy(residual, training->y, n * sizeof *residual);
  fg_engine_whiten(training, bench->noise[noise], residual);
  bench->flip_rss = fg_engine_project_out(n, null, training->columns, residual);
  memset(bench->flip_scores, 0, training->flips * width * sizeof *bench->flip_scores);
  add_scores(bench, null, training->columns, 0, residual);
  for (size_t v = 0; v < bench->versions; v++) {
    fg_engine_bench_tell(bench, 0, v, bench->versions);
    FG_TRY_EXIT(version_basis(ctx, bench, v, bench->noise[noise], null, work, work + each));
    add_scores(bench, work + each, bench->version[v].rank, bench->rank + bench->version[v].first,
               residual);
  }
  if (score) total_scores(bench, score);
exit:
  free(null);
  free(work);
  free(residual);
  return status;
}

/* A flipped residual is projected again: |D r|² less what falls into the null's span. */
void fg_engine_bench_flip(const fg_engine_bench *bench, const signed char *sign, double *z) {
  size_t width = bench->rank + bench->columns;
  double *sums = bench->scratch;
  memset(sums, 0, width * sizeof *sums);
  for (size_t g = 0; g < bench->training->flips; g++)
    for (size_t k = 0; k < width; k++)
      sums[k] += sign[g] * bench->flip_scores[g * width + k];
  double rss = bench->flip_rss - sum_of_squares(sums, bench->rank);
  for (size_t c = 0; c < bench->candidates; c++)
    z[c] = -INFINITY;
  for (size_t v = 0; v < bench->versions; v++) {
    const fg_engine_version *version = &bench->version[v];
    double k = fg_engine_version_freedom(bench, version);
    if (version->rank == 0 || k + 2 > (double)bench->freedom) continue;
    double left = rss - sum_of_squares(sums + bench->rank + version->first, version->rank);
    double one =
        fg_engine_deviate(fmax(left / rss, FG_ENGINE_RATIO_LEAST), k, (double)bench->freedom);
    z[version->candidate] = fmax(z[version->candidate], one);
  }
}
