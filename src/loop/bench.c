/* The bench: candidates whitened, projected and orthonormal, for scoring many responses. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
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
    if (columns > bench->widest) bench->widest = columns;
  }
  return FG_OK;
}

/* An effect takes correlation away more than it adds: the models around the null's best, then in
 * steps down to none. */
static void thin_noises(fg_engine_bench *bench, size_t best) {
  size_t kept = 0;
  for (size_t j = 0; j < bench->noises; j++) {
    bool near = j + 1 >= best && j <= best + 1, below = j + 1 < best && (best - j) % 2 == 1;
    if (!near && !below && bench->noise[j].rho != 0) continue;
    bench->noise[kept] = bench->noise[j];
    bench->weight[kept++] = bench->weight[j];
  }
  bench->noises = kept;
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
  size_t chosen = 0;
  for (size_t j = 1; j < bench->noises; j++)
    if (sums[j] * bench->weight[j] < sums[chosen] * bench->weight[chosen]) chosen = j;
  if (training->n <= FG_ENGINE_SMALL_ROWS) {
    if (training->serial && !training->levels) thin_noises(bench, chosen);
    return FG_OK;
  }
  bench->noise[0] = bench->noise[chosen];
  bench->weight[0] = 1;
  bench->noises = 1;
  return FG_OK;
}

/* The version's columns, whitened, orthonormal beside the null: at most bench->widest × n. */
static fg_status version_basis(fg_context *ctx, const fg_engine_bench *bench, size_t v, size_t j,
                               double *columns, double *unit) {
  const fg_engine_training *training = bench->training;
  fg_engine_version *version = &bench->version[v];
  const fg_loop_candidate *candidate = &bench->candidate[version->candidate];
  size_t n = training->n, count = fg_engine_candidate_columns(training->problem, candidate);
  double lengths[FG_LOOP_COLUMNS], whole = 0;
  FG_TRY(fg_engine_gather(ctx, training, candidate, bench->shape[v], columns));
  for (size_t k = 0; k < count; k++) {
    fg_engine_whiten(training, bench->noise[j], columns + k * n);
    for (size_t i = 0; i < n; i++)
      whole += columns[k * n + i] * columns[k * n + i];
  }
  version->rank = fg_engine_orthonormal(n, bench->null[j].basis, bench->null[j].rank, columns,
                                        count, unit, lengths);
  version->length = 0;
  for (size_t k = 0; k < count; k++)
    version->length += lengths[k] / (double)count;
  version->share = whole > 0 ? version->length * (double)count / whole : 0;
  return FG_OK;
}

/* Draws are scored in single precision. */
static void put_rows(size_t n, size_t width, size_t first, const double *columns, size_t count,
                     float *rows) {
  for (size_t k = 0; k < count; k++)
    for (size_t i = 0; i < n; i++)
      rows[i * width + first + k] = (float)columns[k * n + i];
}

static double explained(size_t n, const double *unit, size_t count, const double *residual) {
  double gain = 0;
  for (size_t k = 0; k < count; k++) {
    double along = 0;
    for (size_t i = 0; i < n; i++)
      along += unit[k * n + i] * residual[i];
    gain += along * along;
  }
  return gain;
}

typedef struct filling {
  fg_engine_bench *bench;
  size_t noise;
  const double *residual;
} filling;

/* Versions that one thread makes at a time. */
enum { VERSIONS_AT_ONCE = 16 };

static fg_status fill_versions(fg_context *ctx, void *shared, size_t item) {
  const filling *f = shared;
  fg_engine_bench *bench = f->bench;
  const fg_engine_training *training = bench->training;
  size_t n = training->n, width = training->columns + bench->columns, each = n * bench->widest;
  size_t from = item * VERSIONS_AT_ONCE, to = from + VERSIONS_AT_ONCE;
  double *work = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, each, 2 * sizeof *work, (void **)&work));
  for (size_t v = from; status == FG_OK && v < to && v < bench->versions; v++) {
    const fg_engine_version *version = &bench->version[v];
    status = version_basis(ctx, bench, v, f->noise, work, work + each);
    if (status != FG_OK) break;
    bench->gain[f->noise * bench->versions + v] =
        explained(n, work + each, version->rank, f->residual);
    if (bench->rows[f->noise])
      put_rows(n, width, training->columns + version->first, work + each, version->rank,
               bench->rows[f->noise]);
  }
  free(work);
  return status;
}

