/* Max-T over all candidates: by flips of whole groups' signs, and by simulation of the null. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/select.h"
#include "loop/engine_random.h"
#include "loop/permute.h"

static size_t family(const fg_engine_bench *bench, size_t candidate) {
  return fg_engine_is_curve(&bench->candidate[candidate]);
}

/* Share of the draws' maxima at or above z, the data themselves being one draw. */
static double tail(const double *sorted, size_t draws, double z) {
  size_t low = 0, high = draws;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (sorted[middle] < z - 1e-9)
      low = middle + 1;
    else
      high = middle;
  }
  return (1 + (double)(draws - low)) / (1 + (double)draws);
}

/* All patterns where there are few (the first sign stays: a pattern and its mirror are one),
 * random ones otherwise. */
static size_t draw_count(size_t flips, size_t draws) {
  if (flips <= 1) return 0;
  return flips - 1 < 12 && ((size_t)1 << (flips - 1)) - 1 <= 2 * draws
             ? ((size_t)1 << (flips - 1)) - 1
             : draws;
}

static void draw_signs(size_t flips, size_t draws, size_t draw, uint64_t *seed, signed char *sign) {
  bool all = draw_count(flips, draws) == ((size_t)1 << (flips - 1 < 12 ? flips - 1 : 12)) - 1;
  for (size_t g = 0; g < flips; g++)
    sign[g] = fg_engine_random_next(seed) >> 63 ? 1 : -1;
  for (size_t g = 0; all && g < flips; g++)
    sign[g] = g > 0 && ((draw + 1) >> (g - 1)) & 1 ? -1 : 1;
}

static void take_maximum(const fg_engine_bench *bench, const double *z, const double *shift,
                         const double *scale, double maximum[2]) {
  maximum[0] = maximum[1] = -INFINITY;
  for (size_t c = 0; c < bench->candidates; c++) {
    double value = shift ? (z[c] - shift[c]) / scale[c] : z[c];
    size_t f = family(bench, c);
    if (value > maximum[f]) maximum[f] = value;
  }
}

/* Index of the largest of `count` sorted maxima that is no accident yet. */
static size_t critical_index(size_t count, double accept_p) {
  double last = (double)(count - 1);
  return (size_t)(last - ceil(accept_p * last - 1e-9)); /* no step up by rounding */
}

static fg_status flip_all(fg_context *ctx, const fg_engine_bench *bench, const fg_engine_null *null,
                          fg_engine_judgement *judgement, double *critical) {
  size_t flips = bench->training->flips, count = draw_count(flips, null->draws);
  uint64_t seed = null->seed;
  fg_status status = FG_OK;
  double *maxima = NULL, *z = NULL;
  signed char *sign = NULL;
  judgement->smallest_p = 1 / (1 + (double)count);
  FG_TRY_EXIT(fg_memory_allocate(ctx, count + 1, 2 * sizeof *maxima, (void **)&maxima));
  FG_TRY_EXIT(fg_memory_allocate(ctx, bench->candidates, sizeof *z, (void **)&z));
  FG_TRY_EXIT(fg_memory_allocate(ctx, flips, sizeof *sign, (void **)&sign));
  for (size_t b = 0; b < count; b++) {
    double maximum[2];
    fg_engine_bench_tell(bench, 1, b, count);
    draw_signs(flips, null->draws, b, &seed, sign);
    fg_engine_bench_flip(bench, sign, z);
    take_maximum(bench, z, NULL, NULL, maximum);
    maxima[b] = maximum[0];
    maxima[count + 1 + b] = maximum[1];
  }
  for (size_t f = 0; f < 2; f++)
    fg_sort(maxima + f * (count + 1), count);
  for (size_t i = 0; i < flips; i++)
    sign[i] = 1;
  fg_engine_bench_flip(bench, sign, z);
  for (size_t c = 0; c < bench->candidates; c++)
    judgement->p_flip[c] = tail(maxima + family(bench, c) * (count + 1), count, z[c]);
  *critical = count ? maxima[critical_index(count, null->accept_p)] : INFINITY;
exit:
  free(maxima);
  free(z);
  free(sign);
  return status;
}

/* In twice the log likelihood: the 90 % quantile of chi² with one degree of freedom. */
#define NOT_RULED_OUT 2.7

/* The strongest correlation that the data do not rule out, so that a short series does not pass for
 * white by luck. */
