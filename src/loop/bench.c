/* The bench: candidates whitened, projected and orthonormal, for scoring many responses. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/parallel.h"
#include "loop/bench_many.h"
#include "loop/between.h"

static size_t candidate_versions(const fg_loop_problem *problem, const fg_loop_candidate *candidate,
                                 double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES]) {
  memset(starts, 0, sizeof(double[FG_LOOP_STARTS][FG_LOOP_SHAPES]));
  return candidate->effect->starts ? candidate->effect->starts(problem, candidate, starts) : 1;
}

static fg_status list_versions(fg_context *ctx, fg_engine_bench *bench) {
  const fg_loop_problem *problem = bench->training->problem;
  double starts[FG_LOOP_STARTS][FG_LOOP_SHAPES];
  size_t room[2] = {0};
  for (size_t c = 0; c < bench->candidates; c++) {
    size_t here = candidate_versions(problem, &bench->candidate[c], starts);
    size_t columns = fg_engine_candidate_columns(problem, &bench->candidate[c]);
    size_t all = bench->versions + here;
    FG_TRY(fg_memory_reserve(ctx, all, sizeof *bench->version, &room[0], (void **)&bench->version));
    FG_TRY(fg_memory_reserve(ctx, all, sizeof *bench->shape, &room[1], (void **)&bench->shape));
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
  version->between =
      bench->between_rank > 0 && fg_engine_constant_in_levels(training, columns, count);
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
  size_t n = training->n, each = n * bench->widest;
  size_t width = training->columns + bench->columns + bench->between_rank;
  size_t from = item * VERSIONS_AT_ONCE, to = from + VERSIONS_AT_ONCE;
  double *work = NULL;
  fg_status status = FG_OK;
  FG_TRY(fg_memory_allocate(ctx, each, 2 * sizeof *work, (void **)&work));
  for (size_t v = from; status == FG_OK && v < to && v < bench->versions; v++) {
    const fg_engine_version *version = &bench->version[v];
    status = version_basis(ctx, bench, v, f->noise, work, work + each);
    if (status != FG_OK) break;
    bench->gain[f->noise * bench->versions + v] =
        fg_engine_along(n, work + each, version->rank, f->residual);
    put_rows(n, width, training->columns + version->first, work + each, version->rank,
             bench->rows[f->noise]);
  }
  free(work);
  return status;
}

static fg_status fill_noise(fg_context *ctx, fg_engine_bench *bench, size_t j) {
  const fg_engine_training *training = bench->training;
  size_t n = training->n, rank = training->columns,
         items = (bench->versions + VERSIONS_AT_ONCE - 1) / VERSIONS_AT_ONCE;
  bool few = n <= FG_ENGINE_SMALL_ROWS;
  fg_status status = FG_OK;
  double *between = NULL, *residual = NULL;
  fg_engine_span *null = &bench->null[j];
  FG_TRY_EXIT(fg_engine_span_open(ctx, training, bench->noise[j], 0, null));
  FG_TRY_EXIT(fg_engine_between_basis(ctx, training, bench->noise[j], null, &between,
                                      &bench->between_rank));
  FG_TRY_EXIT(fg_memory_allocate(ctx, n, sizeof *residual, (void **)&residual));
  memcpy(residual, training->y, n * sizeof *residual);
  fg_engine_whiten(training, bench->noise[j], residual);
  bench->rss[j] = fg_engine_project_out(n, null->basis, null->rank, residual);
  bench->between_rss[j] = fg_engine_along(n, between, bench->between_rank, residual);
  size_t behind = rank + bench->columns, width = behind + bench->between_rank;
  if (few)
    FG_TRY_EXIT(
        fg_memory_allocate(ctx, n, width * sizeof *bench->rows[j] + 1, (void **)&bench->rows[j]));
  if (few) put_rows(n, width, 0, null->basis, rank, bench->rows[j]);
  if (few) put_rows(n, width, behind, between, bench->between_rank, bench->rows[j]);
  fg_engine_bench_tell(bench, j, bench->noises + 1);
  filling f = {bench, j, residual};
  if (few)
    FG_TRY_EXIT(fg_parallel_run(ctx, 0, items, fill_versions, &f));
  else
    FG_TRY_EXIT(fg_engine_bench_fill_many(ctx, bench, residual));
exit:
  free(between);
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