static fg_status fill_noise(fg_context *ctx, fg_engine_bench *bench, size_t j) {
  const fg_engine_training *training = bench->training;
  size_t n = training->n, width = training->columns + bench->columns;
  size_t items = (bench->versions + VERSIONS_AT_ONCE - 1) / VERSIONS_AT_ONCE;
  bool few = n <= FG_ENGINE_SMALL_ROWS;
  fg_status status = FG_OK;
  double *residual = NULL;
  fg_engine_span *null = &bench->null[j];
  FG_TRY_EXIT(fg_engine_span_open(ctx, training, bench->noise[j], 0, null));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, sizeof *residual, (void **)&residual));
  memcpy(residual, training->y, n * sizeof *residual);
  fg_engine_whiten(training, bench->noise[j], residual);
  bench->rss[j] = fg_engine_project_out(n, null->basis, null->rank, residual);
  if (few)
    FG_TRY_EXIT(
        fg_memory_allocate(ctx, n, width * sizeof *bench->rows[j] + 1, (void **)&bench->rows[j]));
  if (few) put_rows(n, width, 0, null->basis, training->columns, bench->rows[j]);
  fg_engine_bench_tell(bench, j, bench->noises + 1);
  filling f = {bench, j, residual};
  FG_TRY_EXIT(fg_parallel_run(ctx, 0, items, fill_versions, &f));
exit:
  free(residual);
  return status;
}

fg_status fg_engine_bench_build(fg_context *ctx, const fg_engine_training *training,
                                const fg_loop_candidate *candidate, size_t candidates,
                                fg_engine_bench *bench) {
  fg_status status = FG_OK;
  const fg_engine_watch watch = bench->watch;
  *bench = (fg_engine_bench){
      .training = training, .candidate = candidate, .candidates = candidates, .watch = watch};
  bench->rank = training->columns;
  FG_TRY_EXIT(list_versions(ctx, bench));
  FG_TRY_EXIT(weigh_noises(ctx, bench));
  FG_TRY_EXIT(fg_memory_allocate(ctx, bench->noises, (bench->versions + 1) * sizeof *bench->gain,
                                 (void **)&bench->gain));
  for (size_t j = bench->noises; j-- > 0;)
    FG_TRY_EXIT(fill_noise(ctx, bench, j));
exit:
  if (status != FG_OK) fg_engine_bench_free(bench);
  return status;
}

void fg_engine_bench_tell(const fg_engine_bench *bench, size_t done, size_t all) {
  const fg_engine_watch *watch = &bench->watch;
  if (watch->show && all) watch->show(watch->user, watch->found, (double)done / (double)all);
}