static size_t cautious_noise(const fg_engine_bench *bench, const double *criterion, size_t best) {
  size_t chosen = best;
  double allowed = criterion[best] * exp(NOT_RULED_OUT / (double)bench->freedom);
  for (size_t j = 0; j < bench->noises; j++) {
    fg_engine_noise noise = bench->noise[chosen], other = bench->noise[j];
    bool stronger =
        other.rho > noise.rho || (other.rho == noise.rho && other.lambda > noise.lambda);
    if (criterion[j] <= allowed && stronger) chosen = j;
  }
  return chosen;
}

/* With the best candidate in the model: an effect over the order must not pass for correlation, nor
 * raise the bar for itself. */
static void noise_criteria(const fg_engine_bench *bench, const fg_engine_version *best,
                           double *criterion) {
  const fg_engine_training *training = bench->training;
  size_t n = training->n, width = bench->rank + bench->columns;
  for (size_t j = 0; j < bench->noises; j++) {
    double *y = bench->scratch + width, *sums = bench->scratch, rss = 0;
    memcpy(y, training->y, n * sizeof *y);
    fg_engine_whiten(training, bench->noise[j], y);
    memset(sums, 0, width * sizeof *sums);
    for (size_t i = 0; i < n; i++) {
      rss += y[i] * y[i];
      for (size_t k = 0; k < width; k++)
        sums[k] += bench->rows[j][i * width + k] * y[i];
    }
    for (size_t k = 0; k < bench->rank; k++)
      rss -= sums[k] * sums[k];
    for (size_t k = 0; k < best->rank; k++)
      rss -= pow(sums[bench->rank + best->first + k], 2);
    criterion[j] = fmax(rss, 1e-300) * bench->weight[j];
  }
}

/* Mean and sd of every candidate's own null put all on one scale. */
static void standardise(size_t draws, size_t count, const double *z, double *shift, double *scale) {
  for (size_t c = 0; c < count; c++) {
    double sum = 0, squares = 0;
    for (size_t b = 0; b < draws; b++) {
      double value = isfinite(z[b * count + c]) ? z[b * count + c] : 0;
      sum += value;
      squares += value * value;
    }
    shift[c] = sum / (double)draws;
    scale[c] = sqrt(fmax(squares / (double)draws - shift[c] * shift[c], 1e-12));
  }
}

static void simulate(const fg_engine_bench *bench, fg_engine_noise noise, size_t draws,
                     uint64_t seed, double *y, fg_engine_score *score, double *z) {
  const fg_engine_training *training = bench->training;
  for (size_t b = 0; b < draws; b++) {
    fg_engine_bench_tell(bench, 1, b, draws);
    for (size_t i = 0; i < training->n; i++)
      y[i] = fg_engine_random_normal(&seed);
    fg_engine_colour(training, noise, y);
    fg_engine_bench_score(bench, y, score, NULL);
    for (size_t c = 0; c < bench->candidates; c++)
      z[b * bench->candidates + c] = score[c].z;
  }
}

static size_t best_candidate(const fg_engine_bench *bench, const fg_engine_score *score) {
  size_t best = 0;
  for (size_t c = 1; c < bench->candidates; c++)
    if (score[c].z > score[best].z || isnan(score[best].z)) best = c;
  return best;
}

/* The F ratio at which a candidate would just pass: at the 99 % point of its family's maxima. */
static void critical_ratios(const fg_engine_bench *bench, const double critical[2],
                            const double *shift, const double *scale,
                            fg_engine_judgement *judgement) {
  for (size_t c = 0; c < bench->candidates; c++) {
    if (!isfinite(judgement->score[c].z)) continue;
    double k = fg_engine_version_freedom(bench, &bench->version[judgement->score[c].version]);
    double z = critical[family(bench, c)];
    if (shift) z = shift[c] + scale[c] * z;
    double f = fg_engine_deviate_to_f(z, k, (double)bench->freedom - k);
    judgement->f_critical[c] = fmax(judgement->f_critical[c], f);
    judgement->z_critical[c] = z;
  }
}

static fg_status simulate_all(fg_context *ctx, const fg_engine_bench *bench, size_t noise,
                              const fg_engine_null *null, fg_engine_judgement *judgement) {
  size_t count = bench->candidates, draws = null->draws;
  double passing = 1 - null->accept_p / FG_ENGINE_FAMILIES;
  fg_status status = FG_OK;
  double *z = NULL, *y = NULL, *maxima = NULL, *shift = NULL, critical[2];
  fg_engine_score *score = NULL;
  FG_TRY_EXIT(fg_memory_allocate(ctx, draws, count * sizeof *z + 1, (void **)&z));
  FG_TRY_EXIT(fg_memory_allocate(ctx, bench->training->n, sizeof *y, (void **)&y));
  FG_TRY_EXIT(fg_memory_allocate(ctx, draws, 2 * sizeof *maxima, (void **)&maxima));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, 2 * sizeof *shift, (void **)&shift));
  FG_TRY_EXIT(fg_memory_allocate(ctx, count, sizeof *score, (void **)&score));
  simulate(bench, bench->noise[noise], draws, null->seed ^ 0x5851f42d4c957f2du, y, score, z);
  double *scale = shift + count;
  standardise(draws, count, z, shift, scale);
  for (size_t b = 0; b < draws; b++) {
    double maximum[2];
    take_maximum(bench, z + b * count, shift, scale, maximum);
    maxima[b] = maximum[0];
    maxima[draws + b] = maximum[1];
  }
  for (size_t f = 0; f < 2; f++) {
    fg_sort(maxima + f * draws, draws);
    critical[f] = maxima[f * draws + (size_t)((double)draws * passing)];
  }
  for (size_t c = 0; c < count; c++)
    judgement->p_simulated[c] =
        fmin(1, FG_ENGINE_FAMILIES * tail(maxima + family(bench, c) * draws, draws,
                                          (judgement->score[c].z - shift[c]) / scale[c]));
  critical_ratios(bench, critical, shift, scale, judgement);
exit:
  free(z);
  free(y);
  free(maxima);
  free(shift);
  free(score);
  return status;
}

static fg_status allocate(fg_context *ctx, size_t count, fg_engine_judgement *judgement) {
  *judgement = (fg_engine_judgement){.candidates = count};
  size_t size = sizeof *judgement->p_flip;
  FG_TRY(fg_memory_allocate(ctx, count, sizeof *judgement->score, (void **)&judgement->score));
  FG_TRY(fg_memory_allocate(ctx, count, size, (void **)&judgement->p_flip));
  FG_TRY(fg_memory_allocate(ctx, count, size, (void **)&judgement->p_simulated));
  FG_TRY(fg_memory_allocate(ctx, count, size, (void **)&judgement->f_critical));
  FG_TRY(fg_memory_allocate(ctx, count, size, (void **)&judgement->z_critical));
  for (size_t c = 0; c < count; c++)
    judgement->p_simulated[c] = judgement->z_critical[c] = NAN;
  return FG_OK;
}

fg_status fg_engine_permute(fg_context *ctx, fg_engine_bench *bench, const fg_engine_null *null,
                            fg_engine_judgement *judgement) {
  fg_status status = FG_OK;
  bool small = bench->training->n <= FG_ENGINE_SMALL_ROWS;
  double critical = INFINITY, criterion[FG_ENGINE_NOISES];
  FG_TRY_EXIT(allocate(ctx, bench->candidates, judgement));
  if (bench->candidates == 0) goto exit;
  if (small)
    fg_engine_bench_score(bench, bench->training->y, judgement->score, &judgement->null_noise);
  size_t best = best_candidate(bench, judgement->score);
  size_t noise = 0;
  if (small) {
    noise_criteria(bench, &bench->version[judgement->score[best].version], criterion);
    for (size_t j = 1; j < bench->noises; j++)
      if (criterion[j] < criterion[judgement->best_noise]) judgement->best_noise = j;
    noise = cautious_noise(bench, criterion, judgement->best_noise);
    judgement->cautious_noise = noise;
  }
  FG_TRY_EXIT(fg_engine_bench_prepare_flips(ctx, bench, noise, small ? NULL : judgement->score));
  /* Few: p_flip and smallest_p stay 0. */
  if (!bench->training->problem->few || !small) {
    FG_TRY_EXIT(flip_all(ctx, bench, null, judgement, &critical));
    critical_ratios(bench, (double[2]){critical, critical}, NULL, NULL, judgement);
  }
  if (small) FG_TRY_EXIT(simulate_all(ctx, bench, noise, null, judgement));
exit:
  if (status != FG_OK) fg_engine_judgement_free(judgement);
  return status;
}

void fg_engine_judgement_free(fg_engine_judgement *judgement) {
  free(judgement->score);
  free(judgement->p_flip);
  free(judgement->p_simulated);
  free(judgement->f_critical);
  free(judgement->z_critical);
  *judgement = (fg_engine_judgement){0};
}