void fg_engine_bench_free(fg_engine_bench *bench) {
  for (size_t j = 0; j < FG_ENGINE_NOISES; j++) {
    free(bench->rows[j]);
    fg_engine_span_close(&bench->null[j]);
  }
  free(bench->version);
  free(bench->shape);
  free(bench->gain);
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

static void take_ratio(const fg_engine_bench *bench, size_t v, size_t j, double weighted,
                       fg_engine_score *score) {
  const fg_engine_version *version = &bench->version[v];
  fg_engine_score *best = &score[version->candidate];
  if (version->rank == 0 ||
      fg_engine_version_freedom(bench, version) + 2 > (double)bench->freedom ||
      !(weighted < best->ratio))
    return;
  *best = (fg_engine_score){.ratio = weighted, .version = v, .noise = j};
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

static void clear_scores(size_t count, fg_engine_score *score) {
  for (size_t c = 0; c < count; c++)
    score[c] = (fg_engine_score){.ratio = INFINITY, .z = NAN};
}

void fg_engine_bench_score_data(const fg_engine_bench *bench, fg_engine_score *score,
                                size_t *null) {
  *null = 0;
  clear_scores(bench->candidates, score);
  for (size_t j = 0; j < bench->noises; j++) {
    const double *gain = bench->gain + j * bench->versions;
    if (bench->rss[j] * bench->weight[j] < bench->rss[*null] * bench->weight[*null]) *null = j;
    for (size_t v = 0; v < bench->versions; v++) {
      double left = fmax(bench->rss[j] - gain[v], FG_ENGINE_RATIO_LEAST * bench->rss[j]);
      take_ratio(bench, v, j, left * bench->weight[j], score);
    }
  }
  finish_scores(bench, bench->rss[*null] * bench->weight[*null], score);
}

/* Responses of a batch interleaved, so that every column of the bench is read once for all. */
typedef struct response_batch {
  size_t count;
  float *white; /* n × FG_ENGINE_BATCH */
  float *sums;  /* (rank + columns) × FG_ENGINE_BATCH */
  double *one;  /* n */
  double rss[FG_ENGINE_BATCH], lowest[FG_ENGINE_BATCH];
} response_batch;

static void whiten_batch(const fg_engine_bench *bench, fg_engine_noise noise, const double *y,
                         response_batch *batch) {
  size_t n = bench->training->n;
  for (size_t b = 0; b < FG_ENGINE_BATCH; b++) {
    bool used = b < batch->count;
    batch->rss[b] = 0;
    if (used) {
      memcpy(batch->one, y + b * n, n * sizeof *batch->one);
      fg_engine_whiten(bench->training, noise, batch->one);
    }
    for (size_t i = 0; i < n; i++) {
      batch->white[i * FG_ENGINE_BATCH + b] = used ? (float)batch->one[i] : 0;
      batch->rss[b] += used ? batch->one[i] * batch->one[i] : 0;
    }
  }
}

/* Columns in blocks whose sums stay in the nearest cache. */
enum { BLOCK = 64 };

/* One value of every response of a batch. */
typedef float batch_lane __attribute__((vector_size(FG_ENGINE_BATCH * sizeof(float)), aligned(4)));

/* Four rows at a time, so that a sum is loaded and stored once for all four. */
__attribute__((target_clones("avx2", "default"))) static void
products(size_t n, size_t width, const float *rows, const float *white, float *sums) {
  const batch_lane *at = (const batch_lane *)white;
  batch_lane *sum = (batch_lane *)sums;
  memset(sums, 0, width * sizeof *sum);
  for (size_t from = 0; from < width; from += BLOCK) {
    size_t to = from + BLOCK < width ? from + BLOCK : width, i = 0;
    for (; i + 4 <= n; i += 4) {
      const float *row = rows + i * width;
      batch_lane a = at[i], b = at[i + 1], c = at[i + 2], d = at[i + 3];
      for (size_t k = from; k < to; k++)
        sum[k] += row[k] * a + row[width + k] * b + row[2 * width + k] * c + row[3 * width + k] * d;
    }
    for (; i < n; i++)
      for (size_t k = from; k < to; k++)
        sum[k] += rows[i * width + k] * at[i];
  }
}

static double sum_of_squares(const float *v, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++)
    sum += (double)v[i * FG_ENGINE_BATCH] * v[i * FG_ENGINE_BATCH];
  return sum;
}

static void score_at(const fg_engine_bench *bench, size_t j, const double *y, response_batch *batch,
                     fg_engine_score *score) {
  size_t width = bench->rank + bench->columns;
  whiten_batch(bench, bench->noise[j], y, batch);
  products(bench->training->n, width, bench->rows[j], batch->white, batch->sums);
  for (size_t b = 0; b < batch->count; b++) {
    double rss = batch->rss[b] - sum_of_squares(batch->sums + b, bench->rank);
    const float *sums = batch->sums + bench->rank * FG_ENGINE_BATCH + b;
    if (rss * bench->weight[j] < batch->lowest[b]) batch->lowest[b] = rss * bench->weight[j];
    for (size_t v = 0; v < bench->versions; v++) {
      const fg_engine_version *version = &bench->version[v];
      double left = rss - sum_of_squares(sums + version->first * FG_ENGINE_BATCH, version->rank);
      take_ratio(bench, v, j, fmax(left, FG_ENGINE_RATIO_LEAST * rss) * bench->weight[j],
                 score + b * bench->candidates);
    }
  }
}

fg_status fg_engine_bench_score(fg_context *ctx, const fg_engine_bench *bench, size_t count,
                                const double *y, fg_engine_score *score) {
  size_t n = bench->training->n, width = bench->rank + bench->columns;
  fg_status status = FG_OK;
  response_batch batch = {.count = count};
  clear_scores(count * bench->candidates, score);
  size_t block = FG_ENGINE_BATCH * sizeof *batch.white;
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, block, (void **)&batch.white));
  FG_TRY_EXIT(fg_memory_allocate(ctx, width, block, (void **)&batch.sums));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, sizeof *batch.one, (void **)&batch.one));
  for (size_t b = 0; b < count; b++)
    batch.lowest[b] = INFINITY;
  for (size_t j = 0; j < bench->noises; j++)
    score_at(bench, j, y, &batch, score);
  for (size_t b = 0; b < count; b++)
    finish_scores(bench, batch.lowest[b], score + b * bench->candidates);
exit:
  free(batch.white);
  free(batch.sums);
  free(batch.one);
  return status;
}
